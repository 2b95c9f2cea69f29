"""Machines and the revisions of their documents over a real database."""

import pytest

from storage import machines
from storage.database import Database
from tests.plant import (
    machine,
)


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
        assert [row.id for row in machines.every(session)] == ["alpha", "pump-7", "zeta"]
