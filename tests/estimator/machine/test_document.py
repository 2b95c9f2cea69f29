"""The machine document: what is wrong with it is said with the name of the field, and what is right survives a round trip."""

import json
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.document import DocumentError, Machine, field_path, parse_machine
from tests.estimator.trains import Document, chapter_3, chapter_3_document, few_examples, one_disc_document

NAN, INFINITY = float("nan"), float("inf")


def two_sections() -> Document:
    """The Chapter 3 document with each shaft written as two sections."""
    document = chapter_3_document()
    for shaft in document["shafts"]:
        section = shaft["sections"][0]
        shaft["sections"] = [{**section, "length": 0.5}, {**section, "length": 0.75}]
    return document


def problems(document: Any) -> dict[str, str]:
    """Field and message of everything that is wrong."""
    with pytest.raises(DocumentError) as caught:
        parse_machine(document)
    return dict(caught.value.problems)


def put(document: Document, field: str, value: Any) -> None:
    """Set `bearings[1].kxx` of a document."""
    *path, last = field.replace("[", ".#").replace("]", "").split(".")
    at: Any = document
    for step in path:
        at = at[int(step[1:])] if step.startswith("#") else at[step]
    at[int(last[1:]) if last.startswith("#") else last] = value


def drop(field: str) -> Callable[[Document], None]:
    """Remove a field of the document itself or of one of its parts."""

    def change(document: Document) -> None:
        at: Any = document
        *path, last = field.replace("[", ".#").replace("]", "").split(".")
        for step in path:
            at = at[int(step[1:])] if step.startswith("#") else at[step]
        del at[last]

    return change


WRONG_VALUES: list[tuple[str, Any, str]] = [
    # (field, its wrong value, part of what is said)
    ("schema_version", 2, "1"),
    ("schema_version", "one", "1"),
    ("id", "two words", "letters, digits"),
    ("id", "", "letters, digits"),
    ("id", "trailing-newline\n", "letters, digits"),
    ("id", "x" * 65, "letters, digits"),
    ("plant", "../up", "letters, digits"),
    ("name", "", "at least 1"),
    ("name", "n" * 201, "at most 200"),
    ("rotation", "clockwise", "positive"),
    ("speed_range.minimum_rpm", 0, "greater than 0"),
    ("speed_range.maximum_rpm", INFINITY, "finite"),
    ("materials.steel.young_modulus", -2.1e11, "greater than 0"),
    ("materials.steel.density", 0.0, "greater than 0"),
    ("materials.steel.density", NAN, "finite"),
    ("materials.steel.poisson_ratio", 0.5, "less than 0.5"),
    ("materials.steel.poisson_ratio", -1.0, "greater than -1"),
    ("materials.steel.poisson_ratio", NAN, ""),
    ("materials.steel.colour", "grey", "no such field"),
    ("shafts", [], "at least 1"),
    ("shafts[0].id", "S 1", "letters, digits"),
    ("shafts[0].sections", [], "at least 1"),
    ("shafts[0].sections[0].length", 0.0, "greater than 0"),
    ("shafts[0].sections[0].length", NAN, "finite"),
    ("shafts[0].sections[0].outer_diameter", -0.02, "greater than 0"),
    ("shafts[0].sections[0].inner_diameter", -0.01, "greater than or equal to 0"),
    ("shafts[0].sections[0].material", "mithril", "not one of the materials: steel"),
    ("discs", [], "at least 1"),
    ("discs[1].mass", -1.0, "greater than 0"),
    ("discs[1].mass", NAN, "finite"),
    ("discs[1].mass", "heavy", "number"),
    ("discs[1].mass", None, "number"),
    ("discs[1].polar_inertia", -1e-3, "greater than or equal to 0"),
    ("discs[1].station", -0.1, "greater than or equal to 0"),
    ("discs[1].station", 1.3, "beyond shaft 'S1', which is 1.25 m long"),
    ("discs[1].shaft", "S9", "not one of the shafts: S1, S2"),
    ("discs[1].unbalance.magnitude", -1.0, "greater than or equal to 0"),
    ("discs[1].unbalance.angle_deg", INFINITY, "finite"),
    ("bearings", [], "at least 1"),
    ("bearings[3].station", 1.2501, "beyond shaft 'S2'"),
    ("bearings[3].shaft", "S3", "not one of the shafts"),
    ("bearings[3].kxx", 0.0, "greater than 0"),
    ("bearings[3].kyy", -1.0, "greater than 0"),
    ("bearings[3].cxx", NAN, "finite"),
    ("bearings[3].kxy", NAN, "finite"),
    ("bearings[3].kzz", 1.0, "no such field"),
    ("couplings[0].driver", "S0", "not one of the shafts: S1, S2"),
    ("couplings[0].driven", "S0", "not one of the shafts: S1, S2"),
    ("couplings[0].driven", "S1", "two different shafts"),
    ("couplings[0].k_phix", -1.0, "greater than 0"),
    ("probes", [], "at least 1"),
    ("probes[7].station", 99.0, "beyond shaft 'S2'"),
    ("probes[7].angle_deg", NAN, "finite"),
    ("probes[7].sensitivity", 0.0, "greater than 0"),
    ("noise.relative", 0.0, "greater than 0"),
    ("noise.relative", 1.0, "less than 1"),
    ("noise.relative", NAN, ""),
    ("noise.floor", -1e-9, "greater than or equal to 0"),
    ("element_length", 0.0, "greater than 0"),
    ("colour", "grey", "no such field"),
]


