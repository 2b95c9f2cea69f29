"""An ingest on a real network, sources of all kinds, and what is stored of theirs."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import zenoh

from formats.wire import MESSAGEPACK, Key, SampleBatch, encode_batch
from service.ingest.ingest_thread import Ingest
from service.recovery.gap_recovery import GapRecovery
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from service.sources.publisher import Source
from service.write_path.batch import ArrivedBatch
from service.write_path.sample_writer import SampleWriter
from service.write_path.sequence_gaps import SequenceGap
from service.write_path.source_backoff import SourceBackoff
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.measurements import quarantine
from storage.measurements import samples as sample_store
from storage.tables.measurements import SourceRow
from tests.plant import KEY, SECOND, START, batch, listened_to, wait_until

SAMPLES = "rundown/v1/plant-1/pump-7/samples"


@contextmanager
def ingesting(router: zenoh.Session, database: Database, *, silence_s: float = 60.0) -> Iterator[Ingest]:
    """A service that takes in samples."""
    ingest = Ingest(router, SampleWriter(database, Collector()), silence_s=silence_s)
    ingest.start()
    try:
        yield ingest
    finally:
        ingest.stop()


class FailingWriter(SampleWriter):
    """Meets an error that nobody foresaw where it looks up one machine."""

    def plant_of(self, machine_id: str) -> str | None:
        if machine_id == "pump-9":
            raise ZeroDivisionError("a fault of ours")
        return super().plant_of(machine_id)


class Surroundings(WholeShare):
    """Surroundings that gap recovery needs: of each source 100 samples are known, and none is missing before them.

    gaps: that are recorded. answer: what every reply reads as. own: machines that are stored here; None for all.
    """

    def __init__(self, *, gaps: list[SequenceGap] | None = None, answer: ArrivedBatch | None = None) -> None:
        self.gaps = [] if gaps is None else gaps
        self.answer = answer
        self.own: set[str] | None = None
        self.taken: list[ArrivedBatch] = []
        self.backoff = SourceBackoff()
        self.paused: list[SourceKey] = []
        self.backoff.call_on_pause(self.paused.append)

    def recovery(self, session: zenoh.Session) -> GapRecovery:
        """Gap recovery by itself."""
        return GapRecovery(session, sink=self, records=self, reader=self, share=self, backoff=self.backoff)

    def next_sequence(self, _source: SourceKey) -> int:
        return 100

    def sequence_gaps(self, _source: SourceKey) -> list[SequenceGap]:
        return self.gaps

    def replied(self, _key: Key, _reply: zenoh.Sample) -> ArrivedBatch | None:
        return self.answer

    def take(self, arrived: ArrivedBatch) -> None:
        self.taken.append(arrived)

    def is_owner(self, machine_id: str) -> bool:
        return self.own is None or machine_id in self.own


def rows(database: Database) -> list[SourceRow]:
    with database.reading() as session:
        return list(sample_store.sources(session))


def received(database: Database) -> int:
    return sum(row.received for row in rows(database))


def counts(database: Database) -> tuple[int, int, int]:
    """Next sequence, received and lost of the only source; nothing before it has sent."""
    found = rows(database)
    if not found:
        return 0, 0, 0
    (row,) = found
    return row.next_sequence, row.received, row.lost


def stored_times(database: Database) -> list[int]:
    """Whole seconds after the start."""
    with database.reading() as session:
        held = sample_store.latest(session, KEY.machine, revision=1, count=10_000)
    return [(moment - START) // SECOND for moment in held.time.tolist()]


def rejected(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return quarantine.counts(session)


class PublishingEdge:
    """A source of the machine that publishes samples at 900 r/min, a second apart."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def publish(self, *sizes: int) -> None:
        for size in sizes:
            self.source.publish(batch([900.0] * size, start=START + self.source.sequence * SECOND))


def heard(client: zenoh.Session) -> bool:
    """Return whether what the client publishes goes out. Once it does it goes on doing so, also from one service to the
    next."""
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


class DroppedOnTheWay:
    """A live source with a log, of whose messages the network delivers only some; five samples to a message."""

    def __init__(self, client: zenoh.Session) -> None:
        self.client = client
        self.log: list[SampleBatch] = []
        self.is_there = False
        self.come()

    def come(self) -> None:
        self.is_there = True
        self.queryable = self.client.declare_queryable(KEY.log, self.answer)
        self.token = self.client.liveliness().declare_token(KEY.live)

    def publish(self, *, dropped: bool = False) -> None:
        first = 5 * len(self.log)
        self.log.append(batch([900.0] * 5, sequence=first, start=START + first * SECOND))
        if not dropped:
            put(self.client, encode_batch(self.log[-1]))

    def answer(self, query: zenoh.Query) -> None:
        with query:
            first, limit = (int(query.parameters.get(name) or 0) for name in ("from", "limit"))
            held = self.log if self.is_there else []  # a question from before may still be on its way
            for one in [one for one in held if one.sequence + 5 > first][: limit or None]:
                query.reply(KEY.log, encode_batch(one), encoding=MESSAGEPACK)

    def leave_a_gap(self, plant: Database) -> None:
        """Five samples are stored; of fifteen, ten are lost and counted while its log is away. `come` brings the log back."""
        wait_until(lambda: heard(self.client))
        self.publish()
        wait_until(lambda: received(plant) == 5)
        self.leave()
        for dropped in (True, True, False):
            self.publish(dropped=dropped)
        wait_until(lambda: counts(plant) == (20, 10, 10))

    def leave(self) -> None:
        self.is_there = False
        self.token.undeclare()
        self.queryable.undeclare()
