"""Coordinates that a named cause frees: the same that its hypothesis moves, beside elevations."""

from functools import cache

import numpy as np
import pytest

from estimator.alignment.freed_coordinates import FREED, freed_directions
from estimator.arrays import Floats
from estimator.diagnosis.hypotheses import Hypothesis, hypotheses
from estimator.diagnosis.moving_causes import moving_causes
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import describe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.updated_model.model import expected_model
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.statics.test_process_forces import with_force

STANDING = {"kxx": 4e8, "kyy": 6e8, "cxx": 1e5, "cyy": 1e5, "mxx": 200.0, "myy": 200.0}


@cache
def machine() -> Machine:
    """A train with all that can happen to one: a force, a pedestal, bearings oiled by one supply and by their own."""
    said = with_force(motor_compressor_document("flexible"), force_y=-500.0, force_y_spread=800.0)
    said["pedestals"] = [{"id": "P2", "bearing": "B2", **STANDING}]
    said["parameters"] = [{"names": "pedestal.*", "spread": 0.2}]
    said["couplings"][0]["rotating_error"] = {"offset_spread": 3e-5, "angle_spread": 3e-4}
    for number, bearing in enumerate(said["bearings"]):
        bearing["speed_dependence"] = {"form": "journal", "elevation_spread": 150e-6}
        if number < 2:
            bearing["film"]["oil"] |= {"supply": "main"}
    return parse_machine(said)


MODEL = expected_model(machine())
COORDINATES = MODEL.coordinates_at(np.ones(1))


def moved(columns: Floats) -> set[str]:
    places = np.flatnonzero(np.abs(columns).reshape(len(COORDINATES.names), -1).any(axis=1))
    return {COORDINATES.names[place] for place in places}


@cache
def everything() -> tuple[Hypothesis, ...]:
    unknown = unknowns(machine(), assemble_rotor(machine()))
    amplitude = dict.fromkeys(machine().channels, 1e-5)
    return hypotheses(machine(), unknown, COORDINATES.names, typical=np.full(COORDINATES.size, 1e-5), amplitude=amplitude)


def test_each_kind_of_cause_frees_what_its_hypothesis_moves() -> None:
    found = set()
    for one in everything():
        names = {name for columns in one.variants for name in moved(columns) if "elevation" not in name}
        directions = freed_directions(COORDINATES, moving_causes([(one.kind, one.element)]))
        assert moved(directions) == names, one
        found.add(one.kind)
    assert {
        "misalignment",
        "coupling",
        "bearing",
        "pedestal",
        "wear",
        "oil",
        "process_force",
        "unbalance",
        "rotating_coupling",
    } <= found


def test_all_films_have_thicker_oil_together_and_each_clearance_is_its_own() -> None:
    oil = freed_directions(COORDINATES, moving_causes([("oil", "machine")]))
    assert oil.shape == (COORDINATES.size, 1)
    assert moved(oil) == {"oil.main.viscosity_factor", "bearing.B3.viscosity", "bearing.B4.viscosity"}
    place = COORDINATES.names.index("bearing.B3.viscosity")
    assert oil[place] == pytest.approx(FREED * COORDINATES.spread[place])
    worn = freed_directions(
        COORDINATES, moving_causes([("wear", "bearing.B2"), ("wear", "bearing.B2"), ("wear", "bearing.B3")])
    )
    assert moved(worn) == {"bearing.B2.clearance", "bearing.B3.clearance"}
    assert worn.shape == (COORDINATES.size, 2)


def test_what_moves_no_coordinate_frees_none() -> None:
    for cause in (("misalignment", "coupling.C1"), ("sensor", "probe.B1H"), ("oil_of_another_release", "machine")):
        assert freed_directions(COORDINATES, moving_causes([cause])).shape == (COORDINATES.size, 0)
    assert {describe(name).quantity for name in COORDINATES.names} >= {"force_y", "unbalance", "clearance"}