@pytest.mark.parametrize(("field", "value", "said"), WRONG_VALUES, ids=[f"{f}={v!r:.20}" for f, v, _ in WRONG_VALUES])
def test_wrong_value_is_named_alone(field: str, value: Any, said: str) -> None:
    document = two_sections()
    put(document, field, value)
    found = problems(document)
    assert list(found) == [field]
    assert said in found[field]


@pytest.mark.parametrize(
    "field",
    [
        "id",
        "plant",
        "name",
        "speed_range",
        "materials",
        "shafts",
        "discs",
        "bearings",
        "probes",
        "speed_range.maximum_rpm",
        "materials.steel.density",
        "shafts[1].sections",
        "shafts[1].sections[0].material",
        "discs[0].mass",
        "discs[0].unbalance.angle_deg",
        "bearings[2].station",
        "couplings[0].driven",
        "probes[0].angle_deg",
    ],
)
def test_missing_field_is_named(field: str) -> None:
    document = two_sections()
    drop(field)(document)
    assert problems(document) == {field: "Field required"}


@pytest.mark.parametrize(
    "field",
    ["schema_version", "rotation", "couplings", "noise", "element_length", "discs[0].unbalance", "bearings[0].kxy"],
)
def test_field_with_a_default_may_be_missing(field: str) -> None:
    document = two_sections()
    drop(field)(document)
    assert parse_machine(document).schema_version == 1


@pytest.mark.parametrize("inner", [0.02, 0.03])
def test_wall_must_have_a_thickness(inner: float) -> None:
    document = two_sections()
    document["shafts"][1]["sections"][0]["inner_diameter"] = inner
    found = problems(document)
    assert list(found) == ["shafts[1].sections[0]"]
    assert f"inner_diameter {inner} must be smaller than outer_diameter 0.02" in found["shafts[1].sections[0]"]


@pytest.mark.parametrize("maximum", [90, 50])
def test_speed_range_must_be_ordered(maximum: float) -> None:
    document = two_sections()
    document["speed_range"]["maximum_rpm"] = maximum
    assert "must be below maximum_rpm" in problems(document)["speed_range"]


@pytest.mark.parametrize("kind", ["shafts", "discs", "bearings", "probes"])
def test_both_of_two_equal_ids_are_named(kind: str) -> None:
    document = two_sections()
    document[kind][1]["id"] = document[kind][0]["id"]
    if kind == "shafts":  # whatever stands on S2 is then nowhere; only the ids are of interest
        document["shafts"].append({**document["shafts"][0], "id": "S2"})
    found = problems(document)
    assert list(found) == [f"{kind}[0].id", f"{kind}[1].id"]
    assert f"stands more than once among the {kind}" in found[f"{kind}[0].id"]


