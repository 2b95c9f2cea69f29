"""Batches of a transaction that failed are stored one by one in short turns: between them ingest goes on, in order, and
nothing that was taken is lost or answered twice."""

import time
from concurrent.futures import Future
from contextlib import ExitStack
from typing import Any

import pytest
import zenoh
from sqlalchemy.exc import OperationalError

from service.ingest.ingest_thread import Ingest
from service.replication.work_share import lease_of
from service.runs.collector import Collector
from service.write_path import single_writes, write_batch
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.http_queue import NotStoring
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.engine import Database
from storage.measurements.quarantine import Rejection
from tests.plant import KEY, SECOND, START, arrived, batch, wait_until
from tests.service.ingest.plant_network import counts, heard, put_batch, received, rows

AWAY = OperationalError("INSERT", {}, Exception("the server went away"))


class OnlyAlone(SampleWriter):
    """Cannot store several batches at once, nor any of a source that fails; once it is away where it stores one."""

    def __init__(self, database: Database, *, seconds: float = 0.0) -> None:
        super().__init__(database, Collector())
        self.seconds = seconds
        self.alone: list[tuple[str, int]] = []
        self.away = False

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if len(arrived) > 1 or any(one.batch.source == "failing" for one in arrived):
            raise ZeroDivisionError("a fault of ours")
        if arrived and self.away:
            self.away = False
            raise AWAY
        self.alone += [(one.batch.source, one.batch.sequence) for one in arrived]
        if arrived:
            time.sleep(self.seconds)  # a slow disk
        return super().store(arrived, rejections, **more)


@pytest.fixture
def backoff() -> SourceBackoff:
    return SourceBackoff()


@pytest.fixture
def writer(plant: Database) -> OnlyAlone:
    return OnlyAlone(plant)


@pytest.fixture
def held(writer: OnlyAlone, backoff: SourceBackoff, monkeypatch: pytest.MonkeyPatch) -> WriteBatch:
    """A write batch that stores one batch in a turn."""
    monkeypatch.setattr(write_batch, "LONGEST_TURN_S", 0.0)
    return WriteBatch(writer, backoff)


def one(sequence: int, source: str = "monitor") -> ArrivedBatch:
    return arrived(batch([900.0], sequence=sequence, start=START + sequence * SECOND, source=source))


def take(held: WriteBatch, first: int, last: int, source: str = "monitor") -> list[Future[StoreOutcome]]:
    """Hold batches of one sample each, for all of which somebody waits."""
    promises: list[Future[StoreOutcome]] = []
    for sequence in range(first, last):
        promises.append(Future())
        held.take(one(sequence, source), promises[-1])
    return promises


def turns_until_stored(held: WriteBatch) -> int:
    turns = 0
    while held.is_pending:
        held.store()
        turns += 1
    return turns


def test_a_turn_ends_when_its_time_is_over_and_what_comes_meanwhile_follows_in_order(
    plant: Database, writer: OnlyAlone, held: WriteBatch
) -> None:
    promises = take(held, 0, 5)
    held.store()
    assert (len(writer.alone), len(held)) == (1, 4)
    later = take(held, 5, 6)
    held.store()
    assert (len(writer.alone), len(held)) == (2, 4)
    assert turns_until_stored(held) == 4
    assert writer.alone == [("monitor", sequence) for sequence in range(6)]
    assert [promise.result(0.0).received for promise in promises + later] == [1] * 6
    assert counts(plant) == (6, 6, 0)


def test_as_much_is_stored_in_a_turn_as_there_is_time_for(
    plant: Database, writer: OnlyAlone, held: WriteBatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(write_batch, "LONGEST_TURN_S", 60.0)
    take(held, 0, 10)
    held.store()
    assert (len(writer.alone), len(held)) == (10, 0)
    assert received(plant) == 10


def test_what_a_source_sent_while_it_failed_is_left_to_its_log_when_it_is_paused(
    plant: Database, held: WriteBatch, backoff: SourceBackoff, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(single_writes, "MAXIMUM_TRIES", 1)
    tried, untried = take(held, 0, 2, "failing")
    others = take(held, 0, 3)
    held.store()
    (late,) = take(held, 2, 3, "failing")
    turns_until_stored(held)
    assert not backoff.accepts(one(0, "failing").source)
    for promise in (tried, untried, late):
        assert isinstance(promise.exception(0.0), NotStoring)
    assert [promise.result(0.0).received for promise in others] == [1] * 3
    assert {row.source: row.received for row in rows(plant)} == {"monitor": 3}


def test_a_database_that_goes_away_between_two_turns_loses_nothing(
    plant: Database, writer: OnlyAlone, held: WriteBatch
) -> None:
    promises = take(held, 0, 4)
    held.store()
    writer.away = True
    with pytest.raises(OperationalError):
        held.store()
    assert len(held) == 3
    held.fail_waiting(NotStoring("the server went away"))
    turns_until_stored(held)
    assert promises[0].result(0.0).received == 1
    for promise in promises[1:]:
        assert isinstance(promise.exception(0.0), NotStoring)
    assert counts(plant) == (4, 4, 0)


def test_promises_that_are_broken_between_two_turns_are_not_answered_again(plant: Database, held: WriteBatch) -> None:
    promises = take(held, 0, 3)
    held.store()
    held.fail_waiting(NotStoring("the server went away"))
    turns_until_stored(held)
    assert [promise.exception(0.0) is None for promise in promises] == [True, False, False]
    assert counts(plant) == (3, 3, 0)


def test_machines_that_are_taken_over_between_two_turns_are_let_go_of(plant: Database, held: WriteBatch) -> None:
    promises = take(held, 0, 3)
    held.store()
    held.drop([lease_of(KEY.machine)])
    assert not held.is_pending
    assert [promise.exception(0.0) is None for promise in promises] == [True, False, False]
    assert counts(plant) == (1, 1, 0)


def test_refusals_are_answered_once_they_are_kept_one_a_turn(plant: Database, held: WriteBatch) -> None:
    refused: list[Future[StoreOutcome]] = [Future() for _ in range(3)]
    for number, promise in enumerate(refused):
        held.refusals.quarantine(one(number), LookupError("no such thing"), promise)
    take(held, 10, 12)
    held.store()  # together, which fails; then two rejections and a batch
    assert not any(promise.done() for promise in refused)
    turns_until_stored(held)
    for promise in refused:
        assert isinstance(promise.exception(0.0), NotStoring)
    assert received(plant) == 2


def test_ingest_goes_on_while_batches_are_stored_one_by_one(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    """Sixty of 0.03 s each: in one go they would hold up a cycle for nearly all the time that they take together."""
    writer = OnlyAlone(plant, seconds=0.03)
    ingest = Ingest(router, writer, silence_s=60.0)
    with ExitStack() as until:
        ingest.start()
        until.callback(ingest.stop)
        wait_until(lambda: heard(client))
        began = time.monotonic()
        for number in range(60):
            put_batch(client, number, number + 1)
        wait_until(lambda: len(writer.alone) >= 5)
        answers = [answer for answer in client.get(KEY.received, timeout=5.0) if answer.ok is not None]
        assert len(answers) == 1
        assert len(writer.alone) < 60, "it was answered when all were stored"
        wait_until(lambda: received(plant) == 60)
        took = time.monotonic() - began
        assert ingest.trouble is None
        assert ingest.gauges["rundown_ingest_longest_cycle_seconds"] < took / 2
    assert counts(plant) == (60, 60, 0)
