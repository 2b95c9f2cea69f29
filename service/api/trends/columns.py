"""Prepares parameter histories for plots: cut to a time range, downsampled, in columns, and cached while they are current."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from estimator.arrays import Floats
from estimator.updated_model.vector_angle import angle_deg, angle_half_width_deg
from service.api.conventions.values import rfc3339_texts
from service.api.trends.downsampling import Chosen, min_max
from service.monitoring.parameter_catalogue import units_of
from service.monitoring.trend_bands import BaselineBand, baseline_bands
from storage.database.change_counts import Changes
from storage.database.engine import Database
from storage.findings import trends
from storage.findings.jobs import RUN
from storage.findings.trends import HistoryStamp, Integers, ParameterHistory, Texts
from storage.machines import machines

MAXIMUM_HISTORIES = 512
"""Largest number of cached histories; one of 2,000 points takes some 600 kB."""

ACCEPTED = "accepted"
NOT_ACCEPTED = "not_accepted"
NOT_ESTIMABLE = "not_estimable"


@dataclass(frozen=True)
class Columns:
    """One parameter's history, ready to be cut: the stored columns and those derived for display.

    value: magnitude of an unbalance, without a standard error; lower and upper are its interval. kind: a number for each kind
    of run, accepted or not. complex: whether the parameter is an unbalance.
    """

    history: ParameterHistory
    measured_at: Texts
    computed_at: Texts
    value: Floats
    standard_error: Floats
    quality: Texts
    kind: Integers
    complex: bool
    baselines: list[BaselineBand]

    def __len__(self) -> int:
        return len(self.history)


@dataclass(frozen=True)
class _CachedHistory:
    """A history with the state of the whole store (mark) and of the machine (stamp) before it was read."""

    mark: Hashable | None
    stamp: HistoryStamp
    columns: Columns


class HistoryCache:
    """Histories by machine, parameter and scope, read again after a change that concerns them."""

    def __init__(self, database: Database, *, baseline_runs: int) -> None:
        self._database = database
        self._changes = Changes(database)
        self._baseline_runs = baseline_runs
        self._histories: OrderedDict[tuple[str, str, str], _CachedHistory] = OrderedDict()
        self._lock = threading.Lock()

    def columns(self, machine_id: str, parameters: Sequence[str], *, scope: str) -> dict[str, Columns]:
        """Return the columns of each parameter; those of one that was never identified hold only its unit.

        Raises MachineUnknown, and ParameterUnknown for a parameter that the machine cannot have.
        """
        mark = self._changes.mark(trends.TABLES)
        found = self._valid_columns(machine_id, parameters, scope, lambda kept: mark is not None and kept.mark == mark)
        if not parameters or len(found) < len(parameters):
            found = self._read(machine_id, parameters, scope, mark)
        return {name: found[name] for name in parameters}

    def _read(self, machine_id: str, parameters: Sequence[str], scope: str, mark: Hashable | None) -> dict[str, Columns]:
        with self._database.reading() as session:
            machines.get(session, machine_id)
            stamp = trends.stamp(session, machine_id)
            found = self._valid_columns(machine_id, parameters, scope, lambda kept: kept.stamp == stamp)
            missing = [name for name in parameters if name not in found]
            read = trends.histories(session, machine_id, missing, scope=scope) if missing else {}
            units = units_of(session, machine_id, [name for name, history in read.items() if not len(history)])
            for name, stored in read.items():
                history, bands = replace(stored, unit=units.get(name, stored.unit)), []
                if scope == RUN:  # only single runs are compared with a baseline
                    bands = baseline_bands(session, machine_id, name, history, baseline_runs=self._baseline_runs)
                found[name] = _columns(history, bands)
        for name, columns in found.items():
            self._store((machine_id, name, scope), _CachedHistory(mark, stamp, columns))
        return found

    def _valid_columns(
        self, machine_id: str, parameters: Sequence[str], scope: str, holds: Callable[[_CachedHistory], bool]
    ) -> dict[str, Columns]:
        found = {}
        with self._lock:
            for name in parameters:
                kept = self._histories.get((machine_id, name, scope))
                if kept is not None and holds(kept):
                    found[name] = kept.columns
                    self._histories.move_to_end((machine_id, name, scope))
        return found

    def _store(self, key: tuple[str, str, str], kept: _CachedHistory) -> None:
        if not len(kept.columns):
            return  # anybody can ask for names that are not there
        with self._lock:
            self._histories[key] = kept
            self._histories.move_to_end(key)
            while len(self._histories) > MAXIMUM_HISTORIES:
                self._histories.popitem(last=False)


def in_time_range(columns: Columns, *, first: int | None, last: int | None, most: int) -> Chosen:
    """Return the points of a closed time range [ns], downsampled to at most `most`.

    Accepted and not accepted points of each kind of run are downsampled separately: a failed fit displaces no valid value.
    """
    time = columns.history.measured_at
    begin = 0 if first is None else int(np.searchsorted(time, first, "left"))
    end = len(time) if last is None else max(begin, int(np.searchsorted(time, last, "right")))
    chosen = min_max(time[begin:end], columns.value[begin:end], columns.kind[begin:end], most=most)
    return Chosen(begin + chosen.index, chosen.method, chosen.points)


def value_columns(columns: Columns, chosen: Chosen) -> dict[str, list[Any]]:
    """Return the chosen points by column; NaN where there is no value."""
    history, at = columns.history, chosen.index
    return {
        "measured_at": columns.measured_at[at].tolist(),
        "computed_at": columns.computed_at[at].tolist(),
        "value": columns.value[at].tolist(),
        "standard_error": columns.standard_error[at].tolist(),
        "lower": history.lower[at].tolist(),
        "upper": history.upper[at].tolist(),
        "quality": columns.quality[at].tolist(),
        "run_kind": history.run_kind[at].tolist(),
        "identification": history.identification[at].tolist(),
    }


def complex_parts(columns: Columns, chosen: Chosen) -> dict[str, list[float] | None]:
    """Return real and imaginary part of an unbalance, and its angle; null for every other parameter."""
    if not columns.complex:
        return dict.fromkeys(("real", "imaginary", "angle_deg", "angle_half_width_deg"))
    history, at = columns.history, chosen.index
    vector = history.value[at] + 1j * history.imaginary[at]
    return {
        "real": vector.real.tolist(),
        "imaginary": vector.imag.tolist(),
        "angle_deg": angle_deg(vector).tolist(),
        "angle_half_width_deg": angle_half_width_deg(vector, history.upper[at]).tolist(),
    }


def baseline_columns(columns: Columns, chosen: Chosen) -> dict[str, list[float]]:
    """Return the baseline band that applies to each chosen point; NaN where there is none."""
    history, at = columns.history, chosen.index
    band = np.full((3, len(at)), np.nan)
    time, kind = history.measured_at[at], history.run_kind[at]
    for one in columns.baselines:
        until = np.inf if one.until is None else one.until
        band[:, (kind == one.run_kind) & (time >= one.since) & (time < until)] = [
            [one.band.centre],
            [one.band.lower],
            [one.band.upper],
        ]
    return dict(zip(("baseline_centre", "baseline_lower", "baseline_upper"), band.tolist(), strict=True))


def _columns(history: ParameterHistory, bands: list[BaselineBand]) -> Columns:
    is_complex = bool(np.isfinite(history.imaginary).any())
    value = np.hypot(history.value, history.imaginary) if is_complex else history.value
    quality = np.where(history.accepted, np.where(np.isfinite(value), ACCEPTED, NOT_ESTIMABLE), NOT_ACCEPTED)
    return Columns(
        history=history,
        measured_at=rfc3339_texts(history.measured_at),
        computed_at=rfc3339_texts(history.computed_at),
        value=value,
        standard_error=np.full(len(history), np.nan) if is_complex else history.standard_error,
        quality=quality.astype(np.object_),
        kind=2 * np.unique(history.run_kind, return_inverse=True)[1] + history.accepted,
        complex=is_complex,
        baselines=bands,
    )
