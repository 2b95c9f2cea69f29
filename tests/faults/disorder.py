"""A network that delivers late, in another order, twice or not at all, at the rates that a plant may have on a bad day."""

import heapq
import random
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimator.fit.estimates import Estimate
from estimator.fit.identification import Options
from estimator.machine.document import Machine
from estimator.runs.segmentation import RunKind
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from formats.wire import SampleBatch, encode_batch, source_key
from service.identification.computation import compute
from service.identification.task import IdentificationTask
from service.runs.collector import Collector
from service.write_path.batch import ArrivedBatch
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples, encode
from storage.machines import machines
from storage.measurements import runs, samples
from storage.tables.measurements import RunRow, SourceRow
from tests.identification import chapter_3
from tests.plant import SECOND, START, Document, assert_same_samples, batch
from tests.prompt_writer import PromptWriter

TWICE, MOVED, LATE, GONE = 0.10, 0.10, 0.01, 0.01
"""Parts of the messages that come twice, up to a minute late, up to a day late, never."""
MOVED_S, LATE_S = 60.0, 24 * 3600.0
SWEEP_S, HOLD_S = 600.0, 200.0
SIZE = 5
CYCLE = 20
"""Messages in a transaction, as a busy ingest takes them."""
NEVER_S = 1e9


@dataclass(frozen=True)
class Delivered:
    """Messages as the network left them: in the order in which they come, and the numbers of those that never do."""

    order: list[SampleBatch]
    gone: list[int]
    twice: int
    moved: int
    late: int


@dataclass(frozen=True)
class Stored:
    """All that a store holds of what was sent."""

    samples: Samples
    runs: list[tuple[str, str, int, int | None, int | None]]
    points: list[Samples]
    estimates: list[tuple[Estimate, ...]]
    source: SourceRow


