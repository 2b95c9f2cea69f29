"""Gains and run-outs that known unbalances show at given coefficients: exact at the right ones, else kept."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.arrays import Complexes
from estimator.calibration.chain_start import best_chains
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem
from estimator.machine.document import Machine, parse_machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from tests.plant import document

GAIN = np.array([5.0 * np.exp(3.0j), 0.2, 1.0, 2.0j])
RUN_OUT = np.array([2e-6, 1e-6j, 0.0, -1e-6])
OWN = np.array([1e-3 - 2e-3j, 3e-3j])


@pytest.fixture(scope="module")
def machine() -> Machine:
    """A pump whose chains may be any."""
    said = document()
    for probe in said["probes"]:
        probe |= {"gain_spread": 3.0, "run_out_spread": 1e-6}
    return parse_machine(said)


def problem(machine: Machine, added: Complexes) -> FitProblem:
    """Readings (S, m) of three runs at 20 speeds with known unbalances (3, P)."""
    speed = np.tile(np.linspace(50.0, 300.0, 20), len(added))
    weights = np.repeat(added, 20, axis=0)
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    blank = Measurement.of(speed=speed, phasor=np.ones((speed.size, GAIN.size), dtype=complex))
    blank = replace(blank, added=weights)
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    built = FitProblem(train, blank, coordinates, Noise(floor=1e-9), np.zeros_like(blank.usable), robust=False)
    theta = coordinates.centre.copy()
    for disc, place in enumerate(coordinates.excitation_place[: OWN.size]):
        theta[place : place + 2] = np.array([OWN[disc].real, OWN[disc].imag]) / coordinates.excitation_scale[disc]
    return replace(built, measurement=replace(blank, phasor=GAIN * built.model(theta) + RUN_OUT))


def test_chains_far_off_are_found_at_the_right_coefficients(machine: Machine) -> None:
    one = problem(machine, np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3j]]))
    found = best_chains(one, one.coordinates.centre, np.full(one.measurement.phasor.shape, 1e9))
    np.testing.assert_allclose(one.coordinates.channels.gains(found), GAIN, rtol=1e-6)
    np.testing.assert_allclose(one.coordinates.channels.run_outs(found), RUN_OUT, atol=1e-12)
    np.testing.assert_allclose(one.coordinates.excitations(found)[: OWN.size], OWN, rtol=1e-3)


def test_without_weights_chains_stay_as_they_are(machine: Machine) -> None:
    one = problem(machine, np.zeros((3, 2), dtype=complex))
    found = best_chains(one, one.coordinates.centre, np.full(one.measurement.phasor.shape, 1e9))
    np.testing.assert_array_equal(one.coordinates.channels.gains(found), np.ones(GAIN.size))
