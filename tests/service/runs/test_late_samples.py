"""Samples that come late: holes filled, runs reopened, whole runs found afterwards, and what comes too late counted."""

import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy.orm import Session

from service.runs import late_samples
from service.runs.collector import Collector
from service.runs.late_samples import BESIDE, LARGEST_COUNT, Window, add_late
from service.write_path.sequence_gaps import NEVER
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.findings import identifications, jobs, trends
from storage.findings.identifications import ComparisonGroup, Origin
from storage.machines import machines
from storage.measurements import quarantine, runs
from storage.measurements import samples as sample_store
from storage.tables.findings import JobRow
from storage.tables.measurements import RunRow, SourceRow
from tests.databases import Databases, opened
from tests.plant import KEY, SECOND, START, arrived, batch, few_examples, identification, machine, sweep_rpm
from tests.prompt_writer import PromptWriter

MONITOR = SourceKey(KEY.machine, "monitor", 1)
DOWN = sweep_rpm(2990.0, 310.0, 80)
"""A run-down, a sample a second."""
CYCLE = [*[2990.0] * 20, *DOWN, *[250.0] * 20]


@pytest.fixture
def writer(plant: Database) -> PromptWriter:
    """One that sorts in what came late at the next look."""
    return PromptWriter(plant, Collector(late_s=0.0))


def send(writer: PromptWriter, rpm: list[float], first: int, last: int, *, start: int = START, **changes: Any) -> None:
    """Samples number first to before last of a source that measures these speeds, a second apart."""
    one = batch(rpm[first:last], sequence=first, start=start + first * SECOND, **changes)
    writer.store([arrived(one, received_at=start + 10**6 * SECOND)], [])


def settle(writer: PromptWriter) -> None:
    writer.settle(silence_s=3600.0)


def found_runs(database: Database) -> list[RunRow]:
    """Oldest first."""
    with database.reading() as session:
        return list(reversed(runs.of_machine(session, KEY.machine)))


def held(database: Database, run: RunRow) -> Samples:
    with database.reading() as session:
        found = runs.samples(session, run.id)
    assert found is not None
    return found


def found_jobs(database: Database) -> list[JobRow]:
    with database.reading() as session:
        return list(reversed(jobs.of_machine(session, KEY.machine, limit=100)))


def source(database: Database, key: SourceKey = MONITOR) -> SourceRow:
    with database.reading() as session:
        return sample_store.source(session, key)


def times(database: Database) -> list[int]:
    with database.reading() as session:
        return list(map(int, sample_store.latest(session, KEY.machine, revision=1, count=10_000).time))


def file_identification(session: Session, job_id: int, run: RunRow, *, scope: str) -> None:
    """An accepted identification of a run, as the job's outcome."""
    origin = Origin(
        machine_id=KEY.machine,
        revision=run.revision,
        job_id=job_id,
        scope=scope,
        run_kind=run.kind,
        run_ids=[run.id],
        measured_at=run.time_last or run.time_first,
        options={},
        code_version="0.1.0",
    )
    identifications.add(session, origin, identification())


# --- holes ----------------------------------------------------------------------------------------------------------


def test_a_number_that_was_lost_fills_its_hole(plant: Database, writer: PromptWriter) -> None:
    speeds = [1000.0] * 12
    send(writer, speeds, 0, 4)
    send(writer, speeds, 8, 12)
    assert (source(plant).lost, source(plant).missing) == (4, [[4, 7, START + 3 * SECOND, START + 8 * SECOND]])
    send(writer, speeds, 5, 7)
    row = source(plant)
    assert (row.received, row.lost, row.duplicates) == (10, 2, 0)
    assert row.missing == [[4, 4, START + 3 * SECOND, START + 5 * SECOND], [7, 7, START + 6 * SECOND, START + 8 * SECOND]]
    send(writer, speeds, 3, 9)
    row = source(plant)
    assert (row.received, row.lost, row.duplicates, row.missing) == (12, 0, 4, None)
    assert times(plant) == [START + i * SECOND for i in range(12)]


