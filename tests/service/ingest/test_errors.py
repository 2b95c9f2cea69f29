"""Errors that nobody foresaw: one message's or one source's trouble is its own, and it is caught up with."""

import time
from contextlib import ExitStack
from typing import Any

import pytest
import zenoh
from sqlalchemy import select

from formats.wire import MESSAGEPACK, encode_body, source_key
from service.ingest import ingest_thread as ingest_module
from service.ingest.ingest_thread import Ingest
from service.recovery import gap_recovery as recovery_module
from service.recovery import known_logs
from service.resilience import backoff as backoff_module
from service.runs.collector import Collector
from service.sources.publisher import Source
from service.write_path import single_writes
from service.write_path.batch import StoreOutcome
from service.write_path.http_queue import NotStoring, Submissions
from service.write_path.sample_writer import SampleWriter
from service.write_path.sequence_gaps import SequenceGap
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.tables.machines import RevisionRow
from storage.tables.measurements import CollectorRow
from tests.plant import KEY, batch, machine, wait_until
from tests.service.ingest.failing_writers import AWAY, Partial, counts_of, running
from tests.service.ingest.plant_network import (
    DroppedOnTheWay,
    PublishingEdge,
    counts,
    heard,
    put_batch,
    received,
    rejected,
    rows,
)


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)


def spoil(database: Database, name: str) -> None:
    """Make it impossible to tell where a machine's collection stands."""
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
    edge: PublishingEdge,
    monkeypatch: pytest.MonkeyPatch,
    most_tries: int,
    fewest: int,
) -> None:
    """Its messages wait in its source's log: nothing is lost, and nobody else is held up by it."""
    monkeypatch.setattr(backoff_module, "FIRST_PAUSE_S", 0.5)
    monkeypatch.setattr(single_writes, "MAXIMUM_TRIES", most_tries)
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
    monkeypatch.setattr(recovery_module, "PATIENCE_S", 0.3)
    monkeypatch.setattr(known_logs, "SILENCE_S", 3600.0)
    monkeypatch.setattr(backoff_module, "FIRST_PAUSE_S", 0.5)
    monkeypatch.setattr(single_writes, "MAXIMUM_TRIES", 1)
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
        ingest = running(router, SampleWriter(plant, Collector()), submissions, until)
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
    """Return what becomes of five samples of a machine."""
    body = encode_body(batch([900.0] * 5, machine=name, **changes), MESSAGEPACK)
    return submissions.offer(name, body, MESSAGEPACK).result(10.0)


def test_one_source_of_a_machine_is_put_off_and_caught_up_with_while_the_other_goes_on(
    router: zenoh.Session, plant: Database, client: zenoh.Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where it has fallen silent by then."""
    monkeypatch.setattr(backoff_module, "FIRST_PAUSE_S", 0.5)
    writer = Partial(plant, Collector())
    with ExitStack() as until:
        ingest = running(router, writer, Submissions(), until)
        failing, working = (
            PublishingEdge(until.enter_context(Source(client, KEY, name=name))) for name in ("failing", "working")
        )
        wait_until(lambda: heard(client))
        while ingest._cycle.backoff.accepts(SourceKey(KEY.machine, "failing", failing.source.log.epoch)):
            failing.publish(1)
            working.publish(1)
            time.sleep(0.15)
        assert failing.source.sequence < 30
        working.publish(5)
        wait_until(lambda: received(plant) == working.source.sequence)
        writer.broken = False
        wait_until(lambda: received(plant) == working.source.sequence + failing.source.sequence)
        assert ingest.trouble is None
    assert {row.source: row.lost for row in rows(plant)} == {"failing": 0, "working": 0}


class Forgetful(SampleWriter):
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
            PublishingEdge(until.enter_context(Source(client, KEY, name=f"failing-{number}"))).publish(5)
        wait_until(lambda: heard(client))
        for _ in range(20):
            lossy.publish(dropped=True)
            time.sleep(0.1)
            assert ingest.trouble is None
        wait_until(lambda: received(plant) == 100)


class InterruptedWriter(SampleWriter):
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
    monkeypatch.setattr(recovery_module, "PATIENCE_S", 0.3)
    monkeypatch.setattr(known_logs, "SILENCE_S", 3600.0)
    writer = InterruptedWriter(plant, Collector())
    with ExitStack() as until:
        running(router, writer, Submissions(), until)
        wait_until(lambda: heard(client))
        lossy.publish()
        wait_until(lambda: received(plant) == 5)
        lossy.leave()
        for dropped in (True, True, False):
            lossy.publish(dropped=dropped)
        wait_until(lambda: counts(plant) == (20, 10, 10))
        writer.interrupted = True
        lossy.come()
        wait_until(lambda: counts(plant) == (20, 20, 0))
    assert not writer.interrupted


class NeverClosing(SampleWriter):
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
