"""Runs and where their collection stands, over a real database."""

from typing import Any

import pytest
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import RunRow
from tests.plant import (
    START,
    assert_same_samples,
    machine,
    samples,
)


def open_run(session: Session, *, time_first: int = START, kind: str = "run-down", revision: int = 1) -> RunRow:
    return runs.open_run(session, "pump-7", revision=revision, kind=kind, direction=1, time_first=time_first)


def closed_run(session: Session, held: Samples, *, state: str = runs.CLOSED) -> RunRow:
    row = open_run(session, time_first=int(held.time[0]))
    runs.close(row, samples=held, state=state, reason="the speed turned back")
    session.flush()
    return row


def test_an_open_run_is_current_until_it_is_closed(plant: Database) -> None:
    with plant.transaction() as session:
        run_id = open_run(session).id
    with plant.transaction() as session:
        row = runs.open_run_of(session, "pump-7")
        assert row is not None
        assert row.id == run_id
        assert runs.samples(session, run_id) is None
        runs.close(row, samples=samples(5), state=runs.CLOSED, reason="the speed turned back")
    with plant.reading() as session:
        assert runs.open_run_of(session, "pump-7") is None
        row = runs.get(session, run_id)
        assert (row.state, row.reason, row.count) == (runs.CLOSED, "the speed turned back", 5)
        assert row.time_last == int(samples(5).time[-1])
        assert row.speed_minimum == samples(5).speed.min()
        assert row.speed_maximum == samples(5).speed.max()
        held = runs.samples(session, run_id)
        assert held is not None
        assert_same_samples(held, samples(5))


def test_no_two_runs_begin_at_once(plant: Database) -> None:
    with plant.transaction() as session:
        first = open_run(session)
        second = open_run(session, kind="run-up")
        assert second.time_first == first.time_first + 1


def test_unknown_runs_are_said(plant: Database) -> None:
    with plant.reading() as session:
        for look in (runs.get, runs.samples):
            with pytest.raises(runs.RunUnknown):
                look(session, 77)


def test_runs_of_a_machine_in_a_time_range_newest_first(plant: Database) -> None:
    with plant.transaction() as session:
        for start in (20, 0, 10):
            closed_run(session, samples(2, start=START + start))
    with plant.reading() as session:

        def found(first: int | None = None, last: int | None = None, limit: int | None = None) -> list[int]:
            rows = runs.of_machine(session, "pump-7", first=first, last=last, limit=limit)
            return [row.time_first - START for row in rows]

        assert found() == [20, 10, 0]
        assert found(first=START + 10) == [20, 10]
        assert found(last=START + 10) == [10, 0]
        assert found(first=START + 1, last=START + 19) == [10]
        assert found(limit=1) == [20]
        assert runs.of_machine(session, "other") == []


def test_newest_closed_leaves_out_open_discarded_and_other_revisions(plant: Database) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
        closed = [closed_run(session, samples(2, start=START + start)).id for start in (0, 10, 20)]
        closed_run(session, samples(2, start=START + 30), state=runs.DISCARDED)
        open_run(session, time_first=START + 40)
        later = open_run(session, time_first=START + 50, revision=2)
        runs.close(later, samples=samples(2, start=START + 50), state=runs.CLOSED, reason="over")
    with plant.reading() as session:
        assert [row.id for row in runs.newest_closed(session, "pump-7", revision=1, limit=2)] == closed[:0:-1]


def test_collector_state_is_kept_and_replaced(plant: Database) -> None:
    state: dict[str, Any] = {"sweep": {"low_speed": 1.25, "last_time": None}, "seen": START}
    with plant.transaction() as session:
        assert runs.collector_state(session, "pump-7") is None
        runs.save_collector_state(session, "pump-7", {"seen": 0})
    with plant.transaction() as session:
        runs.save_collector_state(session, "pump-7", state)
    with plant.reading() as session:
        assert runs.collector_state(session, "pump-7") == state
