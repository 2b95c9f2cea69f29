"""The repositories over a real database: what they store, what they give back, and what the database itself enforces."""

import math
from typing import Any

import numpy as np
import pytest
from sqlalchemy import func, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from storage import baselines, identifications, jobs, machines, quarantine, runs, trends
from storage import samples as sample_store
from storage.blocks import Samples
from storage.database import Database
from storage.quarantine import Rejection
from storage.samples import SourceKey
from storage.tables import QuarantineRow, RunRow
from tests.plant import (
    START,
    assert_same_samples,
    identification,
    machine,
    samples,
    store_identification,
)

MONITOR = SourceKey("pump-7", "monitor", 1)

# --- machines -------------------------------------------------------------------------------------------------------


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
            lambda: machines.document(session, "pump-7", 2),
        ):
            with pytest.raises(machines.MachineUnknown):
                look()


def test_machines_come_by_id(plant: Database) -> None:
    with plant.transaction() as session:
        for name in ("zeta", "alpha"):
            machines.create(session, machine(id=name))
    with plant.reading() as session:
        assert [row.id for row in machines.every(session)] == ["alpha", "pump-7", "zeta"]


# --- samples --------------------------------------------------------------------------------------------------------


def add_blocks(session: Session, *blocks: Samples, key: SourceKey = MONITOR, revision: int = 1) -> None:
    """Store blocks one after the other."""
    sequence = 0
    for block in blocks:
        sample_store.add_block(session, key, revision=revision, first_sequence=sequence, samples=block)
        sequence += len(block)


def times(found: Samples) -> list[int]:
    return [moment - START for moment in found.time.tolist()]


def test_stored_samples_come_back_to_the_bit(plant: Database) -> None:
    held = samples(10)
    with plant.transaction() as session:
        add_blocks(session, held)
    with plant.reading() as session:
        assert_same_samples(sample_store.latest(session, "pump-7", revision=1, count=10), held)


def test_between_takes_what_lies_in_it_by_time(plant: Database) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, start=START + 50, step=10), samples(5, step=10))
    with plant.reading() as session:
        found = sample_store.between(session, "pump-7", revision=1, first=START + 30, last=START + 60)
    assert times(found) == [30, 40, 50, 60]


@pytest.mark.parametrize(("first", "last"), [(-100, -1), (41, 49), (95, 200), (60, 50)])
def test_between_without_samples_is_empty(plant: Database, first: int, last: int) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        assert len(sample_store.between(session, "pump-7", revision=1, first=START + first, last=START + last)) == 0


def test_samples_belong_to_a_machine_and_revision(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        machines.revise(session, machine(name="New"))
        add_blocks(session, samples(2))
        add_blocks(session, samples(3, start=START + 100), key=SourceKey("pump-7", "monitor", 2), revision=2)
    with plant.reading() as session:
        assert len(sample_store.latest(session, "pump-7", revision=1, count=10)) == 2
        assert len(sample_store.latest(session, "pump-7", revision=2, count=10)) == 3
        assert len(sample_store.latest(session, "other", revision=1, count=10)) == 0


@pytest.mark.parametrize("count", [1, 4, 5, 7, 100])
def test_latest_takes_the_newest_by_time(plant: Database, count: int) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, count=count)
    assert times(found) == list(range(0, 100, 10))[-count:]


def test_latest_of_two_sources_at_once_takes_the_newest_of_both(plant: Database) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(11, step=10))
        add_blocks(session, samples(10, start=START + 5, step=10), key=SourceKey("pump-7", "second", 1))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, count=4)
    assert times(found) == [85, 90, 95, 100]


@pytest.mark.parametrize(
    ("first", "last", "count", "expected"),
    [
        (None, 60, 3, [40, 50, 60]),
        (20, 55, 10, [20, 30, 40, 50]),
        (90, None, 10, [90]),
        (41, 49, 10, []),
        (60, 50, 10, []),
        (None, -1, 10, []),
    ],
)
def test_latest_within_a_time_range(
    plant: Database, first: int | None, last: int | None, count: int, expected: list[int]
) -> None:
    begin, end = (None if moment is None else START + moment for moment in (first, last))
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, channels=2, count=count, first=begin, last=end)
    assert times(found) == expected


def test_the_same_samples_cannot_be_stored_twice(plant: Database) -> None:
    def twice() -> None:
        with plant.transaction() as session:
            add_blocks(session, samples(2))
            add_blocks(session, samples(2))

    with pytest.raises(IntegrityError, match="UNIQUE"):
        twice()


