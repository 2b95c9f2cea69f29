"""Errors at the door: a number out of its range is told with its unit, what is usual, and the unit that was probably meant."""

import copy
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.machine.films import JournalFilm, Oil
from estimator.strict_model import field_at
from estimator.usual_values import OTHER_UNITS, declaration, question
from formats.files.document_files import read_yaml
from tests.paths import EXAMPLES

DOCUMENT: dict[str, Any] = read_yaml(EXAMPLES / "turbine-on-tilting-pads.yaml")
BEARING = ("bearings", 0)
FILM = (*BEARING, "film")
FORM = (*BEARING, "speed_dependence")
COUNTS = {"number", "bins", "samples_per_bin", "samples", "mountings"}
"""Fields that count something and have no unit."""
OF_OTHER_UNITS = {"usual_change", "stated_at", "values", "covariance"}
"""Fields whose unit is that of something else."""


def spoiled(path: tuple[str | int, ...], value: Any) -> dict[str, Any]:
    """The document with one field set; each bearing has a film of its own."""
    document = copy.deepcopy(DOCUMENT)
    for bearing in document["bearings"]:
        bearing["film"] = copy.deepcopy(bearing["film"])
    place: Any = document
    for part in path[:-1]:
        place = place.setdefault(part, {}) if isinstance(place, dict) else place[part]
    place[path[-1]] = value
    return document


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ((*FILM, "radial_clearance"), -1e-4, "-0.0001 m: should be greater than 0; usual is 0.001 to 0.002 of the radius"),
        (
            (*FILM, "oil", "temperature_c"),
            323,
            "323 °C: should be less than or equal to 180 °C; usual is 10 to 120 °C; was 323 K meant, 49.9 °C?",
        ),
        ((*FILM, "oil", "temperature_c"), 200, "was 200 °F meant, 93.3 °C?"),
        (
            (*FORM, "elevation_spread"),
            0.15,
            "0.15 m: should be less than or equal to 0.01 m; usual is 1e-05 to 0.001 m; was 0.15 mm meant, 0.00015 m?",
        ),
        ((*FORM, "elevation_spread"), 150, "was 150 µm meant, 0.00015 m?"),
        ((*FORM, "clearance_spread"), 15, "15: should be less than 0.5; usual is 0.01 to 0.3; was 15 % meant, 0.15?"),
        ((*FORM, "clearance_spread"), -0.1, "-0.1: should be greater than or equal to 0; usual is 0.01 to 0.3"),
        ((*FILM, "pads", "number"), 2, "2: should be greater than or equal to 3; usual is 4 or 5"),
        ((*FILM, "pads", "arc_deg"), 1.05, "was 1.05 rad meant, 60.2 °?"),
        ((*FILM, "pads", "pivot"), 60, "was 60 % meant, 0.6?"),
        ((*FILM, "preload"), 1.5, "1.5: should be less than 1; usually 0.3 to 0.6 for lobed ones, 0 to 0.5 for tilting pads"),
        ((*FILM, "groove_deg"), 400, "400 °: should be less than 85 °; usual is 5 to 45 °"),
        ((*FILM, "oil", "iso_vg"), 33, "was 32 meant?"),
        ((*FILM, "oil", "iso_vg"), "VG 46", "was 46 meant?"),
        ((*FILM, "diameter"), 100, "100 m: should be less than 100 m; usual is 0.02 to 1 m; was 100 mm meant, 0.1 m?"),
        ((*BEARING, "kxx"), -1e8, "-1e+08 N/m: should be greater than 0; usual is 1e+5 to 1e+10 N/m"),
        (("shafts", 0, "sections", 0, "length"), 300, "was 300 mm meant, 0.3 m?"),
        (("materials", "steel", "density"), 0, "0 kg/m³: should be greater than 0; usual is 7850 kg/m³, of steel"),
        (("operation", "longest_hold_s"), 5, "5 s: should be greater than or equal to 10 s"),
        (("noise", "relative"), 1, "was 1 % meant, 0.01?"),
        (("probes", 0, "sensitivity"), 1e20, "1e+20 V/m: should be less than 1e+15 V/m"),
    ],
)
def test_a_number_out_of_range_is_told_with_its_unit_and_what_is_usual(
    path: tuple[str | int, ...], value: float, words: str
) -> None:
    with pytest.raises(DocumentError) as raised:
        parse_machine(spoiled(path, value))
    ((_, said),) = raised.value.problems
    assert said == words if words[0] in "-0123456789" else said.endswith(f"; {words}"), said


