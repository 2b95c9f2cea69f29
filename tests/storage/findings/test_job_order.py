"""The order in which identification jobs are taken: by priority, in turns between plants, and nothing waits for ever."""

from typing import Any

import pytest
from sqlalchemy import event
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.findings import job_order, jobs
from storage.findings.job_order import ASKED, AUTOMATIC, RECOMPUTED
from storage.machines import machines
from storage.tables.findings import JobRow
from tests.plant import machine

PLANTS = ("a", "b", "c")
NUMBERS = iter(range(1, 10**9))


@pytest.fixture
def plants(database: Database) -> Database:
    """Three plants with a machine each."""
    with database.transaction() as session:
        for plant in PLANTS:
            machines.create(session, machine(id=f"pump-{plant}", plant=f"plant-{plant}"))
    return database


def ask(session: Session, plants: str, priority: int = AUTOMATIC) -> None:
    """A job of each of these plants, in this order."""
    for plant in plants:
        by = None if priority == AUTOMATIC else "anna"
        run = [next(NUMBERS)]
        jobs.enqueue(session, f"pump-{plant}", scope=jobs.RUN, run_ids=run, asked_by=by, priority=priority)


def taken(session: Session, limit: int, **rules: Any) -> str:
    """The plants whose jobs are taken."""
    return "".join(row.plant[-1] for row in jobs.claim_next(session, limit, **rules))


def finish(session: Session) -> None:
    for row in session.query(JobRow).filter_by(state=jobs.RUNNING):
        jobs.finish(row, state=jobs.DONE)


def test_a_plant_with_one_job_is_served_next_however_many_another_one_has_waiting(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, 500 * "a", ASKED)
        assert taken(session, 2) == "aa"
        ask(session, "b", ASKED)
        assert taken(session, 2) == "ba"
        ask(session, "cb", ASKED)
        assert taken(session, 3) == "cba"
        finish(session)
        ask(session, "b", ASKED)
        assert "b" in taken(session, 2)


def test_plants_take_turns_also_who_comes_again_and_again(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, 6 * "a" + 4 * "b" + "c")
        assert taken(session, 11) == "abcabababaa"
        finish(session)
        ask(session, 4 * "a")
        found = ""
        for _ in range(4):
            ask(session, "b")
            found += taken(session, 2)
        assert found == "abababab"


def test_what_is_asked_for_keeps_no_automatic_job_waiting(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, "aab", RECOMPUTED)
        ask(session, "aab", ASKED)
        ask(session, "cca")
        assert taken(session, 9) == "cac" + "aba" + "aba"


def test_what_has_done_harm_is_behind_everything_and_in_turns_too(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, "aab")
        for row in jobs.claim_next(session, 3):
            jobs.requeue(session, row, "it took too long")
        ask(session, "c", RECOMPUTED)
        assert taken(session, 4) == "caba"


def test_others_are_bounded_so_that_a_process_is_left_for_automatic_jobs(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, "aaa", ASKED)
        ask(session, "b")
        assert taken(session, 4, behind=1) == "ba"
        assert taken(session, 4, behind=0) == ""
        assert taken(session, 4, behind=1, overdue=True) == "a"


def test_what_has_waited_too_long_comes_first_once(plants: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    with plants.transaction() as session:
        ask(session, "c", RECOMPUTED)
        ask(session, "b", ASKED)
        ask(session, 9 * "a")
        assert taken(session, 1, overdue=True) == "a"
        monkeypatch.setattr(job_order, "OVERDUE_S", -1.0)
        assert taken(session, 1) == "a"
        assert taken(session, 2, behind=1, overdue=True) == "ca"
        assert taken(session, 3, behind=2, overdue=True) == "baa"


def test_an_interrupted_job_keeps_its_turn(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, "aaaa")
        assert taken(session, 2) == "aa"
        ask(session, "bb")
        jobs.requeue_running(session)
        assert taken(session, 4) == "aaba"


def test_taking_and_queueing_reads_few_rows_of_many_that_wait(plants: Database) -> None:
    with plants.transaction() as session:
        ask(session, 30 * "a", ASKED)
    if plants.kind != "sqlite":
        pytest.skip("the plan of a small table says nothing on PostgreSQL")
    asked: list[tuple[str, Any]] = []
    event.listen(plants.engine, "before_cursor_execute", lambda *args: asked.append((args[2], args[3])))
    with plants.transaction() as session:
        ask(session, "b", ASKED)
        assert taken(session, 2) == "ab"
        assert jobs.count_waiting_of(session, asked_by="anna", most=9) == 9
        assert jobs.count_requested_of_machine(session, "pump-a", most=9) == 9
    with plants.engine.connect() as connection:
        plans = [
            row[3]
            for statement, values in asked
            if statement.startswith("SELECT") and "identification_jobs" in statement
            for row in connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {statement}", values)
        ]
    assert len(plans) >= 8
    assert not [plan for plan in plans if plan.startswith("SCAN identification_jobs") or "TEMP B-TREE" in plan], plans
