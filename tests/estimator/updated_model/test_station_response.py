"""Response away from the probes: against the dense model of `trains`, reciprocity of the train, and Monte Carlo."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.machine.parts import Probe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.rotor.shaft_element import plane_element
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.station_response import StationResponse, displacement_row, station_response
from tests.estimator.models import draws, model_of
from tests.estimator.trains import (
    Document,
    chapter_3,
    chapter_3_document,
    dense_response,
    mirrored,
    one_disc_document,
    truth,
)

SPEED = np.array([50.0, 118.0, 160.0, 290.0])


def place(shaft: str, station: float, angle: float, name: str = "P") -> Probe:
    return Probe(id=name, shaft=shaft, station=station, angle_deg=angle)


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_a_probe_is_a_place_like_any_other(turned: bool) -> None:
    machine = parse_machine(mirrored(chapter_3_document())) if turned else chapter_3()
    found = station_response(model_of(machine), speed=SPEED, places=machine.probes)
    expected = dense_response(machine, SPEED, direction=machine.direction)
    assert found.response.value == pytest.approx(expected, rel=1e-8)


def test_a_place_between_nodes_moves_as_a_node_there_would_statically() -> None:
    """Two elements instead of one, nothing loading the node between them: exact for a beam under end loads."""
    length, part = 0.4, 0.3
    shaft = {"outer_diameter": 0.2, "inner_diameter": 0.1, "young_modulus": 2e11, "density": 7800.0, "poisson_ratio": 0.3}
    whole = np.zeros((6, 6))
    for first, piece in ((0, part * length), (2, (1 - part) * length)):
        whole[first : first + 4, first : first + 4] += plane_element(length=piece, **shaft).stiffness
    outer = [0, 1, 4, 5]
    middle = -np.linalg.solve(whole[2:4, 2:4], whole[2:4][:, outer])[0]  # displacement per displacement and slope of the ends
    document = one_disc_document(length=2 * length, diameter=0.2, disc_station=length, element_length=length)
    document["shafts"][0]["sections"][0] |= {"inner_diameter": 0.1}
    document["materials"]["steel"]["young_modulus"] = 2e11
    machine = parse_machine(document)
    rotor = assemble_rotor(machine)
    # x with θy, y with -θx.
    for angle, dofs, signs in ((0.0, [4, 7, 8, 11], [1, 1, 1, 1]), (90.0, [5, 6, 9, 10], [1, -1, 1, -1])):
        found = displacement_row(machine, rotor, place("S", (1 + part) * length, angle))
        assert found[dofs] == pytest.approx(middle * signs, rel=1e-9)
        assert np.abs(np.delete(found, dofs)).max() < 1e-12


def test_a_place_between_nodes_sees_nearly_what_a_finer_mesh_says() -> None:
    """0.25 m elements are coarse for 20 mm shafts: 1 % of the largest amplitude along."""
    places = [place("S1", 0.333, 20.0, "one"), place("S2", 0.777, -70.0, "two")]
    document = chapter_3_document()
    document["probes"] += [one.model_dump(exclude_none=True) for one in places]
    there = dense_response(parse_machine(document), SPEED, direction=1)[:, -2:]
    found = station_response(model_of(chapter_3()), speed=SPEED, places=places).response.value
    assert np.abs(found - there).max() < 0.01 * np.abs(there).max()
    assert np.abs(found / there - 1).max() < 0.05


def test_an_angle_projects_x_and_y() -> None:
    places = [place("S1", 0.6, angle) for angle in (0.0, 90.0, 30.0, 210.0)]
    x, y, between, opposite = station_response(model_of(chapter_3()), speed=SPEED, places=places).response.value.T
    assert between == pytest.approx(np.cos(np.pi / 6) * x + np.sin(np.pi / 6) * y, rel=1e-12)
    assert opposite == pytest.approx(-between, rel=1e-12)


def unit_response(document: Document, disc: int, seen: tuple[str, float], speed: float) -> complex:
    """x at a place, per unbalance on one disc, at one speed."""
    machine = parse_machine(document)
    coefficients, unbalances = truth(machine)
    only_one = np.where(np.arange(unbalances.size) == disc, 1.0 + 0j, 0j)
    covariance = model_of(machine).covariance
    only = UpdatedModel.of(machine, coefficients=coefficients, unbalances=only_one, covariance=covariance)
    return complex(station_response(only, speed=np.array([speed]), places=[place(*seen, 0.0)]).response.value[0, 0])


@pytest.mark.parametrize("speed", [70.0, 150.0, 260.0])
def test_reciprocity_of_a_symmetric_train(speed: float) -> None:
    """No gyroscopic moments, planes apart: the first disc moves the last one as that moves the first (Maxwell, Betti)."""
    document = chapter_3_document()
    for part in (*document["bearings"], *document["couplings"]):
        for name in ("kxy", "kyx", "cxy", "cyx"):
            part[name] = 0.0
    for disc in document["discs"]:
        disc["polar_inertia"] = 0.0
    for material in document["materials"].values():
        material["density"] = 1e-3  # of the shafts, whose gyroscopic moments would spoil it
    discs = document["discs"]
    first, last = 0, len(discs) - 1
    there = unit_response(document, first, (discs[last]["shaft"], discs[last]["station"]), speed)
    back = unit_response(document, last, (discs[first]["shaft"], discs[first]["station"]), speed)
    assert there == pytest.approx(back, rel=1e-6)


def test_jeffcott_rotor_between_its_bearings_in_closed_form() -> None:
    """Rigid massless shaft, disc in the middle: X = U ω² / (k - mω² + jωc) everywhere; 1e-3 for the shaft's bending."""
    document = one_disc_document(
        length=0.2, diameter=0.2, density=1e-2, kxx=1e5, kyy=1e5, cxx=20.0, cyy=20.0, element_length=0.1
    )
    model = model_of(parse_machine(document))
    speed = np.array([50.0, 190.0, 400.0])
    found = station_response(model, speed=speed, places=[place("S", 0.03, 0.0), place("S", 0.17, 90.0)]).response.value
    expected = model.excitations[0] * speed**2 / (2e5 - 5.0 * speed**2 + 40j * speed)
    assert found[:, 0] == pytest.approx(expected, rel=1e-3)
    assert found[:, 1] == pytest.approx(-1j * expected, rel=1e-3)


