"""The fitted response: what the fit itself predicts, with the errors that its covariance leaves."""

import numpy as np
import pytest

from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.updated_model.fitted_response import fitted_response
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.model import model_at
from tests.plant import document
from tests.plant import machine as plant_machine

SPEED = np.linspace(40.0, 300.0, 25)


def with_chains() -> Machine:
    """The plant's machine, with gains and run-outs of two channels unknown."""
    probes = [one | {"gain_spread": 0.05, "run_out_spread": 2e-6} for one in document()["probes"][:2]]
    return plant_machine(probes=[*probes, *document()["probes"][2:]])


def identified(machine: Machine, direction: float) -> tuple[FitProblem, np.ndarray, np.ndarray]:
    """A fit's problem, a point somewhere (n,) and a covariance (n, n)."""
    turning = np.full(SPEED.size, direction)
    train = condense(machine, speed=SPEED, direction=turning)
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    measurement = Measurement.of(speed=SPEED, phasor=np.ones((SPEED.size, len(machine.probes)), complex), direction=direction)
    problem = FitProblem(train, measurement, coordinates, Noise(), np.zeros(measurement.phasor.shape, dtype=bool))
    rng = np.random.default_rng(5)
    theta = 0.3 * rng.standard_normal(coordinates.size)
    spread = rng.standard_normal((coordinates.size, coordinates.size)) * 1e-3 * coordinates.unit[:, None]
    return problem, coordinates.point(theta), spread @ spread.T


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_it_is_what_the_fit_predicts(direction: float) -> None:
    machine = with_chains()
    problem, point, covariance = identified(machine, direction)
    turning = np.full(SPEED.size, direction)
    found = fitted_response(machine, problem.coordinates.names, point, covariance, speed=SPEED, direction=turning)
    expected = problem.model(problem.coordinates.theta(point))
    assert np.allclose(found.value, expected, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_band_is_that_of_differences(direction: float) -> None:
    machine = with_chains()
    problem, point, covariance = identified(machine, direction)
    turning = np.full(SPEED.size, direction)
    found = fitted_response(machine, problem.coordinates.names, point, covariance, speed=SPEED, direction=turning)
    columns = []
    for place, size in enumerate(np.sqrt(np.diag(covariance))):
        step = np.zeros(point.size)
        step[place] = 1e-3 * size
        ahead, behind = (problem.model(problem.coordinates.theta(point + sign * step)) for sign in (1, -1))
        columns.append((ahead - behind) / (2e-3 * size))
    slope = np.moveaxis(np.array(columns), 0, -1)
    parts = np.stack([slope.real, slope.imag], axis=-2)
    expected = parts @ covariance @ np.swapaxes(parts, -1, -2)
    largest = np.abs(expected).max(axis=(-2, -1), keepdims=True)
    assert np.all(np.abs(found.covariance - expected) < 1e-4 * largest)
    assert np.all((found.lower <= found.amplitude) & (found.amplitude <= found.upper))


def test_without_chains_it_is_the_response_of_the_updated_model() -> None:
    machine = plant_machine()
    problem, point, covariance = identified(machine, 1.0)
    names = problem.coordinates.names
    found = fitted_response(machine, names, point, covariance, speed=SPEED, direction=np.ones(SPEED.size))
    model = model_at(machine, names, point, covariance)
    band = forced_response(model, speed=SPEED).band(model)
    assert np.allclose(found.value, band.value)
    assert np.allclose(found.upper, band.upper)


def test_a_channel_that_was_not_identified_is_exact() -> None:
    """The coordinates of chains may be missing, those of the shaft may not."""
    machine = with_chains()
    problem, point, covariance = identified(plant_machine(), 1.0)
    names = problem.coordinates.names
    found = fitted_response(machine, names, point, covariance, speed=SPEED, direction=np.ones(SPEED.size))
    plain = fitted_response(plant_machine(), names, point, covariance, speed=SPEED, direction=np.ones(SPEED.size))
    assert np.allclose(found.value, plain.value)
    with pytest.raises(ValueError, match=r"it lacks bearing\.B1\.kxx"):
        fitted_response(machine, names[1:], point[1:], covariance[1:, 1:], speed=SPEED, direction=np.ones(SPEED.size))


def test_many_speeds_are_as_each_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are computed in blocks, so that the slopes of a long run do not fill the memory."""
    machine = with_chains()
    problem, point, covariance = identified(machine, 1.0)
    turning = np.where(np.arange(SPEED.size) % 3 == 0, 1.0, -1.0)
    whole = fitted_response(machine, problem.coordinates.names, point, covariance, speed=SPEED, direction=turning)
    monkeypatch.setattr("estimator.rotor.condensation.BLOCK", 7)
    found = fitted_response(machine, problem.coordinates.names, point, covariance, speed=SPEED, direction=turning)
    for name in ("value", "covariance", "lower", "upper"):
        assert getattr(found, name).shape == getattr(whole, name).shape
        assert np.allclose(getattr(found, name), getattr(whole, name), rtol=1e-9, atol=1e-18)
