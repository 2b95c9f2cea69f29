"""Repository of sample blocks and of the reception state of each source."""

import logging
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sqlalchemy import case, func, insert, select, tuple_
from sqlalchemy.orm import Session

from storage.clock import latest as latest_time
from storage.encoding.sample_blocks import DamagedBlock, Samples, decode, encode, join
from storage.encoding.source_key import SourceKey
from storage.paging import Keys, ordered
from storage.tables.measurements import SampleBlockRow, SourceRow

logger = logging.getLogger(__name__)

ALL_TIME = -(2**63), 2**63 - 1
"""Earliest and latest time that a store can hold [ns]."""


@dataclass(frozen=True)
class Totals:
    """Counts of all sources of a machine together. last_time: time of the newest sample that is not in the future [ns], else
    0."""

    machine_id: str
    received: int
    duplicates: int
    lost: int
    late: int
    last_time: int


def add_block(
    session: Session,
    key: SourceKey,
    *,
    revision: int,
    first_sequence: int,
    samples: Samples,
    received_at: int | None = None,
) -> None:
    """Store samples of one source; the arguments are those of `block_row`."""
    add_blocks(
        session, [block_row(key, revision=revision, first_sequence=first_sequence, samples=samples, received_at=received_at)]
    )


def block_row(
    key: SourceKey, *, revision: int, first_sequence: int, samples: Samples, received_at: int | None = None
) -> dict[str, Any]:
    """Return the row of a block of samples of one source.

    first_sequence: sequence number of a sample in this block and in no other; received_at: arrival of the block's last sample,
    by this machine's clock [ns].
    """
    return {
        "machine_id": key.machine_id,
        "revision": revision,
        "source": key.source,
        "epoch": key.epoch,
        "first_sequence": first_sequence,
        "count": len(samples),
        "time_first": int(samples.time.min()),
        "time_last": int(samples.time.max()),
        "received_at": received_at,
        "data": encode(samples),
    }


def add_blocks(session: Session, blocks: Sequence[Mapping[str, Any]]) -> None:
    """Store blocks in one statement, without an object and a returned id for each."""
    if blocks:
        session.execute(insert(SampleBlockRow), blocks)