def test_same_id_among_different_kinds_is_allowed() -> None:
    document = two_sections()
    document["discs"][0]["id"] = document["bearings"][0]["id"] = document["probes"][0]["id"] = "S1"
    assert parse_machine(document).discs[0].id == "S1"


def test_shaft_has_at_most_one_coupling_at_each_end() -> None:
    document = two_sections()
    document["couplings"].append({"id": "C2", "driver": "S1", "driven": "S2"})
    found = problems(document)
    assert set(found) == {f"couplings[{i}].{end}" for i in (0, 1) for end in ("driver", "driven")}
    assert "is the driver of more than one coupling" in found["couplings[1].driver"]


def test_part_at_the_very_end_of_a_shaft_is_on_it() -> None:
    document = two_sections()
    document["shafts"][0]["sections"] = [{"length": 0.125, "outer_diameter": 0.02, "material": "steel"}] * 10
    document["discs"][1]["station"] = 1.25 + 5e-10
    assert parse_machine(document).shaft("S1").length == 1.25


def test_all_wrong_fields_are_reported_at_once() -> None:
    document = two_sections()
    for field, value in (("discs[0].mass", -1), ("bearings[1].kxx", NAN), ("id", "a b"), ("colour", 1), ("noise.relative", 2)):
        put(document, field, value)
    del document["probes"][3]["angle_deg"]
    expected = {"discs[0].mass", "bearings[1].kxx", "id", "colour", "noise.relative", "probes[3].angle_deg"}
    assert set(problems(document)) == expected


def test_all_wrong_references_are_reported_at_once() -> None:
    document = two_sections()
    for field, value in (
        ("shafts[1].sections[0].material", "mithril"),
        ("discs[0].station", 7.0),
        ("bearings[1].id", "B1"),
        ("couplings[0].driven", "S7"),
        ("probes[2].shaft", "S8"),
    ):
        put(document, field, value)
    assert set(problems(document)) == {
        "shafts[1].sections[0].material",
        "discs[0].station",
        "bearings[0].id",
        "bearings[1].id",
        "couplings[0].driven",
        "probes[2].shaft",
    }


def test_wrong_fields_and_wrong_references_are_reported_in_one_round() -> None:
    document = chapter_3_document()
    document["bearings"][0]["kxx"] = -1.0
    document["bearings"][1]["shaft"] = "nowhere"
    document["shafts"][0]["sections"][0]["material"] = "stel"
    document["discs"][0]["station"] = 99.0
    document["couplings"][0]["driven"] = "elsewhere"
    document["probes"][1]["id"] = document["probes"][0]["id"]
    document["speed_range"]["maximum_rpm"] = "fast"
    found = problems(document)
    assert set(found) == {
        "bearings[0].kxx",
        "bearings[1].shaft",
        "shafts[0].sections[0].material",
        "discs[0].station",
        "couplings[0].driven",
        "probes[0].id",
        "probes[1].id",
        "speed_range.maximum_rpm",
    }
    assert "is not one of the shafts" in found["bearings[1].shaft"]


def test_a_part_that_is_wrong_itself_may_be_referred_to() -> None:
    document = chapter_3_document()
    document["shafts"][0]["sections"][0]["outer_diameter"] = -1.0
    assert list(problems(document)) == ["shafts[0].sections[0].outer_diameter"]
    assert list(problems({**chapter_3_document(), "shafts": "none", "nmae": 1})) == ["shafts", "nmae"]


def test_message_keeps_braces_of_the_document() -> None:
    document = two_sections()
    document["materials"]["{x}"] = document["materials"]["steel"]
    assert "letters, digits" in next(iter(problems(document).values()))


@pytest.mark.parametrize("document", [None, 3, "text", [], [chapter_3_document()]])
def test_what_is_no_mapping_is_the_document_s_fault(document: Any) -> None:
    assert list(problems(document)) == ["document"]


