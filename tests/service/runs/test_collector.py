"""Run collection: from stored samples to runs that carry their own samples, and to the identifications asked for."""

from typing import Any

import pytest

from service.runs.collector import Collector
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.findings import JobRow
from storage.tables.measurements import RunRow
from tests.plant import SECOND, START, arrived, batch, machine, sweep_rpm
from tests.prompt_writer import PromptWriter


class Stream:
    """A source that publishes one stretch of speeds after the other, a sample a second."""

    def __init__(self, writer: PromptWriter, *, source: str = "monitor") -> None:
        self.writer = writer
        self.count = 0
        self.time = START
        self.source = source

    def send(self, rpm: list[float], *, pause_s: int = 0, **changes: Any) -> None:
        self.time += pause_s * SECOND
        one = batch(rpm, sequence=self.count, start=self.time, source=self.source, **changes)
        self.writer.store([arrived(one)], [])
        self.count += len(rpm)
        self.time += len(rpm) * SECOND


@pytest.fixture
def stream(writer: PromptWriter) -> Stream:
    return Stream(writer)


def found_runs(database: Database) -> list[RunRow]:
    """Oldest first."""
    with database.reading() as session:
        return list(reversed(runs.of_machine(session, "pump-7")))


def found_jobs(database: Database) -> list[JobRow]:
    with database.reading() as session:
        return list(reversed(jobs.of_machine(session, "pump-7", limit=100)))


def samples_of(database: Database, run: RunRow) -> Samples:
    with database.reading() as session:
        held = runs.samples(session, run.id)
    assert held is not None
    return held


def only_run(database: Database) -> RunRow:
    (run,) = found_runs(database)
    return run


DOWN, UP = sweep_rpm(2990.0, 310.0), sweep_rpm(310.0, 2990.0)
STANDSTILL = [250.0] * 2


def test_a_run_down_is_open_until_it_is_over(plant: Database, stream: Stream) -> None:
    stream.send(DOWN)
    run = only_run(plant)
    assert (run.kind, run.state, run.time_first, run.time_last) == ("run-down", runs.OPEN, START, None)
    assert found_jobs(plant) == []
    stream.send(STANDSTILL)
    run = only_run(plant)
    assert (run.state, run.reason) == (runs.CLOSED, "the speed left the speed range")
    assert (run.count, run.time_last) == (40, START + 39 * SECOND)
    assert samples_of(plant, run).time.tolist() == [START + i * SECOND for i in range(40)]


def test_a_closed_run_is_identified_once(plant: Database, stream: Stream) -> None:
    stream.send([*DOWN, *STANDSTILL])
    stream.send(STANDSTILL * 5)
    (job,) = found_jobs(plant)
    assert (job.scope, job.run_ids, job.state) == (jobs.RUN, [only_run(plant).id], jobs.QUEUED)


def test_run_up_hold_and_run_down_are_two_runs(plant: Database, stream: Stream) -> None:
    stream.send([*UP, *[2990.0] * 10, *DOWN, *STANDSTILL])
    up, down = found_runs(plant)
    assert (up.kind, up.state, up.reason) == ("run-up", runs.CLOSED, "the speed turned back")
    assert (down.kind, down.state) == ("run-down", runs.CLOSED)
    assert up.time_last is not None
    assert up.time_last <= down.time_first
    assert [job.run_ids for job in found_jobs(plant)] == [[up.id], [down.id]]


@pytest.mark.parametrize(
    ("rpm", "said"),
    [
        pytest.param(sweep_rpm(2990.0, 310.0, 19), "not identified: 19 samples, 20 are needed", id="few samples"),
        pytest.param(
            sweep_rpm(840.0, 320.0, 30), "not identified: it covers 19 % of the speed range, 20 % are needed", id="span"
        ),
    ],
)
def test_a_short_run_is_discarded_and_says_why(plant: Database, stream: Stream, rpm: list[float], said: str) -> None:
    stream.send([*rpm, *STANDSTILL])
    run = only_run(plant)
    assert (run.state, run.reason) == (runs.DISCARDED, f"the speed left the speed range; {said}")
    assert run.count == len(rpm)
    assert found_jobs(plant) == []


