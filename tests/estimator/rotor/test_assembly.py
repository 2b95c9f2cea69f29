"""Mesh and assembly of a train, and the sense of its gyroscopic moments.

Laws: the mesh rules of `node_stations`; total mass and moment of inertia against the sums by hand (relative 1e-12); a disc
in the middle of a massless symmetric shaft has the tilting frequencies ±ΩI_p/2I_d + √((ΩI_p/2I_d)² + k/I_d) (1e-5), the
greater of which whirls with the spin; a spin turned round swaps forward and backward.
"""

import math

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.machine.mesh import DEFAULT_ELEMENTS_PER_SHAFT, node_stations
from estimator.machine.parts import Bearing, Disc, Probe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.shaft_element import shear_coefficient
from tests.estimator.trains import Document, chapter_3, chapter_3_document, dense_elements, few_examples, one_disc_document

Floats = NDArray[np.float64]


def test_chapter_3_has_a_node_every_quarter_metre() -> None:
    machine = chapter_3()
    for shaft in machine.shafts:
        assert node_stations(machine, shaft) == pytest.approx(np.linspace(0.0, 1.25, 6), abs=1e-12)


@few_examples
@given(
    stations=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6),
    ends=st.lists(st.floats(0.01, 0.5), min_size=1, max_size=4),
    longest=st.one_of(st.none(), st.floats(0.02, 0.6)),
)
def test_every_part_and_section_end_has_a_node_and_no_element_is_too_long(
    stations: list[float], ends: list[float], longest: float | None
) -> None:
    length = math.fsum(ends)
    document = one_disc_document(length=length)
    document["shafts"][0]["sections"] = [{"length": end, "outer_diameter": 0.03, "material": "steel"} for end in ends]
    document["element_length"] = longest
    document["bearings"] = [{"id": f"B{i}", "shaft": "S", "station": station * length} for i, station in enumerate(stations)]
    machine = parse_machine(document)
    found = node_stations(machine, machine.shafts[0])
    assert found[0] == 0.0
    assert found[-1] == pytest.approx(length, rel=1e-12)
    steps = np.diff(found)
    assert np.all(steps > 1e-9)
    assert np.all(steps <= (longest or length / DEFAULT_ELEMENTS_PER_SHAFT) * (1 + 1e-5))
    parts: list[Bearing | Disc | Probe] = [*machine.bearings, *machine.discs, *machine.probes]
    wanted = [*np.cumsum(ends), *(part.station for part in parts)]
    rotor = assemble_rotor(machine)
    for station in wanted:
        assert np.min(np.abs(found - station)) <= 1e-9
        assert abs(found[rotor.node("S", station)] - station) <= 1e-9


def test_span_of_exactly_the_longest_length_stays_in_one_piece() -> None:
    document = one_disc_document(length=0.4, disc_station=0.1, element_length=0.1)
    assert (0.4 - 0.1) / 0.1 > 3  # in binary
    machine = parse_machine(document)
    assert node_stations(machine, machine.shafts[0]) == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])


def test_stations_nearer_than_the_tolerance_are_one_node() -> None:
    document = one_disc_document()
    document["element_length"] = None
    plain = parse_machine(document)
    document["probes"][0]["station"] += 5e-10
    document["bearings"][1]["station"] += 5e-10
    near = parse_machine(document)
    assert len(node_stations(near, near.shafts[0])) == len(node_stations(plain, plain.shafts[0]))
    rotor = assemble_rotor(near)
    assert rotor.node("S", near.probes[0].station) == rotor.node("S", near.discs[0].station)
    assert rotor.node("S", near.bearings[1].station) == rotor.end_node("S")


def test_stations_farther_than_the_tolerance_are_two_nodes() -> None:
    document = one_disc_document()
    document["probes"][0]["station"] += 1e-6
    rotor = assemble_rotor(parse_machine(document))
    assert rotor.node("S", document["probes"][0]["station"]) == rotor.node("S", 0.5) + 1


def test_place_without_a_node_is_an_error() -> None:
    with pytest.raises(ValueError, match=r"no node at station 0\.1 m of shaft 'S1'"):
        assemble_rotor(chapter_3()).node("S1", 0.1)


