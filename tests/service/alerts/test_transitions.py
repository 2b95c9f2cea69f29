"""Stored alerts: one open per episode, every transition written down and queued once, restarts change nothing."""

import time
from typing import Any

import alembic.command
import pytest
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from benchmarks.faults.alert_life import check, live
from service.alerts import transitions
from service.alerts.lifecycle import Forbidden, Severity, Suppression
from service.alerts.transitions import AlertFinding, Person
from storage.alerts import alerts, deliveries, suppressions
from storage.database.engine import Database
from storage.tables.alerting import AlertEventRow, AlertRow, DeliveryRow
from storage.tables.findings import IdentificationRow
from tests.plant import SECOND, START, identification, store_identification
from tests.storage.migration import migrate

ANNA = Person("anna", "seen on the shaft")
MACHINE, RULE, ELEMENT = "pump-7", "misalignment", "coupling.C1"


@pytest.fixture
def found(plant: Database) -> IdentificationRow:
    with plant.transaction() as session:
        return store_identification(session, identification(), run_id=1, measured_at=START)


def finding(
    row: IdentificationRow, *, severity: Severity = Severity.ALERT, latching: bool = False, sigma: float = 4.0
) -> AlertFinding:
    return AlertFinding({"identification": row.id, "sigma": sigma}, row.id, row.measured_at, severity, latching)


def raised(session: Session, row: IdentificationRow, *, element: str = ELEMENT, **how: Any) -> AlertRow:
    return transitions.raise_alert(session, MACHINE, rule=RULE, element=element, finding=finding(row, **how))


def kinds(session: Session, row: AlertRow) -> list[str]:
    return [event.kind for event in alerts.history(session, row.id)]