def test_error_reads_one_line_per_problem() -> None:
    error = DocumentError([("discs[0].mass", "too small"), ("id", "missing")])
    assert str(error) == "discs[0].mass: too small\nid: missing"
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    ("location", "path"),
    [((), "document"), (("id",), "id"), (("bearings", 1, "shaft"), "bearings[1].shaft"), ((0, "x"), "[0].x")],
)
def test_field_path(location: tuple[int | str, ...], path: str) -> None:
    assert field_path(location) == path


def full() -> Document:
    """A document in which every optional field stands."""
    document = two_sections()
    document["rotation"] = "negative"
    document["shafts"][0]["sections"][0]["inner_diameter"] = 0.005
    document["probes"][0]["sensitivity"] = 7874.0
    return document


@pytest.mark.parametrize(
    "document", [chapter_3_document(), one_disc_document(), full()], ids=["chapter 3", "one disc", "full"]
)
def test_round_trip(document: Document) -> None:
    machine = parse_machine(document)
    dumped = machine.model_dump(mode="json")
    assert parse_machine(dumped) == machine
    assert parse_machine(json.loads(json.dumps(dumped))) == machine
    assert parse_machine(machine.model_dump(mode="json", exclude_none=True)) == machine


@few_examples
@given(
    st.floats(1e-3, 10.0),
    st.floats(1e-3, 1.0),
    st.floats(0.0, 0.99),
    st.floats(-1e9, 1e9),
    st.floats(-1e3, 1e3),
    st.booleans(),
)
def test_round_trip_is_exact_for_any_number(
    length: float, outer: float, ratio: float, cross: float, angle: float, known: bool
) -> None:
    document = one_disc_document(length=length, kxy=cross)
    document["shafts"][0]["sections"][0].update(outer_diameter=outer, inner_diameter=outer * ratio)
    document["probes"][0]["angle_deg"] = angle
    if not known:
        del document["discs"][0]["unbalance"], document["bearings"][0]["kxx"]
    machine = parse_machine(document)
    again = parse_machine(json.loads(json.dumps(machine.model_dump(mode="json"))))
    assert again == machine
    assert again.shafts[0].sections[0].inner_diameter == outer * ratio
    assert (again.bearings[0].kxx is None) != known


def test_machine_answers_for_its_parts() -> None:
    machine = chapter_3()
    assert machine.channels == ("B1X", "B1Y", "B2X", "B2Y", "B3X", "B3Y", "B4X", "B4Y")
    assert machine.shaft("S2") is machine.shafts[1]
    assert machine.shaft("S2").length == 1.25
    assert machine.direction == 1
    assert parse_machine(full()).direction == -1
    with pytest.raises(KeyError, match="S3"):
        machine.shaft("S3")


def test_machine_cannot_be_changed() -> None:
    machine = chapter_3()
    changed = (
        "stays as it was read; change what the machine's model_dump\\(\\) returns, and read that with read_machine\\(…\\)$"
    )
    with pytest.raises(ValueError, match=f"^name: Machine {changed}"):
        machine.name = "other"  # type: ignore[misc]
    with pytest.raises(AttributeError, match=f"^station: Bearing {changed}"):
        del machine.bearings[0].station
    assert parse_machine(machine.model_dump() | {"name": "other"}).name == "other"


def test_schema_of_the_document_can_be_written_down() -> None:
    schema = Machine.model_json_schema()
    assert schema["additionalProperties"] is False
    assert set(schema["required"]) == {
        "id", "plant", "name", "speed_range", "materials", "shafts", "discs", "bearings", "probes",
    }  # fmt: skip


def test_conditions_may_come_and_go_but_not_change_their_unit() -> None:
    def with_conditions(*units: str) -> Machine:
        conditions = [{"name": f"c{i}", "unit": unit} for i, unit in enumerate(units)]
        return parse_machine(chapter_3_document() | {"conditions": conditions})

    one = with_conditions("degC", "%")
    assert one.condition_names == ("c0", "c1")
    for other in (chapter_3(), with_conditions("degC"), with_conditions("degC", "%", "bar")):
        assert one.describes_the_same_as(other)
        assert other.describes_the_same_as(one)
    assert not one.describes_the_same_as(with_conditions("degF", "%"))