def messages_of(machine: Machine, *, rate: float, sweeps: int, seed: int) -> list[SampleBatch]:
    """Messages of a machine that runs down and up in turn, with holds between."""
    rng = np.random.default_rng(seed)
    kinds: list[RunKind] = ["run-down", "run-up"] * sweeps
    held = round(HOLD_S * rate)
    speeds: list[np.ndarray] = []
    for kind in kinds[:sweeps]:
        _, speed = speed_law(machine, kind, duration=SWEEP_S, samples=round(SWEEP_S * rate))
        speeds += [np.full(held, speed[0]), speed]
    speed = np.concatenate([*speeds, np.full(held, speeds[-1][-1])])
    speed = speed[: speed.size // SIZE * SIZE]
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
    return [
        batch(
            speed[first : first + SIZE].tolist(),
            sequence=first,
            plant=machine.plant,
            machine=machine.id,
            channels=list(machine.channels),
            speed_unit="rad/s",
            amplitude_unit="m",
            amplitude_kind="peak",
            phase_convention="lead",
            phase_unit="rad",
            time_ns=[START + round(SECOND * k / rate) for k in range(first, first + SIZE)],
            amplitude=np.abs(phasor[first : first + SIZE]).tolist(),
            phase=np.angle(phasor[first : first + SIZE]).tolist(),
        )
        for first in range(0, speed.size, SIZE)
    ]


def delivered(messages: Sequence[SampleBatch], *, seed: int, gone: float = GONE) -> Delivered:
    """The messages as they come. The last one comes in time, so that what is missing before it is known."""
    rng = random.Random(seed)
    coming: list[tuple[float, int, SampleBatch]] = []
    never: list[int] = []
    twice = moved = late = 0
    for number, one in enumerate(messages):
        sent = one.time_ns[-1] / SECOND
        chance = rng.random()
        if number == len(messages) - 1:
            chance = 1.0
        if chance < gone:
            never += range(one.sequence, one.sequence + SIZE)
            continue
        if chance < gone + LATE:
            delay, late = rng.uniform(MOVED_S, LATE_S), late + 1
        elif chance < gone + LATE + MOVED:
            delay, moved = rng.uniform(0.0, MOVED_S), moved + 1
        else:
            delay = 0.0
        heapq.heappush(coming, (sent + delay, number, one))
        if rng.random() < TWICE:
            twice += 1
            heapq.heappush(coming, (sent + delay + rng.uniform(0.0, MOVED_S), number, one))
    return Delivered([heapq.heappop(coming)[2] for _ in range(len(coming))], never, twice, moved, late)


def told(url: str, document: Machine, messages: Sequence[SampleBatch]) -> Stored:
    """Return what a store makes of messages in this order, once no more come."""
    database = Database(url)
    try:
        with database.transaction() as session:
            machines.create(session, document)
        writer = PromptWriter(database, Collector(late_s=0.0))
        arrived = [ArrivedBatch(one, "", encode_batch(one), START + 3 * 86_400 * SECOND) for one in messages]
        for first in range(0, len(arrived), CYCLE):
            writer.store(arrived[first : first + CYCLE], [])
            writer.settle(silence_s=NEVER_S)  # what came late so far is sorted in, again and again
        writer.settle(silence_s=0.0)
        return _held(database, document, source_key(messages[0]).source)
    finally:
        database.close()


def _held(database: Database, document: Machine, source: str) -> Stored:
    with database.reading() as session:
        rows = session.query(RunRow).filter_by(state=runs.CLOSED).order_by(RunRow.time_first).all()
        points = [held for row in rows if (held := runs.samples(session, row.id)) is not None]
        text = machines.revision(session, document.id, 1).document
        return Stored(
            samples=samples.latest(session, document.id, revision=1, count=10**7),
            runs=[(row.kind, row.state, row.time_first, row.time_last, row.count) for row in rows],
            points=points,
            estimates=[_estimates(text, held) for held in points],
            source=session.query(SourceRow).filter_by(source=source).one(),
        )


def _estimates(document: Document, held: Samples) -> tuple[Estimate, ...]:
    found = compute(IdentificationTask(document, [encode(held)], Options(), timeout_s=300.0)).identification
    assert found is not None
    assert found.accepted
    return found.estimates


def _assert_same(one: Stored, other: Stored) -> None:
    assert_same_samples(one.samples, other.samples)
    assert one.runs == other.runs
    assert len(one.points) == len(other.points)
    for held, expected in zip(one.points, other.points, strict=True):
        assert_same_samples(held, expected)
    assert one.estimates == other.estimates


def spoiled_stream(folder: Path, *, rate: float, sweeps: int, seed: int) -> str:
    """The store and the estimates are those of the clean stream; where a part never comes, those of that stream without it."""
    machine = chapter_3()
    messages = messages_of(machine, rate=rate, sweeps=sweeps, seed=seed)
    clean = told(f"sqlite:///{folder / 'clean.db'}", machine, messages)
    assert len(clean.runs) == sweeps
    total = SIZE * len(messages)

    whole = delivered(messages, seed=seed, gone=0.0)
    found = told(f"sqlite:///{folder / 'whole.db'}", machine, whole.order)
    _assert_same(found, clean)
    assert (found.source.received, found.source.duplicates, found.source.lost) == (total, SIZE * whole.twice, 0)

    part = delivered(messages, seed=seed + 1)
    missing = set(part.gone)
    without = told(f"sqlite:///{folder / 'without.db'}", machine, [one for one in messages if one.sequence not in missing])
    found = told(f"sqlite:///{folder / 'part.db'}", machine, part.order)
    _assert_same(found, without)
    assert found.source.received == total - len(missing)
    assert (found.source.duplicates, found.source.lost) == (SIZE * part.twice, len(missing))
    holes = [number for hole in found.source.missing or () for number in range(hole[0], hole[1] + 1)]
    assert holes == part.gone
    return (
        f"{total} samples in {len(messages)} messages, {len(clean.runs)} runs: {part.twice} twice, {part.moved} moved, "
        f"{part.late} late, {len(missing) // SIZE} gone; the same store and estimates"
    )
