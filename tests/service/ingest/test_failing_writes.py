"""Writes that fail, and a database that goes away at the worst moment: what was received stays, who waits is answered."""

from concurrent.futures import Future
from contextlib import ExitStack
from typing import Any

import pytest
import zenoh
from sqlalchemy.exc import IntegrityError, OperationalError

from formats.wire import MESSAGEPACK, encode_batch, encode_body
from service.ingest import ingest_thread as ingest_module
from service.recovery import gap_recovery as recovery_module
from service.resilience import backoff as backoff_module
from service.runs.collector import Collector
from service.write_path import single_writes
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.http_queue import NotStoring, Submissions
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.measurements.quarantine import Rejection
from tests.failing_writes import refuse
from tests.plant import KEY, arrived, batch, wait_until
from tests.service.ingest.failing_writers import AWAY, AwayForOne, running
from tests.service.ingest.plant_network import (
    DroppedOnTheWay,
    FailingWriter,
    PublishingEdge,
    counts,
    heard,
    ingesting,
    put,
    put_batch,
    received,
    rejected,
    rows,
)


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)


def test_what_was_left_untried_is_held_where_storing_one_by_one_is_interrupted(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(single_writes, "MAXIMUM_TRIES", 1)
    paused: list[SourceKey] = []
    backoff = SourceBackoff()
    backoff.call_on_pause(paused.append)
    waiting = WriteBatch(AwayForOne(plant, Collector()), backoff)
    for number in range(3):
        waiting.take(arrived(batch([900.0], sequence=number, source="failing")))
    waiting.take(arrived(batch([900.0], source="working")))
    with pytest.raises(OperationalError):
        waiting.store()
    waiting.store()
    assert [source.source for source in paused] == ["failing"]
    assert not backoff.accepts(paused[0])
    assert {row.source: row.received for row in rows(plant)} == {"working": 1}


class FirstThreeFail(SampleWriter):
    """Meets an error that nobody foresaw with what a source sent first."""

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if any(one.batch.sequence < 15 for one in arrived):
            raise ZeroDivisionError("a fault of ours")
        return super().store(arrived, rejections, **more)


def test_behind_many_that_cannot_be_stored_those_that_can_are_reached(
    router: zenoh.Session, plant: Database, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(backoff_module, "FIRST_PAUSE_S", 0.2)
    monkeypatch.setattr(single_writes, "MAXIMUM_TRIES", 1)
    for _ in range(6):
        lossy.publish(dropped=True)
    with ExitStack() as until:
        running(router, FirstThreeFail(plant, Collector()), Submissions(), until)
        wait_until(lambda: received(plant) == 15)
    assert counts(plant) == (30, 15, 15)


class Failing(SampleWriter):
    """Meets these errors when it stores, one each time, then none."""

    def __init__(self, database: Database, *errors: Exception) -> None:
        super().__init__(database, Collector())
        self.errors = list(errors)

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if arrived and self.errors:
            raise self.errors.pop(0)
        return super().store(arrived, rejections, **more)


HELD = IntegrityError("INSERT", {}, Exception("a constraint"))


def test_a_database_that_goes_away_while_messages_are_stored_one_by_one(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    writer, submissions = Failing(plant, HELD, AWAY, AWAY), Submissions()
    with ExitStack() as until:
        ingest = running(router, writer, submissions, until)
        wait_until(lambda: heard(client))
        for source in ("one", "other"):
            put(client, encode_batch(batch([900.0] * 5, source=source)))
        wait_until(lambda: received(plant) == 10)
        assert ingest.alive
        assert writer.errors == []
        assert rejected(plant) == {}
        wait_until(lambda: ingest.trouble is None)


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        pytest.param((AWAY,), NotStoring, id="the database is away"),
        pytest.param((RuntimeError("a fault of ours"), RuntimeError("again")), NotStoring, id="unforeseen"),
        pytest.param((HELD, AWAY), NotStoring, id="away between"),
    ],
)
def test_whoever_waits_over_http_is_answered(
    router: zenoh.Session, plant: Database, errors: tuple[Exception, ...], expected: type[Exception]
) -> None:
    submissions = Submissions()
    with ExitStack() as until:
        ingest = running(router, Failing(plant, *errors), submissions, until)
        body = encode_body(batch([900.0] * 5), MESSAGEPACK)
        with pytest.raises(expected):
            submissions.offer(KEY.machine, body, MESSAGEPACK).result(10.0)
        wait_until(lambda: ingest.trouble is None and submissions.trouble is None)
        again: Future[StoreOutcome] = submissions.offer(KEY.machine, body, MESSAGEPACK)
        outcome = again.result(10.0)
        assert outcome.received + outcome.duplicates == 5
    assert counts(plant) == (5, 5, 0)


def test_a_message_that_cannot_be_checked_is_put_aside_by_itself(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    with ExitStack() as until:
        ingest = running(router, FailingWriter(plant, Collector()), Submissions(), until)
        wait_until(lambda: heard(client))
        for number in range(5):
            put_batch(client, 0, 5, machine="pump-9", source=f"source-{number}")
            put_batch(client, 5 * number, 5 * number + 5)
        wait_until(lambda: received(plant) == 25)
        assert ingest.trouble is None
    assert rejected(plant) == {"unexpected_error": 5}


class Blind(SampleWriter):
    """Cannot look something up the first time."""

    blind = True

    def plant_of(self, machine_id: str) -> str | None:
        if self.blind:
            self.blind = False
            raise AWAY
        return super().plant_of(machine_id)


def test_a_message_that_was_in_hand_when_the_database_went_away_is_not_dropped(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    with ExitStack() as until:
        running(router, Blind(plant, Collector()), Submissions(), until)
        wait_until(lambda: heard(client))
        put_batch(client, 0, 5)
        wait_until(lambda: received(plant) == 5)


def test_a_batch_that_was_in_hand_when_the_database_went_away_is_answered(router: zenoh.Session, plant: Database) -> None:
    submissions = Submissions()
    with ExitStack() as until:
        running(router, Blind(plant, Collector()), submissions, until)
        with pytest.raises(NotStoring, match="Exception of PostgreSQL"):
            submissions.offer(KEY.machine, encode_body(batch(), MESSAGEPACK), MESSAGEPACK).result(10.0)


def received_of(database: Database) -> dict[str, tuple[int, int]]:
    """Next sequence and received of each source."""
    return {row.source: (row.next_sequence, row.received) for row in rows(database)}


def test_a_stop_waits_for_no_log_and_leaves_it_what_follows(
    router: zenoh.Session, plant: Database, client: zenoh.Session, edge: PublishingEdge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recovery_module, "PATIENCE_S", 3600.0)
    with ingesting(router, plant) as ingest:
        wait_until(lambda: heard(client))
        edge.publish(5)
        wait_until(lambda: received(plant) == 5)
        source, epoch = edge.source.name, edge.source.log.epoch
        put_batch(client, 100, 105, source=source, epoch=epoch)
        put_batch(client, 100, 105, source="without-a-log")
        put_batch(client, 0, 5, source="seen")
        wait_until(lambda: received(plant) == 10)
    assert not ingest.alive
    assert received_of(plant) == {source: (5, 5), "seen": (5, 5), "without-a-log": (105, 5)}


class AwayAtTheEnd(SampleWriter):
    """Its database is away until the service ends, and then for so many tries more."""

    def __init__(self, database: Database, tries: int) -> None:
        super().__init__(database, Collector())
        self.tries, self.ending = tries, False

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if arrived and (not self.ending or self.tries > 0):
            self.tries -= self.ending
            raise AWAY
        return super().store(arrived, rejections, **more)


@pytest.mark.parametrize(("tries", "stored"), [(1, 5), (1_000, 0)])
def test_what_the_database_refuses_at_the_end_is_tried_once_more(
    router: zenoh.Session,
    plant: Database,
    client: zenoh.Session,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    tries: int,
    stored: int,
) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.5)
    writer = AwayAtTheEnd(plant, tries)
    with ExitStack() as until:
        ingest = running(router, writer, Submissions(), until)
        wait_until(lambda: heard(client))
        put_batch(client, 0, 5)
        wait_until(lambda: ingest.trouble is not None)
        writer.ending = True
    assert received(plant) == stored
    assert ("1 messages are not stored" in caplog.text) == (stored == 0)


def test_a_rejection_that_cannot_be_kept_takes_no_other_with_it(plant: Database) -> None:
    held = WriteBatch(Failing(plant), SourceBackoff())
    for reason in ("unknown_unit", "unexpected_error", "wrong_shape"):
        held.refusals.reject(
            Rejection.of_message(received_at=0, key="k", machine_id=None, reason=reason, detail="", payload=b"")
        )
    with plant.transaction() as session:
        refuse(session, "quarantine", write="INSERT", when="NEW.reason = 'unexpected_error'")
    held.store_all()  # a turn ends after a tenth of a second
    assert sorted(rejected(plant)) == ["unknown_unit", "wrong_shape"]
