"""The example train on tilting pads: its model's derivatives, and an identification of clearances and viscosities."""

import numpy as np
import yaml

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.statics.film_model import film_model
from tests.paths import EXAMPLES

SPEED = np.linspace(7500.0, 800.0, 120) * np.pi / 30


def example() -> Machine:
    """The turbine and compressor on tilting pads."""
    return parse_machine(yaml.safe_load((EXAMPLES / "turbine-on-tilting-pads.yaml").read_text(encoding="utf-8")))


def test_derivatives_of_the_coefficients_are_those_of_differences() -> None:
    model = film_model(example())
    rng = np.random.default_rng(2)
    centre, spread = (np.array([getattr(one, name) for one in model.parameters]) for name in ("centre", "spread"))
    curves, fitted = model.at(SPEED), centre + 0.4 * spread * rng.standard_normal(centre.size)
    found, own = curves.derivatives(fitted, slice(None)), curves.values(fitted)
    size = np.abs(own).reshape(SPEED.size, 4, 2, 4).max(axis=(0, 3), keepdims=True)
    size = np.broadcast_to(size, (1, 4, 2, 4)).reshape(-1)
    for place in range(16):
        step = np.zeros(fitted.size)
        step[place] = 1e-4  # a pad loses its film within a tenth of a clearance
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / 2e-4
        np.testing.assert_allclose(found[:, :, place] / size, difference / size, atol=2e-4)


def test_clearances_and_viscosities_are_found_again() -> None:
    machine = example()
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    coordinates, rng = Coordinates.of(train, unbalance_scale=1.0), np.random.default_rng(4)
    own = [n for n, one in enumerate(coordinates.parameters) if one.name.endswith((".clearance", ".viscosity"))]
    fitted = coordinates.centre.copy()
    fitted[own] += 0.1 * rng.standard_normal(len(own))
    unbalances = [
        one.unbalance.magnitude * np.exp(1j * np.radians(one.unbalance.angle_deg)) for one in machine.discs if one.unbalance
    ]
    phasor = response(train, coefficients=coordinates.coefficients(fitted), excitations=np.array(unbalances))
    size = np.sqrt((0.01 * np.abs(phasor)) ** 2 + 1e-14) / np.sqrt(2.0)
    noisy = phasor + size * (rng.standard_normal(phasor.shape) + 1j * rng.standard_normal(phasor.shape))
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy), Options(starts=1))
    assert found.accepted
    estimates = {one.name: one for one in found.estimates}
    for place in own:
        parameter = coordinates.parameters[place]
        one = estimates[parameter.name]
        assert one.value is not None
        assert one.standard_error is not None
        true = float(parameter.value(fitted[place : place + 1])[0])
        assert abs(one.value - true) < 3.5 * one.standard_error
        assert one.standard_error < 0.15 * one.value
