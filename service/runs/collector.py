"""Run collection: new samples of a machine advance its state, by which runs begin and end. `closing.py` collects their
samples."""

import logging
import threading
import time
from collections.abc import Collection

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.runs.operating_state import Mode, ModeChanged, OperatingEvent, OperatingLimits, advance, silence
from estimator.runs.segmentation import RunEnded, RunStarted
from estimator.runs.speed_bins import ROLLING, SpeedBins, filled
from service.runs.collection_state import CollectionState, state_of, states_of
from service.runs.danger_level import DangerWatch, watched
from service.runs.late_arrivals import LATE_PATIENCE_S, LateArrivals
from storage.clock import FUTURE_TOLERANCE, is_ahead, latest
from storage.encoding.sample_blocks import Samples
from storage.machines import machines
from storage.measurements import runs, samples

logger = logging.getLogger(__name__)

ALIVE_PATIENCE = 10.0
"""Factor by which a connected source may be silent longer than one that is not."""
RECENT = 3_600_000_000_000
"""Largest age of a sample that shows a machine's present state: an hour [ns]."""


class Collector:
    """Run collection of all machines. Its whole state is stored with the samples, in the same transaction."""

    def __init__(self, *, late_s: float = LATE_PATIENCE_S) -> None:
        self.lock = threading.Lock()
        """Held while the state of a machine's collection is read and written, by ingest and by closing."""
        self.late = LateArrivals(patience_s=late_s)
        self._heard_at: dict[str, float] = {}
        self._silent: set[str] = set()

    def forget(self) -> None:
        """Forget when machines were last active, as after a start."""
        self._heard_at.clear()
        self._silent.clear()
        self.late.forget()

    def note_activity(self, machine_id: str) -> None:
        """Note that a machine sends, though nothing is accepted now."""
        self._heard_at[machine_id] = time.monotonic()

    def recheck(self, machine_ids: Collection[str]) -> None:
        """Check machines again for which a failed transaction has stored nothing."""
        self._silent.difference_update(machine_ids)
        self.late.recheck(machine_ids)

    def seen(self, session: Session, machine_id: str) -> int:
        """Return the time of the newest sample known to run collection [ns]; a sample that arrives later but lies before is
        late."""
        stored = runs.collector_state(session, machine_id)
        return 0 if stored is None or is_ahead(int(stored["seen"])) else int(stored["seen"])

    def feed(self, session: Session, machine: Machine, revision: int, new: Samples) -> None:
        """Process newly stored samples of one machine, by time; those before the newest known one are late."""
        self._heard_at[machine.id] = time.monotonic()
        self._silent.discard(machine.id)
        now = state_of(session, machine.id) or CollectionState(revision)
        limits = OperatingLimits.of(machine)
        if now.revision != revision:
            _revise(session, machine.id, now, revision)
        if now.is_of_the_future and (recent := _recent(new.time)).size:
            _set_back(session, machine.id, now, seen=int(recent.min()) - 1)
        turning, late = now.direction, new.time <= now.seen
        if late.any():
            self.late.note(session, machine.id, now, new.time[late])
        fresh = new.pick(~late)
        fresh = fresh.pick(np.concatenate([[True], fresh.time[1:] > fresh.time[:-1]])[: len(fresh)])
        modes: list[Mode] = []
        for moment, speed, direction in zip(fresh.time.tolist(), fresh.speed.tolist(), fresh.direction.tolist(), strict=True):
            now.seen, now.direction = moment, direction
            now.operating, events = advance(now.operating, limits, time=moment, speed=speed, direction=direction)
            modes.append(now.operating.mode)
            if now.operating.mode not in ("stopped", "unknown"):
                now.note_speed(now.operating.sweep.believed_speed)
            for event in events:
                _record(session, machine, revision, direction, event)
        now.danger = watched(now.danger, machine, fresh, modes)
        if machine.collection.runs != "sweeps" and len(fresh):
            _fill_bins(session, machine, now, fresh, turned=bool(np.any(fresh.direction != turning)))
        runs.save_collector_state(session, machine.id, now.stored())

    def has_fallen_silent(self, machine_id: str, *, silence_s: float, alive: bool) -> bool:
        """Return whether a machine has just become silent: it sent nothing for `silence_s`, longer while its source lives."""
        heard = self._heard_at.setdefault(machine_id, time.monotonic())
        waited = time.monotonic() - heard >= silence_s * (ALIVE_PATIENCE if alive else 1.0)
        return waited and machine_id not in self._silent

    def note_idle(self, session: Session, machine_ids: Collection[str]) -> None:
        """Exclude machines from the check for silence until samples come, if their operating mode is unknown."""
        known = states_of(session, machine_ids)
        self._silent |= {
            one for one in machine_ids if one not in known or not (known[one].is_under_way or known[one].is_of_the_future)
        }

    def end_silent(self, session: Session, machine_id: str) -> None:
        """End the open run of a machine that has fallen silent."""
        self._silent.add(machine_id)
        now = state_of(session, machine_id)
        if now is None or not (now.is_under_way or now.is_of_the_future):
            return
        _silence(session, machine_id, now, reason="the source fell silent")
        if now.is_of_the_future:
            _set_back(session, machine_id, now, seen=samples.newest_time(session, machine_id, until=latest()) or 0)
        runs.save_collector_state(session, machine_id, now.stored())


