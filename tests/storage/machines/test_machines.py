"""Machines and the revisions of their documents over a real database."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import alembic.command
import alembic.config
import pytest
from sqlalchemy import event, select

from estimator.machine.document import Machine
from estimator.machine.rules import Condition
from service.monitoring import baseline_changes
from service.security import authentication
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.machines import RevisionRow
from tests.api_in_process import Api
from tests.plant import document, machine
from tests.storage.migration import migrate


def test_a_created_machine_is_revision_1(plant: Database) -> None:
    with plant.reading() as session:
        row = machines.get(session, "pump-7")
        assert (row.plant, row.revision) == ("plant-1", 1)
        assert machines.document(session, "pump-7") == machine()
        assert [one.revision for one in machines.revisions(session, "pump-7")] == [1]


def test_a_machine_is_created_once(plant: Database) -> None:
    with plant.transaction() as session, pytest.raises(machines.MachineExists, match="pump-7"):
        machines.create(session, machine(name="Another"))
    with plant.reading() as session:
        assert machines.document(session, "pump-7").name == "Pump 7"


def test_a_revision_leaves_the_earlier_ones_as_they_were(plant: Database) -> None:
    with plant.transaction() as session:
        assert machines.revise(session, machine(name="Pump 7, new bearings")).revision == 2
    with plant.reading() as session:
        assert machines.document(session, "pump-7").name == "Pump 7, new bearings"
        assert machines.document(session, "pump-7", 1) == machine()
        assert [one.revision for one in machines.revisions(session, "pump-7")] == [1, 2]


def test_an_equal_document_is_no_new_revision(plant: Database) -> None:
    with plant.transaction() as session:
        assert machines.revise(session, machine()).revision == 1


def test_a_document_may_go_back_to_what_it_was(plant: Database) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(name="Other"))
        assert machines.revise(session, machine()).revision == 3


def test_a_revision_stays_in_its_plant(plant: Database) -> None:
    with plant.transaction() as session, pytest.raises(machines.PlantChanged, match="'plant-1', not 'plant-2'"):
        machines.revise(session, machine(plant="plant-2"))


def test_unknown_machines_and_revisions_are_said(plant: Database) -> None:
    with plant.transaction() as session:
        for look in (
            lambda: machines.get(session, "nobody"),
            lambda: machines.revise(session, machine(id="nobody")),
            lambda: machines.document(session, "nobody"),
            lambda: machines.document(session, "nobody", 1),
        ):
            with pytest.raises(machines.MachineUnknown, match="nobody"):
                look()
        with pytest.raises(machines.RevisionUnknown, match="2 of machine 'pump-7'"):
            machines.document(session, "pump-7", 2)


def test_machines_come_by_id(plant: Database) -> None:
    with plant.transaction() as session:
        for name in ("zeta", "alpha"):
            machines.create(session, machine(id=name))
    with plant.reading() as session:
        assert [row.id for row in machines.list_all(session)] == ["alpha", "pump-7", "zeta"]


def with_conditions(*names_and_units: str) -> tuple[Condition, ...]:
    return tuple(Condition(name=name, unit=unit) for name, unit in (one.split(":") for one in names_and_units))


LOAD, OIL = "load:%", "oil:degC"
HISTORY: Sequence[dict[str, Any]] = [
    {"name": "a"},
    {"name": "b"},
    {"discs": document()["discs"][:1]},
    {"discs": document()["discs"][:1], "name": "c"},
    {"name": "d", "conditions": with_conditions(LOAD)},
    {"name": "e", "conditions": with_conditions(LOAD)},
    {"name": "f", "conditions": with_conditions(LOAD, OIL)},
    {"name": "g", "conditions": with_conditions(OIL, LOAD)},
    {"name": "h", "conditions": with_conditions(LOAD)},
    {"name": "i"},
    {"name": "j", "conditions": with_conditions("load:kW")},
    {"name": "k"},
]
"""Changes that a document may go through: another name, another train, operating conditions that come, go, change order and
unit."""


def revised(database: Database) -> list[Machine]:
    """The documents of a machine that went through it, the first one of all included."""
    made = [machine(), *(machine().model_copy(update=one) for one in HISTORY)]
    made[3:5] = [machine(**one) for one in HISTORY[2:4]]
    with database.transaction() as session:
        for one in made[1:]:
            machines.revise(session, one)
    return made


def around(made: list[Machine], number: int) -> list[int]:
    """Revisions that can be compared with one, each held against it."""
    found = [number]
    for step in (-1, 1):
        other = number + step
        while 0 < other <= len(made) and made[other - 1].describes_the_same_as(made[number - 1]):
            found.append(other)
            other += step
    return sorted(found)


def require_right(database: Database, made: list[Machine]) -> None:
    with database.reading() as session:
        for number in range(1, len(made) + 1):
            expected = around(made, number)
            assert machines.comparable_revisions(session, "pump-7", number) == expected
            names = made[number - 1].condition_names
            alike = [one for one in expected if made[one - 1].condition_names == names]
            assert machines.revisions_with_same_channels(session, "pump-7", number) == alike


def test_revisions_that_can_be_compared_are_those_around_one_that_describe_the_same(plant: Database) -> None:
    made = revised(plant)
    require_right(plant, made)
    assert len({tuple(around(made, number)) for number in range(1, len(made) + 1)}) > 4


def test_so_are_those_of_an_older_release(plant: Database) -> None:
    made = revised(plant)
    query = select(RevisionRow.revision, RevisionRow.same_since, RevisionRow.alike_since).order_by(RevisionRow.revision)
    with plant.reading() as session:
        before = session.execute(query).all()
    migrate(plant, alembic.command.downgrade, "0021")
    migrate(plant, alembic.command.upgrade, "head")
    with plant.reading() as session:
        assert session.execute(query).all() == before
    require_right(plant, made)


class Read:
    """Numbers of documents read, and statements made, on a database."""

    documents = statements = 0

    def document(self, *_: Any) -> None:
        self.documents += 1

    def statement(self, *_: Any) -> None:
        self.statements += 1

    def of(self, work: Callable[[], object]) -> tuple[int, int]:
        """Documents and statements of some work."""
        before = self.documents, self.statements
        work()
        return self.documents - before[0], self.statements - before[1]


@pytest.fixture
def read(plant: Database) -> Iterator[Read]:
    """Counts while the test runs."""
    found = Read()
    event.listen(RevisionRow, "load", found.document)
    event.listen(plant.engine, "before_cursor_execute", found.statement)
    yield found
    event.remove(RevisionRow, "load", found.document)


def test_neither_a_revision_nor_a_read_beside_it_costs_more_with_their_number(
    plant: Database, read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Who asks is looked up every three seconds: one statement more where these pass in between.
    monkeypatch.setattr(authentication, "IDENTITY_CACHE_S", math.inf)
    api = Api(plant)

    def revise(number: int) -> Callable[[], object]:
        def work() -> None:
            with plant.transaction() as session:
                baseline_changes.revise(session, machine(name=f"Pump {number}"))

        return work

    def costs(number: int) -> list[tuple[int, int]]:
        answer = (lambda: api.value("/machines/pump-7/samples", limit=10), lambda: api.value("/machines/pump-7/state"))
        return [read.of(work) for work in (revise(number), *answer)]

    costs(2)
    few = costs(3)
    for number in range(4, 60):
        revise(number)()
    assert costs(60) == few
    assert max(documents for documents, _ in few) <= 4
    with plant.reading() as session:
        assert machines.comparable_revisions(session, "pump-7", 60) == list(range(1, 61))


def test_a_document_is_parsed_once_and_another_revision_is_another_one(database: Database) -> None:
    with database.transaction() as session:
        machines.create(session, machine())
        first = machines.document(session, machine().id)
        assert machines.document(session, machine().id) is first
        machines.revise(session, machine(name="New"))
        assert machines.document(session, machine().id).name == "New"
        assert machines.document(session, machine().id, 1) == first == machine()
