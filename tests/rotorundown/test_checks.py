"""Checks of machines and runs from Python: the same as the command prints."""

import pytest
from msgspec.structs import replace

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.machine_files import WrongMachine
from rotorundown.run_columns import WrongRun
from tests.paths import EXAMPLES


def test_a_machine_and_its_run_without_a_fault(pump: Machine, run: rd.MachineRun) -> None:
    checked = rd.check(pump, run)
    assert checked.warnings == ()
    assert str(checked) == f"{pump}\n{run}"
    assert checked.runs[0].quality.findings == ()
    assert rd.check(pump).runs == ()


def test_what_is_probably_a_mistake_is_named_and_once_more_beside_a_refused_fit(result: rd.Result) -> None:
    said = rd.read_machine(EXAMPLES / "motor-pump.yaml").model_dump()
    for probe in said["probes"]:
        probe["angle_deg"] = 2.35619 if probe["angle_deg"] > 90.0 else 0.785398
    radians = rd.read_machine(said)
    words = "probes[0].angle_deg: 2.35619 °: probes mostly stand at multiples of 15°; was 2.35619 rad meant, 135 °?"
    assert words in [str(one) for one in rd.check(radians).warnings]
    assert f"warning: {words}" in str(rd.check(radians))
    assert "rad meant" not in str(replace(result, machine=radians))
    refused = replace(result, machine=radians, identification=replace(result.identification, accepted=False))
    assert "document: probes[0].angle_deg: 2.35619 °: probes mostly stand" in " ".join(str(refused).split())


def test_what_is_no_run_or_no_machine_any_more_is_named(pump: Machine) -> None:
    with pytest.raises(WrongRun, match=r"one of runs is a str: read it first, with read_run"):
        rd.check(pump, ["run.csv"])  # type: ignore[list-item]
    with pytest.raises(WrongMachine, match="this is no machine"):
        rd.check(pump.model_copy(update={"bearings": ()}))


def test_a_run_that_turns_the_other_way_than_the_document_says_is_named(pump: Machine, run: rd.MachineRun) -> None:
    backwards = rd.read_machine(pump.model_dump() | {"rotation": "negative"})
    (checked,) = rd.check(backwards, run).runs
    words = "its direction is positive, the document's rotation negative: one of them is wrong, or it ran backwards"
    assert checked.findings[0] == words
    assert f"{run.name}: {words}" in str(checked)
    assert words not in rd.check(pump, run).runs[0].findings
