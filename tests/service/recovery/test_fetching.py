"""Tests that what is missing is fetched from the source's log, once it shows; what cannot be fetched is counted."""

import threading
import time
from functools import partial

import pytest
import zenoh

from formats.wire import MESSAGEPACK, Key, encode_batch
from service.ingest import periodic_checks
from service.ingest.ingest_thread import Ingest
from service.sources.publisher import Source
from service.sources.replay_log import MemoryLog
from service.write_path.sequence_gaps import NEVER, SequenceGap
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import KEY, SECOND, START, arrived, batch, machine, wait_until
from tests.service.ingest.plant_network import (
    DroppedOnTheWay,
    PublishingEdge,
    Surroundings,
    counts,
    heard,
    ingesting,
    put_batch,
    received,
    rejected,
    rows,
    stored_times,
)


def test_what_is_published_is_stored(plant: Database, ingest: Ingest, client: zenoh.Session, edge: PublishingEdge) -> None:
    wait_until(lambda: heard(client))
    edge.publish(5, 3, 2)
    wait_until(lambda: received(plant) == 10)
    assert stored_times(plant) == list(range(10))
    assert counts(plant) == (10, 10, 0)
    assert ingest.alive
    assert ingest.trouble is None


def test_what_was_published_before_the_service_came_is_fetched(
    router: zenoh.Session, plant: Database, edge: PublishingEdge
) -> None:
    edge.publish(5, 5, 5)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 15)
    assert stored_times(plant) == list(range(15))
    assert counts(plant) == (15, 15, 0)


def test_what_was_published_while_the_service_was_away_is_fetched(
    router: zenoh.Session, client: zenoh.Session, plant: Database, edge: PublishingEdge
) -> None:
    with ingesting(router, plant):
        wait_until(lambda: heard(client))
        edge.publish(5)
        wait_until(lambda: received(plant) == 5)
    edge.publish(4, 4)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 13)
        edge.publish(3)
        wait_until(lambda: received(plant) == 16)
    assert stored_times(plant) == list(range(16))
    assert counts(plant) == (16, 16, 0)