def _revise(session: Session, machine_id: str, now: CollectionState, revision: int) -> None:
    _silence(session, machine_id, now, reason="the machine's document was revised")
    now.revision, now.bins, now.rolled_at = revision, None, 0
    now.slowest = now.fastest = 0.0
    now.danger = DangerWatch()


def _recent(times: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the times that lie in the present [ns]."""
    last = latest()
    return times[(times >= last - FUTURE_TOLERANCE - RECENT) & (times <= last)]


def _set_back(session: Session, machine_id: str, now: CollectionState, *, seen: int) -> None:
    """Continue from `seen` [ns] when the newest known sample lies in the future: else all samples until then would be late."""
    logger.warning("%s: its newest samples are of the future; its state is told from the present on again", machine_id)
    _silence(session, machine_id, now, reason="the clock was set back")
    now.operating = replace(now.operating, since=0)
    now.seen, now.bins, now.rolled_at = seen, None, 0


def _silence(session: Session, machine_id: str, now: CollectionState, *, reason: str) -> None:
    machine = machines.document(session, machine_id, now.revision)
    now.operating, events = silence(now.operating, OperatingLimits.of(machine), reason=reason)
    now.danger = now.danger.interrupted()
    for event in events:
        _record(session, machine, now.revision, now.direction, event)


def _record(session: Session, machine: Machine, revision: int, direction: int, event: OperatingEvent) -> None:
    if isinstance(event, ModeChanged):
        runs.add_state(session, machine.id, since=event.time, mode=event.mode, speed=event.speed)
    elif machine.collection.runs == ROLLING:
        return
    elif isinstance(event, RunStarted):
        runs.open_run(session, machine.id, revision=revision, kind=event.kind, direction=direction, time_first=event.time)
        logger.info("%s: a %s has begun", machine.id, event.kind)
    else:
        _end(session, machine.id, event)


def _end(session: Session, machine_id: str, event: RunEnded) -> None:
    row = runs.open_run_of(session, machine_id)
    if row is not None:
        runs.end(row, first=event.start, last=event.time, reason=event.reason)


def _fill_bins(session: Session, machine: Machine, now: CollectionState, fresh: Samples, *, turned: bool) -> None:
    """Fill the speed bins; make a run of them when they are full enough and the last one is long enough ago."""
    rules = machine.collection.rolling
    if now.bins is None or now.rolled_at == 0:
        now.bins, now.rolled_at = SpeedBins.empty(machine), int(fresh.time[0])
    same = fresh.pick(fresh.direction == now.direction)
    if turned:
        now.bins = SpeedBins.empty(machine)  # the other sense of rotation is another run
    now.bins = filled(now.bins, machine, time=same.time, speed=same.speed)
    if now.seen - now.rolled_at < 1e9 * rules.interval_s:
        return
    now.bins = now.bins.recent(machine, now.seen)
    if now.bins.coverage < rules.coverage:
        return
    times = now.bins.all_times
    if times:
        row = runs.open_run(
            session, machine.id, revision=now.revision, kind=ROLLING, direction=now.direction, time_first=times[0]
        )
        reason = f"{100 * now.bins.coverage:.0f} % of the speed bins hold samples"
        runs.end_rolling(row, times=times, reason=reason)
    # The next run shares no sample with this one: what is compared later must be independent.
    now.bins, now.rolled_at = SpeedBins.empty(machine), now.seen
