"""The film plant against the reference arrays of the motor and compressor."""

from functools import cache
from typing import get_args

import numpy as np
import pytest

from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.assembly import assemble
from tests.film_plant.motor_compressor import CASES, CouplingKind, motor_compressor
from tests.film_plant.response import eigenvalues, response
from tests.film_plant.statics import Equilibrium, Statics, aligned_elevations
from tests.film_plant.train import Train
from tests.paths import DATA

KINDS = get_args(CouplingKind)
each_case = pytest.mark.parametrize(("kind", "case"), [(kind, case) for kind in KINDS for case in CASES])


@cache
def arrays() -> dict[str, Floats]:
    """The reference arrays."""
    with np.load(DATA / "motor-compressor" / "arrays.npz") as file:
        return dict(file)


def reference(kind: str, case: str, what: str) -> Floats:
    """One of them."""
    return arrays()[f"{kind}.{case}.{what}"]


@cache
def solved(kind: CouplingKind, case: str) -> tuple[Train, Equilibrium]:
    """The train and its films at the reference's speeds."""
    train = motor_compressor(kind, case)
    return train, Statics(train).follow(arrays()["speed"])


@each_case
def test_loads_and_positions(kind: CouplingKind, case: str) -> None:
    train, films = solved(kind, case)
    load = reference(kind, case, "load")
    assert np.max(np.abs(films.load - load) / np.linalg.norm(load, axis=2, keepdims=True)) < 0.001
    off = films.position - reference(kind, case, "journal_position")
    assert np.max(np.abs(off) / train.clearances[:, None]) < 0.001


@each_case
def test_stiffness_and_damping(kind: CouplingKind, case: str) -> None:
    _, films = solved(kind, case)
    for found, name in ((films.stiffness, "stiffness"), (films.damping, "damping")):
        due = reference(kind, case, name)
        assert np.max(np.abs(found - due).max(axis=(2, 3)) / np.abs(due).max(axis=(2, 3))) < 0.02, name


@each_case
def test_response_with_the_coefficients_of_the_arrays(kind: CouplingKind, case: str) -> None:
    found = _response(motor_compressor(kind, case), reference(kind, case, "stiffness"), reference(kind, case, "damping"))
    due = reference(kind, case, "response")
    assert np.abs(found - due).max() < 1e-10 * np.abs(due).max()


@each_case
def test_response_with_its_own_coefficients(kind: CouplingKind, case: str) -> None:
    train, films = solved(kind, case)
    due = reference(kind, case, "response")
    assert np.abs(_response(train, films.stiffness, films.damping) - due).max() < 0.02 * np.abs(due).max()


def _response(train: Train, stiffness: Floats, damping: Floats) -> Complexes:
    return response(assemble(train), speed=arrays()["speed"], stiffness=stiffness, damping=damping)


@pytest.mark.parametrize("kind", KINDS)
def test_elevations_of_a_coupling_that_carries_nothing(kind: CouplingKind) -> None:
    train = motor_compressor(kind)
    station = np.array([one.station + train.shafts[0].length * one.shaft for one in train.bearings])
    off = aligned_elevations(train)[:, 1] - train.elevations[:, 1]
    level = np.polynomial.Polynomial.fit(station, off, 1)(station)
    assert np.abs(off - level).max() < 1e-10


def test_critical_speeds_and_damping_ratios() -> None:
    train = motor_compressor("flexible")
    matrices, found = assemble(train), []
    for rpm in (2296.0, 2466.0, 2846.0, 3066.0):
        speed = rpm * np.pi / 30
        films = Statics(train).follow(np.array([speed]))
        values = eigenvalues(matrices, speed=speed, stiffness=films.stiffness[0], damping=films.damping[0])
        near = values[np.argmin(np.abs(values.imag - speed))]
        assert near.imag == pytest.approx(speed, rel=0.01)
        found.append(-near.real / abs(near))
    assert found == pytest.approx([0.11, 0.12, 0.034, 0.037], rel=0.06)


def test_loads_carry_the_train() -> None:
    train, films = solved("rigid", "parallel_up")
    masses = sum(one.mass for one in train.discs) + 2 * train.couplings[0].half[0]
    steel = sum(np.pi / 4 * d**2 * length for shaft in train.shafts for length, d in shaft.pieces) * train.material.density
    assert films.load.sum(axis=1)[:, 1] == pytest.approx(9.81 * (masses + steel), rel=1e-6)
    # Sideways they cancel to what a stiffness of 3 GN/m leaves of its own rounding.
    assert films.load.sum(axis=1)[:, 0] == pytest.approx(0.0, abs=0.1)