def test_messages_that_the_network_dropped_are_fetched_when_the_gap_shows(
    router: zenoh.Session,
    client: zenoh.Session,
    plant: Database,
    lossy: DroppedOnTheWay,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Quiet sources are not looked at: the gap alone must bring what is missing, and in order."""
    monkeypatch.setattr(periodic_checks, "TAIL_CHECK_S", 3600.0)
    with ingesting(router, plant):
        wait_until(lambda: heard(client))
        for dropped in (False, False, True, True, False, True, False):
            lossy.publish(dropped=dropped)
        wait_until(lambda: received(plant) == 35)
    assert stored_times(plant) == list(range(35))
    assert counts(plant) == (35, 35, 0)


@pytest.mark.usefixtures("ingest")
def test_the_last_messages_are_fetched_from_a_source_that_fell_quiet(
    client: zenoh.Session, plant: Database, lossy: DroppedOnTheWay
) -> None:
    """Nothing follows them that would show the gap."""
    wait_until(lambda: heard(client))
    lossy.publish()
    wait_until(lambda: received(plant) == 5)
    for _ in range(2):
        lossy.publish(dropped=True)
    wait_until(lambda: received(plant) == 15)
    assert stored_times(plant) == list(range(15))
    assert counts(plant) == (15, 15, 0)


@pytest.mark.usefixtures("ingest")
def test_a_restarted_source_is_another_one(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))

    def has_received(count: int) -> bool:
        return received(plant) == count

    for start, expected in ((0, 5), (100, 10)):
        with Source(client, KEY, name="edge") as source:
            source.publish(batch([900.0] * 5, start=START + start * SECOND))
            wait_until(partial(has_received, expected))
    assert [(row.next_sequence, row.lost) for row in rows(plant)] == [(5, 0), (5, 0)]


def test_only_what_the_log_no_longer_holds_is_lost(router: zenoh.Session, plant: Database, client: zenoh.Session) -> None:
    with Source(client, KEY, name="edge", log=MemoryLog(samples=6)) as source:
        PublishingEdge(source).publish(*[2] * 10)
        time.sleep(0.5)  # what is still on its way would reach the service after all
        with ingesting(router, plant):
            wait_until(lambda: received(plant) == 6)
    assert counts(plant) == (20, 6, 14)


def test_what_a_log_could_not_tell_while_it_was_away_is_asked_for_when_it_is_back(
    router: zenoh.Session, client: zenoh.Session, plant: Database, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed right behind a gap: the gap is counted as lost, and is no longer when the source is started again."""
    monkeypatch.setattr("service.recovery.gap_recovery.PATIENCE_S", 0.3)
    with ingesting(router, plant):
        wait_until(lambda: heard(client))
        lossy.publish()
        wait_until(lambda: received(plant) == 5)
        lossy.leave()
        for dropped in (True, True, False, True, False):
            lossy.publish(dropped=dropped)
        wait_until(lambda: counts(plant) == (30, 15, 15))
        lossy.come()
        wait_until(lambda: counts(plant) == (30, 30, 0))
    assert stored_times(plant) == list(range(30))


def test_a_log_that_was_mute_while_its_source_was_connected_is_asked_again(
    router: zenoh.Session, client: zenoh.Session, plant: Database, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Frozen for some seconds, say: nobody is told that it was away."""
    monkeypatch.setattr("service.recovery.gap_recovery.PATIENCE_S", 0.3)
    monkeypatch.setattr("service.recovery.known_logs.SILENCE_S", 1.0)
    with ingesting(router, plant):
        wait_until(lambda: heard(client))
        lossy.publish()
        wait_until(lambda: received(plant) == 5)
        lossy.queryable.undeclare()
        for dropped in (True, False, True, False):
            lossy.publish(dropped=dropped)
        wait_until(lambda: counts(plant) == (25, 15, 10))
        lossy.queryable = client.declare_queryable(KEY.log, lossy.answer)
        wait_until(lambda: counts(plant) == (25, 25, 0))
    assert stored_times(plant) == list(range(25))


@pytest.mark.usefixtures("ingest")
def test_the_last_messages_of_each_of_two_sources_of_a_machine_are_fetched(
    client: zenoh.Session, plant: Database, lossy: DroppedOnTheWay
) -> None:
    """The other one does not fall quiet."""
    wait_until(lambda: heard(client))
    with Source(client, KEY, name="other") as other:
        lossy.publish()
        for _ in range(2):
            lossy.publish(dropped=True)

        def fetched() -> bool:
            other.publish(batch([900.0], start=START + 1000 * SECOND + other.sequence))
            return 15 in [row.received for row in rows(plant) if row.source != "other"]

        wait_until(fetched)


def test_a_token_that_is_no_id_is_nobody(
    router: zenoh.Session, client: zenoh.Session, plant: Database, edge: PublishingEdge
) -> None:
    """A wildcard would ask every log for a machine that is none."""
    tokens = [client.liveliness().declare_token(f"rundown/v1/live/{name}") for name in ("*/*", "a b/c")]
    edge.publish(5)
    with ingesting(router, plant) as running:
        wait_until(lambda: received(plant) == 5)
        time.sleep(0.5)
        assert list(running._cycle.recovery.live) == [KEY]
    assert rejected(plant) == {}
    for token in tokens:
        token.undeclare()


def test_a_log_that_does_not_answer_holds_up_nobody_else(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its queries would last longer than the test."""
    monkeypatch.setattr("service.recovery.log_queries.REPLAY_TIMEOUT_S", 60.0)
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    mute = Key(KEY.plant, "pump-8")
    release = threading.Event()
    queryable = client.declare_queryable(mute.log, lambda _query: release.wait(60.0))
    token = client.liveliness().declare_token(mute.live)

    def has_received(count: int) -> bool:
        return received(plant) >= count

    with ingesting(router, plant):
        wait_until(lambda: heard(client))
        put_batch(client, 0, 5, machine="pump-8")
        put_batch(client, 10, 15, machine="pump-8")  # a hole that nobody will answer for
        for number in range(20):
            put_batch(client, 5 * number, 5 * number + 5)
            wait_until(partial(has_received, 5 * number + 10), seconds=2.0)
        release.set()
        token.undeclare()
        queryable.undeclare()


class DamagedLog(DroppedOnTheWay):
    """Its answers are damaged in their second batch, the first times it is asked for one."""

    damage = 2

    def answer(self, query: zenoh.Query) -> None:
        with query:
            first = int(query.parameters.get("from") or 0)
            for place, one in enumerate(one for one in self.log if one.sequence + 5 > first):
                payload = encode_batch(one)
                if place == 1 and self.damage > 0:
                    self.damage -= 1
                    payload = payload[:-1] + b"\xc1"
                query.reply(KEY.log, payload, encoding=MESSAGEPACK)


def test_a_damaged_reply_is_asked_for_again(router: zenoh.Session, client: zenoh.Session, plant: Database) -> None:
    source = DamagedLog(client)
    for _ in range(4):
        source.publish(dropped=True)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 20)
        assert counts(plant) == (20, 20, 0)
        assert stored_times(plant) == list(range(20))
        assert rejected(plant).keys() == {"bad_frame"}
    source.leave()


class ForgottenInTheMiddle(DroppedOnTheWay):
    """Its second batch is gone from the log for good."""

    def answer(self, query: zenoh.Query) -> None:
        with query:
            first = int(query.parameters.get("from") or 0)
            for one in [one for one in self.log if one.sequence + 5 > first and one.sequence != 5]:
                query.reply(KEY.log, encode_batch(one), encoding=MESSAGEPACK)


def test_a_gap_in_the_log_is_lost_and_the_rest_is_fetched(
    router: zenoh.Session, client: zenoh.Session, plant: Database
) -> None:
    source = ForgottenInTheMiddle(client)
    for _ in range(4):
        source.publish(dropped=True)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 15)
        assert counts(plant) == (20, 15, 5)
    source.leave()


