"""Stability margin of a train on its films: that of the eigenproblem of its document, with the error of differences."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.stability_margin import stability_margin
from estimator.machine.film_speeds import reported_rpm
from estimator.statics.equilibrium import film_train
from estimator.statics.film_stability import least_damped_whirl
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.models import rich_model
from tests.estimator.updated_model.propagation import propagated
from tests.estimator.updated_model.test_alignment_results import before, elevations, machine_of


def decrement(model: UpdatedModel) -> float:
    found = stability_margin(model)
    assert found is not None
    return found.log_decrement


def test_it_is_that_of_the_eigenproblem_at_running_speed() -> None:
    machine = machine_of()
    speed = rpm_to_rad_per_s(reported_rpm(machine)[-1])
    equilibrium = film_train(machine).equilibrium(speed)
    assert equilibrium is not None
    alone, found = least_damped_whirl(machine, equilibrium), stability_margin(expected_model(machine))
    assert alone is not None
    assert found is not None
    assert alone.frequency < speed
    assert found.speed == pytest.approx(speed)
    assert found.frequency == pytest.approx(alone.frequency, rel=1e-3)
    assert found.log_decrement == pytest.approx(alone.log_decrement, rel=1e-2)
    assert found.error == 0.0


def test_its_error_is_that_of_differences() -> None:
    model = before(expected_model(machine_of()))
    model = replace(model, covariance=1e-2 * model.covariance)  # where it is linear
    found = stability_margin(model)
    assert found is not None
    expected = float(np.sqrt(propagated(lambda one: np.array([decrement(one)]), model)[0, 0]))
    assert found.error == pytest.approx(expected, rel=1e-2)


def test_a_bearing_that_is_unloaded_takes_it_away() -> None:
    model = expected_model(machine_of("rigid"))
    values = model.values.copy()
    values[elevations(model)[1]] -= 40e-6
    assert decrement(replace(model, values=values)) < decrement(model)


def test_trains_without_films_have_none() -> None:
    assert stability_margin(rich_model()) is None