def test_the_bearings_take_the_power_that_the_unbalance_gives() -> None:
    """Power of the unbalance forces, ½ Re(jω x conj(f)), equals ½ω² Σ c|x|² of the dampers."""
    machine = parse_machine(one_disc_document(disc_station=0.3, cxx=200.0, cyy=500.0, kxx=1e6, kyy=3e6))
    model = model_of(machine)
    speed = np.array([120.0, 250.0])
    places = [place("S", station, angle) for station in (0.3, 0.0, 1.0) for angle in (0.0, 90.0)]
    q = station_response(model, speed=speed, places=places).response.value
    force = model.excitations[0] * speed**2
    given = 0.5 * np.real(1j * speed * (q[:, 0] * np.conj(force) + q[:, 1] * np.conj(-1j * force)))
    taken = 0.5 * speed**2 * (200.0 * np.abs(q[:, [2, 4]]) ** 2 + 500.0 * np.abs(q[:, [3, 5]]) ** 2).sum(axis=1)
    assert given == pytest.approx(taken, rel=1e-6)
    assert np.all(given > 0)


def test_band_is_that_of_monte_carlo() -> None:
    """2000 draws; 12 % of a standard deviation, 15 % of a half width."""
    model = model_of(chapter_3(), error=0.01)
    seen = place("S1", 0.25, 45.0)
    found: StationResponse = station_response(model, speed=SPEED, places=[seen])
    train = condense(model.machine.model_copy(update={"probes": (seen,)}), speed=SPEED, direction=np.ones(SPEED.size))
    cloud = np.array([response(train, coefficients=c, excitations=u)[:, 0] for c, u in draws(model, 2000)])
    band = found.response
    for part, index in (("real", 0), ("imag", 1)):
        expected = np.std(getattr(cloud, part), axis=0)
        assert np.sqrt(band.covariance[:, 0, index, index]) == pytest.approx(expected, rel=0.12)
    half = (band.upper - band.amplitude)[:, 0]
    high, low = np.quantile(np.abs(cloud), [0.975, 0.025], axis=0)
    assert np.all(np.abs(high - band.upper[:, 0]) < 0.15 * half)
    assert np.all(np.abs(low - band.lower[:, 0]) < 0.15 * half)


@pytest.mark.parametrize(
    ("shaft", "station", "message"),
    [("S9", 0.1, "'S9' is not one of the shafts: S1, S2"), ("S1", 99.0, "lies beyond shaft 'S1'")],
)
def test_a_place_must_be_on_a_shaft(shaft: str, station: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        station_response(model_of(chapter_3()), speed=SPEED, places=[place(shaft, station, 0.0)])
