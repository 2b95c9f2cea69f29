"""Errors that nobody foresaw, and a database that goes away at the worst moment: one message's trouble is its own, what was
received stays, and whoever waits gets an answer."""

import time
from concurrent.futures import Future
from contextlib import ExitStack
from typing import Any

import pytest
import zenoh
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError, OperationalError

from service.ingest import ingest_thread as ingest_module
from service.ingest.ingest_thread import Ingest
from service.journal import single_writes
from service.journal.batch import ArrivedBatch, StoreOutcome
from service.journal.http_queue import NotStoring, Submissions
from service.journal.journal import Journal
from service.journal.sequence_gaps import SequenceGap
from service.journal.source_backoff import SourceBackoff
from service.journal.write_batch import WriteBatch
from service.recovery import gap_recovery as healing_module
from service.recovery import known_logs
from service.resilience import backoff as putting_off
from service.runs.collector import Collector
from service.sources.publisher import Source
from service.wire import MESSAGEPACK, encode_batch, encode_body, source_key
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements.quarantine import Rejection
from storage.measurements.samples import SourceKey
from storage.tables import CollectorRow, RevisionRow
from tests.failing_writes import refuse
from tests.plant import KEY, arrived, batch, machine, wait_until
from tests.service.ingest.plant_network import (
    Confused,
    DroppedOnTheWay,
    Edge,
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


def spoil(database: Database, name: str) -> None:
    """Where a machine's collection stands can no longer be told."""
    with database.transaction() as session:
        session.get_one(CollectorRow, name).state = {"revision": 1, "seen": "yesterday"}


def test_what_meets_an_unforeseen_error_is_put_aside_and_stops_nothing(
    plant: Database, ingest: Ingest, client: zenoh.Session
) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5)
    wait_until(lambda: received(plant) == 5)
    spoil(plant, KEY.machine)
    put_batch(client, 5, 10)
    put_batch(client, 0, 5, machine="pump-8")
    wait_until(lambda: received(plant) == 10)
    wait_until(lambda: rejected(plant).get("unexpected_error", 0) >= 1)
    assert {(row.machine_id, row.received) for row in rows(plant)} == {("pump-7", 5), ("pump-8", 5)}
    assert ingest.alive
    wait_until(lambda: ingest.trouble is None)


@pytest.mark.parametrize(("most_tries", "fewest"), [(50, 3), (1, 1)], ids=["again and again", "all of many at once"])
def test_a_machine_that_fails_is_put_off_and_caught_up_with(
    plant: Database,
    ingest: Ingest,
    client: zenoh.Session,
    edge: Edge,
    monkeypatch: pytest.MonkeyPatch,
    most_tries: int,
    fewest: int,
) -> None:
    """Its messages wait in its source's log: nothing is lost, and nobody else is held up by it."""
    monkeypatch.setattr(putting_off, "FIRST_PAUSE_S", 0.5)
    monkeypatch.setattr(single_writes, "MOST_TRIES", most_tries)
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    wait_until(lambda: heard(client))
    edge.publish(5)
    wait_until(lambda: received(plant) == 5)
    with plant.transaction() as session:
        standing = session.get_one(CollectorRow, KEY.machine).state
    spoil(plant, KEY.machine)
    paused: list[SourceKey] = []
    ingest._cycle.backoff.call_on_pause(paused.append)
    while not paused:
        edge.publish(1)
        time.sleep(0.15)
    assert edge.source.sequence < 30
    with plant.transaction() as session:
        session.get_one(CollectorRow, KEY.machine).state = standing
    put_batch(client, 0, 5, machine="pump-8")
    edge.publish(3)
    wait_until(lambda: received(plant) == 5 + edge.source.sequence)
    assert counts_of(plant, KEY.machine) == (edge.source.sequence, edge.source.sequence)
    assert fewest <= rejected(plant)["unexpected_error"] <= edge.source.sequence


