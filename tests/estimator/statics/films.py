"""Documents of trains on oil films: the reference motor and compressor, and a rotor between two equal bearings."""

import copy
from typing import Any

from estimator.machine.document import Machine, parse_machine
from tests.film_plant.documents import linear_document
from tests.film_plant.motor_compressor import CouplingKind, motor_compressor
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.train import ConstantOil


def motor_compressor_document(kind: CouplingKind, case: str = "aligned") -> dict[str, Any]:
    """The document by geometry of one of the reference cases; elevations are those over the aligned case."""
    train, aligned = motor_compressor(kind, case), motor_compressor(kind)
    plant = Plant("motor-compressor", train, train, 700.0 * RPM, 4600.0 * RPM)
    said = linear_document(plant, perturbation=0.0, element_length=1.0)
    for bearing, true, usual in zip(said["bearings"], train.bearings, aligned.bearings, strict=True):
        assert isinstance(true.oil, ConstantOil)
        bearing["film"] = {
            "diameter": true.diameter,
            "length": true.length,
            "radial_clearance": true.clearance,
            "oil": {"viscosity": true.oil.value},
            "elevation_y": true.elevation[1] - usual.elevation[1],
        }
    return said


def between_two_bearings(**changed: Any) -> Machine:
    """A stiff rotor of 200 kg in the middle of two equal plain bearings; what is changed is of their films."""
    lateral = {"kxx": 1e8, "kyy": 1e8, "cxx": 1e5, "cyy": 1e5, "kxy": 0.0, "kyx": 0.0, "cxy": 0.0, "cyx": 0.0}
    said = {"diameter": 0.08, "length": 0.04, "radial_clearance": 8e-5, "oil": {"viscosity": 0.02}} | changed
    document: dict[str, Any] = {
        "id": "symmetric",
        "plant": "tests",
        "name": "symmetric",
        "speed_range": {"minimum_rpm": 500, "maximum_rpm": 6000},
        "materials": {"light": {"young_modulus": 2e11, "density": 1.0}},
        "shafts": [{"id": "S", "sections": [{"length": 1.0, "outer_diameter": 0.1, "material": "light"}]}],
        "discs": [{"id": "D", "shaft": "S", "station": 0.5, "mass": 200.0, "diametral_inertia": 2.0, "polar_inertia": 4.0}],
        "bearings": [
            {"id": f"B{number}", "shaft": "S", "station": station, **lateral, "film": copy.deepcopy(said)}
            for number, station in enumerate((0.1, 0.9), start=1)
        ],
        "probes": [{"id": "X", "shaft": "S", "station": 0.1, "angle_deg": 0}],
    }
    return parse_machine(document)


PADS: dict[str, Any] = {"number": 5, "arc_deg": 60.0, "pivot": 0.6, "load": "between_pads"}
"""Five offset pads, loaded between two."""


def on_tilting_pads(document: dict[str, Any], **changed: Any) -> dict[str, Any]:
    """A document whose films are those of tilting pads; what is changed is of the films."""
    said = copy.deepcopy(document)
    for bearing in said["bearings"]:
        bearing["film"] |= {"profile": "tilting_pad", "preload": 0.3, "pads": PADS} | changed
    return said