def test_shafts_follow_one_another() -> None:
    rotor = assemble_rotor(chapter_3())
    assert rotor.size == 2 * 6 * 4
    assert rotor.first_node == {"S1": 0, "S2": 6}
    assert (rotor.end_node("S1"), rotor.end_node("S2")) == (5, 11)
    assert not np.any(rotor.stiffness[:24, 24:])
    assert not np.any(rotor.mass[:24, 24:])


def stepped() -> Document:
    """A hollow, stepped shaft of two materials."""
    document = one_disc_document(length=1.0, disc_station=0.7)
    document["materials"]["titanium"] = {"young_modulus": 1.1e11, "density": 4500.0}
    document["shafts"][0]["sections"] = [
        {"length": 0.33, "outer_diameter": 0.05, "inner_diameter": 0.03, "material": "steel"},
        {"length": 0.47, "outer_diameter": 0.02, "material": "titanium"},
        {"length": 0.2, "outer_diameter": 0.04, "inner_diameter": 0.01, "material": "steel"},
    ]
    return document


def test_total_mass_and_inertia_are_those_of_the_parts() -> None:
    machine = parse_machine(stepped())
    rotor = assemble_rotor(machine)
    pieces = [(0.0, 0.33, 0.05, 0.03, 7800.0), (0.33, 0.8, 0.02, 0.0, 4500.0), (0.8, 1.0, 0.04, 0.01, 7800.0)]
    mass, about_start, polar = 5.0, 5.0 * 0.7**2 + 0.02, 0.04
    for start, stop, outer, inner, density in pieces:
        area, second = math.pi / 4 * (outer**2 - inner**2), math.pi / 64 * (outer**4 - inner**4)
        mass += density * area * (stop - start)
        about_start += density * (area * (stop**3 - start**3) / 3 + second * (stop - start))
        polar += density * 2 * second * (stop - start)
    stations = rotor.stations["S"]
    x, y, about_x, about_y = (np.zeros(rotor.size) for _ in range(4))
    x[0::4] = y[1::4] = 1.0
    about_x[2::4], about_x[1::4] = 1.0, -stations
    about_y[3::4], about_y[0::4] = 1.0, stations
    assert x @ rotor.mass @ x == pytest.approx(mass, rel=1e-12)
    assert y @ rotor.mass @ y == pytest.approx(mass, rel=1e-12)
    assert about_x @ rotor.mass @ about_x == pytest.approx(about_start, rel=1e-12)
    assert about_y @ rotor.mass @ about_y == pytest.approx(about_start, rel=1e-12)
    assert about_x @ rotor.gyroscopic @ about_y == pytest.approx(polar, rel=1e-12)
    for motion in (x, y, about_x, about_y):
        assert np.abs(rotor.stiffness @ motion).max() < 1e-12 * np.abs(rotor.stiffness).max()


def test_disc_adds_its_mass_and_inertias_at_its_node_alone() -> None:
    document = chapter_3_document()
    plain = assemble_rotor(parse_machine(document))
    document["discs"][2].update(mass=3.5, diametral_inertia=0.0065, polar_inertia=0.012)
    heavier = assemble_rotor(parse_machine(document))
    at = 4 * plain.node("S2", 0.5)
    mass, gyroscopic = np.zeros_like(plain.mass), np.zeros_like(plain.mass)
    mass[at, at] = mass[at + 1, at + 1] = 1.0
    mass[at + 2, at + 2] = mass[at + 3, at + 3] = 0.002
    gyroscopic[at + 2, at + 3], gyroscopic[at + 3, at + 2] = 0.003, -0.003
    assert heavier.mass - plain.mass == pytest.approx(mass, abs=1e-12)
    assert heavier.gyroscopic - plain.gyroscopic == pytest.approx(gyroscopic, abs=1e-15)
    assert np.array_equal(heavier.stiffness, plain.stiffness)


LENGTH, DIAMETER, SUPPORT, DIAMETRAL, POLAR = 1.0, 0.03, 2e6, 0.02, 0.035