def test_a_source_begins_at_nothing_and_keeps_its_counts(plant: Database) -> None:
    with plant.transaction() as session:
        row = sample_store.source(session, MONITOR)
        assert (row.next_sequence, row.received, row.duplicates, row.lost, row.last_time) == (0, 0, 0, 0, 0)
        row.next_sequence, row.lost = 7, 2
    with plant.reading() as session:
        assert sample_store.source(session, MONITOR).next_sequence == 7
        assert sample_store.source(session, SourceKey("pump-7", "monitor", 2)).next_sequence == 0


def test_sources_of_one_machine_or_of_all(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        for key in (MONITOR, SourceKey("other", "monitor", 1), SourceKey("pump-7", "alternate", 5)):
            sample_store.source(session, key)
    with plant.reading() as session:
        assert [(row.machine_id, row.source) for row in sample_store.sources(session)] == [
            ("other", "monitor"),
            ("pump-7", "alternate"),
            ("pump-7", "monitor"),
        ]
        assert len(sample_store.sources(session, "pump-7")) == 2


# --- runs -----------------------------------------------------------------------------------------------------------


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
        row = runs.current(session, "pump-7")
        assert row is not None
        assert row.id == run_id
        assert runs.samples(session, run_id) is None
        runs.close(row, samples=samples(5), state=runs.CLOSED, reason="the speed turned back")
    with plant.reading() as session:
        assert runs.current(session, "pump-7") is None
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

        def found(**limits: int) -> list[int]:
            return [row.time_first - START for row in runs.of_machine(session, "pump-7", **limits)]

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


# --- jobs -----------------------------------------------------------------------------------------------------------


def ask(session: Session, *run_ids: int, scope: str = jobs.RUN) -> int | None:
    row = jobs.ask(session, "pump-7", scope=scope, run_ids=list(run_ids))
    return None if row is None else row.id


def states(session: Session) -> list[str]:
    return [row.state for row in reversed(jobs.of_machine(session, "pump-7", limit=100))]


def test_the_same_identification_is_asked_for_once(plant: Database) -> None:
    with plant.transaction() as session:
        assert ask(session, 1, 2, scope=jobs.GATHERED) is not None
        assert ask(session, 2, 1, scope=jobs.GATHERED) is None
        assert ask(session, 1, scope=jobs.GATHERED) is not None
        assert ask(session, 1, scope=jobs.RUN) is not None
        jobs.finish(jobs.take(session, 1)[0], state=jobs.DONE)
    with plant.transaction() as session:
        assert ask(session, 1, 2, scope=jobs.GATHERED) is None


def test_jobs_are_taken_oldest_first_and_only_once(plant: Database) -> None:
    with plant.transaction() as session:
        asked = [ask(session, run_id) for run_id in (5, 3, 4)]
        assert jobs.waiting(session)
    with plant.transaction() as session:
        assert [row.id for row in jobs.take(session, 2)] == asked[:2]
    with plant.transaction() as session:
        assert [row.id for row in jobs.take(session, 2)] == asked[2:]
        assert jobs.take(session, 2) == []
        assert not jobs.waiting(session)
        assert states(session) == [jobs.RUNNING] * 3


def test_a_finished_job_says_how_and_when(plant: Database) -> None:
    with plant.transaction() as session:
        ask(session, 1)
        ask(session, 2)
        done, failed = jobs.take(session, 2)
        jobs.finish(done, state=jobs.DONE)
        jobs.finish(failed, state=jobs.FAILED, error="NotEnoughData: too few")
    with plant.reading() as session:
        assert jobs.get(session, done.id).error is None
        assert jobs.get(session, failed.id).error == "NotEnoughData: too few"
        assert (jobs.get(session, done.id).finished_at or 0) >= done.created_at
        assert jobs.count(session) == {jobs.DONE: 1, jobs.FAILED: 1}


def test_a_job_that_costs_every_worker_is_given_up(plant: Database) -> None:
    with plant.transaction() as session:
        ask(session, 1)
        for attempt in range(1, jobs.LARGEST_ATTEMPTS + 1):
            (row,) = jobs.take(session, 1)
            assert row.attempts == attempt
            jobs.put_back(row, "the worker died")
        assert jobs.take(session, 1) == []
        assert row.state == jobs.FAILED
        assert row.error == "given up after 3 attempts: the worker died"


def test_what_an_earlier_process_left_running_is_queued_again(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id in range(4):
            ask(session, run_id)
        jobs.finish(jobs.take(session, 1)[0], state=jobs.DONE)
        jobs.take(session, 2)
    with plant.transaction() as session:
        assert jobs.put_back_running(session) == 2
        assert states(session) == [jobs.DONE, jobs.QUEUED, jobs.QUEUED, jobs.QUEUED]
        # A stop of the service is no attempt.
        assert [row.attempts for row in jobs.take(session, 3)] == [1, 1, 1]


def test_jobs_of_a_machine_newest_first(plant: Database) -> None:
    with plant.transaction() as session:
        asked = [ask(session, run_id) for run_id in range(3)]
        assert [row.id for row in jobs.of_machine(session, "pump-7", limit=2)] == asked[:0:-1]
        with pytest.raises(jobs.JobUnknown):
            jobs.get(session, 99)


# --- identifications ------------------------------------------------------------------------------------------------


def test_an_identification_comes_back_whole(plant: Database) -> None:
    outcome = identification(unknown=["bearing.B1.kxy"], condition_number=math.inf)
    with plant.transaction() as session:
        stored = store_identification(session, outcome, run_id=1).id
    with plant.reading() as session:
        row = identifications.get(session, stored)
        assert row.accepted
        assert (row.chi_square, row.degrees_of_freedom, row.condition_number) == (123.0, 120, math.inf)
        assert tuple(row.coordinates) == outcome.coordinates
        assert np.array_equal(identifications.covariance(row), outcome.covariance)
        found = identifications.estimates(session, stored)
        assert [one.parameter for one in found] == [one.name for one in outcome.estimates]
        for one, expected in zip(found, outcome.estimates, strict=True):
            for name in ("value", "standard_error", "lower", "upper", "imaginary", "imaginary_standard_error", "reason"):
                assert getattr(one, name) == getattr(expected, name), (one.parameter, name)


def test_unknown_identifications_are_said(plant: Database) -> None:
    with plant.reading() as session, pytest.raises(identifications.IdentificationUnknown):
        identifications.get(session, 5)


def test_a_job_has_one_identification(plant: Database) -> None:
    with plant.transaction() as session:
        first = store_identification(session, identification(), run_id=1)
        origin = identifications.Origin("pump-7", 1, first.job_id, "run", "run-up", [1], START, {}, "0.1.0")
        with pytest.raises(IntegrityError, match="UNIQUE"):
            identifications.add(session, origin, identification())
        session.rollback()


def test_identifications_in_a_time_range_newest_first(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id, moment in enumerate((20, 0, 10)):
            store_identification(session, identification(), run_id=run_id, measured_at=START + moment)
    with plant.reading() as session:

        def found(**limits: int) -> list[int]:
            return [row.measured_at - START for row in identifications.of_machine(session, "pump-7", **limits)]

        assert found() == [20, 10, 0]
        assert found(first=START + 10, last=START + 10) == [10]
        assert found(limit=2) == [20, 10]


def test_only_accepted_single_runs_of_one_kind_and_revision_make_a_baseline(plant: Database) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
        good = [
            store_identification(session, identification(), run_id=i, measured_at=START + 10 * (3 - i)).id for i in range(3)
        ]
        store_identification(session, identification(accepted=False), run_id=10)
        store_identification(session, identification(), run_id=11, run_kind="run-up")
        store_identification(session, identification(), run_id=12, scope=jobs.GATHERED)
        store_identification(session, identification(), run_id=13, revision=2)
    with plant.reading() as session:

        def ids(rows: Any) -> list[int]:
            return [row.id for row in rows]

        like = identifications.Like(revisions=(1,), run_kind="run-down")
        assert ids(identifications.first_accepted(session, "pump-7", like, limit=2)) == good[:0:-1]
        assert ids(identifications.newest(session, "pump-7", like, limit=2)) == good[:2]


def test_a_logarithmic_point_holds_the_direct_terms_that_are_known(plant: Database) -> None:
    outcome = identification({"bearing.B1.kxx": 2.0}, unknown=["bearing.B2.kyy"])
    outcome.covariance[:] = np.arange(outcome.covariance.size).reshape(outcome.covariance.shape)
    with plant.transaction() as session:
        stored = store_identification(session, outcome, run_id=1).id
    with plant.reading() as session:
        point = identifications.logarithmic_point(session, identifications.get(session, stored))
    assert "bearing.B2.kyy" not in point.names
    assert not any(name.endswith(("kxy", "kyx", "cxy", "cyx", "unbalance")) for name in point.names)
    assert len(point.names) == 4 * 4 + 6 - 1
    assert point.value[point.names.index("bearing.B1.kxx")] == pytest.approx(math.log(4e6))
    at = [outcome.coordinates.index(name) for name in point.names]
    assert np.array_equal(point.covariance, outcome.covariance[np.ix_(at, at)])


def test_history_of_parameters_oldest_first(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id, (moment, factor) in enumerate([(20, 1.2), (0, 1.0), (10, 1.1)]):
            outcome = identification({"coupling.C1.kxx": factor})
            store_identification(session, outcome, run_id=run_id, measured_at=START + moment)
        store_identification(session, identification({"coupling.C1.kxx": 9.0}), run_id=9, scope=jobs.GATHERED)
    names = ["coupling.C1.kxx", "disc.D1.unbalance", "nothing"]
    with plant.reading() as session:
        stiffness, unbalance, nothing = trends.histories(session, "pump-7", names, scope=jobs.RUN).values()
        gathered = trends.histories(session, "pump-7", names, scope=jobs.GATHERED)["coupling.C1.kxx"]
    assert (stiffness.value / 2e6).tolist() == pytest.approx([1.0, 1.1, 1.2])
    assert stiffness.measured_at.tolist() == [START, START + 10, START + 20]
    assert np.isnan(stiffness.imaginary).all()
    assert (gathered.value / 2e6).tolist() == pytest.approx([9.0])
    assert (len(unbalance), unbalance.unit, unbalance.imaginary.tolist()) == (3, "kg m", [-5e-4] * 3)
    assert (len(nothing), nothing.unit) == (0, None)


def test_the_stamp_of_histories_changes_with_what_they_hold(plant: Database) -> None:
    seen = []

    def look(session: Session) -> None:
        seen.append(trends.stamp(session, "pump-7"))

    with plant.transaction() as session:
        look(session)
        look(session)
        store_identification(session, identification(), run_id=1)
        look(session)
        baselines.begin(session, "pump-7", since=START, identification_ids=None, reason="why", by="anna")
        look(session)
        run = runs.open_run(session, "pump-7", revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(run, samples=samples(), state=runs.DISCARDED, reason="joined")
        look(session)
        machines.revise(session, machine(name="New"))
        look(session)
    assert seen[0] == seen[1]
    assert len(set(seen)) == 5


# --- quarantine -----------------------------------------------------------------------------------------------------


def rejection(number: int, reason: str = "bad_frame", machine_id: str | None = None) -> Rejection:
    return Rejection(START + number, f"key/{number}", machine_id, reason, f"detail {number}", b"payload")


def kept(session: Session) -> list[int]:
    return [row.received_at - START for row in quarantine.newest(session, reason=None, machine_id=None, limit=100)]


def test_rejections_are_counted_by_reason(database: Database) -> None:
    with database.transaction() as session:
        quarantine.add(session, [rejection(1), rejection(2), rejection(3, "undecodable", "pump-7")])
    with database.transaction() as session:
        quarantine.add(session, [rejection(4)])
    with database.reading() as session:
        assert quarantine.counts(session) == {"bad_frame": 3, "undecodable": 1}
        assert kept(session) == [4, 3, 2, 1]
        by_reason = quarantine.newest(session, reason="bad_frame", machine_id=None, limit=2)
        assert [row.received_at - START for row in by_reason] == [4, 2]
        by_machine = quarantine.newest(session, reason=None, machine_id="pump-7", limit=9)
        assert [row.detail for row in by_machine] == ["detail 3"]


def test_the_oldest_rejections_are_let_go_but_stay_counted(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quarantine, "KEPT_ROWS", 3)
    with database.transaction() as session:
        quarantine.add(session, [rejection(number) for number in range(5)])
        assert kept(session) == [4, 3, 2]
        quarantine.add(session, [rejection(5)])
        assert kept(session) == [5, 4, 3]
        assert quarantine.counts(session) == {"bad_frame": 6}


def test_of_a_large_rejection_only_the_beginning_is_kept(database: Database) -> None:
    large = Rejection(START, "k" * 2000, None, "too_large", "d" * 9000, b"x" * 100_000)
    with database.transaction() as session:
        quarantine.add(session, [large])
    with database.reading() as session:
        (row,) = quarantine.newest(session, reason=None, machine_id=None, limit=9)
        assert (row.size, len(row.payload), len(row.key), len(row.detail)) == (100_000, quarantine.KEPT_BYTES, 512, 2000)


def test_nothing_rejected_changes_nothing(database: Database) -> None:
    with database.transaction() as session:
        quarantine.add(session, [])
        assert quarantine.counts(session) == {}
        assert session.scalar(select(func.count()).select_from(QuarantineRow)) == 0
