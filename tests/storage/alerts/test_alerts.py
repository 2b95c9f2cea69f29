"""The repository of alerts and events: what is open, in which order lists come, what a page begins with."""

import pytest

from storage.alerts import alerts
from storage.alerts.alerts import AlertUnknown
from storage.database.engine import Database
from tests.plant import KEY, START
from tests.storage.alerts.stored_alerts import add, add_event


def test_an_alert_is_open_until_it_is_closed(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        first, second = add(session, found, "coupling.C1"), add(session, found, "bearing.B1")
        assert alerts.open_alert(session, KEY.machine, rule="misalignment", element="bearing.B1") is second
        assert alerts.open_alert(session, KEY.machine, rule="unbalance", element="bearing.B1") is None
        assert list(alerts.open_alerts(session, KEY.machine)) == [first, second]
        first.closed_at = START
        session.flush()
        assert list(alerts.open_alerts(session, KEY.machine)) == [second]
        assert list(alerts.open_alerts(session, "another")) == []


def test_a_new_alert_is_normal_and_has_no_event(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        row = add(session, found, "coupling.C1")
        assert (row.state, row.condition, row.event_count, row.first_measured_at) == ("normal", "normal", 0, START)
        assert alerts.history(session, row.id) == []
    with plant.reading() as session:
        assert alerts.get(session, row.id).evidence == {"runs": 3}


def test_events_are_numbered_for_each_alert_and_record_its_state(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        first, second = add(session, found, "coupling.C1"), add(session, found, "bearing.B1")
        for row, kind in ((first, "raised"), (second, "raised"), (first, "acknowledged")):
            row.state = kind
            add_event(session, row, kind)
        assert [(one.number, one.kind, one.state) for one in alerts.history(session, first.id)] == [
            (1, "raised", "raised"),
            (2, "acknowledged", "acknowledged"),
        ]
        assert [one.number for one in alerts.history(session, first.id, limit=1)] == [1]
        assert [one.number for one in alerts.history(session, first.id, after=(1,))] == [2]
        assert alerts.last_event(session, first.id).kind == "acknowledged"
        assert alerts.last_event(session, second.id).number == 1


def test_events_of_all_alerts_come_in_their_order(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        assert alerts.newest_event(session) == 0
        rows = [add(session, found, "coupling.C1"), add(session, found, "bearing.B1")]
        events = [add_event(session, row).id for row in (*rows, rows[0])]
        assert events == sorted(events)
        assert alerts.newest_event(session) == events[-1]
        assert [one.id for one in alerts.events_after(session, events[0], limit=9)] == events[1:]
        assert [one.id for one in alerts.events_after(session, 0, limit=2)] == events[:2]
        assert alerts.events_after(session, events[-1], limit=9) == []


def test_alerts_are_found_newest_first_a_page_at_a_time(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        times = (2, 1, 2, 3)
        rows = [add(session, found, f"bearing.B{n}", opened_at=START + at) for n, at in enumerate(times)]
        rows[3].closed_at = START + 4
        session.flush()
        newest_first = [rows[one].id for one in (3, 2, 0, 1)]

        def ids(*, only_open: bool = False, limit: int = 9, after: tuple[int, int] | None = None) -> list[int]:
            listed = alerts.find(session, machine_id=KEY.machine, only_open=only_open, limit=limit, after=after)
            return [row.id for row in listed]

        assert ids() == newest_first
        assert ids(only_open=True) == newest_first[1:]
        assert ids(limit=2) == newest_first[:2]
        assert ids(after=(START + 2, rows[2].id)) == newest_first[2:]  # opened at one time: by number
        assert alerts.find(session, machine_id="another", only_open=False, limit=9) == []
        assert len(alerts.find(session, machine_id=None, only_open=False, limit=9)) == len(rows)


def test_an_unknown_alert_is_named(plant: Database) -> None:
    with plant.reading() as session, pytest.raises(AlertUnknown) as unknown:
        alerts.get(session, 7)
    assert unknown.value.detail == "no alert 7"
