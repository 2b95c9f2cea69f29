"""Gains that a wrong unit of the trial weights explains, the likeliest pair first."""

import numpy as np
import pytest

from estimator.calibration.likely_gains import unlikely_gains
from estimator.units import KILOGRAM_METRES

ABOUT = np.exp(0.3j) * np.array([1.1, 0.95, 1.0, 1.08], dtype=complex)


@pytest.mark.parametrize(
    ("given", "meant"), [("g in", "g mm"), ("g mm", "g in"), ("oz in", "g in"), ("g in", "oz in"), ("kg m", "kg mm")]
)
def test_the_unit_that_was_given_and_the_one_that_explains_the_gains_come_first(given: str, meant: str) -> None:
    factor = KILOGRAM_METRES[meant] / KILOGRAM_METRES[given]
    (words,) = unlikely_gains(factor * ABOUT, {given})
    assert f"(such as {meant} given as {given}" in words
    assert "on average, all nearly alike, which no usual chain does" in words
    assert words.count(f"given as {given}") == words.count("given as")


def test_usual_gains_are_no_doubt_and_unlike_ones_no_common_factor() -> None:
    assert unlikely_gains(ABOUT, {"g mm"}) == ()
    (words,) = unlikely_gains(np.array([12.7, 50.8, 25.4, 25.4], dtype=complex), {"g mm"})
    assert "alike" not in words