def test_what_fills_a_hole_must_lie_between_its_neighbours_in_time(plant: Database, writer: PromptWriter) -> None:
    speeds = [1000.0] * 12
    send(writer, speeds, 0, 4)
    send(writer, speeds, 8, 12)
    wrong = batch([1000.0] * 4, sequence=4, start=START, step=3 * SECOND)
    writer.store([arrived(wrong)], [])
    with plant.reading() as session:
        kept = quarantine.newest(session, reason=None, machine_id=None, limit=10)
    assert sorted(row.reason for row in kept) == ["time_out_of_order"] * 3
    row = source(plant)
    assert (row.received, row.lost, row.missing) == (9, 0, None)


def test_a_batch_that_cannot_be_converted_leaves_no_hole(plant: Database, writer: PromptWriter) -> None:
    speeds = [1000.0] * 12
    send(writer, speeds, 0, 4)
    send(writer, speeds, 8, 12)
    send(writer, speeds, 4, 8, speed_unit="knots")
    row = source(plant)
    assert (row.received, row.lost, row.missing) == (8, 0, None)


def test_a_hole_before_rejected_samples_has_no_end_in_time(plant: Database, writer: PromptWriter) -> None:
    send(writer, [1000.0] * 12, 0, 2)
    send(writer, [1000.0] * 12, 4, 6, speed_unit="knots")
    assert source(plant).missing == [[2, 3, START + SECOND, NEVER]]
    send(writer, [1000.0] * 12, 2, 4)
    assert (source(plant).received, source(plant).lost) == (4, 0)


@settings(few_examples, max_examples=15)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3), st.floats(0.0, 0.3))
def test_any_order_of_arrival_stores_the_same_samples(
    databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory, seed: int, lost: float, twice: float
) -> None:
    """Batches of all sizes, lost, doubled and shuffled: what came is stored, once, and the counters are exact."""
    rng = random.Random(seed)
    cuts = sorted({0, 60, *(rng.randrange(60) for _ in range(10))})
    whole = [(first, last) for first, last in zip(cuts, cuts[1:], strict=False)]
    sent = [piece for piece in whole if rng.random() >= lost] or whole[:1]
    sent += [piece for piece in sent if rng.random() < twice]
    rng.shuffle(sent)
    with opened(databases, plant_template, tmp_path_factory.mktemp("late") / "late.db") as database:
        writer = PromptWriter(database, Collector())
        speeds = sweep_rpm(2900.0, 400.0, 60)
        for first, last in sent:
            send(writer, speeds, first, last)
        expected = sorted({number for first, last in sent for number in range(first, last)})
        assert times(database) == [START + number * SECOND for number in expected]
        row = source(database)
        assert (row.received, row.lost) == (len(expected), max(expected) + 1 - len(expected))
        assert row.received + row.duplicates == sum(last - first for first, last in sent)


# --- runs -----------------------------------------------------------------------------------------------------------


def test_late_samples_of_an_open_run_are_simply_in_it(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 70)
    send(writer, CYCLE, 50, 60)
    send(writer, CYCLE, 70, 120)
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.state, run.reopened_at) == (runs.CLOSED, None)
    assert held(plant, run).speed.size == 80 + 5
    assert source(plant).late == 10


