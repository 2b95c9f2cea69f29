"""Tests that damaged data of one machine hold up no other machine: neither their storing nor their runs."""

import time

import pytest
from sqlalchemy import event, select, text
from sqlalchemy.exc import DBAPIError

from service.resilience import backoff
from service.resilience.backoff import LONGEST_PAUSE_S, Backoff
from service.runs import silence
from service.runs.collector import Collector
from service.runs.silence import AT_ONCE
from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import quarantine, runs
from storage.tables.measurements import QuarantineRow, RunRow, SampleBlockRow
from tests.failing_writes import refuse
from tests.plant import START, arrived, batch, machine, sweep_rpm
from tests.prompt_writer import PromptWriter

DOWN, STANDSTILL = sweep_rpm(2990.0, 310.0), [250.0] * 2


@pytest.fixture
def two(plant: Database) -> Database:
    """A database that knows pump-7 and pump-8."""
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    return plant


def coast_down(writer: PromptWriter, *names: str, first: int = 0, last: int = 30) -> None:
    for name in names:
        one = batch([*DOWN, *STANDSTILL][first:last], machine=name, sequence=first, start=START + first * 10**9)
        writer.store([arrived(one)], [])


def run_of(database: Database, name: str) -> RunRow:
    with database.reading() as session:
        (row,) = runs.of_machine(session, name)
        return row


def rejections(database: Database) -> list[QuarantineRow]:
    with database.reading() as session:
        return list(quarantine.newest(session, reason=None, machine_id=None, limit=100))


def damage_the_blocks(database: Database, name: str) -> None:
    """Damage the blocks like a bad disk."""
    with database.transaction() as session:
        for row in session.scalars(select(SampleBlockRow).where(SampleBlockRow.machine_id == name)):
            row.data = row.data[:-1] + bytes([row.data[-1] ^ 0xFF])


def test_a_block_that_cannot_be_read_is_left_out_of_its_run(plant: Database, writer: PromptWriter) -> None:
    coast_down(writer, "pump-7", last=4)
    damage_the_blocks(plant, "pump-7")
    coast_down(writer, "pump-7", first=4, last=42)
    run = run_of(plant, "pump-7")
    assert (run.state, run.count) == (runs.CLOSED, 36)
    with plant.reading() as session:
        assert len(jobs.of_machine(session, "pump-7", limit=10)) == 1
    (rejection,) = rejections(plant)
    assert (rejection.reason, rejection.machine_id, rejection.key) == ("damaged_block", "pump-7", f"run {run.id}")
    assert "is left out" in rejection.detail
    assert "checksum" in rejection.detail


def test_a_closing_that_was_not_stored_is_done_again(plant: Database, writer: PromptWriter) -> None:
    coast_down(writer, "pump-7")
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE identification_jobs RENAME TO away"))
    with pytest.raises(DBAPIError, match="identification_jobs"):
        writer.settle(silence_s=0.0)
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE away RENAME TO identification_jobs"))
    assert run_of(plant, "pump-7").state == runs.ENDED
    writer.settle(silence_s=0.0)
    assert run_of(plant, "pump-7").state == runs.CLOSED


def test_a_machine_that_cannot_be_closed_holds_up_no_other(
    two: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(silence, "LONGEST_ENDING_S", 60.0)  # on a busy machine the second one would be left to the next call
    coast_down(writer, "pump-7", "pump-8")
    with two.transaction() as session:
        refuse(session, "runs", write="UPDATE", when="NEW.machine_id = 'pump-7'")
    writer.settle(silence_s=0.0)
    assert [run_of(two, name).state for name in ("pump-7", "pump-8")] == [runs.OPEN, runs.CLOSED]
    (rejection,) = rejections(two)
    assert (rejection.reason, rejection.key) == ("unexpected_error", "runs of pump-7")
    assert "refused by the test" in rejection.detail
    with two.transaction() as session:
        session.execute(text("DROP TRIGGER refuse" + (" ON runs" if two.kind == "postgresql" else "")))
    writer.settle(silence_s=0.0)
    assert run_of(two, "pump-7").state == runs.OPEN, "tried again without a pause"
    now = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now + backoff.FIRST_PAUSE_S)
    writer.settle(silence_s=0.0)
    assert run_of(two, "pump-7").state == runs.CLOSED


