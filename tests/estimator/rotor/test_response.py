"""The forward response.

References: ROSS (ross-rotordynamics 2.3.0, which shares no code with this project) on the Chapter 3 train, relative
deviation below 1e-9 at every speed and probe; the Jeffcott rotor X = ω²U/(k - mω² + jcω) in closed form (relative 1e-5 for
a rigid shaft, 1e-7 for a massless flexible one); laws that hold to rounding (1e-9): linearity in the unbalance, circular
orbits and reciprocity on isotropic bearings, order and names of parts without effect, a probe at α sees x cos α + y sin α.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.rotor.shaft_element import shear_coefficient
from tests.estimator.trains import Document, chapter_3, chapter_3_document, few_examples, one_disc_document, ross, truth

Complexes = NDArray[np.complex128]
SPEED = np.array([5.0, 60.0, 122.0, 150.0, 176.0, 283.0, 400.0])


def nominal(machine: Machine, speed: NDArray[np.float64] = SPEED, direction: int = 1) -> Complexes:
    coefficients, unbalances = truth(machine)
    train = condense(machine, speed=speed, direction=np.full(speed.size, float(direction)))
    return response(train, coefficients=coefficients, excitations=unbalances)


def of(document: Document) -> Complexes:
    return nominal(parse_machine(document))


def test_chapter_3_agrees_with_ross() -> None:
    speed, expected = ross()
    found = nominal(chapter_3(), speed)
    assert found.shape == (300, 8)
    assert np.max(np.abs(found - expected) / np.abs(expected)) < 1e-9


@few_examples
@given(
    mass=st.floats(0.5, 50.0),
    stiffness=st.floats(1e4, 1e6),
    ratio=st.floats(0.05, 0.5),
    at=st.floats(0.1, 4.0),
    magnitude=st.floats(1e-5, 1e-2),
    angle=st.floats(0.0, 360.0),
    direction=st.sampled_from([1, -1]),
    rigid=st.booleans(),
)
def test_jeffcott_rotor(
    mass: float, stiffness: float, ratio: float, at: float, magnitude: float, angle: float, direction: int, rigid: bool
) -> None:
    # A disc in the middle of a shaft of next to no density. The shaft is so thick that it counts as rigid, or it is
    # slender and its stiffness 1 / (L³/48EI + L/4κGA) stands in series with the bearings'. k and c are of both bearings.
    critical = math.sqrt(stiffness / mass)
    damping = 2 * ratio * stiffness / critical
    length, diameter = (0.1, 1.0) if rigid else (1.0, 0.03)
    document = one_disc_document(
        length=length,
        diameter=diameter,
        density=1e-6,
        mass=mass,
        kxx=stiffness / 2,
        kyy=stiffness / 2,
        cxx=damping / 2,
        cyy=damping / 2,
        element_length=length / 2,
    )
    document["discs"][0]["unbalance"] = {"magnitude": magnitude, "angle_deg": angle}
    omega = at * critical
    found = nominal(parse_machine(document), np.array([omega]), direction)[0]
    support = stiffness + 1j * omega * damping
    if not rigid:
        kappa = shear_coefficient(poisson_ratio=0.3, diameter_ratio=0.0)
        bending, shear = 2.1e11 * math.pi / 64 * diameter**4, kappa * 2.1e11 / 2.6 * math.pi / 4 * diameter**2
        support = 1 / (1 / support + length**3 / (48 * bending) + length / (4 * shear))
    heavy = magnitude * np.exp(1j * direction * math.radians(angle))
    expected = omega**2 * heavy / (support - mass * omega**2)
    assert found[0] == pytest.approx(expected, rel=1e-5)
    assert found[1] == pytest.approx(-1j * direction * found[0], rel=1e-7)


def test_heavy_spot_leads_where_the_shaft_is_stiff_and_lags_half_a_turn_far_above_the_critical_speed() -> None:
    document = one_disc_document(mass=5.0, kxx=1e5, kyy=1e5, cxx=10.0, cyy=10.0)
    document["discs"][0]["unbalance"] = {"magnitude": 1e-3, "angle_deg": 30}
    slow, fast = np.rad2deg(np.angle(nominal(parse_machine(document), np.array([5.0, 1500.0]))[:, 0]))
    assert slow == pytest.approx(30.0, abs=0.5)
    assert fast % 360 == pytest.approx(210.0, abs=2.0)


unbalance_lists = st.lists(
    st.complex_numbers(max_magnitude=1e-2, allow_nan=False, allow_infinity=False, allow_subnormal=False),
    min_size=4,
    max_size=4,
)


@few_examples
@given(unbalance_lists, unbalance_lists, st.floats(-3.0, 3.0))
def test_response_is_linear_in_real_multiples_and_sums_of_unbalances(
    one: list[complex], other: list[complex], factor: float
) -> None:
    train = condense(chapter_3(), speed=SPEED, direction=np.ones_like(SPEED))
    coefficients = truth(chapter_3())[0]

    def at(unbalances: Complexes) -> Complexes:
        return response(train, coefficients=coefficients, excitations=unbalances)

    first: Complexes = np.array(one)
    second: Complexes = np.array(other)
    scale = np.abs(at(np.full(4, 1e-2 + 0j))).max()
    assert np.abs(at(first + factor * second) - at(first) - factor * at(second)).max() < 1e-9 * scale
    assert not np.any(at(np.zeros(4, dtype=complex)))


@few_examples
@given(st.floats(0.0, 360.0), st.sampled_from([1, -1]))
def test_turning_every_unbalance_turns_the_phase_of_every_probe(angle: float, direction: int) -> None:
    coefficients, unbalances = truth(chapter_3())
    train = condense(chapter_3(), speed=SPEED, direction=np.full(SPEED.size, float(direction)))
    turn = np.exp(1j * math.radians(angle))
    found = response(train, coefficients=coefficients, excitations=unbalances * turn)
    # The mark passes the probes later or earlier: against the axes the angle counts the other way.
    expected = response(train, coefficients=coefficients, excitations=unbalances) * (
        turn if direction > 0 else turn.conjugate()
    )
    assert np.all(np.abs(found - expected) < 1e-9 * np.abs(expected).max(axis=0))


def two_discs(*, kxx: float, kyy: float, cross: float, polar: float, density: float = 7800.0) -> Document:
    """Two unequal discs with probes at both, on bearings whose cross-coupled stiffness is skew."""
    document = one_disc_document(
        disc_station=0.3, kxx=kxx, kyy=kyy, kxy=cross, kyx=-cross, polar_inertia=polar, density=density
    )
    document["discs"].append({**document["discs"][0], "id": "D2", "station": 0.8, "mass": 2.0, "polar_inertia": 0.5 * polar})
    document["probes"] = [
        {"id": f"{disc}{axis}", "shaft": "S", "station": station, "angle_deg": angle}
        for disc, station in (("one", 0.3), ("two", 0.8))
        for axis, angle in (("x", 0), ("y", 90))
    ]
    return document


def single_unbalance(document: Document, plane: int) -> Complexes:
    machine = parse_machine(document)
    unbalances = np.zeros(2, dtype=complex)
    unbalances[plane] = 1e-3
    train = condense(machine, speed=SPEED, direction=np.ones_like(SPEED))
    return response(train, coefficients=truth(machine)[0], excitations=unbalances)


@few_examples
@given(st.floats(1e5, 1e7), st.floats(-5e5, 5e5), st.floats(0.0, 0.5))
def test_isotropic_train_whirls_in_circles_and_is_reciprocal_between_planes(
    stiffness: float, cross: float, polar: float
) -> None:
    # x + jy of an isotropic train obeys one complex symmetric equation, gyroscopic and skew terms included.
    document = two_discs(kxx=stiffness, kyy=stiffness, cross=cross, polar=polar)
    first, second = single_unbalance(document, 0), single_unbalance(document, 1)
    for found in (first, second):
        assert np.all(np.abs(found[:, 1::2] + 1j * found[:, 0::2]) < 1e-9 * np.abs(found[:, 0::2]).max())
    assert np.all(np.abs(first[:, 2] - second[:, 0]) < 1e-9 * np.abs(first[:, 2]).max())


def test_orthotropic_train_is_reciprocal_without_gyroscopic_moments_only() -> None:
    # Without them the x-z plane stands alone, with symmetric matrices.
    still = two_discs(kxx=1e6, kyy=4e6, cross=0.0, polar=0.0, density=1e-9)
    first, second = single_unbalance(still, 0), single_unbalance(still, 1)
    assert np.all(np.abs(first[:, 2] - second[:, 0]) < 1e-9 * np.abs(first[:, 2]).max())
    turning = two_discs(kxx=1e6, kyy=4e6, cross=0.0, polar=0.5, density=1e-9)
    first, second = single_unbalance(turning, 0), single_unbalance(turning, 1)
    assert np.abs(first[:, 2] / second[:, 0] - 1).max() > 1e-3


def test_order_of_bearings_discs_and_shafts_changes_nothing() -> None:
    document = chapter_3_document()
    expected = of(document)
    for kind in ("bearings", "discs", "shafts"):
        changed = chapter_3_document()
        changed[kind] = changed[kind][::-1]
        assert np.all(np.abs(of(changed) - expected) < 1e-9 * np.abs(expected).max(axis=0)), kind


def test_order_of_probes_is_the_order_of_channels() -> None:
    document = chapter_3_document()
    document["probes"] = document["probes"][::-1]
    assert of(document) == pytest.approx(of(chapter_3_document())[:, ::-1], rel=1e-12)


def test_names_of_parts_change_nothing() -> None:
    document = chapter_3_document()
    for kind in ("bearings", "discs", "couplings", "probes"):
        for i, part in enumerate(document[kind]):
            part["id"] = f"{kind}-{7 * i % 5}-{i}"
    assert np.array_equal(of(document), of(chapter_3_document()))


@few_examples
@given(st.floats(-720.0, 720.0))
def test_probe_at_an_angle_sees_x_cos_plus_y_sin(angle: float) -> None:
    document = chapter_3_document()
    document["probes"] += [{"id": "slanted", "shaft": "S1", "station": 1.0, "angle_deg": angle}]
    found = of(document)
    x, y = found[:, 2], found[:, 3]
    expected = x * math.cos(math.radians(angle)) + y * math.sin(math.radians(angle))
    assert np.all(np.abs(found[:, 8] - expected) < 1e-12 * np.abs(found).max())


def test_probe_turned_half_a_turn_sees_the_opposite() -> None:
    document = chapter_3_document()
    for probe in document["probes"]:
        probe["angle_deg"] += 180
    assert of(document) == pytest.approx(-of(chapter_3_document()), rel=1e-9)


def test_finer_mesh_changes_little() -> None:
    document = chapter_3_document()
    document["element_length"] = 0.05
    fine, finer = of(document), of({**document, "element_length": 0.025})
    assert np.all(np.abs(fine - finer) < 1e-4 * np.abs(finer).max(axis=0))
