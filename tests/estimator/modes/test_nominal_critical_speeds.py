"""Critical speeds of the document's nominal model, and which of them a run crosses."""

import math

import pytest

from estimator.modes.nominal_critical_speeds import crossed_critical_speeds, nominal_critical_speeds
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from tests.estimator.rigid_rotor import bounce, rigid_rotor, tilting_stiffness
from tests.estimator.trains import chapter_3


def test_modes_crossed_are_the_critical_speeds_between_the_speeds() -> None:
    train = chapter_3()
    every = nominal_critical_speeds(train).tolist()
    rpm = [rad_per_s_to_rpm(one) for one in every]
    middle, highest = (every[1] + every[2]) / 2, rpm_to_rad_per_s(train.speed_range.maximum_rpm)
    lowest = rpm_to_rad_per_s(300.0)
    assert crossed_critical_speeds(train, lowest=lowest, highest=middle) == pytest.approx(rpm[:2], abs=0.1)
    assert crossed_critical_speeds(train, lowest=middle, highest=highest) == pytest.approx(rpm[2:], abs=0.1)


def test_nominal_critical_speeds_are_those_of_the_rigid_rotor_in_its_speed_range() -> None:
    rotor = rigid_rotor(diametral=0.05, polar=0.03)
    conical = [math.sqrt(tilting_stiffness() / (0.05 + sign * 0.03)) for sign in (1, -1)]
    highest = rpm_to_rad_per_s(rotor.speed_range.maximum_rpm)
    expected = sorted(one for one in (bounce(), bounce(), *conical) if one <= highest)
    assert len(expected) >= 2
    assert nominal_critical_speeds(rotor) == pytest.approx(expected, rel=1e-4)
