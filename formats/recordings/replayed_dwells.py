"""A recording of dwells as a stream: the rows of each run one after the other, and never as if a sweep went through them.

Rows of a table of dwells stand in any order, and rows with different trial weights beside each other. Where the table has no
times, each speed gets a place of its own, so far from the next that no service takes the two for a sweep.
"""

import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from estimator.runs.dwells import NEAR
from estimator.units import KILOGRAM_METRES
from formats.recordings.recording import RecordedCircumstances, read_circumstances
from formats.recordings.sidecar import read_sidecar
from formats.recordings.sidecar_place import sidecar_of
from formats.wire import TABLES, SampleBatch
from storage.clock import to_datetime

APART_S = 3600.0
"""Time between dwells at different speeds, or of different runs [s]: longer than the pauses that usual sweeps have."""
MOST_SHOWN = 50
"""Most runs that are told."""


class ReplayedRun(Struct, frozen=True):
    """Rows of one mounting with the same trial weights.

    Attributes:
        mounting: Name of the mounting.
        first: Time of the first row [ns].
        last: Time of the last row [ns].
        weights: Unbalance on each disc [kg m], from +x towards +y; discs without are left out. None where nobody states them.
    """

    mounting: str
    first: int
    last: int
    weights: dict[str, complex] | None

    def request_text(self) -> str:
        """Return what makes a run of it, and what names that in a calibration, as JSON."""
        period = {"from": _time_text(self.first), "to": _time_text(self.last, up=True), "by": "NAME"}
        if self.weights is None:
            return json.dumps(period)
        weights = [
            {
                "disc": disc,
                "amount": round(abs(one) / KILOGRAM_METRES["g mm"], 6),
                "unit": "g mm",
                "angle_deg": round(math.degrees(math.atan2(one.imag, one.real)), 4),
            }
            for disc, one in self.weights.items()
        ]
        asked = {"run": "NUMBER", "weights": weights, "mounting": self.mounting, "steady": True}
        return f"{json.dumps(period)}, and as {json.dumps(asked)}"


def replayed_dwells(batch: SampleBatch, path: Path, sidecar: Path | None = None) -> tuple[SampleBatch, list[ReplayedRun]]:
    """Return a recording's batch as it is to be published, and the runs in it; of a sweep as it is, and none.

    Raises UnreadableFile.
    """
    circumstances = read_circumstances(path, sidecar)
    if circumstances.kind != "dwells":
        return batch, []
    keys = _keys(circumstances, len(batch.time_ns))
    timed = read_sidecar(sidecar or sidecar_of(path)).time is not None
    order = _order(batch, keys, timed=timed)
    times = [batch.time_ns[row] for row in order] if timed else _times(batch, keys, order)
    found = _reordered(batch, order, times)
    return found, list(_runs(circumstances, keys, order, times))


def dwells_text(machine: str, runs: Sequence[ReplayedRun]) -> str:
    """Return how the runs of published dwells become runs of the service."""
    lines = [
        f"Dwells are no sweep, which would become a run by itself: {len(runs)} runs are to be asked for, each by a "
        f"POST to /api/v1/machines/{machine}/runs, and named in one to /api/v1/machines/{machine}/model-calibrations:"
    ]
    lines += [f"  {one.mounting}: {one.request_text()}" for one in runs[:MOST_SHOWN]]
    if len(runs) > MOST_SHOWN:
        lines.append(f"  … and {len(runs) - MOST_SHOWN} more")
    if any(later.first <= one.last for one, later in zip(runs, runs[1:], strict=False)):
        lines.append("  Runs overlap in time, by the table's times: rows with other weights would be in them, too")
    return "\n".join(lines)


MountedWeights = tuple[str, tuple[complex, ...]]
"""A mounting and the weights on the discs that the sidecar names."""


def _keys(circumstances: RecordedCircumstances, count: int) -> list[MountedWeights]:
    """Return what tells runs apart, of each row."""
    added = list(circumstances.added.values())
    return [(circumstances.mounting[row], tuple(one[row] for one in added)) for row in range(count)]


def _order(batch: SampleBatch, keys: Sequence[MountedWeights], *, timed: bool) -> list[int]:
    """Return the rows in the order in which they are published: by time, or run by run and in each by speed."""
    if timed:
        return [int(row) for row in np.argsort(batch.time_ns, kind="stable")]
    places = {key: place for place, key in enumerate(dict.fromkeys(keys))}
    return sorted(range(len(keys)), key=lambda row: (places[keys[row]], batch.speed[row]))


def _times(batch: SampleBatch, keys: Sequence[MountedWeights], order: Sequence[int]) -> list[int]:
    """Return a time of each row in their order [ns]: near those of its dwell, far from all others."""
    step = batch.time_ns[1] - batch.time_ns[0] if len(batch.time_ns) > 1 else 0
    found = [batch.time_ns[0]]
    for before, row in zip(order, order[1:], strict=False):
        same = keys[row] == keys[before] and abs(batch.speed[row] - batch.speed[before]) <= NEAR * batch.speed[before]
        found.append(found[-1] + (step if same else round(1e9 * APART_S)))
    return found


def _reordered(batch: SampleBatch, order: Sequence[int], times: list[int]) -> SampleBatch:
    """Return a batch with its rows in another order, at other times."""

    def picked(rows: Sequence[Any]) -> list[Any]:
        return [rows[row] for row in order]

    conditions = None if batch.conditions is None else {name: picked(one) for name, one in batch.conditions.items()}
    tables = {name: picked(rows) for name in TABLES if (rows := getattr(batch, name)) is not None}
    return msgspec.structs.replace(batch, time_ns=times, speed=picked(batch.speed), conditions=conditions, **tables)


def _runs(
    circumstances: RecordedCircumstances, keys: Sequence[MountedWeights], order: Sequence[int], times: Sequence[int]
) -> Iterable[ReplayedRun]:
    """Yield the runs in the order of their first row."""
    own: dict[MountedWeights, list[int]] = {}
    for row, moment in zip(order, times, strict=True):
        own.setdefault(keys[row], []).append(moment)
    for (mounting, added), moments in own.items():
        weights = {disc: one for disc, one in zip(circumstances.added, added, strict=True) if one}
        yield ReplayedRun(mounting, min(moments), max(moments), weights if circumstances.stated else None)


def _time_text(moment: int, *, up: bool = False) -> str:
    """Return a time in RFC 3339, to the microsecond before, or with `up` at or after it."""
    return to_datetime(moment + (999 if up else 0)).isoformat().replace("+00:00", "Z")