def test_a_closed_run_is_reopened_and_identified_again_each_time(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    (before,) = found_runs(plant)
    assert (before.state, before.count) == (runs.CLOSED, 75)
    send(writer, CYCLE, 52, 58)
    settle(writer)
    (run,) = found_runs(plant)
    assert run.id == before.id
    assert (run.state, run.count) == (runs.CLOSED, 81)
    assert run.reopened_at is not None
    assert np.all(np.diff(held(plant, run).time) > 0)
    send(writer, CYCLE, 50, 52)
    send(writer, CYCLE, 58, 60)
    settle(writer)
    (after,) = found_runs(plant)
    assert (after.id, after.count) == (run.id, 85)
    assert after.reopened_at is not None
    assert after.reopened_at > run.reopened_at
    assert after.coverage is not None
    assert after.coverage["late_samples_left_out"] == 0
    assert (source(plant).received, source(plant).lost, source(plant).late) == (120, 0, 10)
    jobs_of_it = [(job.run_ids, job.options) for job in found_jobs(plant)]
    assert jobs_of_it == [([run.id], None), ([run.id], {"reopened": 1}), ([run.id], {"reopened": 2})]


def test_a_reopened_run_waits_twice_as_long_each_time(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    hours = [0.0]
    monkeypatch.setattr("service.runs.late_samples.now", lambda: START + round(3600 * SECOND * hours[0]))

    def sort_in(windows: list[Window]) -> list[Window]:
        left = []
        for window in windows:
            with plant.reading() as session:
                plan = late_samples.plan(session, KEY.machine, window, patience_s=3600.0)
            if plan is None:
                left.append(window)
                continue
            with plant.transaction() as session:
                late_samples.apply(session, plan)
            patient.closing.close_ended()
        return left

    patient = PromptWriter(plant, Collector(late_s=3600.0))
    send(patient, CYCLE, 0, 50)
    send(patient, CYCLE, 60, 120)
    counts = []
    for number, hours[0] in enumerate((0.0, 1.9, 2.1, 6.0, 6.2)):
        send(patient, CYCLE, 50 + number, 51 + number)
        left = sort_in([[1, START + 50 * SECOND, START + (50 + number) * SECOND, 1]])
        (run,) = found_runs(plant)
        counts.append((run.count, len(left)))
    assert counts == [(76, 0), (76, 1), (78, 0), (78, 1), (80, 0)]


def test_what_lengthens_a_run_bit_by_bit_waits_like_what_lies_in_it(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """As from a source that sends what it has kept, in order, behind what it measures now."""
    moment = [0.0]
    monkeypatch.setattr("service.runs.collector.time.monotonic", lambda: moment[0])
    monkeypatch.setattr("service.runs.late_samples.now", lambda: START + round(SECOND * moment[0]))
    writer = PromptWriter(plant, Collector(late_s=10.0))
    send(writer, CYCLE, 0, 60)
    send(writer, CYCLE, 100, 120)
    for number in range(60, 100):
        send(writer, CYCLE, number, number + 1)
        moment[0] += 20.0
        settle(writer)
    asked = [job.options for job in found_jobs(plant) if job.options]
    assert 3 <= len(asked) <= 7
    for moment[0] in (5000.0, 5020.0):
        settle(writer)
    assert [run.count for run in found_runs(plant) if run.state == runs.CLOSED] == [85]


def test_late_samples_that_do_not_cease_are_sorted_in_all_the_same(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    moment = [0.0]
    monkeypatch.setattr("service.runs.collector.time.monotonic", lambda: moment[0])
    writer = PromptWriter(plant, Collector(late_s=10.0))
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 70, 120)
    counts = []
    for number in range(20):
        send(writer, CYCLE, 50 + number, 51 + number)
        moment[0] += 9.0
        settle(writer)
        counts.append(found_runs(plant)[0].count)
    assert counts[:11] == [65] * 11
    assert counts[11] == 77


def test_what_comes_when_the_raw_samples_are_gone_is_counted(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    with plant.transaction() as session:
        machines.get(session, KEY.machine).blocks_since = START + 119 * SECOND
    send(writer, CYCLE, 50, 60)
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.count, run.reopened_at) == (75, None)
    assert run.coverage is not None
    assert run.coverage["late_samples_left_out"] == 10


def test_a_run_whose_samples_were_let_go_of_has_them_again_when_it_is_rebuilt(plant: Database, writer: PromptWriter) -> None:
    """The raw samples may be kept for longer than those of runs."""
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    with plant.transaction() as session:
        (row,) = runs.of_machine(session, KEY.machine)
        row.data, row.flags, row.released_at = None, None, START
    send(writer, CYCLE, 50, 60)
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.count, run.released_at) == (85, None)
    assert len(held(plant, run)) == 85


def test_of_a_reopened_run_the_newest_identification_counts(plant: Database, writer: PromptWriter) -> None:
    """In trends, baselines and alerts; the one before stays readable."""
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    (run,) = found_runs(plant)
    send(writer, CYCLE, 50, 60)
    settle(writer)
    (reopened,) = found_runs(plant)
    with plant.transaction() as session:
        for job in jobs.claim_next(session, 10):
            jobs.finish(job, state=jobs.DONE)
            file_identification(session, job.id, reopened, scope=jobs.RUN)
        assert [row.run_ids for row in identifications.of_machine(session, KEY.machine)] == [[run.id]] * 2
        (counted,) = identifications.first_accepted(session, KEY.machine, ComparisonGroup((1,), "run-down"), limit=10)
        assert counted.id == max(row.id for row in identifications.of_machine(session, KEY.machine))
        points = trends.histories(session, KEY.machine, ["coupling.C1.kxx"], scope=jobs.RUN)["coupling.C1.kxx"]
        assert points.identification.tolist() == [counted.id]


def test_the_identification_of_a_run_that_was_joined_to_another_counts_no_more(plant: Database, writer: PromptWriter) -> None:
    slow = [*[2990.0] * 20, *sweep_rpm(2990.0, 310.0, 600), *[250.0] * 20]
    send(writer, slow, 0, 220)
    send(writer, slow, 400, 640)
    with plant.transaction() as session:
        for job in jobs.claim_next(session, 10):
            jobs.finish(job, state=jobs.DONE)
            file_identification(session, job.id, runs.get(session, job.run_ids[0]), scope=jobs.RUN)
        assert len(identifications.first_accepted(session, KEY.machine, ComparisonGroup((1,), "run-down"), limit=10)) == 2
    send(writer, slow, 220, 400)
    settle(writer)
    first, _ = found_runs(plant)
    with plant.reading() as session:
        counted = identifications.first_accepted(session, KEY.machine, ComparisonGroup((1,), "run-down"), limit=10)
        assert [row.run_ids for row in counted] == [[first.id]]


def test_late_samples_are_sorted_in_after_a_restart_too(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    send(writer, CYCLE, 50, 60)
    settle(PromptWriter(plant, Collector(late_s=0.0)))
    (run,) = found_runs(plant)
    assert run.count == 85


def test_nothing_is_sorted_in_while_more_comes(plant: Database) -> None:
    writer = PromptWriter(plant, Collector(late_s=60.0))
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    send(writer, CYCLE, 50, 60)
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.count, run.reopened_at) == (75, None)


def test_late_samples_may_make_a_discarded_run_worth_an_identification(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 28)
    send(writer, CYCLE, 94, 120)
    (run,) = found_runs(plant)
    assert run.state == runs.DISCARDED
    send(writer, CYCLE, 28, 94)
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.state, run.count) == (runs.CLOSED, 85)
    assert run.reason == "the speed left the speed range"
    assert [job.options for job in found_jobs(plant)] == [{"reopened": 1}]


def test_late_samples_beside_a_run_lengthen_it(plant: Database, writer: PromptWriter) -> None:
    """Its first half was on the way when it closed."""
    send(writer, CYCLE, 60, 120)
    (before,) = found_runs(plant)
    first_half = batch(CYCLE[:60], source="other", start=START)
    writer.store([arrived(first_half)], [])
    settle(writer)
    (run,) = found_runs(plant)
    assert run.id == before.id
    assert before.time_first == START + 60 * SECOND
    assert run.time_first == START + 20 * SECOND
    assert run.count == 85


def test_halves_that_a_pause_had_parted_become_one_run(plant: Database, writer: PromptWriter) -> None:
    slow = [*[2990.0] * 20, *sweep_rpm(2990.0, 310.0, 600), *[250.0] * 20]
    send(writer, slow, 0, 220)
    send(writer, slow, 400, 640)
    first, second = found_runs(plant)
    assert (first.state, first.reason, second.state) == (runs.CLOSED, "a pause in the data", runs.CLOSED)
    send(writer, slow, 220, 400)
    settle(writer)
    first, second = found_runs(plant)
    assert (first.state, first.count, first.reason) == (runs.CLOSED, 605, "the speed left the speed range")
    assert (second.state, second.reason) == (runs.DISCARDED, f"late samples join it to run {first.id}")


def test_a_whole_run_that_comes_late_becomes_a_run_of_its_own(plant: Database, writer: PromptWriter) -> None:
    """An hour without a network, while a second source went on; then the first one's log is heard after all."""
    send(writer, CYCLE, 0, 120, start=START + 3600 * SECOND, source="second")
    send(writer, CYCLE, 0, 120)
    settle(writer)
    late_samples, known = found_runs(plant)
    assert (late_samples.kind, late_samples.state, late_samples.count, late_samples.reopened_at) == (
        "run-down",
        runs.CLOSED,
        85,
        None,
    )
    assert late_samples.reason == "the speed left the speed range; it came late"
    assert (known.count, known.reopened_at) == (85, None)
    assert [job.run_ids for job in found_jobs(plant)] == [[known.id], [late_samples.id]]


def test_a_late_run_in_batches_is_one_run(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 120, start=START + 3600 * SECOND, source="second")
    for first in range(0, 120, 10):
        send(writer, CYCLE, first, first + 10)
    settle(writer)
    late_samples, _ = found_runs(plant)
    assert (late_samples.count, late_samples.reopened_at) == (85, None)


LONG_RECORD = [*[2990.0] * 40, *sweep_rpm(2990.0, 310.0, 90), *[250.0] * 40, *sweep_rpm(310.0, 2990.0, 90), *[2990.0] * 40]
"""Runs from 40 to 129 and from 170 to 259, among 300 samples."""


@pytest.mark.parametrize("seed", range(5))
def test_a_scenario_told_in_any_order_has_the_same_runs(plant: Database, writer: PromptWriter, seed: int) -> None:
    """The end of a run-up may lie a message later, in the hold behind it, where that was heard of first."""
    order = list(range(0, 300, 20))
    random.Random(seed).shuffle(order)
    for first in order:
        send(writer, LONG_RECORD, first, first + 20)
    writer.settle(silence_s=0.0)
    settle(writer)
    closed = [run for run in found_runs(plant) if run.state == runs.CLOSED]
    assert [run.kind for run in closed] == ["run-down", "run-up"]
    for run, (first, last) in zip(closed, [(40, 129), (170, 259)], strict=True):
        numbers = set(((held(plant, run).time - START) // SECOND).tolist())
        assert set(range(first, last + 1)) <= numbers <= set(range(first - 5, last + 21))
    assert (source(plant).received, source(plant).lost) == (300, 0)


def test_late_samples_wait_for_the_run_beside_them_to_close(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 50, 80, source="second")
    send(writer, CYCLE, 0, 50)
    settle(writer)
    (run,) = found_runs(plant)
    assert run.state == runs.OPEN
    send(writer, CYCLE, 80, 120, source="second")
    settle(writer)
    (run,) = found_runs(plant)
    assert (run.state, run.count, run.time_first) == (runs.CLOSED, 85, START + 20 * SECOND)


def test_late_samples_at_speed_change_nothing(plant: Database, writer: PromptWriter) -> None:
    steady = [2990.0] * 500
    send(writer, steady, 0, 200)
    send(writer, steady, 300, 500)
    send(writer, steady, 200, 300)
    settle(writer)
    assert found_runs(plant) == []
    assert source(plant).late == 100


def test_samples_under_a_new_revision_do_not_enter_an_old_run(plant: Database, writer: PromptWriter) -> None:
    send(writer, CYCLE, 0, 50)
    send(writer, CYCLE, 60, 120)
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
    send(writer, CYCLE, 50, 60)
    settle(writer)
    run, alone = found_runs(plant)
    assert (run.count, run.reopened_at) == (75, None)
    assert (alone.state, alone.revision, alone.count) == (runs.DISCARDED, 2, 10)


# --- windows --------------------------------------------------------------------------------------------------------


def test_windows_join_what_lies_near() -> None:
    windows = add_late([], 1, [0, BESIDE, 5 * BESIDE])
    assert windows == [[1, 0, BESIDE, 2], [1, 5 * BESIDE, 5 * BESIDE, 1]]
    assert add_late(windows, 1, [2 * BESIDE, 3 * BESIDE, 4 * BESIDE]) == [[1, 0, 5 * BESIDE, 6]]
    assert add_late([[1, 0, 0, 1]], 2, [0]) == [[1, 0, 0, 1], [2, 0, 0, 1]]


@few_examples
@given(st.lists(st.lists(st.integers(0, 1000), max_size=30), max_size=5))
def test_windows_are_bounded_and_count_every_sample(batches: list[list[int]]) -> None:
    windows: list[list[int]] = []
    for numbers in batches:
        windows = add_late(windows, 1, [2 * BESIDE * number for number in numbers])
    assert len(windows) <= LARGEST_COUNT
    assert sum(window[3] for window in windows) == sum(map(len, batches))
    for one, other in zip(windows, windows[1:], strict=False):
        assert one[2] + BESIDE < other[1]
