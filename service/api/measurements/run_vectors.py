"""Keeps the vectors of runs at running speed in memory: a run is read once, as its samples do not change."""

import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sqlalchemy.orm import Session

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.phasors.harmonic_ratio import Orders
from estimator.phasors.near_speed import near_running_speed
from estimator.phasors.running_speed import mean_level, running_speed_vectors
from storage.encoding.sample_blocks import DamagedBlock
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import RunRow

MOST_KEPT = 10_000
"""Runs kept; the vectors of one take some 200 bytes a channel."""


@dataclass(frozen=True, slots=True)
class ChannelVectors:
    """Vectors and levels of one channel at running speed [m], NaN where there is none; gap: towards the probe."""

    first: complex = complex(np.nan, np.nan)
    second: complex = complex(np.nan, np.nan)
    overall: float = np.nan
    gap: float = np.nan


Kept = tuple[float, dict[str, ChannelVectors]]
"""Mean speed [rad/s], and the vectors by channel."""
RunVectorsKey = tuple[int, int | None, int | None, float]
"""Run, its end, number of its samples, running speed: made anew by late samples, a run has other ones."""


@dataclass(frozen=True)
class RunVectors:
    """Vectors of one run at running speed, in the order of a document's channels; NaN for one that the run did not have.

    ended_at: [ns]; direction: +1 or -1; speed: mean of the samples [rad/s]; first, second: 1× and 2× (m,) [m]; overall, gap:
    unfiltered levels, 0-to-peak, and places towards the probe (m,) [m].
    """

    run: int
    kind: str
    ended_at: int
    direction: int
    speed: float
    first: Complexes
    second: Complexes
    overall: Floats
    gap: Floats


class RunVectorCache:
    """Cache of the vectors of runs, by channel."""

    def __init__(self) -> None:
        self._kept: OrderedDict[RunVectorsKey, Kept | None] = OrderedDict()
        self._lock = threading.Lock()

    def of_runs(self, session: Session, machine: Machine, rows: Sequence[RunRow], *, running_speed: float) -> list[RunVectors]:
        """Return the vectors of closed runs that came near a speed [rad/s], in their order; a damaged run is left out."""
        found = []
        for row in rows:
            key = (row.id, row.time_last, row.count, running_speed)
            with self._lock:
                known, kept = key in self._kept, self._kept.get(key)
            if not known:
                kept = _read(session, row, running_speed)
                self._keep(key, kept)
            if kept is not None:
                found.append(_ordered(row, machine, *kept))
        return found

    def _keep(self, key: RunVectorsKey, vectors: Kept | None) -> None:
        with self._lock:
            self._kept[key] = vectors
            while len(self._kept) > MOST_KEPT:
                self._kept.popitem(last=False)


def _read(session: Session, row: RunRow, speed: float) -> Kept | None:
    try:
        held = runs.samples(session, row.id)
    except DamagedBlock:
        return None  # the run itself says what is wrong, where it is asked for
    if held is None:
        return None
    first = np.where(held.usable, held.phasor, complex(np.nan, np.nan))
    near = running_speed_vectors(Orders(held.speed, first, held.second), running_speed=speed)
    if near is None:
        return None
    channels = machines.document(session, row.machine_id, row.revision).channels
    within = near_running_speed(held.speed, speed)
    overall, gap = mean_level(held.overall[within]), mean_level(held.gap[within])
    return near.speed, {
        name: ChannelVectors(complex(near.first[i]), complex(near.second[i]), float(overall[i]), float(gap[i]))
        for i, name in enumerate(channels)
    }


def _ordered(row: RunRow, machine: Machine, speed: float, vectors: dict[str, ChannelVectors]) -> RunVectors:
    found = [vectors.get(channel, ChannelVectors()) for channel in machine.channels]
    ended = row.time_first if row.time_last is None else row.time_last
    return RunVectors(
        run=row.id,
        kind=row.kind,
        ended_at=ended,
        direction=row.direction,
        speed=speed,
        first=np.array([one.first for one in found], complex),
        second=np.array([one.second for one in found], complex),
        overall=np.array([one.overall for one in found]),
        gap=np.array([one.gap for one in found]),
    )
