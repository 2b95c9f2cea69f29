"""What a run covers: speeds, modes, density, channels."""

import math

import numpy as np
import pytest

from estimator.coverage import coverage, nominal_critical_speeds
from estimator.machine import Machine
from estimator.measurement import Measurement
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from tests.estimator.rigid_rotor import bounce, rigid_rotor, tilting_stiffness
from tests.estimator.trains import chapter_3
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


def test_modes_crossed_are_the_critical_speeds_between_the_speeds() -> None:
    train = chapter_3()
    every = [rad_per_s_to_rpm(one) for one in nominal_critical_speeds(train).tolist()]
    middle = (every[1] + every[2]) / 2
    low, high = sweep(train, 300.0, middle), sweep(train, middle, train.speed_range.maximum_rpm)
    assert coverage(train, low, duration_s=1.0).critical_speeds_rpm == pytest.approx(every[:2], abs=0.1)
    assert coverage(train, high, duration_s=1.0).critical_speeds_rpm == pytest.approx(every[2:], abs=0.1)


def test_nominal_critical_speeds_are_those_of_the_rigid_rotor_in_its_speed_range() -> None:
    rotor = rigid_rotor(diametral=0.05, polar=0.03)
    conical = [math.sqrt(tilting_stiffness() / (0.05 + sign * 0.03)) for sign in (1, -1)]
    highest = rpm_to_rad_per_s(rotor.speed_range.maximum_rpm)
    expected = sorted(one for one in (bounce(), bounce(), *conical) if one <= highest)
    assert len(expected) >= 2
    assert nominal_critical_speeds(rotor) == pytest.approx(expected, rel=1e-4)


def sweep(train: Machine, first: float, last: float) -> Measurement:
    """Ten samples between two speeds [r/min]."""
    speed = rpm_to_rad_per_s(1.0) * np.linspace(first, last, 10)
    return Measurement.of(speed=speed, phasor=np.ones((10, len(train.probes)), dtype=complex))