def test_a_run_just_long_enough_is_identified(plant: Database, stream: Stream) -> None:
    stream.send([*sweep_rpm(860.0, 310.0, 20), *STANDSTILL])
    assert only_run(plant).state == runs.CLOSED
    assert len(found_jobs(plant)) == 1


def test_a_revision_during_a_run_closes_it_with_the_old_document(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:25])
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
    stream.send([*DOWN[25:], *STANDSTILL])
    first, second = found_runs(plant)
    assert (first.revision, first.state, first.reason) == (1, runs.CLOSED, "the machine's document was revised")
    assert (first.count, second.revision, second.count) == (25, 2, 15)
    assert second.time_first == START + 25 * SECOND
    assert [job.run_ids for job in found_jobs(plant)] == [[first.id]]


def test_a_revision_that_reorders_the_channels_does_not_mix_them(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:25])
    with plant.transaction() as session:
        machines.revise(session, machine(probes=machine().model_dump()["probes"][:2]))
    stream.send(DOWN[25:], channels=["B2X", "B2Y"], amplitude=[[1.0] * 2] * 15, phase=[[1.0] * 2] * 15)
    first, _ = found_runs(plant)
    assert samples_of(plant, first).phasor.shape == (25, 4)


def test_silence_closes_a_run(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:30])
    stream.writer.settle(silence_s=60.0)
    assert only_run(plant).state == runs.OPEN
    stream.writer.settle(silence_s=0.0)
    run = only_run(plant)
    assert (run.state, run.reason, run.count) == (runs.CLOSED, "the source fell silent", 30)
    assert len(found_jobs(plant)) == 1


def test_silence_closes_a_run_after_a_restart_too(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:30])
    again = PromptWriter(plant, Collector())
    again.settle(silence_s=60.0)
    assert only_run(plant).state == runs.OPEN
    again.settle(silence_s=0.0)
    assert only_run(plant).state == runs.CLOSED


def test_silence_without_a_run_changes_nothing(plant: Database, stream: Stream) -> None:
    stream.writer.settle(silence_s=0.0)
    stream.send([1000.0] * 5)
    stream.writer.settle(silence_s=0.0)
    assert found_runs(plant) == []


def test_after_silence_the_next_samples_are_a_new_run(plant: Database, stream: Stream) -> None:
    stream.send(sweep_rpm(2990.0, 1500.0, 25))
    stream.writer.settle(silence_s=0.0)
    stream.send([*sweep_rpm(1490.0, 310.0, 25), *STANDSTILL])
    first, second = found_runs(plant)
    assert (first.count, second.count) == (25, 25)
    assert second.time_first == START + 25 * SECOND


def test_a_pause_in_the_data_ends_a_run(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:30])
    stream.send(DOWN[30:], pause_s=121)
    first, second = found_runs(plant)
    assert (first.reason, first.count) == ("a pause in the data", 30)
    assert second.state == runs.OPEN


def test_a_change_of_direction_ends_a_run_which_keeps_its_own_samples(plant: Database, stream: Stream) -> None:
    stream.send(DOWN[:30])
    stream.send(DOWN[30:], direction="negative")
    first, second = found_runs(plant)
    assert (first.reason, first.count, first.direction) == ("the sense of rotation changed", 30, 1)
    assert second.direction == -1


def test_samples_older_than_the_newest_known_begin_no_run(plant: Database, stream: Stream) -> None:
    stream.send([*DOWN, *STANDSTILL])
    second = Stream(stream.writer, source="late")
    second.send([*DOWN, *STANDSTILL])
    assert len(found_runs(plant)) == 1
    assert len(found_jobs(plant)) == 1


def test_machines_are_collected_apart(plant: Database, stream: Stream) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    stream.send(DOWN[:20])
    other = Stream(stream.writer)
    other.send(UP[:20], machine="pump-8")
    stream.send([*DOWN[20:], *STANDSTILL])
    with plant.reading() as session:
        (row,) = runs.of_machine(session, "pump-8")
        assert (row.kind, row.state) == ("run-up", runs.OPEN)
    assert only_run(plant).state == runs.CLOSED
