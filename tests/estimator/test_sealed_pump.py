"""The example with everything that a document may hold: a run-down determines its seal, its bows and its equivalent load.

Data from the condensed model; what that does with seals, bows and loads is asked elsewhere, against full solves.
"""

import numpy as np
import pytest
import yaml

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.simulation.simulated_plant import noise, speed_law
from tests.estimator.full_train import deviations
from tests.estimator.trains import ROOT

KNOTTED = tuple(f"bearing.B1.{name}" for name in ("kxx", "kyy", "cxx", "cyy"))


@pytest.fixture(scope="module")
def machine() -> Machine:
    return parse_machine(yaml.safe_load((ROOT / "examples" / "sealed-pump.yaml").read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def run(machine: Machine) -> tuple[Identification, dict[str, complex]]:
    """A run-down of a machine that is not quite as its document says, and the true values."""
    rng = np.random.default_rng(0)
    _, speed = speed_law(machine, "run-down", duration=30.0, samples=200)
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    coefficients = np.array([one.expected for one in train.unknowns.coefficients])
    coefficients = coefficients * np.exp(0.08 * rng.standard_normal(coefficients.size))
    turn = np.exp(1j * rng.uniform(-np.pi, np.pi, len(train.unknowns.excitations)))
    size = [one.spread if one.nominal is None else abs(one.nominal) for one in train.unknowns.excitations]
    excitations = np.array(size, dtype=float) * turn
    clean = response(train, coefficients=coefficients, excitations=excitations)
    found = identify(machine, Measurement.of(speed=speed, phasor=clean + noise(machine.noise, clean, rng), direction=1))
    return found, dict(zip(train.unknowns.names, [*coefficients.astype(complex), *excitations], strict=True))


def test_the_run_is_accepted_and_its_errors_are_those_stated(run: tuple[Identification, dict[str, complex]]) -> None:
    found, truth = run
    assert found.accepted, found.verdict
    constant = {name: value for name, value in truth.items() if name not in KNOTTED}
    knots = {f"{name}@{rpm}rpm": truth[name] for name in KNOTTED for rpm in (1000, 4000)}
    error = deviations(found, {**constant, **knots})
    assert 0.7 < np.sqrt(np.mean(error**2)) < 1.3
    assert np.abs(error).max() < 4.5


@pytest.mark.parametrize(("name", "largest"), [("seal.N1.kxx", 0.1), ("seal.N1.mxx", 0.1), ("shaft.pump.bow", 0.01)])
def test_what_it_is_for_is_determined(run: tuple[Identification, dict[str, complex]], name: str, largest: float) -> None:
    found, truth = run
    error = found.estimate(name).standard_error
    assert error is not None
    assert error < largest * abs(truth[name])


def test_the_load_is_determined(run: tuple[Identification, dict[str, complex]]) -> None:
    found, truth = run
    for name in ("force_x", "force_y", "moment_x", "moment_y"):
        error = found.estimate(f"coupling.C1.{name}").standard_error
        assert error is not None
        assert error < 0.1 * abs(truth[f"coupling.C1.{name}"])
