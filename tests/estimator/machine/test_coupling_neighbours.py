"""Tests where a misalignment shows: which bearings are beside a coupling."""

from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.document import Machine, parse_machine
from tests.estimator.trains import chapter_3, chapter_3_document


def neighbours(machine: Machine) -> tuple[str, ...]:
    return neighbouring_bearings(machine, machine.couplings[0])


def with_bearings(*places: tuple[str, str, float]) -> Machine:
    document = chapter_3_document()
    document["bearings"] = [{"id": name, "shaft": shaft, "station": station} for name, shaft, station in places]
    return parse_machine(document)


def test_the_bearings_beside_a_coupling_are_the_last_before_and_the_first_behind_it() -> None:
    assert neighbours(chapter_3()) == ("B2", "B3")


def test_the_order_in_the_document_does_not_matter() -> None:
    machine = with_bearings(("d", "S2", 1.25), ("b", "S1", 1.0), ("c", "S2", 0.25), ("a", "S1", 0.0))
    assert neighbours(machine) == ("b", "c")


def test_a_shaft_may_have_no_bearing() -> None:
    assert neighbours(with_bearings(("a", "S1", 0.0), ("b", "S1", 1.0))) == ("b",)
    assert neighbours(with_bearings(("c", "S2", 0.5))) == ("c",)


def test_each_coupling_of_a_longer_train_has_its_own() -> None:
    document = chapter_3_document()
    document["shafts"].append({"id": "S3", "sections": document["shafts"][0]["sections"]})
    document["bearings"].append(document["bearings"][0] | {"id": "B5", "shaft": "S3", "station": 0.5})
    document["couplings"].append(document["couplings"][0] | {"id": "C2", "driver": "S2", "driven": "S3"})
    machine = parse_machine(document)
    assert [neighbouring_bearings(machine, one) for one in machine.couplings] == [("B2", "B3"), ("B4", "B5")]


def test_a_spacer_without_bearings_is_stepped_over() -> None:
    document = chapter_3_document()
    document["shafts"].insert(1, {"id": "spacer", "sections": document["shafts"][0]["sections"]})
    first = document["couplings"][0]
    document["couplings"] = [first | {"driven": "spacer"}, first | {"id": "C2", "driver": "spacer", "driven": "S2"}]
    machine = parse_machine(document)
    assert [neighbouring_bearings(machine, one) for one in machine.couplings] == [("B2", "B3"), ("B2", "B3")]
