"""Reads what has changed for clients: what cannot be told of one machine holds up no other."""

import logging
from typing import Any

import pytest

from service.alerts import transitions
from service.alerts.transitions import Person
from service.opcua.plant_reader import PlantReader
from service.opcua.unshown import Unshown
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


def commented(database: Database, alert: int, *, evidence: Any = None) -> None:
    """Let somebody comment an alert. evidence: what the event then holds of it."""
    with database.transaction() as session:
        transitions.comment(session, alerts.get(session, alert), Person("anna", "looked at"))
        if evidence is not None:
            alerts.last_event(session, alert).evidence = evidence


def changed_condition(database: Database, alert: int, condition: str) -> str:
    """Write the condition of an alert; the one that it had."""
    with database.transaction() as session:
        row = alerts.get(session, alert)
        before, row.condition = row.condition, condition
        return before


def test_an_event_that_cannot_be_read_is_logged_once_and_named_and_the_others_are_reported(
    database: Database, ids: tuple[Ids, Ids], caplog: pytest.LogCaptureFixture
) -> None:
    unshown = Unshown()
    reader = PlantReader(database, unshown=unshown)
    assert {one.machine for one in reader.open_alerts()} == {KEY.machine, HIDDEN}
    assert {one.id for one in reader.read_changes().machines} == {KEY.machine, HIDDEN}
    assert unshown.trouble is None
    for one in ids:
        commented(database, one.alert_id)
    condition = changed_condition(database, ids[1].alert_id, "of another release")
    with caplog.at_level(logging.ERROR):
        told = [one.machine for _ in range(3) for one in reader.read_changes().alerts]
    assert told == [KEY.machine]
    assert caplog.text.count(f"of alert {ids[1].alert_id} is not told over OPC UA") == 1
    assert f"alert {ids[1].alert_id}:" in str(unshown.trouble)
    changed_condition(database, ids[1].alert_id, condition)
    commented(database, ids[1].alert_id)
    assert [one.machine for one in reader.read_changes().alerts] == [HIDDEN], "what comes then is told"


@pytest.mark.parametrize("evidence", [{"measured_at": "yesterday"}, {"measured_at": 5}, ["of another release"], "none"])
def test_an_alert_whose_evidence_no_text_takes_is_reported_as_it_stands(
    database: Database, ids: tuple[Ids, Ids], evidence: object
) -> None:
    """Both when it happens and when a server starts."""
    reader = PlantReader(database)
    before = {one.id: one for one in reader.open_alerts()}[ids[1].alert_id]
    commented(database, ids[1].alert_id, evidence=evidence)
    starting = PlantReader(database).open_alerts()
    for found in ({one.id: one for one in many} for many in (reader.read_changes().alerts, starting)):
        told = found[ids[1].alert_id]
        assert (told.status, told.is_open, told.comment) == (before.status, True, "looked at")
        assert told.message.endswith(": its text cannot be made")
        assert not told.has_text
    assert [one.has_text for one in starting if one.machine == KEY.machine] == [True]


@pytest.mark.usefixtures("ids")
def test_a_state_that_cannot_be_read_leaves_those_of_the_others(database: Database) -> None:
    with database.transaction() as session:
        session.add(CollectorRow(machine_id=KEY.machine, state={"of": "another release"}))
        session.add(CollectorRow(machine_id=HIDDEN, state=CollectionState(1, seen=5).stored()))
    assert {name: one.seen for name, one in PlantReader(database).read_changes().standings.items()} == {HIDDEN: 5}
