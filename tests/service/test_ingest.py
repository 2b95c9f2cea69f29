"""Ingest over a real loopback network: what is missing is fetched from the source's log, what cannot be fetched is counted,
and nothing that arrives can stop it."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import pytest
import zenoh
from sqlalchemy import text

from service import ingest as ingest_module
from service.collection import Collector
from service.ingest import Ingest
from service.journal import Journal
from service.source import Source
from service.source_log import MemoryLog
from service.wire import ALL_SAMPLES, LARGEST_MESSAGE, MESSAGEPACK, Key, SampleBatch, encode_batch
from storage import machines, quarantine, runs
from storage import samples as sample_store
from storage.database import Database
from storage.tables import SourceRow
from tests.plant import KEY, SECOND, START, batch, listened_to, machine, sweep_rpm, wait_until
from tests.refusing import refuse

SAMPLES = "rundown/v1/plant-1/pump-7/samples"


@pytest.fixture(autouse=True)
def _impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Look at quiet sources often, so that no test waits long."""
    monkeypatch.setattr(ingest_module, "TAIL_CHECK_S", 0.1)


@contextmanager
def ingesting(router: zenoh.Session, database: Database, *, silence_s: float = 60.0) -> Iterator[Ingest]:
    """A service that takes in samples."""
    ingest = Ingest(router, Journal(database, Collector()), silence_s=silence_s)
    ingest.start()
    try:
        yield ingest
    finally:
        ingest.stop()


@pytest.fixture
def ingest(router: zenoh.Session, plant: Database) -> Iterator[Ingest]:
    """A service that runs before any source does."""
    with ingesting(router, plant) as running:
        yield running


def rows(database: Database) -> list[SourceRow]:
    with database.reading() as session:
        return list(sample_store.sources(session))


def received(database: Database) -> int:
    return sum(row.received for row in rows(database))


def counts(database: Database) -> tuple[int, int, int]:
    """Next sequence, received and lost of the only source."""
    (row,) = rows(database)
    return row.next_sequence, row.received, row.lost


