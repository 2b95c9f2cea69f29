"""Wrong machine documents are named in one line that says what would be right."""

import re
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

import rotorundown as rd
from estimator.machine.document import DocumentError, Machine
from rotorundown.machine_files import WrongMachine
from tests.rotorundown.wrong_input import PUMP, one_line


def test_a_contradiction_of_a_machine_is_one_line(pump: Machine) -> None:
    said = pump.model_dump()
    said["couplings"] = [{**one, "driven": "nobody"} for one in said["couplings"]]
    with pytest.raises(WrongMachine, match=r"couplings\[0\].driven: 'nobody' is not one of the shafts: motor, pump") as raised:
        rd.read_machine(said)
    one_line(raised)
    with pytest.raises(DocumentError, match=r"^couplings\[0\].driven: 'nobody' is not one of the shafts: motor") as directly:
        rd.Machine(**said)
    one_line(directly)


def test_a_machine_is_not_made_of_a_document_in_its_place(pump: Machine) -> None:
    made: Any = rd.Machine
    for given in ({}, pump.model_dump(), "pump.yaml"):
        with pytest.raises(DocumentError, match=r"takes fields by name; documents are read by read_machine") as raised:
            made(given)
        one_line(raised)


WRONG_FIELDS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "of the document": (
        lambda said: said.update(rotatoin="positive"),
        "rotatoin: there is no such field; did you mean 'rotation'",
    ),
    "of a part": (
        lambda said: said["shafts"][0]["sections"][0].update(lenght=1.0),
        "shafts[0].sections[0].lenght: there is no such field; did you mean 'length'?",
    ),
    "of a named part": (lambda said: said["materials"]["steel"].update(densty=1.0), "did you mean 'density'"),
    "that is no list": (lambda said: said.update(shafts=3), "shafts: should be a list"),
    "that has no names": (lambda said: said.update(materials=["steel"]), "materials: should be fields by name"),
    "like none": (lambda said: said["speed_range"].update(z=1), "there is no such field: there are maximum_rpm, minimum_rpm"),
}


@pytest.mark.parametrize("name", WRONG_FIELDS)
def test_an_unknown_field_gets_its_close_matches(pump: Machine, name: str) -> None:
    change, words = WRONG_FIELDS[name]
    said = pump.model_dump(mode="json", exclude_none=True)
    change(said)
    for make in (rd.read_machine, lambda document: rd.Machine(**document)):
        with pytest.raises(ValueError, match=re.escape(words)) as raised:
            make(said)
        one_line(raised)


def test_a_machine_is_printed_in_a_line(pump: Machine) -> None:
    assert str(pump) == repr(pump) == "motor-pump: 2 shafts, 4 discs, 4 bearings, 1 coupling, 8 probes; 300 to 3600 r/min"


CONTRADICTIONS: dict[str, tuple[Callable[[Machine], dict[str, Any]], str]] = {
    "no bearings": (lambda _: {"bearings": ()}, "bearings: should have at least 1 of them, not 0"),
    "an empty range": (
        lambda pump: {"speed_range": pump.speed_range.model_copy(update={"minimum_rpm": 4000.0})},
        "speed_range: minimum_rpm 4000.0 must be below maximum_rpm 3600.0",
    ),
    "a disc on no shaft": (
        lambda pump: {"discs": (pump.discs[0].model_copy(update={"shaft": "moter"}), *pump.discs[1:])},
        "discs[0].shaft: 'moter' is not one of the shafts",
    ),
    "a mass in words": (
        lambda pump: {"discs": (pump.discs[0].model_copy(update={"mass": "heavy"}), *pump.discs[1:])},
        "discs[0].mass: Input should be a valid number",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_copy_of_a_machine_that_contradicts_itself_is_refused(pump: Machine, run: rd.MachineRun, name: str) -> None:
    change, words = CONTRADICTIONS[name]
    wrong = pump.model_copy(update=change(pump))
    for use in (rd.read_machine, rd.simulate, rd.model, lambda machine: rd.identify(machine, run)):
        with pytest.raises(WrongMachine, match=f"^this is no machine: {re.escape(words)}") as raised:
            use(wrong)
        one_line(raised)


def test_a_decimal_comma_in_a_document_is_named(pump: Machine) -> None:
    said = pump.model_dump()
    said["discs"][0]["mass"] = "220,5"
    with pytest.raises(WrongMachine, match=r"discs\[0\].mass: '220,5' is no number: write it with a decimal point") as raised:
        rd.read_machine(said)
    one_line(raised)


def test_what_is_no_machine_is_one_line(tmp_path: Path) -> None:
    wrong: Any
    for wrong, words in (
        (PUMP.read_text(), "this is the text of a document: give the path of its file"),
        (StringIO(), "not an opened file (StringIO): give its path"),
    ):
        with pytest.raises(WrongMachine, match=re.escape(words)) as raised:
            rd.read_machine(wrong)
        one_line(raised)
    (tmp_path / "tabs.yaml").write_text("id: pump\n\tplant: plant-1\n")
    with pytest.raises(
        WrongMachine, match=r"tabs.yaml, line 2 is neither YAML nor JSON: .* indent with spaces, not with tabs"
    ):
        rd.read_machine(tmp_path / "tabs.yaml")
    for wrong in (None, [1]):
        with pytest.raises(WrongMachine, match="a document's path or its fields by name, not") as raised:
            rd.read_machine(wrong)
        one_line(raised)
    for text in ("", "- 1"):
        (tmp_path / "wrong.yaml").write_text(text)
        with pytest.raises(WrongMachine, match="should be fields by name, each with its value") as raised:
            rd.read_machine(tmp_path / "wrong.yaml")
        one_line(raised)
