"""Pedestals: a rigid rotor on them in closed form, relative and absolute probes, rigid ground as their limit."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.modes.eigenmodes import eigenvalues
from estimator.rotor.condensation import condense
from estimator.rotor.modal_reduction import reduced_basis
from estimator.rotor.response import response, sensitivity
from estimator.rotor.system_matrices import system_matrices
from tests.estimator.trains import Document, chapter_3_document, few_examples, one_disc_document, truth

SPEED = np.array([40.0, 120.0, 170.0, 300.0])
PEDESTAL = {"kxx": 4e6, "kyy": 9e6, "cxx": 900.0, "cyy": 1500.0, "mxx": 45.0, "myy": 60.0}


def rigid_rotor(*, mass: float, film: float, **pedestal: float) -> Document:
    """A disc between two bearings of the film's stiffness [N/m] on a shaft that neither bends nor weighs, on pedestals."""
    said = one_disc_document(
        length=0.1, diameter=1.0, density=1e-6, mass=mass, kxx=film, kyy=2 * film, cxx=200.0, cyy=300.0, element_length=0.05
    )
    return said | {"pedestals": [{"id": f"P{k}", "bearing": f"B{k}", **PEDESTAL, **pedestal} for k in (1, 2)]}


def chapter_3_on_pedestals(**changed: float) -> Machine:
    said = chapter_3_document()
    said["pedestals"] = [{"id": one["id"], "bearing": one["id"], **PEDESTAL, **changed} for one in said["bearings"]]
    return parse_machine(said)


def nominal(said: Document | Machine, speed: NDArray[np.float64] = SPEED) -> NDArray[np.complex128]:
    machine = said if isinstance(said, Machine) else parse_machine(said)
    coefficients, unbalances = truth(machine)
    return response(
        condense(machine, speed=speed, direction=np.ones(speed.size)), coefficients=coefficients, excitations=unbalances
    )


@few_examples
@given(mass=st.floats(5.0, 80.0), film=st.floats(1e5, 1e7), at=st.floats(50.0, 600.0))
def test_a_rigid_rotor_stands_on_films_and_pedestals_in_series(mass: float, film: float, at: float) -> None:
    said = rigid_rotor(mass=mass, film=film)
    relative = nominal(said, np.array([at]))[0]
    absolute = nominal(said | {"probes": [one | {"absolute": True} for one in said["probes"]]}, np.array([at]))[0]
    heavy = 1e-3 * np.exp(1j * math.radians(30.0))
    for axis, (letter, oil, turned) in enumerate((("xx", film + 200j * at, 1.0), ("yy", 2 * film + 300j * at, -1j))):
        under = PEDESTAL[f"k{letter}"] + 1j * at * PEDESTAL[f"c{letter}"] - at**2 * PEDESTAL[f"m{letter}"]
        moved = turned * at**2 * heavy / (2 * oil * under / (oil + under) - mass * at**2)
        assert absolute[axis] == pytest.approx(moved, rel=3e-4)
        assert relative[axis] == pytest.approx(moved * under / (oil + under), rel=3e-4)


def test_eigenvalues_of_a_rigid_rotor_on_pedestals() -> None:
    found = eigenvalues(parse_machine(rigid_rotor(mass=30.0, film=2e6)))
    for letter, oil in (("xx", (2e6, 200.0)), ("yy", (4e6, 300.0))):
        k, c, m = (2 * PEDESTAL[f"{name}{letter}"] for name in "kcm")
        film, slow = 2 * oil[0], 2 * oil[1]
        # s² M + s C + K of disc and both pedestals together, as a polynomial in s.
        disc, under, across = np.array([30.0, slow, film]), np.array([m, slow + c, film + k]), np.array([slow, film])
        due = np.roots(np.polysub(np.polymul(disc, under), np.polymul(across, across)))
        for root in due[due.imag > 0.0]:
            assert np.min(np.abs(found - root)) < 1e-4 * abs(root)


def test_very_stiff_pedestals_are_rigid_ground() -> None:
    stiff = chapter_3_on_pedestals(kxx=1e14, kyy=1e14, mxx=1.0, myy=1.0)
    assert nominal(stiff) == pytest.approx(nominal(parse_machine(chapter_3_document())), rel=1e-5)


def test_derivatives_by_pedestals_are_those_of_the_response() -> None:
    machine = chapter_3_on_pedestals()
    coefficients, unbalances = truth(machine)
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    exact = sensitivity(train, coefficients=coefficients, excitations=unbalances).by_coefficient
    places = [k for k, one in enumerate(train.unknowns.coefficients) if one.element == "pedestal.B2"]
    assert [train.unknowns.coefficients[k].term.name for k in places] == ["kxx", "kyy", "cxx", "cyy", "mxx", "myy"]
    for k in places:
        step = np.zeros(coefficients.size)
        step[k] = 1e-5 * coefficients[k]
        above, below = (response(train, coefficients=coefficients + s * step, excitations=unbalances) for s in (1, -1))
        assert (above - below) / (2 * step[k]) == pytest.approx(exact[k], rel=1e-5, abs=1e-6 * np.abs(exact[k]).max())


def test_the_reduced_basis_keeps_the_modes_of_pedestals() -> None:
    machine = chapter_3_on_pedestals()
    whole = eigenvalues(machine, spin=300.0)
    reduced = system_matrices(machine, basis=reduced_basis(machine, 600.0)).state_matrix(spin=300.0)
    found = np.linalg.eigvals(reduced)
    for one in whole[whole.imag < 600.0]:
        assert np.min(np.abs(found - one)) < 1e-4 * abs(one)


def test_a_probe_measures_against_the_nearest_pedestal_or_the_one_it_names() -> None:
    said: dict[str, Any] = chapter_3_document()
    first, second = said["bearings"][:2]
    said["pedestals"] = [{"id": "P", "bearing": first["id"], **PEDESTAL}]
    machine = parse_machine(said)
    near = [one for one in machine.probes if one.shaft == first["shaft"] and abs(one.station - first["station"]) < 1e-6]
    assert near
    assert all(machine.pedestal_under(one) is machine.pedestals[0] for one in near)
    moved = near[0].model_copy(update={"mounted_on": second["id"]})
    assert machine.pedestal_under(moved) is None
    assert machine.pedestal_under(near[0].model_copy(update={"absolute": True})) is None


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            {"pedestals": [{"id": "P", "bearing": "B9", **PEDESTAL}]},
            r"pedestals\[0\].bearing: 'B9' is not one of the bearings",
        ),
        ({"pedestals": [{"id": f"P{k}", "bearing": "B1", **PEDESTAL} for k in (1, 2)]}, "stands on more than one pedestal"),
        ({"pedestals": [{"id": "P", "bearing": "B1", **PEDESTAL, "kxx": -1.0}]}, r"pedestals\[0\].kxx"),
        ({"probes": [{"id": "X", "shaft": "S", "station": 0.0, "angle_deg": 0, "mounted_on": "B9"}]}, "'B9' is not one"),
        (
            {"probes": [{"id": "X", "shaft": "S", "station": 0.0, "angle_deg": 0, "mounted_on": "B1", "absolute": True}]},
            "stands on the ground",
        ),
    ],
)
def test_pedestals_that_make_no_sense_are_refused(wrong: Document, words: str) -> None:
    with pytest.raises(DocumentError, match=words):
        parse_machine(one_disc_document() | wrong)