def stored_times(database: Database) -> list[int]:
    """Whole seconds after the start."""
    with database.reading() as session:
        held = sample_store.latest(session, KEY.machine, revision=1, count=10_000)
    return [(moment - START) // SECOND for moment in held.time.tolist()]


def rejected(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return quarantine.counts(session)


class Edge:
    """A source of the machine that publishes samples at 900 r/min, a second apart."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def publish(self, *sizes: int) -> None:
        for size in sizes:
            self.source.publish(batch([900.0] * size, start=START + self.source.sequence * SECOND))


@pytest.fixture
def edge(client: zenoh.Session) -> Iterator[Edge]:
    with Source(client, KEY, name="edge") as source:
        yield Edge(source)


def heard(client: zenoh.Session) -> bool:
    """Whether what the client publishes goes out. Once it does it goes on doing so, also from one service to the next."""
    publisher = client.declare_publisher(SAMPLES)
    matching = listened_to(publisher)
    publisher.undeclare()
    return matching


def put(client: zenoh.Session, payload: bytes, *, key: str = SAMPLES, encoding: str = MESSAGEPACK) -> None:
    # Blocking: on a busy machine zenoh would let go of what waits behind a large message.
    client.put(key, payload, encoding=encoding, congestion_control=zenoh.CongestionControl.BLOCK)


def put_batch(client: zenoh.Session, first: int, last: int, **changes: Any) -> None:
    """Samples `first` to before `last` of a source that keeps no log."""
    one: SampleBatch = batch([900.0] * (last - first), sequence=first, start=START + first * SECOND, **changes)
    put(client, encode_batch(one), key=Key(one.plant, one.machine).samples)


# --- with a log -----------------------------------------------------------------------------------------------------


def test_what_is_published_is_stored(plant: Database, ingest: Ingest, client: zenoh.Session, edge: Edge) -> None:
    wait_until(lambda: heard(client))
    edge.publish(5, 3, 2)
    wait_until(lambda: received(plant) == 10)
    assert stored_times(plant) == list(range(10))
    assert counts(plant) == (10, 10, 0)
    assert ingest.alive
    assert ingest.trouble is None


def test_what_was_published_before_the_service_came_is_fetched(router: zenoh.Session, plant: Database, edge: Edge) -> None:
    edge.publish(5, 5, 5)
    with ingesting(router, plant):
        wait_until(lambda: received(plant) == 15)
    assert stored_times(plant) == list(range(15))
    assert counts(plant) == (15, 15, 0)


def test_what_was_published_while_the_service_was_away_is_fetched(
    router: zenoh.Session, client: zenoh.Session, plant: Database, edge: Edge
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


class DroppedOnTheWay:
    """A live source with a log, of whose messages the network delivers only some; five samples to a message."""

    def __init__(self, client: zenoh.Session) -> None:
        self.client = client
        self.log: list[SampleBatch] = []
        self.come()

    def come(self) -> None:
        self.queryable = self.client.declare_queryable(KEY.log, self.answer)
        self.token = self.client.liveliness().declare_token(KEY.live)

    def publish(self, *, dropped: bool = False) -> None:
        first = 5 * len(self.log)
        self.log.append(batch([900.0] * 5, sequence=first, start=START + first * SECOND))
        if not dropped:
            put(self.client, encode_batch(self.log[-1]))

    def answer(self, query: zenoh.Query) -> None:
        with query:
            first = int(query.parameters.get("from") or 0)
            for one in [one for one in self.log if one.sequence + 5 > first]:
                query.reply(KEY.log, encode_batch(one), encoding=MESSAGEPACK)

    def leave(self) -> None:
        self.token.undeclare()
        self.queryable.undeclare()


@pytest.fixture
def lossy(client: zenoh.Session) -> Iterator[DroppedOnTheWay]:
    source = DroppedOnTheWay(client)
    yield source
    source.leave()


def test_messages_that_the_network_dropped_are_fetched_when_the_gap_shows(
    router: zenoh.Session,
    client: zenoh.Session,
    plant: Database,
    lossy: DroppedOnTheWay,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Quiet sources are not looked at: the gap alone must bring what is missing, and in order."""
    monkeypatch.setattr(ingest_module, "TAIL_CHECK_S", 3600.0)
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
        Edge(source).publish(*[2] * 10)
        time.sleep(0.5)  # what is still on its way would reach the service after all
        with ingesting(router, plant):
            wait_until(lambda: received(plant) == 6)
    assert counts(plant) == (20, 6, 14)


def test_what_a_log_could_not_tell_while_it_was_away_is_asked_for_when_it_is_back(
    router: zenoh.Session, client: zenoh.Session, plant: Database, lossy: DroppedOnTheWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed right behind a gap: the gap is counted as lost, and is no longer when the source is started again."""
    monkeypatch.setattr("service.healing.HEALING_PATIENCE_S", 0.3)
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
    monkeypatch.setattr("service.healing.HEALING_PATIENCE_S", 0.3)
    monkeypatch.setattr("service.healing.REPLAY_PAUSE_S", 1.0)
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


def test_a_token_that_is_no_id_is_nobody(router: zenoh.Session, client: zenoh.Session, plant: Database, edge: Edge) -> None:
    """A wildcard would ask every log for a machine that is none."""
    tokens = [client.liveliness().declare_token(f"rundown/v1/live/{name}") for name in ("*/*", "a b/c")]
    edge.publish(5)
    with ingesting(router, plant) as running:
        wait_until(lambda: received(plant) == 5)
        time.sleep(0.5)
        assert list(running._healing.live) == [KEY]
    assert rejected(plant) == {}
    for token in tokens:
        token.undeclare()


# --- without a log --------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("ingest")
def test_without_a_log_a_gap_is_lost_and_the_rest_is_stored(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5)
    put_batch(client, 8, 10)
    put_batch(client, 10, 12)
    wait_until(lambda: received(plant) == 9)
    assert counts(plant) == (12, 9, 3)
    assert stored_times(plant) == [*range(5), *range(8, 12)]


@pytest.mark.usefixtures("ingest")
def test_what_comes_twice_is_stored_once(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    for first, last in ((0, 5), (0, 5), (3, 8)):
        put_batch(client, first, last)
    wait_until(lambda: received(plant) == 8)
    assert stored_times(plant) == list(range(8))
    assert rows(plant)[0].duplicates == 7


# --- what cannot be taken -------------------------------------------------------------------------------------------

GOOD = encode_batch(batch())
BAD: dict[str, tuple[str, dict[str, Any]]] = {
    "noise": ("bad_frame", {"payload": b"\x00\xff" * 50}),
    "nothing": ("bad_frame", {"payload": b""}),
    "damaged": ("bad_frame", {"payload": GOOD[:-1]}),
    "oversized": ("too_large", {"payload": bytes(LARGEST_MESSAGE + 100)}),
    "another format": ("undecodable", {"payload": GOOD, "encoding": "application/json"}),
    "unknown machine": (
        "unknown_machine",
        {"payload": encode_batch(batch(machine="x")), "key": "rundown/v1/plant-1/x/samples"},
    ),
    "another plant": ("unknown_machine", {"payload": encode_batch(batch(plant="p")), "key": "rundown/v1/p/pump-7/samples"}),
    "another machine's key": ("key_mismatch", {"payload": GOOD, "key": "rundown/v1/plant-1/pump-8/samples"}),
    "a key with odd letters": ("key_mismatch", {"payload": GOOD, "key": "rundown/v1/plant-1/pümp 7/samples"}),
    "unknown channel": ("unknown_channel", {"payload": encode_batch(batch(epoch=2, channels=["a", "b", "c", "d"]))}),
    "unknown condition": ("unknown_condition", {"payload": encode_batch(batch(epoch=4, conditions={"humidity": [40.0]}))}),
    "unknown unit": ("wrong_unit", {"payload": encode_batch(batch(epoch=3, speed_unit="RPM"))}),
    "newer schema": ("future_schema", {"payload": encode_batch(batch(schema=2))}),
}


def test_what_cannot_be_taken_is_kept_apart_and_stops_nothing(plant: Database, ingest: Ingest, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    expected: dict[str, int] = {}
    for reason, arguments in BAD.values():
        put(client, **arguments)
        expected[reason] = expected.get(reason, 0) + 1
    put_batch(client, 0, 5, source="good")
    wait_until(lambda: received(plant) == 5)
    assert rejected(plant) == expected
    assert ingest.alive
    assert ingest.trouble is None


def test_what_the_database_cannot_hold_is_put_aside_and_stops_nothing(
    plant: Database, ingest: Ingest, client: zenoh.Session
) -> None:
    with plant.transaction() as session:
        refuse(session, "sample_blocks", write="INSERT", when="NEW.source = 'poison'")
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5, source="poison")
    put_batch(client, 0, 5, source="good")
    put_batch(client, 5, 10, source="good")
    wait_until(lambda: received(plant) == 10)
    wait_until(lambda: rejected(plant) == {"undecodable": 1})
    assert {row.source for row in rows(plant)} == {"good"}
    assert ingest.trouble is None


@pytest.mark.usefixtures("ingest")
def test_an_oversized_message_is_told_with_its_size(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    size = LARGEST_MESSAGE + 5000
    put(client, bytes(size))
    wait_until(lambda: rejected(plant) == {"too_large": 1})
    with plant.reading() as session:
        (row,) = quarantine.newest(session, reason=None, machine_id=KEY.machine, limit=9)
    assert str(size) in row.detail
    assert row.size == size
    assert len(row.payload) == quarantine.KEPT_BYTES


@pytest.mark.usefixtures("ingest")
def test_a_machine_made_known_later_is_taken_from_then_on(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5, machine="pump-8")
    wait_until(lambda: rejected(plant) == {"unknown_machine": 1})
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    put_batch(client, 5, 10, machine="pump-8")
    wait_until(lambda: received(plant) == 5)


# --- the thread -----------------------------------------------------------------------------------------------------


def test_silence_closes_a_run(router: zenoh.Session, plant: Database, client: zenoh.Session) -> None:
    with ingesting(router, plant, silence_s=0.3):
        wait_until(lambda: heard(client))
        put(client, encode_batch(batch(sweep_rpm(2990.0, 1000.0))))

        def closed() -> bool:
            with plant.reading() as session:
                return [run.reason for run in runs.of_machine(session, KEY.machine)] == ["the source fell silent"]

        wait_until(closed)


def test_what_is_queued_is_stored_before_the_service_stops(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    arrived: list[zenoh.Sample] = []
    witness = router.declare_subscriber(ALL_SAMPLES, arrived.append)
    with ingesting(router, plant) as ingest:
        wait_until(lambda: heard(client))
        for number in range(200):
            put_batch(client, number, number + 1)
        wait_until(lambda: len(arrived) == 200)
    assert not ingest.alive
    assert received(plant) == 200
    witness.undeclare()


def test_a_database_that_refuses_is_tried_again(
    plant: Database, ingest: Ingest, client: zenoh.Session, edge: Edge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)
    wait_until(lambda: heard(client))
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE sample_blocks RENAME TO away"))
    edge.publish(5, 5)
    wait_until(lambda: ingest.trouble is not None)
    assert "sample_blocks" in (ingest.trouble or "")
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE away RENAME TO sample_blocks"))
    wait_until(lambda: received(plant) == 10)
    wait_until(lambda: ingest.trouble is None)
    assert counts(plant) == (10, 10, 0)


# --- what the service answers ---------------------------------------------------------------------------------------


def asked_how_far(client: zenoh.Session, key: str) -> list[dict[str, Any]]:
    """The answers to the question how far a machine's sources are durable."""
    return [json.loads(reply.ok.payload.to_bytes()) for reply in client.get(key, timeout=5.0) if reply.ok is not None]


@pytest.mark.usefixtures("ingest")
def test_a_source_can_ask_how_far_it_was_received(client: zenoh.Session, plant: Database) -> None:
    wait_until(lambda: heard(client))
    assert asked_how_far(client, KEY.received) == [{"plant": KEY.plant, "machine": KEY.machine, "sources": []}]
    put_batch(client, 0, 5)
    put_batch(client, 8, 10)
    wait_until(lambda: received(plant) == 7)
    (answer,) = asked_how_far(client, KEY.received)
    assert answer["sources"] == [
        {"source": "monitor", "epoch": 1, "next_sequence": 10, "received": 7, "duplicates": 0, "lost": 3}
    ]
    assert asked_how_far(client, Key("plant-1", "pump-8").received) == []
    assert asked_how_far(client, Key("plant-2", KEY.machine).received) == []


# --- logs that misbehave --------------------------------------------------------------------------------------------


def test_a_log_that_does_not_answer_holds_up_nobody_else(
    router: zenoh.Session, client: zenoh.Session, plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its queries would last longer than the test."""
    monkeypatch.setattr("service.healing.REPLAY_TIMEOUT_S", 60.0)
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


def test_a_hole_in_the_log_is_lost_and_the_rest_is_fetched(
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
    monkeypatch.setattr("service.healing.MOST_QUERIES", 2)
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
