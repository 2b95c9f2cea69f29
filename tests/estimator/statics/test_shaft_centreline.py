"""The shaft centreline: what probes see of journals by the lever rule, derivatives against differences, and foreign films."""

from typing import Any

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.statics.film_model import film_model
from estimator.statics.shaft_centreline import ProbeLines, ShaftCentreline, probe_views
from tests.estimator.statics.test_film_model import SPEED, document, drawn
from tests.film_plant.documents import film_document
from tests.film_plant.plants import motor_compressor_plant

COMPLIANCE = 1.0 / 4e8
OTHER = 1.0 / 2e8


def one_shaft(*, pedestals: bool = False, **probe: Any) -> Machine:
    """A shaft that is held by two bearings alone, so that at rest it moves as a rigid body, with one probe."""
    said = document()
    first = said["bearings"][:2]
    said |= {
        "couplings": [],
        "shafts": said["shafts"][:1],
        "bearings": first,
        "discs": [one for one in said["discs"] if one["shaft"] == "S1"],
        "probes": [{"id": "P", "shaft": "S1", "angle_deg": 90.0, **probe}],
        "parameters": [],
    }
    if pedestals:
        said["pedestals"] = [
            {"id": f"P{one['id']}", "bearing": one["id"], "kxx": 1.0 / OTHER, "kyy": 1.0 / COMPLIANCE, "cxx": 1e4, "cyy": 1e4}
            | {"mxx": 100.0, "myy": 100.0}
            for one in first
        ]
    return parse_machine(said)


def probe_lines(machine: Machine) -> ProbeLines:
    """Views of the probes with pedestals as stiff as the document says."""
    views = probe_views(machine)
    return views.at(np.ones(len(views.coupled.parameters)))


def lever(machine: Machine, station: float) -> Floats:
    """Parts of the two journals' motions that a point of a rigid shaft has."""
    low, high = (one.station for one in machine.bearings)
    part = (station - low) / (high - low)
    return np.array([1.0 - part, part])


def test_a_probe_between_two_bearings_sees_their_journals_by_the_lever_rule() -> None:
    machine = one_shaft(station=0.6)
    lines = probe_lines(machine)
    np.testing.assert_allclose(lines.by_position[0, :, 1], lever(machine, 0.6), atol=1e-9)
    np.testing.assert_allclose(lines.by_position[0, :, 0], 0.0, atol=1e-9)
    assert not lines.by_force.any()


def test_an_oblique_probe_sees_both_planes() -> None:
    machine = one_shaft(station=0.6)
    oblique = probe_lines(one_shaft(station=0.6, angle_deg=135.0))
    seen = oblique.seen(np.array([[3e-6, 4e-6], [3e-6, 4e-6]]), np.zeros((2, 2)))
    np.testing.assert_allclose(seen, [(4e-6 - 3e-6) / np.sqrt(2.0)], rtol=1e-9)
    assert machine.probes[0].angle_deg == 90.0


def test_pedestals_that_give_way_carry_the_journals_and_the_probe_that_stands_on_one() -> None:
    station = 0.6
    for absolute in (False, True):
        machine = one_shaft(pedestals=True, station=station, absolute=absolute)
        lines, parts = probe_lines(machine), lever(machine, station)
        position, force = np.array([[1e-6, -20e-6], [2e-6, -30e-6]]), np.array([[100.0, 900.0], [-50.0, 700.0]])
        moved = parts @ (position[:, 1] - COMPLIANCE * force[:, 1])
        near = int(np.argmax(parts))
        given = 0.0 if absolute else COMPLIANCE * force[near, 1]
        np.testing.assert_allclose(lines.seen(position, force), [moved + given], rtol=1e-9)


def test_a_probe_at_a_bearing_sees_the_journal_in_it_whatever_its_pedestal_does() -> None:
    at = one_shaft(station=0.6).bearings[0]
    lines = probe_lines(one_shaft(pedestals=True, station=at.station))
    force = np.array([[100.0, 900.0], [-50.0, 700.0]])
    np.testing.assert_allclose(lines.seen(np.array([[1e-6, -20e-6], [2e-6, -30e-6]]), force), [-20e-6], rtol=1e-9)


def test_derivatives_are_those_of_differences() -> None:
    machine = parse_machine(document(viscosity_slope_spread=0.2))
    model = film_model(machine)
    line, fitted = ShaftCentreline(model.films, probe_views(machine), SPEED), drawn(model, 3)
    found = line.derivatives(fitted)
    assert found.shape == (SPEED.size, len(machine.probes), model.own.count)
    for place in range(model.own.count):
        step = np.zeros(fitted.size)
        step[place] = 1e-3
        difference = (line.values(fitted + step) - line.values(fitted - step)) / 2e-3
        np.testing.assert_allclose(found[:, :, place], difference, atol=2e-4 * np.abs(difference).max() + 1e-12)


def test_derivatives_by_a_films_own_viscosity_are_those_by_its_parameter() -> None:
    machine = parse_machine(document())
    model = film_model(machine)
    line, fitted = ShaftCentreline(model.films, probe_views(machine), SPEED), drawn(model, 4)
    own, each = line.derivatives(fitted), line.by_viscosities(fitted)
    for number in range(4):
        np.testing.assert_allclose(each[..., number], own[..., model.own.place(number, "viscosity")], rtol=1e-9, atol=1e-15)


def test_the_centreline_is_that_of_films_of_another_make() -> None:
    """Journals of a finite-difference solver's films, a probe in x and in y at each: within 2 % of the clearance."""
    plant = motor_compressor_plant(2, "rigid")
    machine = parse_machine(film_document(plant))
    model = film_model(machine)
    centre = np.array([one.centre for one in model.numbers])
    truth = plant.truth(plant.speeds(12))
    fitted = centre.copy()
    for number, (clearance, viscosity) in enumerate(zip(truth.clearance, truth.viscosity, strict=True)):
        believed = plant.believed.bearings[number].clearance
        fitted[model.own.place(number, "clearance")] = np.log(clearance / believed)
        fitted[model.own.place(number, "viscosity")] = np.log(viscosity)
        for plane, what in enumerate(("elevation_x", "elevation_y")):
            place = model.own.place(number, what)
            fitted[place] = truth.elevation[number, plane] / model.numbers[place].step
    found = ShaftCentreline(model.films, probe_views(machine), plant.speeds(12)).values(fitted)
    exact = truth.films.position.reshape(12, -1)
    off = (found - found.mean(axis=0)) - (exact - exact.mean(axis=0))
    assert np.abs(off).max() < 0.02 * truth.clearance.min()
    assert np.ptp(exact, axis=0).max() > 0.2 * truth.clearance.min()
