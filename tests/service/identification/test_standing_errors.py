"""Errors of measuring chains that a job leaves open: those that the diagnosis of the run before has named, and these only."""

from collections.abc import Sequence

import pytest
from sqlalchemy.orm import Session

from service.identification.standing_errors import identify_beside, store_open_errors
from storage.database.engine import Database
from storage.findings import diagnoses, jobs
from storage.machines import baselines
from storage.measurements import runs
from storage.tables.findings import IdentificationRow, JobRow
from storage.tables.measurements import RunRow
from tests.plant import KEY, SECOND, START, identification, store_identification

WEEK = 7 * 86_400 * SECOND
GAINS = ("probe.B1X.gain", "probe.B1Y.gain")


def closed(session: Session, week: int, *, kind: str = "run-down") -> RunRow:
    run = runs.open_run(session, KEY.machine, revision=1, kind=kind, direction=1, time_first=START + week * WEEK)
    run.state, run.time_last = runs.CLOSED, START + week * WEEK + SECOND
    session.flush()
    return run


def identified(session: Session, run: RunRow, *, named: Sequence[str] = ()) -> IdentificationRow:
    """File an identification of a run on oil films, and a diagnosis that names the gains of some probes."""
    row = store_identification(session, identification(), run_id=run.id, measured_at=run.time_last or 0, run_kind=run.kind)
    row.load_balance = 1
    causes = [{"kind": "sensor", "element": one.removesuffix(".gain")} for one in named]
    diagnoses.add(session, row, baseline=[row.id], runs=1, causes=causes)
    return row


def left_open(session: Session, run: RunRow) -> list[str]:
    """Return what the job of a run leaves open."""
    job = jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[run.id])
    assert job is not None
    store_open_errors(session, job)
    return list((job.options or {}).get("open_errors", []))


def newest_job(session: Session) -> JobRow:
    return session.query(JobRow).order_by(JobRow.id.desc()).first() or JobRow()


def test_a_run_leaves_open_what_the_run_before_it_has_named(plant: Database) -> None:
    with plant.transaction() as session:
        identified(session, closed(session, 0), named=GAINS[:1])
        assert left_open(session, closed(session, 1)) == [GAINS[0]]
        identified(session, closed(session, 2))
        assert left_open(session, closed(session, 3)) == []


@pytest.mark.parametrize("otherwise", ["kind", "slow roll", "later", "own", "no films"])
def test_it_leaves_nothing_open_that_another_sort_of_run_has_named(plant: Database, otherwise: str) -> None:
    with plant.transaction() as session:
        own = closed(session, 1)
        named = own if otherwise == "own" else closed(session, 2 if otherwise == "later" else 0)
        row = identified(session, named, named=GAINS[:1])
        if otherwise == "kind":
            row.run_kind = "run-up"
        elif otherwise == "slow roll":
            row.slow_roll_version = 3
        elif otherwise == "no films":
            row.load_balance = None
        session.flush()
        if otherwise == "own":
            job = jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[own.id], options={"again": 1})
            assert job is not None
            store_open_errors(session, job)
            assert "open_errors" not in (job.options or {})
        else:
            assert left_open(session, own) == []
        session.rollback()


def test_it_leaves_nothing_open_after_a_repair(plant: Database) -> None:
    with plant.transaction() as session:
        identified(session, closed(session, 0), named=GAINS[:1])
        baselines.begin(session, KEY.machine, since=START + WEEK, identification_ids=None, reason="probe repaired", by="me")
        assert left_open(session, closed(session, 2)) == []


def test_what_is_left_open_only_grows_and_is_asked_for_once(plant: Database) -> None:
    with plant.transaction() as session:
        row = identified(session, closed(session, 0), named=GAINS)
        row.options = {"open_errors": [GAINS[0]]}
        identify_beside(session, row, {GAINS[1]})
        again = newest_job(session)
        assert (again.options or {})["open_errors"] == list(GAINS)
        assert again.run_ids == row.run_ids
        row.options = {"open_errors": list(GAINS)}
        identify_beside(session, row, set(GAINS))  # such as of a probe of which nothing is known
        assert newest_job(session) is again


def test_a_run_that_is_identified_anew_is_asked_for_anew(plant: Database) -> None:
    with plant.transaction() as session:
        first = identified(session, run := closed(session, 0), named=GAINS[:1])
        identify_beside(session, first, {GAINS[0]})
        before = newest_job(session)
        first.id, first.options = first.id, {}
        other = IdentificationRow(id=first.id + 7, machine_id=KEY.machine, run_ids=[run.id], options={})
        identify_beside(session, other, {GAINS[0]})
        assert newest_job(session) is not before


def test_a_run_without_samples_is_not_identified_again(plant: Database) -> None:
    with plant.transaction() as session:
        row = identified(session, run := closed(session, 0), named=GAINS[:1])
        run.released_at = START
        before = newest_job(session)
        identify_beside(session, row, {GAINS[0]})
        assert newest_job(session) is before
