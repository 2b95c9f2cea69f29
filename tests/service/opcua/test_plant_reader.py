"""Reads what has changed for clients: what cannot be told of one machine holds up no other."""

import logging

import pytest

from service.alerts import transitions
from service.alerts.transitions import Person
from service.opcua.plant_reader import PlantReader
from service.runs.collection_state import CollectionState
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.measurements import CollectorRow
from tests.plant import KEY
from tests.service.security.two_plants import HIDDEN, Ids, fill


@pytest.fixture
def ids(database: Database) -> tuple[Ids, Ids]:
    """Objects of two plants."""
    return fill(database)


def commented(database: Database, alert: int, *, damaged: bool = False) -> None:
    """Let somebody comment an alert. damaged: the event then holds what no release can tell."""
    with database.transaction() as session:
        transitions.comment(session, alerts.get(session, alert), Person("anna", "looked at"))
        if damaged:
            alerts.last_event(session, alert).evidence = {"measured_at": "yesterday"}


def test_an_event_that_cannot_be_told_is_logged_once_and_the_others_are_told(
    database: Database, ids: tuple[Ids, Ids], caplog: pytest.LogCaptureFixture
) -> None:
    reader = PlantReader(database)
    assert {one.machine for one in reader.open_alerts()} == {KEY.machine, HIDDEN}
    assert {one.id for one in reader.read_changes().machines} == {KEY.machine, HIDDEN}
    for one, damaged in ((ids[0], False), (ids[1], True)):
        commented(database, one.alert_id, damaged=damaged)
    with caplog.at_level(logging.ERROR):
        told = [one.machine for _ in range(3) for one in reader.read_changes().alerts]
    assert told == [KEY.machine]
    assert caplog.text.count(f"of alert {ids[1].alert_id} is not told over OPC UA") == 1
    commented(database, ids[1].alert_id)
    assert [one.machine for one in reader.read_changes().alerts] == [HIDDEN], "what comes then is told"


def test_with_a_damaged_last_event_a_server_starts_with_the_other_alerts(database: Database, ids: tuple[Ids, Ids]) -> None:
    commented(database, ids[1].alert_id, damaged=True)
    assert [one.machine for one in PlantReader(database).open_alerts()] == [KEY.machine]


@pytest.mark.usefixtures("ids")
def test_a_state_that_cannot_be_read_leaves_those_of_the_others(database: Database) -> None:
    with database.transaction() as session:
        session.add(CollectorRow(machine_id=KEY.machine, state={"of": "another release"}))
        session.add(CollectorRow(machine_id=HIDDEN, state=CollectionState(1, seen=5).stored()))
    assert {name: one.seen for name, one in PlantReader(database).read_changes().standings.items()} == {HIDDEN: 5}