def test_machines_of_which_nothing_is_to_be_done_are_looked_at_together(plant: Database, writer: PromptWriter) -> None:
    with plant.transaction() as session:
        for number in range(AT_ONCE + 10):
            machines.create(session, machine(id=f"idle-{number}"))
    coast_down(writer, "pump-7")
    asked: list[str] = []
    event.listen(plant.engine, "before_cursor_execute", lambda *args: asked.append(args[2]))
    event.listen(plant.engine, "savepoint", lambda *_: asked.append("SAVEPOINT"))
    writer.settle(silence_s=0.0)
    assert run_of(plant, "pump-7").state == runs.CLOSED
    assert asked.count("SAVEPOINT") == 1, "of one machine something is to be done"
    assert len([query for query in asked if "collectors" in query]) < 10
    asked.clear()
    writer.settle(silence_s=0.0)
    assert not [query for query in asked if "collectors" in query]


def test_what_the_look_at_all_cannot_read_is_looked_at_alone(two: Database, writer: PromptWriter) -> None:
    coast_down(writer, "pump-7", "pump-8")
    with two.transaction() as session:
        session.execute(text("UPDATE collectors SET state = '{}' WHERE machine_id = 'pump-7'"))
    writer.settle(silence_s=0.0)
    assert run_of(two, "pump-7").state == runs.OPEN
    assert run_of(two, "pump-8").state == runs.CLOSED
    told = {(one.reason, one.machine_id, one.detail.split(";")[0]) for one in rejections(two)}
    why = ("its run cannot be ended", "late samples cannot be sorted in")
    assert told == {("unexpected_error", "pump-7", words) for words in why}


def test_what_fails_is_tried_again_after_twice_the_pause_each_time() -> None:
    waiting = Backoff[str]()
    assert waiting.is_due("pump-7")
    assert [waiting.failed("pump-7") for _ in range(4)] == [10.0, 20.0, 40.0, 80.0]
    assert not waiting.is_due("pump-7")
    assert waiting.is_due("pump-8")
    assert max(waiting.failed("pump-7") for _ in range(10)) == LONGEST_PAUSE_S
    waiting.succeeded("pump-7")
    assert waiting.is_due("pump-7")
    assert waiting.failed("pump-7") == 10.0


def test_failures_may_be_free() -> None:
    waiting = Backoff[str](free=2)
    assert [waiting.failed("pump-7") for _ in range(4)] == [0.0, 0.0, 10.0, 20.0]
    assert len(waiting) == 1
    waiting.succeeded("pump-7")
    assert len(waiting) == 0
    assert waiting.failed("pump-7") == 0.0


def test_a_late_sample_takes_nothing_from_a_run_whose_blocks_were_damaged(plant: Database) -> None:
    writer = PromptWriter(plant, Collector(late_s=0.0))
    coast_down(writer, "pump-7", last=10)
    coast_down(writer, "pump-7", first=11, last=42)
    run = run_of(plant, "pump-7")
    assert (run.state, run.count) == (runs.CLOSED, 39)
    with plant.transaction() as session:
        row = session.scalars(select(SampleBlockRow).order_by(SampleBlockRow.id)).first()
        assert row is not None
        row.data = row.data[:-1]
    coast_down(writer, "pump-7", first=10, last=11)
    writer.settle(silence_s=3600.0)
    kept = run_of(plant, "pump-7")
    assert (kept.state, kept.count, kept.times_reopened) == (runs.CLOSED, 39, None)
    with plant.reading() as session:
        held = runs.samples(session, kept.id)
    assert held is not None
    assert len(held) == 39
    assert [one.reason for one in rejections(plant)] == ["damaged_block"]