@pytest.mark.parametrize(("clearance", "meant"), [(0.11, "0.11 mm"), (110.0, "110 µm")])
def test_a_clearance_in_another_unit_is_asked_for(clearance: float, meant: str) -> None:
    with pytest.raises(DocumentError, match=f"usual is 0.001 to 0.002 of it; was {meant} meant, 0.00011 m\\?"):
        parse_machine(spoiled((*FILM, "radial_clearance"), clearance))


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("operation", "vibration_alert"), 40.0, "40 m: usual is 1e-06 to 0.001 m; was 40 µm meant, 4e-05 m?"),
        (("noise", "floor"), 0.1, "0.1 m: usual is 1e-09 to 5e-05 m; was 0.1 µm meant, 1e-07 m?"),
        (("probes", 2, "run_out_spread"), 5.0, "was 5 µm meant, 5e-06 m?"),
    ],
)
def test_a_length_far_beyond_the_usual_is_refused_where_the_document_enters(
    path: tuple[str | int, ...], value: float, words: str
) -> None:
    document = spoiled(path, value)
    with pytest.raises(DocumentError) as raised:
        accepted_machine(document)
    ((field, said),) = raised.value.problems
    assert field.endswith(str(path[-1]))
    assert words in said
    assert parse_machine(document).id == DOCUMENT["id"]


def test_a_grade_without_a_temperature_is_told_what_is_usual() -> None:
    with pytest.raises(
        DocumentError, match="temperature_c, of the film, usually 40 to 80 °C, or inlet_c, usually 35 to 50 °C"
    ):
        parse_machine(spoiled((*FILM, "oil"), {"iso_vg": 32}))


def test_what_no_unit_makes_usual_is_asked_nothing() -> None:
    told = declaration(JournalFilm.model_fields["diameter"])
    assert told.question(1e9) == ""
    assert question(-110.0, "m", (1e-5, 1e-3)) == ""
    assert question(5.0, "K", (1.0, 2.0)) == ""


def test_the_field_of_an_error_is_found_in_the_form_that_it_is_of() -> None:
    found = field_at(Machine, ("bearings", 0, "speed_dependence", "Table", "kxx", 3))
    assert found is not None
    assert found.description == "at each speed [N/m]; usual is 1e+5 to 1e+9 N/m"
    material = field_at(Machine, ("materials", "density", "young_modulus"))
    assert material is not None
    assert declaration(material).unit == "N/m²"
    assert field_at(Machine, ()) is None


def test_usual_values_lie_within_their_bounds_and_their_unit_has_others() -> None:
    temperature = declaration(Oil.model_fields["temperature_c"])
    assert (temperature.unit, temperature.usual) == ("°C", (10, 120))
    for _, field in _fields(Machine, set()):
        told = declaration(field)
        if told.usual is not None:
            assert told.usual[0] < told.usual[1]
            assert told.unit in OTHER_UNITS


def test_every_number_of_a_document_says_its_unit() -> None:
    lacking = [
        f"{model.__name__}.{name}"
        for (model, name), field in _fields(Machine, set())
        if not declaration(field).unit and name not in COUNTS | OF_OTHER_UNITS and _is_number(field)
    ]
    assert lacking == []


def _is_number(field: FieldInfo) -> bool:
    return any(kind in str(field.annotation) for kind in ("float", "int"))


def _fields(model: type[BaseModel], seen: set[type[BaseModel]]) -> Iterator[tuple[tuple[type[BaseModel], str], FieldInfo]]:
    if model in seen:
        return
    seen.add(model)
    for name, field in model.model_fields.items():
        yield (model, name), field
        for held in _models(field.annotation):
            yield from _fields(held, seen)


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for one in getattr(annotation, "__args__", ()):
        yield from _models(one)