def tilting_disc() -> Machine:
    """A disc in the middle of a shaft of next to no mass on undamped isotropic bearings."""
    return parse_machine(
        one_disc_document(
            length=LENGTH,
            diameter=DIAMETER,
            density=1e-3,
            diametral_inertia=DIAMETRAL,
            polar_inertia=POLAR,
            kxx=SUPPORT,
            kyy=SUPPORT,
            cxx=1e-6,
            cyy=1e-6,
            element_length=0.5,
        )
    )


def tilting_stiffness() -> float:
    """Moment per tilt of the disc [N m/rad]: each half bends and shears as a cantilever loaded by its bearing."""
    half, bending = LENGTH / 2, 2.1e11 * math.pi / 64 * DIAMETER**4
    shear = shear_coefficient(poisson_ratio=0.3, diameter_ratio=0.0) * math.pi / 4 * DIAMETER**2 * 2.1e11 / 2.6
    per_force = half**3 / (3 * bending) + half / shear + 1 / SUPPORT
    return 2 * half**2 / per_force


def whirl(machine: Machine, spin: float, node: int) -> list[tuple[float, float]]:
    """(frequency, sense) of the lowest four modes; sense +1 where the disc's tilt turns from x to y, -1 against it."""
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    size = rotor.size
    a = np.block([[np.zeros((size, size)), np.eye(size)], [-rotor.stiffness - stiffness, -damping - spin * rotor.gyroscopic]])
    b = scipy.linalg.block_diag(np.eye(size), rotor.mass)
    roots, vectors = scipy.linalg.eig(a, b)
    order = [i for i in np.argsort(roots.imag) if roots[i].imag > 1.0][:4]
    result = []
    for i in order:
        theta_x, theta_y = vectors[4 * node + 2, i], vectors[4 * node + 3, i]
        # Of Re(v e^{jωt}): the area that (θx, θy) sweeps is positive from x to y.
        area = float(np.imag(theta_x * np.conj(theta_y)))
        result.append((float(roots[i].imag), area / max(abs(theta_x) ** 2 + abs(theta_y) ** 2, 1e-300) * 2))
    return result


def tilting_modes(spin: float) -> dict[int, float]:
    """Frequencies of the two tilting modes, by sense of whirl."""
    machine = tilting_disc()
    node = assemble_rotor(machine).node("S", LENGTH / 2)
    modes = whirl(machine, spin, node)
    expected = {sense: frequency(sense * abs(spin)) for sense in (1, -1)}
    near = [min(modes, key=lambda mode: abs(mode[0] - value)) for value in expected.values()]
    return {round(sense): value for value, sense in near}


def frequency(spin: float) -> float:
    """Closed form of the mode that whirls in the sense of a positive spin."""
    half = spin * POLAR / (2 * DIAMETRAL)
    return half + math.sqrt(half**2 + tilting_stiffness() / DIAMETRAL)


@pytest.mark.parametrize("spin", [50.0, 200.0, 500.0])
def test_forward_whirl_rises_and_backward_whirl_falls(spin: float) -> None:
    forward = tilting_modes(spin)
    assert forward[1] == pytest.approx(frequency(spin), rel=1e-5)
    assert forward[-1] == pytest.approx(frequency(-spin), rel=1e-5)
    assert forward[-1] < frequency(0.0) < forward[1]


@pytest.mark.parametrize("spin", [50.0, 500.0])
def test_spin_turned_round_swaps_forward_and_backward(spin: float) -> None:
    one, other = tilting_modes(spin), tilting_modes(-spin)
    assert other[1] == pytest.approx(one[-1], rel=1e-9)
    assert other[-1] == pytest.approx(one[1], rel=1e-9)


def test_overhung_disc_with_more_polar_than_diametral_inertia() -> None:
    document = one_disc_document(disc_station=1.0, cxx=1e-6, cyy=1e-6)
    document["bearings"][1]["station"] = 0.6
    machine = parse_machine(document)
    node = assemble_rotor(machine).node("S", 1.0)
    lowest = [whirl(machine, spin, node)[:2] for spin in (100.0, 300.0, 600.0)]
    assert all([round(sense) for _, sense in pair] == [-1, 1] for pair in lowest)
    assert np.all(np.diff([pair[0][0] for pair in lowest]) < 0), "backward falls"
    assert np.all(np.diff([pair[1][0] for pair in lowest]) > 0), "forward rises"
