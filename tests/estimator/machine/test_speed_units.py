"""Speeds outside the document's range, and the units that would bring them into it."""

import math

import numpy as np
import pytest

from estimator.machine.rules import SpeedRange
from estimator.machine.speed_units import outside_speed_range, short_of_speed_range, speed_units
from estimator.units import rpm_to_rad_per_s

RANGE = SpeedRange(minimum_rpm=300, maximum_rpm=3600)
RUN = np.linspace(rpm_to_rad_per_s(310.0), rpm_to_rad_per_s(3500.0), 40)


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (math.pi / 30.0, "speeds in rad/s that were sent as r/min"),
        (1.0 / 60.0, "speeds in Hz that were sent as r/min"),
        (60.0, "speeds in r/min that were sent as Hz"),
        (30.0 / math.pi, "speeds in r/min that were sent as rad/s"),
    ],
)
def test_each_unit_that_was_taken_for_another_is_reported(factor: float, words: str) -> None:
    found = speed_units(RANGE, factor * RUN)
    assert words in [one.words for one in found]
    assert next(one.factor for one in found if one.words == words) == pytest.approx(1.0 / factor)


def test_a_run_that_never_enters_the_range_is_reported_and_one_that_does_is_not() -> None:
    assert outside_speed_range(RANGE, RUN) == ""
    assert outside_speed_range(RANGE, np.zeros(3)) == ""
    assert outside_speed_range(RANGE, np.concatenate([0.001 * RUN, RUN[:1]])) == ""
    assert outside_speed_range(RANGE, RUN / 60.0) == (
        "it turns at 5.167 to 58.33 r/min and never enters the document's speed range, 300 to 3600 r/min: "
        "speeds in rad/s that were sent as r/min or speeds in Hz that were sent as r/min?"
    )
    assert outside_speed_range(RANGE, RUN / 1e4).endswith("is the unit of the speeds right?")


def test_a_machine_that_covers_a_small_part_of_the_range_is_reported_with_the_unit_that_would_explain_it() -> None:
    assert short_of_speed_range(RANGE, RUN) == ""
    assert short_of_speed_range(RANGE, np.zeros(3)) == ""
    as_rad_per_s = np.array([10.0, rpm_to_rad_per_s(3500.0) * math.pi / 30.0])
    assert short_of_speed_range(RANGE, as_rad_per_s) == (
        "it turned at 95.49 to 366.5 r/min, 2 % of 300 to 3600 r/min: "
        "speeds in rad/s that were sent as r/min or speeds in Hz that were sent as rad/s?"
    )
    at_speed = np.array([rpm_to_rad_per_s(3000.0), rpm_to_rad_per_s(3010.0)])
    assert short_of_speed_range(RANGE, at_speed).endswith("0 % of 300 to 3600 r/min; a run sweeps through it")
