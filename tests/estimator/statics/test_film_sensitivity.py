"""Derivatives of equilibria by clearances, viscosities and elevations, against differences of equilibria found anew."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain, film_train
from estimator.statics.film_sensitivity import PARAMETERS, film_sensitivity
from estimator.units import rpm_to_rad_per_s
from tests.estimator.statics.films import motor_compressor_document
from tests.film_plant.motor_compressor import CouplingKind

STEPS = {"clearance": 1e-5, "viscosity": 1e-5, "elevation_x": 1e-9, "elevation_y": 1e-9}


def changed(train: FilmTrain, number: int, name: str, step: float) -> FilmTrain:
    """The train with one parameter of one bearing changed, clearance and viscosity by a part."""
    if name.startswith("elevation"):
        elevation = train.elevation.copy()
        elevation[number, "xy".index(name[-1])] += step
        return replace(train, elevation=elevation)
    bearings = list(train.bearings)
    one = train.journals[number]
    if name == "viscosity":
        bearings[number] = replace(one, oil=one.oil.changed(factor=float(np.exp(step)), slope=0.0))
    else:
        said = one.described.model_copy(update={"radial_clearance": one.described.radial_clearance * float(np.exp(step))})
        bearings[number] = replace(one, described=said)
    return replace(train, bearings=tuple(bearings))


def equilibrium(train: FilmTrain, start: FilmEquilibrium) -> FilmEquilibrium:
    found = train.equilibrium(start.speed, start=start.position)
    assert found is not None
    return found


def check_derivatives(train: FilmTrain, speed: float) -> None:
    """Compare all derivatives of a train's equilibrium at a speed [rad/s] with differences."""
    found = train.equilibrium(speed)
    assert found is not None
    slopes = film_sensitivity(train, [found])
    for number in range(4):
        for place, name in enumerate(PARAMETERS):
            step = STEPS[name]
            ahead, behind = (equilibrium(changed(train, number, name, sign * step), found) for sign in (1, -1))
            row = len(PARAMETERS) * number + place
            for what in ("position", "force", "stiffness", "damping"):
                difference = (getattr(ahead, what) - getattr(behind, what)) / (2 * step)
                own = getattr(slopes, what)[0, row]
                assert np.abs(own - difference).max() <= 1e-4 * np.abs(difference).max(), (number, name, what)


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
def test_derivatives_are_those_of_differences(kind: CouplingKind) -> None:
    check_derivatives(film_train(parse_machine(motor_compressor_document(kind))), rpm_to_rad_per_s(3000.0))


def test_a_rigid_rise_of_all_bearings_moves_nothing_within_them() -> None:
    train = film_train(parse_machine(motor_compressor_document("rigid")))
    found = train.equilibrium(rpm_to_rad_per_s(3000.0))
    assert found is not None
    slopes = film_sensitivity(train, [found])
    rise = slopes.position[0][PARAMETERS.index("elevation_y") :: len(PARAMETERS)].sum(axis=0)
    assert np.abs(rise).max() < 1e-6
