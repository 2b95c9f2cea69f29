"""Tests what a run covers: speeds, density, channels."""

import numpy as np
import pytest

from estimator.phasors.measurement import Measurement
from estimator.runs.coverage import coverage
from estimator.units import rpm_to_rad_per_s
from tests.plant import CHANNELS, machine


def run(rpm: list[float], *, bad: int = 0) -> Measurement:
    """Phasors on all channels, the first `bad` samples of the last one unusable."""
    speed = rpm_to_rad_per_s(1.0) * np.array(rpm)
    phasor = np.full((speed.size, len(CHANNELS)), 1e-5 + 0j)
    phasor[:bad, -1] = np.nan
    return Measurement.of(speed=speed, phasor=phasor)


def test_part_density_and_largest_hole() -> None:
    found = coverage(machine(), run([300.0, 400.0, 1000.0, 1650.0, 1600.0]), duration_s=4.0)
    assert found.part == pytest.approx(1350 / 2700)
    assert found.samples_per_rpm == pytest.approx(5 / 1350)
    assert found.largest_hole_rpm == pytest.approx(600.0)
    assert found.duration_s == 4.0


def test_usable_is_the_part_of_good_values_per_channel() -> None:
    found = coverage(machine(), run([500.0, 600.0, 700.0, 800.0], bad=1), duration_s=4.0)
    assert found.usable == {"B2X": 1.0, "B2Y": 1.0, "B3X": 1.0, "B3Y": 0.75}


def test_one_sample_covers_nothing() -> None:
    found = coverage(machine(), run([500.0]), duration_s=0.0)
    assert (found.part, found.samples_per_rpm, found.largest_hole_rpm) == (0.0, 0.0, 0.0)