def test_an_open_alert_is_brought_up_to_date_without_a_second_event(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        first = raised(session, found, sigma=5.0)
        again = raised(session, found, sigma=6.0)
        assert again.id == first.id
        assert (again.evidence["sigma"], again.message) == (6.0, "")
        assert kinds(session, first) == ["raised"]


def test_evidence_never_changes_without_the_time_of_change(plant: Database, found: IdentificationRow) -> None:
    """Caches and the stamp of a report rest on it: `tests/conftest.py` holds it in every test that stores an alert."""
    with plant.transaction() as session:
        first = raised(session, found, sigma=5.0)
        opened = first.updated_at
    with plant.transaction() as session:
        again = raised(session, found, sigma=6.0)
        events, changed = again.event_count, again.updated_at
    assert (events, changed > opened) == (1, True)
    with pytest.raises(AssertionError, match="evidence"), plant.transaction() as session:
        alerts.get(session, first.id).evidence = {"sigma": 7.0}


def test_an_alert_keeps_when_the_run_was_measured_that_raised_it(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        later = store_identification(session, identification(), run_id=2, measured_at=START + SECOND)
        first = raised(session, found)
        raised(session, later)
        assert (first.first_measured_at, first.measured_at) == (START, START + SECOND)
    # Older releases did not keep it: their alerts' first events tell.
    migrate(plant, alembic.command.downgrade, "0019")
    migrate(plant, alembic.command.upgrade, "head")
    with plant.reading() as session:
        assert alerts.get(session, first.id).first_measured_at == START


def test_a_closed_alert_stays_and_the_next_is_a_new_one(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        closed = raised(session, found)
        transitions.acknowledge(session, closed, ANNA)
        transitions.clear_alert(session, closed)
        assert closed.closed_at is not None
        again = raised(session, found)
        assert again.id != closed.id
        assert kinds(session, closed) == ["raised", "acknowledged", "cleared"]
        assert [row.id for row in alerts.find(session, machine_id=MACHINE, only_open=True, limit=9)] == [again.id]
        assert [row.id for row in alerts.find(session, machine_id=None, only_open=False, limit=9)] == [again.id, closed.id]


def test_events_say_who_when_and_why(plant: Database, found: IdentificationRow) -> None:
    before = time.time_ns()
    with plant.transaction() as session:
        row = raised(session, found)
        transitions.acknowledge(session, row, ANNA)
        transitions.comment(session, row, Person("ben", "coupling looks worn"))
        first, second, third = alerts.history(session, row.id)
        assert (first.by, first.state_before, first.state) == ("rundown", "normal", "unacknowledged")
        assert (second.by, second.comment, second.state) == ("anna", "seen on the shaft", "acknowledged")
        assert (third.kind, third.state_before, third.state) == ("commented", "acknowledged", "acknowledged")
        assert [event.number for event in (first, second, third)] == [1, 2, 3]
        assert before <= first.at <= second.at <= third.at <= time.time_ns()
        transitions.clear_alert(session, row)
        last = alerts.history(session, row.id)[-1]
        assert (row.opened_at, row.closed_at, row.updated_at) == (first.at, last.at, last.at)


def test_elements_have_alerts_of_their_own(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        assert raised(session, found).id != raised(session, found, element="coupling.C2").id


def test_the_database_itself_allows_one_open_alert(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        values = {name: getattr(row, name) for name in AlertRow.__table__.columns.keys() if name != "id"}  # noqa: SIM118
        session.add(AlertRow(**values | {"closed_at": START}))
        session.flush()
        session.add(AlertRow(**values))
        with pytest.raises(IntegrityError, match=r"(?i)unique"):
            session.flush()
        session.rollback()


def test_every_event_is_queued_for_every_active_subscription_in_the_same_transaction(
    plant: Database, found: IdentificationRow
) -> None:
    with plant.transaction() as session:
        for name in ("historian", "pager"):
            deliveries.subscribe(session, kind="webhook", name=name, target="http://127.0.0.1/", secret=None)
        gone = deliveries.subscribe(session, kind="webhook", name="gone", target="http://127.0.0.1/", secret=None)
        deliveries.disable(session, gone, "410")
    with plant.transaction() as session:
        raised(session, found)
        session.rollback()  # as after a kill
    with plant.reading() as session:
        assert session.scalars(select(AlertEventRow)).all() == []
        assert session.scalars(select(DeliveryRow)).all() == []
    with plant.transaction() as session:
        transitions.acknowledge(session, raised(session, found), ANNA)
    with plant.reading() as session:
        queued = [(row.subscription_id, row.event_id) for row in session.scalars(select(DeliveryRow))]
        events = [event.id for event in session.scalars(select(AlertEventRow))]
        assert sorted(queued) == sorted((subscription, event) for subscription in (1, 2) for event in events)
        assert len(events) == 2


def test_a_shelved_alert_calls_nobody_until_its_time_is_over(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        transitions.acknowledge(session, row, ANNA)
        transitions.shelve(session, row, ANNA, until=time.time_ns() + SECOND // 2)
        assert row.state == "shelved"
        assert transitions.release_expired(session) == 0
    time.sleep(0.6)
    with plant.transaction() as session:
        assert transitions.release_expired(session) == 1
        assert transitions.release_expired(session) == 0
        row = alerts.get(session, row.id)
        assert row.state == "unacknowledged"
        assert kinds(session, row) == ["raised", "acknowledged", "shelved", "shelved_ended"]


def test_a_shelving_until_the_cause_is_gone_ends_with_the_episode(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        transitions.shelve(session, row, ANNA, until=time.time_ns() + 60 * SECOND, until_cleared=True)
        transitions.clear_alert(session, row)
        assert row.closed_at is not None
        assert raised(session, found).state == "unacknowledged", "a new cause calls"


def test_one_latched_meanwhile_calls_when_its_shelving_ends_with_the_cause(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = transitions.raise_alert(session, MACHINE, rule="r", element="e", finding=finding(found, latching=True))
        transitions.shelve(session, row, ANNA, until=time.time_ns() + 60 * SECOND, until_cleared=True)
        transitions.clear_alert(session, row)
        assert row.state == "latched_unacknowledged"
        assert kinds(session, row) == ["raised", "shelved", "cleared", "shelved_ended"]


def test_what_is_gone_already_is_not_shelved_until_it_is_gone(plant: Database, found: IdentificationRow) -> None:
    """It would outlive its episode, and silence the next one."""
    with plant.transaction() as session:
        row = transitions.raise_alert(session, MACHINE, rule="r", element="e", finding=finding(found, latching=True))
        transitions.acknowledge(session, row, ANNA)
        transitions.clear_alert(session, row)
        with pytest.raises(Forbidden, match="cause is gone already"):
            transitions.shelve(session, row, ANNA, until=time.time_ns() + 60 * SECOND, until_cleared=True)
        transitions.reset(session, row, ANNA)
        assert transitions.raise_alert(session, MACHINE, rule="r", element="e", finding=finding(found)).suppressions == []


def test_many_suppressions_that_end_at_once_keep_nobody_from_storing(plant: Database) -> None:
    """Each transaction ends a few of them, however many have expired; and a machine has no more than so many."""
    with plant.transaction() as session:
        for number in range(transitions.MOST_SUPPRESSIONS):
            transitions.suppress(session, MACHINE, Suppression.OUT_OF_SERVICE, ANNA, rule=f"r{number}", until=1)
        with pytest.raises(Forbidden, match="end some first"):
            transitions.suppress(session, MACHINE, Suppression.OUT_OF_SERVICE, ANNA, rule="one more")
    rounds = 0
    while True:
        with plant.transaction() as session:
            if not (ended := transitions.release_expired(session)):
                break
            assert ended <= transitions.EXPIRED_AT_ONCE
            rounds += 1
    assert rounds == transitions.MOST_SUPPRESSIONS / transitions.EXPIRED_AT_ONCE


def test_a_shelving_outlives_the_episode(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        transitions.shelve(session, row, ANNA, until=time.time_ns() + 60 * SECOND)
        transitions.clear_alert(session, row)
        assert row.closed_at is not None
        again = raised(session, found)
        assert (again.id != row.id, again.state) == (True, "shelved")
        transitions.unshelve(session, again, ANNA)
        assert again.state == "unacknowledged"
        with pytest.raises(Forbidden, match="not shelved"):
            transitions.unshelve(session, again, ANNA)


@pytest.mark.parametrize("ahead", [-SECOND, 0, transitions.LONGEST_SHELVING_NS + 60 * SECOND])
def test_shelving_ends(plant: Database, found: IdentificationRow, ahead: int) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        with pytest.raises(transitions.MomentRefused, match="at most 30 days"):
            transitions.shelve(session, row, ANNA, until=time.time_ns() + ahead)
        assert row.state == "unacknowledged"


def test_a_machine_in_maintenance_has_no_calling_alerts(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        early = raised(session, found)
        begun = transitions.suppress(session, MACHINE, Suppression.SUPPRESSED_BY_DESIGN, Person("anna", "overhaul"))
        probe = transitions.suppress(session, MACHINE, Suppression.OUT_OF_SERVICE, ANNA, element="coupling.C2")
        late = raised(session, found, element="coupling.C2")
        assert (early.state, late.state) == ("suppressed_by_design", "out_of_service")
        transitions.release(session, begun, ANNA)
        assert (early.state, late.state) == ("unacknowledged", "out_of_service")
        transitions.release(session, probe, ANNA)
        assert late.state == "unacknowledged"
        with pytest.raises(Forbidden, match="ended already"):
            transitions.release(session, probe, ANNA)
        assert suppressions.in_force(session, MACHINE) == []


def test_two_shelvings_of_one_alert_end_with_the_last(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        kind = Suppression.OUT_OF_SERVICE
        whole = transitions.suppress(session, MACHINE, kind, ANNA)
        part = transitions.suppress(session, MACHINE, kind, ANNA, element=ELEMENT)
        transitions.release(session, whole, ANNA)
        assert row.state == "out_of_service"
        transitions.release(session, part, ANNA)
        assert row.state == "unacknowledged"


def test_nobody_acknowledges_what_is_closed(plant: Database, found: IdentificationRow) -> None:
    with plant.transaction() as session:
        row = raised(session, found)
        transitions.clear_alert(session, row)
        transitions.acknowledge(session, row, ANNA)
        assert row.closed_at is not None
        with pytest.raises(Forbidden, match="nothing to acknowledge"):
            transitions.acknowledge(session, row, ANNA)
        with pytest.raises(Forbidden, match="only an open alert"):
            transitions.shelve(session, row, ANNA, until=time.time_ns() + SECOND)


@pytest.mark.parametrize("seed", range(3))
def test_any_life_with_restarts_between_leaves_an_unbroken_history(plant: Database, seed: int) -> None:
    happened = live(plant, steps=300, seed=seed)
    assert min(happened["restarts"], happened["kills"], happened["refused"]) > 0
    kinds = check(plant)
    assert {"raised", "cleared", "acknowledged", "shelved", "commented"} <= set(kinds)
