"""Condensation is exact: it changes the size of the problem, not its answer.

References: the full dynamic stiffness solved without condensation (relative 1e-10 of the largest response of a channel);
the Schur complement by hand; a mirrored train (y -> -y) that turns the other way moves as the mirror shows (1e-10); the
transposed matrix belongs to the spin turned round (1e-12, the Maxwell-Betti law of a rotor).
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.elimination import SingularCondensation
from estimator.rotor.response import response
from tests.estimator.trains import (
    Document,
    chapter_3,
    chapter_3_document,
    dense_elements,
    dense_response,
    few_examples,
    mirrored,
    one_disc_document,
    truth,
)

SPEED = np.array([3.0, 40.0, 121.8, 143.0, 175.5, 250.0, 402.0, 900.0])


def both_senses(machine: Machine, direction: int) -> CondensedTrain:
    return condense(machine, speed=SPEED, direction=np.full(SPEED.size, float(direction)))


def three_shafts() -> Document:
    """A train with a hollow stepped shaft, two couplings, probes between the bearings and at odd angles."""
    document = chapter_3_document()
    document["materials"]["other"] = {"young_modulus": 1.9e11, "density": 7700.0, "poisson_ratio": 0.28}
    document["shafts"].append(
        {
            "id": "S3",
            "sections": [
                {"length": 0.3, "outer_diameter": 0.03, "inner_diameter": 0.012, "material": "other"},
                {"length": 0.5, "outer_diameter": 0.018, "material": "steel"},
            ],
        }
    )
    document["bearings"] += [
        {**document["bearings"][0], "id": "B5", "shaft": "S3", "station": 0.1},
        {**document["bearings"][2], "id": "B6", "shaft": "S3", "station": 0.8},
    ]
    document["couplings"].append({**document["couplings"][0], "id": "C2", "driver": "S2", "driven": "S3", "kxx": 3e5})
    document["discs"].append(
        {**document["discs"][0], "id": "D5", "shaft": "S3", "station": 0.6, "unbalance": {"magnitude": 0.004, "angle_deg": 77}}
    )
    document["probes"] = [
        {"id": "P1", "shaft": "S1", "station": 0.6, "angle_deg": 45},
        {"id": "P2", "shaft": "S1", "station": 0.6, "angle_deg": 135},
        {"id": "P3", "shaft": "S2", "station": 1.25, "angle_deg": -30},
        {"id": "P4", "shaft": "S3", "station": 0.05, "angle_deg": 200},
        {"id": "P5", "shaft": "S3", "station": 0.6, "angle_deg": 0},
    ]
    return document


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("document", [chapter_3_document(), three_shafts()], ids=["chapter 3", "three shafts"])
def test_condensed_response_is_the_full_one(document: Document, direction: int) -> None:
    machine = parse_machine(document)
    coefficients, unbalances = truth(machine)
    found = response(both_senses(machine, direction), coefficients=coefficients, excitations=unbalances)
    expected = dense_response(machine, SPEED, direction=direction)
    assert np.all(np.abs(found - expected) < 1e-10 * np.abs(expected).max(axis=0))


def test_direction_is_taken_speed_by_speed() -> None:
    machine = chapter_3()
    coefficients, unbalances = truth(machine)
    direction = np.array([1.0, -1.0] * 4)
    train = condense(machine, speed=SPEED, direction=direction)
    found = response(train, coefficients=coefficients, excitations=unbalances)
    each = [response(both_senses(machine, sense), coefficients=coefficients, excitations=unbalances) for sense in (1, -1)]
    expected = np.where(direction[:, None] > 0, *each)
    assert found == pytest.approx(expected, rel=1e-12)
    assert np.abs(each[0] / each[1] - 1).max() > 0.1, "the sense of rotation matters"


@pytest.mark.parametrize("document", [chapter_3_document(), three_shafts()], ids=["chapter 3", "three shafts"])
def test_mirrored_machine_turning_backwards_gives_the_mirrored_response(document: Document) -> None:
    # A probe at angle α of the machine stands at -α in the mirror and sees the same; the machine's own x and y
    # channels are checked through α = 0 and, with the sign that the mirror turns, through α = 90.
    straight, turned = parse_machine(document), parse_machine(mirrored(document))
    assert (straight.direction, turned.direction) == (1, -1)
    found = {}
    for machine in (straight, turned):
        coefficients, unbalances = truth(machine)
        found[machine.direction] = response(
            both_senses(machine, machine.direction), coefficients=coefficients, excitations=unbalances
        )
    assert np.all(np.abs(found[1] - found[-1]) < 1e-10 * np.abs(found[1]).max(axis=0))


def test_mirrored_machine_seen_by_the_same_probes_shows_y_reversed() -> None:
    document = mirrored(chapter_3_document())
    document["probes"] = chapter_3_document()["probes"]
    straight, turned = chapter_3(), parse_machine(document)
    one = response(both_senses(straight, 1), coefficients=truth(straight)[0], excitations=truth(straight)[1])
    other = response(both_senses(turned, -1), coefficients=truth(turned)[0], excitations=truth(turned)[1])
    assert np.all(np.abs(other - one * np.array([1.0, -1.0] * 4)) < 1e-10 * np.abs(one).max(axis=0))


def test_retained_degrees_of_freedom_are_those_with_unknowns_or_probes() -> None:
    train = both_senses(chapter_3(), 1)
    assert train.known.shape == (SPEED.size, 16, 16)  # 4 bearings × (x, y) and 2 coupling nodes × (x, y, θx, θy)
    assert train.force.shape == (SPEED.size, 16, 8)
    assert train.left.shape == train.right.shape == (16, 42)
    assert train.output.shape == (8, 16)
    assert train.channels == ("B1X", "B1Y", "B2X", "B2Y", "B3X", "B3Y", "B4X", "B4Y")
    assert train.order.tolist().count(1) == 5 * 4
    assert train.order.tolist().count(0) == 42 - 5 * 4


def test_known_part_is_the_schur_complement_and_the_rest_are_the_elements() -> None:
    machine = chapter_3()
    train = both_senses(machine, 1)
    rotor = assemble_rotor(machine)
    places = sorted(
        {(rotor.node(b.shaft, b.station), 0) for b in machine.bearings}
        | {(node, kind) for node in (rotor.end_node("S1"), rotor.first_node["S2"]) for kind in (0, 1)}
    )
    # The x-z plane's displacements and slopes, then the y-z plane's, whose slope is -θx.
    kept = np.array([4 * node + (0, 3)[kind] for node, kind in places] + [4 * node + (1, 2)[kind] for node, kind in places])
    sign = np.array([1.0] * len(places) + [(1.0, -1.0)[kind] for _, kind in places])
    turned = np.outer(sign, sign)
    # The inverse of a Schur complement is the kept block of the inverse.
    for i, omega in enumerate(SPEED):
        full = rotor.stiffness - omega**2 * rotor.mass + 1j * omega**2 * rotor.gyroscopic
        expected = turned * np.linalg.inv(np.linalg.inv(full)[np.ix_(kept, kept)])
        assert np.abs(train.known[i] - expected).max() < 1e-9 * np.abs(expected).max()
    stiffness, damping = dense_elements(machine)
    added = train.dynamic_stiffness(truth(machine)[0]) - train.known
    expected_added = turned * (stiffness + 1j * SPEED[:, None, None] * damping)[:, kept][:, :, kept]
    assert np.abs(added - expected_added).max() < 1e-9 * np.abs(stiffness).max()
    assert np.abs(stiffness).sum() == pytest.approx(np.abs(stiffness[np.ix_(kept, kept)]).sum())


@few_examples
@given(
    speed=st.floats(1.0, 1000.0),
    station=st.floats(0.05, 0.95),
    diametral=st.floats(0.0, 0.1),
    polar=st.floats(0.0, 0.2),
)
def test_transposed_stiffness_belongs_to_the_spin_turned_round(
    speed: float, station: float, diametral: float, polar: float
) -> None:
    machine = parse_machine(one_disc_document(disc_station=station, diametral_inertia=diametral, polar_inertia=polar))
    train = condense(machine, speed=np.array([speed, speed]), direction=np.array([1.0, -1.0]))
    assert np.abs(train.known[0].T - train.known[1]).max() < 1e-12 * np.abs(train.known[0]).max()


@pytest.mark.parametrize(
    "speed", [[], [[1.0, 2.0]], [1.0, 0.0], [-5.0], [np.nan], [np.inf]], ids=["none", "2-d", "zero", "negative", "nan", "inf"]
)
def test_speeds_must_be_positive_and_finite(speed: list[float]) -> None:
    with pytest.raises(ValueError, match="speed must be"):
        condense(chapter_3(), speed=np.array(speed), direction=np.ones(np.shape(speed)))


@pytest.mark.parametrize("direction", [[1.0], [1.0, 0.0], [1.0, 2.0], [1.0, np.nan]], ids=["short", "zero", "two", "nan"])
def test_direction_must_be_a_sign_for_each_speed(direction: list[float]) -> None:
    with pytest.raises(ValueError, match="direction must hold"):
        condense(chapter_3(), speed=np.array([1.0, 2.0]), direction=np.array(direction))


def disc_between_two_clamped_nodes() -> tuple[Machine, NDArray[np.float64]]:
    """A machine of which condensation eliminates one node's four degrees of freedom only, and its natural frequencies there.

    Coupling halves hold all of a node, so a shaft of two elements between two couplings leaves its middle node, with a disc.
    """
    document = one_disc_document(element_length=0.5)
    steel = document["shafts"][0]["sections"]
    document["shafts"] = [{"id": name, "sections": steel} for name in ("S0", "S", "S1")]
    document["bearings"] = [
        {"id": f"{name}-{end}", "shaft": name, "station": station}
        for name in ("S0", "S1")
        for end, station in (("start", 0.0), ("middle", 0.5), ("end", 1.0))
    ]
    document["couplings"] = [{"id": "C1", "driver": "S0", "driven": "S"}, {"id": "C2", "driver": "S", "driven": "S1"}]
    for probe in document["probes"]:
        probe.update(shaft="S0", station=0.0)
    # Without polar inertia nothing couples x and y; the smallest density there is makes the shaft's own underflow to zero.
    document["discs"][0].update(polar_inertia=0.0)
    document["materials"]["steel"]["density"] = 5e-324
    machine = parse_machine(document)
    rotor = assemble_rotor(machine)
    at = 4 * rotor.node("S", 0.5)
    return machine, np.array([rotor.stiffness[at, at] / rotor.mass[at, at]])


@pytest.mark.parametrize("beside", [0.0, 1e-11, -1e-11])
def test_speed_on_a_clamped_natural_frequency_is_an_error_that_names_it(beside: float) -> None:
    machine, square = disc_between_two_clamped_nodes()
    omega = float(np.sqrt(square[0])) * (1 + beside)
    with pytest.raises(SingularCondensation, match=f"speed {omega:.6g} rad/s.*leave that speed out"):
        condense(machine, speed=np.array([0.5 * omega, omega]), direction=np.ones(2))
    assert condense(machine, speed=np.array([omega * 1.01]), direction=np.array([1.0])).known.shape[0] == 1
