"""Suppressions: which apply to an alert, and which have expired, whatever the clock does."""

import pytest
from sqlalchemy.orm import Session

from storage.alerts import suppressions
from storage.alerts.suppressions import SuppressionUnknown
from storage.clock import TOLERANCE, now
from storage.database.engine import Database
from storage.tables.alerting import SuppressionRow
from tests.plant import KEY


def add(session: Session, rule: str | None, element: str | None, *, until: int | None = None) -> SuppressionRow:
    return suppressions.add(
        session, KEY.machine, kind="shelved", rule=rule, element=element, until=until, by="anna", comment="known"
    )


def test_one_without_rule_or_element_applies_to_all_of_them(plant: Database) -> None:
    with plant.transaction() as session:
        all_alerts = add(session, None, None)
        of_rule = add(session, "misalignment", None)
        of_element = add(session, None, "coupling.C1")
        of_both = add(session, "misalignment", "coupling.C1")

        def applying(rule: str, element: str, machine_id: str = KEY.machine) -> list[SuppressionRow]:
            return list(suppressions.of_alert(session, machine_id, rule=rule, element=element))

        assert applying("misalignment", "coupling.C1") == [all_alerts, of_rule, of_element, of_both]
        assert applying("misalignment", "bearing.B1") == [all_alerts, of_rule]
        assert applying("unbalance", "coupling.C1") == [all_alerts, of_element]
        assert applying("misalignment", "coupling.C1", "another") == []


def test_one_that_has_ended_applies_no_more_and_stays_stored(plant: Database) -> None:
    with plant.transaction() as session:
        first, second = add(session, None, None), add(session, None, None)
        suppressions.end(first, by="berta")
        session.flush()
        assert list(suppressions.in_force(session, KEY.machine)) == [second]
        assert list(suppressions.of_alert(session, KEY.machine, rule="a", element="b")) == [second]
        ended = suppressions.get(session, first.id)
        assert ended.ended_by == "berta"
        assert ended.ended_at is not None


def test_those_in_force_come_a_page_at_a_time(plant: Database) -> None:
    with plant.transaction() as session:
        rows = [add(session, None, None) for _ in range(3)]
        assert list(suppressions.in_force(session, KEY.machine, limit=2)) == rows[:2]
        assert list(suppressions.in_force(session, KEY.machine, after=(rows[1].id,))) == rows[2:]


def test_the_first_to_expire_comes_first(plant: Database) -> None:
    with plant.transaction() as session:
        moment = now()
        later, sooner, never, ahead = (add(session, None, None, until=one) for one in (moment, moment - 9, None, moment + 9))
        assert list(suppressions.expired(session, moment, limit=9)) == [sooner, later]
        suppressions.end(sooner, by="anna")
        session.flush()
        assert list(suppressions.expired(session, moment, limit=9)) == [later]
        assert list(suppressions.expired(session, moment + 9, limit=9)) == [later, ahead]
        assert never.until is None


@pytest.mark.parametrize(("ahead", "expected"), [(TOLERANCE - 5, False), (TOLERANCE + 5, True)])
def test_one_that_begins_in_the_future_has_expired(plant: Database, ahead: int, expected: bool) -> None:
    """The clock was set back since: it would last longer than was meant."""
    with plant.transaction() as session:
        moment = now()
        row = add(session, None, None, until=moment + 10 * TOLERANCE)
        row.since = moment + ahead
        session.flush()
        assert list(suppressions.expired(session, moment, limit=9)) == [row] * expected


def test_an_unknown_one_is_named(plant: Database) -> None:
    with plant.reading() as session, pytest.raises(SuppressionUnknown) as unknown:
        suppressions.get(session, 7)
    assert unknown.value.detail == "no suppression 7"