def between(
    session: Session,
    machine_id: str,
    *,
    revision: int,
    also: Collection[int] = (),
    channels: int = 0,
    first: int,
    last: int,
    largest: int | None = None,
    damaged: list[str] | None = None,
) -> Samples:
    """Return the samples of one revision with first <= time <= last [ns], by time.

    channels: number of columns when there are no samples; also: further revisions, measured alike; largest: when there are
    more samples, only every second, third, … one is taken, so that not many more than this are in memory; damaged: receives a
    message for each unreadable block, which is left out.
    """
    within = (
        (SampleBlockRow.machine_id == machine_id)
        & SampleBlockRow.revision.in_({revision, *also})
        & (SampleBlockRow.time_last >= first)
        & (SampleBlockRow.time_first <= last)
    )
    every = 1
    if largest is not None:
        count = session.scalar(select(func.sum(SampleBlockRow.count)).where(within)) or 0
        every = max(1, -(-int(count) // largest))
    query = select(SampleBlockRow.id, SampleBlockRow.data).where(within)
    query = query.order_by(SampleBlockRow.time_first, SampleBlockRow.id)
    if every > 1:
        query = query.execution_options(yield_per=100)
    parts, passed = [], 0
    for whole in _readable(machine_id, session.execute(query), damaged):
        block = whole.between(first, last)
        parts.append(block.pick(slice(-passed % every, None, every)))
        passed += len(block)
    return _by_time(parts, channels)


def at(
    session: Session,
    machine_id: str,
    *,
    revision: int,
    channels: int = 0,
    times: Sequence[int],
    damaged: list[str] | None = None,
) -> Samples:
    """Return the samples of one revision at these times [ns], ascending; one per time when several sources have it.

    damaged: see `between`.
    """
    parts: list[Samples] = []
    waiting = list(reversed(times))
    while waiting:
        moment = waiting.pop()
        query = (
            select(SampleBlockRow.id, SampleBlockRow.data)
            .where(SampleBlockRow.machine_id == machine_id, SampleBlockRow.revision == revision)
            .where(SampleBlockRow.time_last >= moment, SampleBlockRow.time_first <= moment)
            .order_by(SampleBlockRow.id)
        )
        for block in _readable(machine_id, session.execute(query), damaged):
            which = np.flatnonzero(block.time == moment)
            if which.size:
                parts.append(block.pick(which[:1]))
                while waiting and waiting[-1] in block.time:
                    parts.append(block.pick(np.flatnonzero(block.time == waiting.pop())[:1]))
                break
    return _by_time(parts, channels)


def latest(
    session: Session,
    machine_id: str,
    *,
    revision: int,
    also: Collection[int] = (),
    channels: int = 0,
    count: int,
    first: int | None = None,
    last: int | None = None,
) -> Samples:
    """Return the newest samples of one revision, by time.

    channels: number of columns when there are no samples; also: further revisions, measured alike; first, last: only samples
    with first <= time <= last [ns], None: without that limit.
    """
    query = (
        select(SampleBlockRow.id, SampleBlockRow.data, SampleBlockRow.time_last)
        .where(SampleBlockRow.machine_id == machine_id, SampleBlockRow.revision.in_({revision, *also}))
        .order_by(SampleBlockRow.time_last.desc(), SampleBlockRow.id.desc())
        .execution_options(yield_per=50)
    )
    if first is not None:
        query = query.where(SampleBlockRow.time_last >= first)
    if last is not None:
        query = query.where(SampleBlockRow.time_first <= last)
    newest = _by_time([], channels)
    with session.execute(query) as blocks:
        for number, data, time_last in blocks:
            # Blocks of several sources overlap in time: stop only at one that is older than all that is wanted.
            if len(newest) == count and time_last < newest.time[0]:
                break
            for whole in _readable(machine_id, [(number, data)]):
                block = whole.between(ALL_TIME[0] if first is None else first, ALL_TIME[1] if last is None else last)
                if len(block):
                    parts = [newest, block] if len(newest) else [block]
                    newest = _by_time(parts, channels).pick(slice(-count, None))
    return newest


def newest_time(session: Session, machine_id: str, *, until: int) -> int | None:
    """Return the time of a machine's newest sample in blocks that ended by a time [ns]; None when there is none."""
    block = SampleBlockRow
    return session.scalar(select(func.max(block.time_last)).where(block.machine_id == machine_id, block.time_last <= until))


def newest_receipt(session: Session) -> int | None:
    """Return when the newest samples of any source came, by the service's clock at that time [ns]; None before any."""
    return session.scalar(select(func.max(SourceRow.last_received_at)))


def sources(
    session: Session, machine_id: str | None = None, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[SourceRow]:
    """Return the known sources, of one machine or of all, by machine, name and epoch. after: these of the last of the page
    before."""
    query = select(SourceRow)
    if machine_id is not None:
        query = query.where(SourceRow.machine_id == machine_id)
    by = SourceRow.machine_id, SourceRow.source, SourceRow.epoch
    return session.scalars(ordered(query, by, after, descending=False).limit(limit)).all()


def totals(session: Session) -> list[Totals]:
    """Return the counts of received samples per machine, by id."""
    row = SourceRow
    sums = [func.sum(column) for column in (row.received, row.duplicates, row.lost, row.late)]
    newest = func.max(case((row.last_time <= latest_time(), row.last_time), else_=0))
    query = select(row.machine_id, *sums, newest).group_by(row.machine_id).order_by(row.machine_id)
    return [Totals(name, *map(int, figures)) for name, *figures in session.execute(query)]


def known_sources(session: Session, keys: Collection[SourceKey]) -> Sequence[SourceRow]:
    """Return those of these starts of sources that are known."""
    row = SourceRow
    wanted = [(key.machine_id, key.source, key.epoch) for key in keys]
    return session.scalars(select(row).where(tuple_(row.machine_id, row.source, row.epoch).in_(wanted))).all()


def source(session: Session, key: SourceKey) -> SourceRow:
    """Return the reception state of a source; a new row when the source is unknown."""
    row = session.get(SourceRow, (key.machine_id, key.source, key.epoch))
    if row is None:
        row = SourceRow(
            machine_id=key.machine_id,
            source=key.source,
            epoch=key.epoch,
            next_sequence=0,
            received=0,
            duplicates=0,
            lost=0,
            late=0,
            last_time=0,
        )
        session.add(row)
    return row


def _readable(machine_id: str, blocks: Iterable[tuple[int, bytes]], damaged: list[str] | None = None) -> Iterator[Samples]:
    """Yield the samples of the blocks, by id; a block that a disk has damaged is left out, so that the others stay usable."""
    for number, data in blocks:
        try:
            yield decode(data)
        except DamagedBlock as error:
            words = f"sample block {number} of machine '{machine_id}' is left out: {error}"
            logger.error(words)
            if damaged is not None:
                damaged.append(words)


def _by_time(parts: Sequence[Samples], channels: int) -> Samples:
    samples = join(parts, channels=channels)
    return samples.pick(np.argsort(samples.time, kind="stable"))
