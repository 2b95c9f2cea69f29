"""Bands that a trend is drawn with: of each baseline that its identifications were compared with."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from sqlalchemy.orm import Session

from estimator.fit.estimates import CONFIDENCE_95
from estimator.trends.baseline_band import Band, baseline_band, magnitude_band
from service.monitoring.comparison import baseline_of
from storage.findings.identifications import ComparisonGroup
from storage.findings.trends import ParameterHistory
from storage.machines import baselines, machines
from storage.tables.machines import BaselineRow


@dataclass(frozen=True)
class BaselineBand:
    """The band of one kind of run. since, until: the part of the trend that it applies to [ns]; until: None for the present
    one.

    identifications: those that form it.
    """

    run_kind: str
    since: int
    until: int | None
    band: Band
    identifications: tuple[int, ...]


def baseline_bands(
    session: Session, machine_id: str, name: str, history: ParameterHistory, *, baseline_runs: int
) -> list[BaselineBand]:
    """Return the bands over a parameter's history, oldest first; none for a baseline that is incomplete or lacks the
    parameter."""
    begun = sorted(baselines.of_machine(session, machine_id), key=lambda row: (row.since, row.id))
    places: dict[_Key, list[int]] = {}
    for place in np.flatnonzero(history.accepted):
        places.setdefault(_key(history, int(place), begun), []).append(int(place))
    bands = []
    for key, group in places.items():
        began = None if key.begun < 0 else begun[key.begun]
        revisions = tuple(machines.comparable_revisions(session, machine_id, key.revision))
        since, balance = 0 if began is None else began.since, key.load_balance or None
        like = ComparisonGroup(revisions, key.run_kind, key.slow_roll_version or None, since, balance)
        rows, wanted = baseline_of(session, machine_id, like, began, baseline_runs=baseline_runs)
        band = _band(name, history, [row.id for row in rows]) if len(rows) == wanted else None
        if band is not None:
            later = [other[0] for one, other in places.items() if one.run_kind == key.run_kind and other[0] > group[-1]]
            until = int(history.measured_at[min(later)]) if later else None
            ids = tuple(row.id for row in rows)
            bands.append(BaselineBand(key.run_kind, int(history.measured_at[group[0]]), until, band, ids))
    return bands


class _Key(NamedTuple):
    """Common properties of identifications compared with one baseline. begun: the baseline's number, -1 for the first runs."""

    begun: int
    run_kind: str
    revision: int
    slow_roll_version: int
    load_balance: int


def _key(history: ParameterHistory, place: int, begun: Sequence[BaselineRow]) -> _Key:
    number = bisect_right(begun, int(history.measured_at[place]), key=lambda row: row.since) - 1
    kind, revision = str(history.run_kind[place]), int(history.revision[place])
    return _Key(number, kind, revision, int(history.slow_roll_version[place]), int(history.load_balance[place]))


def _band(name: str, history: ParameterHistory, ids: Sequence[int]) -> Band | None:
    at = np.flatnonzero(np.isin(history.identification, ids))
    value, imaginary = history.value[at], history.imaginary[at]
    if len(at) < len(ids) or not np.isfinite(value).all():
        return None
    half = (history.upper[at] - history.lower[at]) / (2 * CONFIDENCE_95)
    error = np.where(np.isfinite(history.standard_error[at]), history.standard_error[at], half)
    if not np.isfinite(error).all():
        return None
    if np.isfinite(imaginary).all():
        return magnitude_band(name, value + 1j * imaginary, error * (1 + 1j))
    return baseline_band(name, value, error)
