"""A source whose clock is wrong, jumps, or overflows, and what must be kept of it."""

import random
from dataclasses import dataclass, replace

from service.runs.collector import Collector
from service.write_path.batch import ArrivedBatch
from storage.database.engine import Database
from storage.encoding.sample_blocks import decode
from storage.encoding.source_key import SourceKey
from storage.measurements import quarantine, samples
from storage.tables.measurements import SampleBlockRow, SourceRow
from tests.plant import KEY, SECOND, START, arrived, batch
from tests.prompt_writer import PromptWriter

MINUTE, HOUR = 60 * SECOND, 3600 * SECOND
SIZE, BATCHES = 5, 24
STEP = SECOND // 10
MONITOR = SourceKey(KEY.machine, "monitor", 1)


@dataclass(frozen=True)
class KeptNumbers:
    """numbers: of the blocks' first samples, as stored. measured: times of all samples. received: of each block [ns]."""

    numbers: list[int]
    measured: list[int]
    received: list[int | None]
    source: SourceRow
    rejected: dict[str, int]


def told(clock: list[int]) -> list[ArrivedBatch]:
    """Batches whose samples say these times; they arrive when they were truly measured."""
    found = []
    for first in range(0, len(clock), SIZE):
        one = batch([1000.0] * SIZE, sequence=first, time_ns=clock[first : first + SIZE])
        found.append(replace(arrived(one), received_at=START + (first + SIZE) * STEP))
    return found


def kept(database: Database, messages: list[ArrivedBatch]) -> KeptNumbers:
    """Return what the store holds once all of this has come, each message in a call of its own."""
    writer = PromptWriter(database, Collector(late_s=0.0))
    for one in messages:
        writer.store([one], [])
    writer.settle(silence_s=0.0)
    with database.reading() as session:
        rows = session.query(SampleBlockRow).order_by(SampleBlockRow.id).all()
        return KeptNumbers(
            numbers=[row.first_sequence for row in rows],
            measured=[moment for row in rows for moment in decode(row.data).time.tolist()],
            received=[row.received_at for row in rows],
            source=samples.source(session, MONITOR),
            rejected=quarantine.counts(session),
        )


TRUE = [START + k * STEP for k in range(SIZE * BATCHES)]
OVERFLOWING = (2**63 - 1, 2**62, -(2**63), -1)


@dataclass(frozen=True)
class Wandered:
    """Number of times that the clock stepped back, and the fate of the samples."""

    steps_back: int
    stored: int
    apart: int

    def __str__(self) -> str:
        return f"{self.steps_back} steps back; {self.stored} samples stored, {self.apart} put apart"


def wandering(database: Database, *, seed: int) -> Wandered:
    """A clock that is minutes wrong, steps back and forth, and now and then overflows for a message."""
    draw = random.Random(seed)
    skew = draw.randrange(-5 * MINUTE, 5 * MINUTE)
    clock, overflowing, steps_back = [], 0, 0
    for first in range(0, len(TRUE), SIZE):
        if first and draw.random() < 0.15:
            before, skew = skew, draw.choice((skew - draw.randrange(SECOND, HOUR), draw.randrange(-HOUR, 5 * MINUTE)))
            steps_back += skew < before
        if draw.random() < 0.05:
            clock += [draw.choice(OVERFLOWING)] * SIZE
            overflowing += SIZE
        else:
            clock += [moment + skew for moment in TRUE[first : first + SIZE]]
    found = kept(database, told(clock))
    assert found.numbers == sorted(found.numbers)
    assert set(found.rejected) <= {"time_out_of_order", "time_out_of_range"}, found.rejected
    assert found.rejected.get("time_out_of_range", 0) == overflowing
    apart = found.rejected.get("time_out_of_order", 0)
    assert apart <= 2 * steps_back, (apart, steps_back)
    assert (found.source.received + apart + overflowing, found.source.next_sequence) == (len(TRUE), len(TRUE))
    assert found.source.lost == 0
    left = iter(clock)
    assert all(moment in left for moment in found.measured), "not in the source's order, or not its times"
    assert len(found.measured) == found.source.received
    assert set(found.received) <= {moment + STEP for moment in TRUE[SIZE - 1 :: SIZE]}
    return Wandered(steps_back, found.source.received, apart)