def test_what_was_counted_as_lost_is_asked_for_again_after_a_machine_was_put_off(
    plant: Database, ingest: Ingest, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(healing_module, "PATIENCE_S", 0.3)
    monkeypatch.setattr(known_logs, "SILENCE_S", 3600.0)
    monkeypatch.setattr(putting_off, "FIRST_PAUSE_S", 0.5)
    monkeypatch.setattr(single_writes, "MOST_TRIES", 1)
    lossy.leave_a_gap(plant)
    with plant.transaction() as session:
        standing = session.get_one(CollectorRow, KEY.machine).state
    spoil(plant, KEY.machine)
    lossy.come()
    wait_until(lambda: rejected(plant).get("unexpected_error", 0) > 0)
    wait_until(lambda: not ingest._cycle.backoff.accepts(source_key(lossy.log[0])))
    with plant.transaction() as session:
        session.get_one(CollectorRow, KEY.machine).state = standing
    wait_until(lambda: counts(plant) == (20, 20, 0))


def test_a_batch_over_http_that_cannot_be_looked_at_holds_up_no_other(router: zenoh.Session, plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
        session.scalars(select(RevisionRow).where(RevisionRow.machine_id == KEY.machine)).one().document = {}
    submissions = Submissions()
    with ExitStack() as until:
        ingest = running(router, Journal(plant, Collector()), submissions, until)
        for _ in range(3):
            with pytest.raises(NotStoring, match="log has it"):
                offer(submissions, KEY.machine)
        assert offer(submissions, "pump-8").received == 5
        assert ingest.trouble is None
    assert rejected(plant) == {"unexpected_error": 3}


def test_a_source_that_fails_over_http_is_put_off_and_no_other(router: zenoh.Session, plant: Database) -> None:
    submissions = Submissions()
    with ExitStack() as until:
        ingest = running(router, Partial(plant, Collector()), submissions, until)
        for _ in range(3):
            with pytest.raises(NotStoring, match="log has it"):
                offer(submissions, KEY.machine, source="failing")
        with pytest.raises(NotStoring, match="source 'failing' of machine 'pump-7'; it is tried again later"):
            offer(submissions, KEY.machine, source="failing")
        assert offer(submissions, KEY.machine, source="working").received == 5
        assert ingest.trouble is None
    assert rejected(plant) == {"unexpected_error": 3}


def offer(submissions: Submissions, name: str, **changes: Any) -> StoreOutcome:
    """What becomes of five samples of a machine."""
    body = encode_body(batch([900.0] * 5, machine=name, **changes), MESSAGEPACK)
    return submissions.offer(name, body, MESSAGEPACK).result(10.0)


class Partial(Journal):
    """Meets an error that nobody foresaw where it stores what one source sends, until it is mended."""

    broken = True

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if self.broken and any(one.batch.source == "failing" for one in arrived):
            raise ZeroDivisionError("a fault of ours")
        return super().store(arrived, rejections, **more)


def test_one_source_of_a_machine_is_put_off_and_caught_up_with_while_the_other_goes_on(
    router: zenoh.Session, plant: Database, client: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where it has fallen silent by then."""
    monkeypatch.setattr(putting_off, "FIRST_PAUSE_S", 0.5)
    journal = Partial(plant, Collector())
    with ExitStack() as until:
        ingest = running(router, journal, Submissions(), until)
        failing, working = (Edge(until.enter_context(Source(client, KEY, name=name))) for name in ("failing", "working"))
        wait_until(lambda: heard(client))
        while ingest._cycle.backoff.accepts(SourceKey(KEY.machine, "failing", failing.source.log.epoch)):
            failing.publish(1)
            working.publish(1)
            time.sleep(0.15)
        assert failing.source.sequence < 30
        working.publish(5)
        wait_until(lambda: received(plant) == working.source.sequence)
        journal.broken = False
        wait_until(lambda: received(plant) == working.source.sequence + failing.source.sequence)
        assert ingest.trouble is None
    assert {row.source: row.lost for row in rows(plant)} == {"failing": 0, "working": 0}


class AwayForOne(Partial):
    """The database goes away, once, where what the other source sends is stored by itself."""

    away = True

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if self.away and [one.batch.source for one in arrived] == ["working"]:
            self.away = False
            raise AWAY
        return super().store(arrived, rejections, **more)


class Forgetful(Journal):
    """Cannot tell how far one source has come."""

    def next_sequence(self, source: SourceKey) -> int:
        if source.source.startswith("failing"):
            raise ZeroDivisionError("a fault of ours")
        return super().next_sequence(source)


def test_a_source_of_which_nothing_can_be_told_stops_no_other(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    submissions = Submissions()
    with ExitStack() as until:
        ingest = running(router, Forgetful(plant, Collector()), submissions, until)
        wait_until(lambda: heard(client))
        for number in range(5):
            put_batch(client, 5 * number, 5 * number + 5, source="failing")
            put_batch(client, 5 * number, 5 * number + 5, source="working")
            with pytest.raises(NotStoring, match="log has it"):
                offer(submissions, KEY.machine, source="failing")
            assert ingest.trouble is None
        wait_until(lambda: received(plant) == 25)
    assert rejected(plant) == {"unexpected_error": 10}


def test_sources_with_logs_of_which_nothing_can_be_told_stop_no_other(
    router: zenoh.Session, plant: Database, client: zenoh.Session, lossy: DroppedOnTheWay
) -> None:
    with ExitStack() as until:
        ingest = running(router, Forgetful(plant, Collector()), Submissions(), until)
        for number in range(3):
            Edge(until.enter_context(Source(client, KEY, name=f"failing-{number}"))).publish(5)
        wait_until(lambda: heard(client))
        for _ in range(20):
            lossy.publish(dropped=True)
            time.sleep(0.1)
            assert ingest.trouble is None
        wait_until(lambda: received(plant) == 100)


class Interrupted(Journal):
    """Cannot tell what is missing once, for the database is away."""

    interrupted = False

    def sequence_gaps(self, source: SourceKey) -> list[SequenceGap]:
        if self.interrupted:
            self.interrupted = False
            raise AWAY
        return super().sequence_gaps(source)


def test_a_question_for_what_was_lost_outlives_a_database_that_goes_away(
    router: zenoh.Session, plant: Database, client: zenoh.Session, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(healing_module, "PATIENCE_S", 0.3)
    monkeypatch.setattr(known_logs, "SILENCE_S", 3600.0)
    journal = Interrupted(plant, Collector())
    with ExitStack() as until:
        running(router, journal, Submissions(), until)
        wait_until(lambda: heard(client))
        lossy.publish()
        wait_until(lambda: received(plant) == 5)
        lossy.leave()
        for dropped in (True, True, False):
            lossy.publish(dropped=dropped)
        wait_until(lambda: counts(plant) == (20, 10, 10))
        journal.interrupted = True
        lossy.come()
        wait_until(lambda: counts(plant) == (20, 20, 0))
    assert not journal.interrupted


class NeverClosing(Journal):
    """Cannot close runs, for the database refuses."""

    def end_silent(self, **_: object) -> None:
        raise AWAY


def test_logs_are_asked_though_runs_cannot_be_closed(
    router: zenoh.Session, plant: Database, client: zenoh.Session, lossy: DroppedOnTheWay
) -> None:
    with ExitStack() as until:
        ingest = running(router, NeverClosing(plant, Collector()), Submissions(), until)
        wait_until(lambda: heard(client))
        lossy.publish()
        wait_until(lambda: received(plant) == 5)
        lossy.publish(dropped=True)
        wait_until(lambda: received(plant) == 10)
        assert ingest.trouble == "runs cannot be ended: the server went away"


def test_what_was_left_untried_is_held_where_storing_one_by_one_is_interrupted(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(single_writes, "MOST_TRIES", 1)
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


class FirstThreeFail(Journal):
    """Meets an error that nobody foresaw with what a source sent first."""

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if any(one.batch.sequence < 15 for one in arrived):
            raise ZeroDivisionError("a fault of ours")
        return super().store(arrived, rejections, **more)


def test_behind_many_that_cannot_be_stored_those_that_can_are_reached(
    router: zenoh.Session, plant: Database, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(putting_off, "FIRST_PAUSE_S", 0.2)
    monkeypatch.setattr(single_writes, "MOST_TRIES", 1)
    for _ in range(6):
        lossy.publish(dropped=True)
    with ExitStack() as until:
        running(router, FirstThreeFail(plant, Collector()), Submissions(), until)
        wait_until(lambda: received(plant) == 15)
    assert counts(plant) == (30, 15, 15)


class Failing(Journal):
    """Meets these errors when it stores, one each time, then none."""

    def __init__(self, database: Database, *errors: Exception) -> None:
        super().__init__(database, Collector())
        self.errors = list(errors)

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], **more: Any) -> list[StoreOutcome]:
        if arrived and self.errors:
            raise self.errors.pop(0)
        return super().store(arrived, rejections, **more)


def running(router: zenoh.Session, journal: Journal, submissions: Submissions, until: ExitStack) -> Ingest:
    ingest = Ingest(router, journal, silence_s=60.0, submissions=submissions)
    ingest.start()
    until.callback(ingest.stop)
    return ingest


HELD = IntegrityError("INSERT", {}, Exception("a constraint"))
AWAY = OperationalError("INSERT", {}, Exception("the server went away"))


def test_a_database_that_goes_away_while_messages_are_stored_one_by_one(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    journal, submissions = Failing(plant, HELD, AWAY, AWAY), Submissions()
    with ExitStack() as until:
        ingest = running(router, journal, submissions, until)
        wait_until(lambda: heard(client))
        for source in ("one", "other"):
            put(client, encode_batch(batch([900.0] * 5, source=source)))
        wait_until(lambda: received(plant) == 10)
        assert ingest.alive
        assert journal.errors == []
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


def test_a_message_that_cannot_be_looked_at_is_put_aside_by_itself(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    with ExitStack() as until:
        ingest = running(router, Confused(plant, Collector()), Submissions(), until)
        wait_until(lambda: heard(client))
        for number in range(5):
            put_batch(client, 0, 5, machine="pump-9", source=f"source-{number}")
            put_batch(client, 5 * number, 5 * number + 5)
        wait_until(lambda: received(plant) == 25)
        assert ingest.trouble is None
    assert rejected(plant) == {"unexpected_error": 5}


class Blind(Journal):
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
        with pytest.raises(NotStoring, match="went away"):
            submissions.offer(KEY.machine, encode_body(batch(), MESSAGEPACK), MESSAGEPACK).result(10.0)


def counts_of(database: Database, name: str) -> tuple[int, int]:
    """Next sequence and received of a machine's only source."""
    (row,) = (row for row in rows(database) if row.machine_id == name)
    return row.next_sequence, row.received


def received_of(database: Database) -> dict[str, tuple[int, int]]:
    """Next sequence and received of each source."""
    return {row.source: (row.next_sequence, row.received) for row in rows(database)}


def test_a_stop_waits_for_no_log_and_leaves_it_what_follows(
    router: zenoh.Session, plant: Database, client: zenoh.Session, edge: Edge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(healing_module, "PATIENCE_S", 3600.0)
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


class AwayAtTheEnd(Journal):
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
    journal = AwayAtTheEnd(plant, tries)
    with ExitStack() as until:
        ingest = running(router, journal, Submissions(), until)
        wait_until(lambda: heard(client))
        put_batch(client, 0, 5)
        wait_until(lambda: ingest.trouble is not None)
        journal.ending = True
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
    held.store()
    assert sorted(rejected(plant)) == ["unknown_unit", "wrong_shape"]
