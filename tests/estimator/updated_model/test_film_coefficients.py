"""Coefficients of films over speed: those of the results at the reported speeds, smooth between, withheld where uncertain."""

import numpy as np
import pytest

from estimator.machine.film_speeds import reported_rpm
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.derived_quantities import model_quantities
from estimator.updated_model.film_coefficients import film_coefficients
from estimator.updated_model.model import expected_model
from tests.estimator.models import rich_model
from tests.estimator.updated_model.test_film_results import machine_of, uncertain


@pytest.mark.parametrize("size", [0.1, 3.0])
def test_they_are_those_of_the_results_at_the_reported_speeds(size: float) -> None:
    machine = machine_of()
    model = uncertain(machine, size=size)
    rpm = reported_rpm(machine)
    derived = {one.name: one for one in model_quantities(model, speed=100.0)}
    withheld = 0
    for one in film_coefficients(model, speed=np.array([rpm_to_rad_per_s(at) for at in rpm])):
        for place, at in enumerate(rpm):
            told = derived[f"bearing.{one.bearing}.{one.term}@{at:g}rpm"]
            assert told.unit == one.unit
            if told.value is None:
                assert np.isnan([one.value[place], one.lower[place], one.upper[place]]).all()
                withheld += 1
            else:
                found = (one.value[place], one.lower[place], one.upper[place])
                assert found == pytest.approx((told.value, told.lower, told.upper), rel=1e-9)
    assert (withheld > 0) == (size > 1.0)


def test_between_those_speeds_they_are_smooth_and_lie_in_their_bands() -> None:
    machine = machine_of()
    low, high = (rpm_to_rad_per_s(reported_rpm(machine)[place]) for place in (0, -1))
    found = film_coefficients(uncertain(machine), speed=np.linspace(low, high, 60))
    assert [one.term for one in found[:8]] == ["kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy"]
    assert [one.bearing for one in found[::8]] == [one.id for one in machine.bearings]
    for one in found:
        assert (one.lower < one.value).all()
        assert (one.value < one.upper).all()
        assert np.abs(np.diff(one.value)).max() < 0.2 * np.ptp(one.value)


def test_a_train_without_films_has_none() -> None:
    model = rich_model()
    assert film_coefficients(model, speed=np.array([100.0, 200.0])) == ()
    assert film_coefficients(expected_model(machine_of()), speed=np.array([100.0]))
