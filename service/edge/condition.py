"""Conditions of the edge agent's input: their names, and those that hold now.

A condition begins, lasts and ends; its beginning and end are logged, and the agent's status lists all that hold.
"""

import logging
import threading
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from storage.clock import now

logger = logging.getLogger(__name__)

CONDITIONS = {
    "no_pulses": "the keyphasor gives no pulses, or too few: no samples",
    "inconsistent_pulses": "the keyphasor's intervals are not those of a turning shaft: no samples",
    "several_pulses": "the keyphasor's intervals repeat as those of several marks do: no samples until they are declared",
    "keyphasor_not_finite": "more than a tenth of the keyphasor's samples are no numbers: no samples",
    "pulses_repaired": "pulses were missing or too many; the angle was bridged",
    "keyphasor_gap": "the angle is known in a part of the block only; that part is used",
    "phase_reference_lost": "with several marks per turn, the count of the marks was lost while turning: values are bad",
    "speed_out_of_range": "the speed is beyond what the machine can do: wrong sampling rate or pulses per turn; no samples",
    "too_slow": "a block holds fewer than three turns, or fewer than five samples a turn: no samples",
    "rail": "half of the samples or more are at an end of the measuring range: the channel is bad",
    "flat_line": "one value for a turn or longer, such as of an unplugged probe: the channel is bad",
    "not_finite": "samples that are no numbers: the channel is bad",
    "clipped": "flat tops: the channel is out of range",
    "unreadable_file": "the file is missing or not what its name says: it is left out",
    "truncated_file": "the file ends early; what can be read of it is used",
    "damaged_file": "the file is broken; an NPZ is left out, of others what lies before the damage is used",
    "missing_column": "the input has no such channel",
    "wrong_sampling_rate": "the input's own sampling rate is not the configured one: it is left out",
    "no_start_time": "nobody says when the file begins: it is left out",
    "time_reversed": "samples that are not later than those before: they are left out",
    "input_gap": "waveforms are missing in between; a new block begins behind them",
    "input_overrun": "waveforms came faster than they could be worked off; some were left out",
    "damaged_message": "a message on the topic is not what it should be: it is left out",
    "no_waveforms": "nothing comes on the topic",
    "log_unusable": "the log takes nothing, such as on a full disk; the agent tries again and loses nothing of a file",
}
"""Each condition's name and its meaning for the samples."""


@dataclass(frozen=True)
class WaveformFinding:
    """A condition that was found: its name, its channel or file (None: the whole input), the details in words."""

    name: str
    subject: str | None
    detail: str


class Conditions:
    """The conditions that hold now, and how often each was found. May be read from another thread."""

    def __init__(self) -> None:
        self._active: dict[tuple[str, str | None], tuple[WaveformFinding, int]] = {}
        self._counts: Counter[str] = Counter()
        self._lock = threading.Lock()

    def block(self, found: Iterable[WaveformFinding]) -> None:
        """Set the conditions of the newest block; those of the block before that are not among them have ended."""
        fresh = {(one.name, one.subject): one for one in found}
        with self._lock:
            for key in [key for key in self._active if key not in fresh]:
                logger.info("%s is over", _text(self._active.pop(key)[0]))
            for one in fresh.values():
                self._record(one)

    def begin(self, name: str, subject: str | None, detail: str) -> None:
        """Begin a condition, in addition to those of the newest block."""
        with self._lock:
            self._record(WaveformFinding(name, subject, detail))

    def add_event(self, name: str, subject: str | None, detail: str) -> None:
        """Count and log a single event."""
        with self._lock:
            self._counts[name] += 1
        logger.warning("%s", _text(WaveformFinding(name, subject, detail)))

    def holds(self, name: str) -> bool:
        """Return whether a condition of this name holds."""
        with self._lock:
            return any(key[0] == name for key in self._active)

    def counts(self) -> dict[str, int]:
        """Return the number of blocks, files or messages in which each condition was found."""
        with self._lock:
            return dict(self._counts)

    def report(self) -> dict[str, Any]:
        """Return the part of the status on conditions: those that hold and since when, and the counts."""
        with self._lock:
            lasting = [
                {"name": one.name, "subject": one.subject, "detail": one.detail, "since_ns": since}
                for one, since in self._active.values()
            ]
            return {"conditions": lasting, "counts": dict(self._counts)}

    def _record(self, one: WaveformFinding) -> None:
        self._counts[one.name] += 1
        key = one.name, one.subject
        if key not in self._active:
            logger.warning("%s", _text(one))
        self._active[key] = one, self._active[key][1] if key in self._active else now()


def _text(one: WaveformFinding) -> str:
    where = f"{one.subject}: " if one.subject else ""
    return f"{where}{one.name}: {one.detail}"
