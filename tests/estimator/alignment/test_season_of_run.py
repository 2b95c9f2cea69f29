"""Season of a run: what follows the temperature differs as much as the oil does."""

import pytest
from msgspec.structs import replace

from estimator.alignment.season_of_run import season_of_run
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.updated_model.test_alignment_results import machine_of

STATED = HealthyVariation(slow_oil=0.3, slow_viscosity=0.02, slow_clearance=0.01)


def with_oil(model: UpdatedModel, factor: float) -> UpdatedModel:
    """The model of a machine whose oil is believed to be thicker by a factor, as its temperature says."""
    machine: Machine = model.machine
    bearings = []
    for one in machine.bearings:
        assert one.film is not None
        assert one.film.oil.viscosity is not None
        oil = one.film.oil.model_copy(update={"viscosity": factor * one.film.oil.viscosity})
        bearings.append(one.model_copy(update={"film": one.film.model_copy(update={"oil": oil})}))
    return replace(model, machine=machine.model_copy(update={"bearings": tuple(bearings)}))


MODEL = expected_model(machine_of())


def test_a_run_of_the_same_oil_is_of_the_same_season() -> None:
    found = season_of_run(STATED, [MODEL], MODEL, shift=0.0, error=0.03)
    assert found.slow_oil == 0.3
    assert found.slow_viscosity == pytest.approx(0.002)
    assert found.slow_clearance == pytest.approx(0.001)


def test_the_farther_the_oil_the_farther_what_follows_it() -> None:
    half, far = (season_of_run(STATED, [MODEL], MODEL, shift=shift, error=0.0) for shift in (-0.15, 0.9))
    assert (half.slow_viscosity, half.slow_clearance) == pytest.approx((0.01, 0.005))
    assert (far.slow_oil, far.slow_viscosity, far.slow_clearance) == pytest.approx((0.9, 0.06, 0.03))


def test_a_season_that_the_temperature_tells_is_one_too() -> None:
    found = season_of_run(STATED, [MODEL] * 2, with_oil(MODEL, 1.3498588), shift=0.0, error=0.0)
    assert found.slow_viscosity == pytest.approx(0.02, rel=1e-6)
    assert found.slow_oil == 0.3


def test_a_machine_without_seasons_of_oil_keeps_what_is_stated() -> None:
    machine = MODEL.machine
    still = STATED.model_copy(update={"slow_oil": 0.0})
    operation = machine.operation.model_copy(update={"healthy_variation": still})
    model = replace(MODEL, machine=machine.model_copy(update={"operation": operation}))
    found = season_of_run(still, [model], model, shift=0.1, error=0.0)
    assert (found.slow_viscosity, found.slow_clearance) == (0.02, 0.01)