@pytest.mark.usefixtures("ingest")
def test_batches_in_another_order_are_stored_in_theirs(client: zenoh.Session, plant: Database) -> None:
    wait_until(lambda: heard(client))
    for first in (0, 10, 15, 5, 25, 20):
        put_batch(client, first, first + 5)
    wait_until(lambda: received(plant) == 30)
    assert counts(plant) == (30, 30, 0)
    assert stored_times(plant) == list(range(30))


def test_many_quiet_sources_are_all_asked_though_few_at_a_time(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.recovery.log_queries.MAXIMUM_QUERIES", 2)
    names = [f"pump-{number}" for number in range(10, 20)]
    with plant.transaction() as session:
        for name in names:
            machines.create(session, machine(id=name))
    sources = [Source(client, Key(KEY.plant, name), name="edge") for name in names]
    for source in sources:
        source.publish(batch([900.0] * 5, machine=source.key.machine))
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 50)
        assert {row.received for row in rows(plant)} == {5}
        for source in sources:
            source.close()


class BusyLog(DroppedOnTheWay):
    """The first question for a hole is not answered, as by a log that is held up."""

    asked_for_holes = 0

    def answer(self, query: zenoh.Query) -> None:
        if query.parameters.get("limit") == "10":
            self.asked_for_holes += 1
            if self.asked_for_holes == 1:
                query.drop()
                return
        super().answer(query)


def test_a_log_that_does_not_answer_for_a_hole_is_asked_again(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.recovery.gap_recovery.PATIENCE_S", 0.3)
    monkeypatch.setattr("service.recovery.known_logs.SILENCE_S", 3600.0)
    monkeypatch.setattr("service.resilience.backoff.FIRST_PAUSE_S", 0.3)
    busy = BusyLog(client)
    with ingesting(router, plant):
        busy.leave_a_gap(plant)
        busy.come()
        wait_until(lambda: counts(plant) == (20, 20, 0))
    assert busy.asked_for_holes >= 2
    busy.leave()


class RecordingClient(DroppedOnTheWay):
    """Keeps what it was asked for: the first number, and how many batches."""

    def __init__(self, client: zenoh.Session) -> None:
        self.asked: list[tuple[int, int]] = []
        super().__init__(client)

    def answer(self, query: zenoh.Query) -> None:
        self.asked.append((int(query.parameters.get("from") or 0), int(query.parameters.get("limit") or 0)))
        super().answer(query)


def test_a_log_is_asked_for_a_part_at_a_time(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Answers of many logs at once must not fill the memory."""
    monkeypatch.setattr("service.recovery.log_queries.LARGEST_QUERY", 3)
    log = RecordingClient(client)
    for _ in range(10):
        log.publish(dropped=True)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 50)
    assert {0, 15, 30, 45} <= {first for first, _ in log.asked}
    assert max(limit for _, limit in log.asked) == min(limit for first, limit in log.asked if first) == 3
    log.leave()


def test_a_large_hole_is_asked_for_a_part_at_a_time(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.recovery.log_queries.LARGEST_QUERY", 1)
    monkeypatch.setattr("service.recovery.gap_recovery.PATIENCE_S", 0.3)
    monkeypatch.setattr("service.recovery.known_logs.SILENCE_S", 3600.0)
    log = RecordingClient(client)
    with ingesting(router, plant):
        log.leave_a_gap(plant)
        log.asked.clear()
        log.come()
        wait_until(lambda: counts(plant) == (20, 20, 0))
    assert {(5, 1), (10, 1)} <= set(log.asked)
    assert stored_times(plant) == list(range(20))
    log.leave()


class HeldBack(DroppedOnTheWay):
    """Answers nothing before it is let; what it was asked for is kept."""

    def __init__(self, client: zenoh.Session) -> None:
        self.let = threading.Event()
        self.asked: list[int] = []
        super().__init__(client)

    def answer(self, query: zenoh.Query) -> None:
        self.asked.append(int(query.parameters.get("from") or 0))
        self.let.wait(10.0)
        super().answer(query)


def test_gaps_that_show_while_older_ones_are_asked_for_are_asked_for_as_well(
    router: zenoh.Session, client: zenoh.Session
) -> None:
    log = HeldBack(client)
    gaps = [SequenceGap(10, 14, START, NEVER)]
    fetching = Surroundings(gaps=gaps, answer=arrived(batch([900.0] * 5, sequence=10))).recovery(router)
    for _ in range(20):
        log.publish(dropped=True)

    def comes() -> None:
        fetching.live.forget_sources()
        fetching.place(KEY, arrived(batch([900.0], sequence=99)))

    def asked_for(first: int) -> bool:
        fetching.check_tails(quiet_s=3600.0)
        fetching.collect(100)
        return first in log.asked

    def comes_and_is_asked() -> bool:
        comes()
        return asked_for(10)

    wait_until(comes_and_is_asked)
    gaps.append(SequenceGap(50, 54, START, NEVER))
    comes()
    log.let.set()
    wait_until(lambda: asked_for(50), seconds=10.0)
    log.leave()
