"""State of a machine's run collection, stored with the samples that led to it."""

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any, Self

import msgspec
from sqlalchemy.orm import Session

from estimator.runs.operating_state import OperatingState
from estimator.runs.speed_bins import SpeedBins
from service.runs.danger_level import DangerWatch
from service.runs.late_samples import Window
from storage.clock import is_ahead
from storage.measurements import runs


@dataclass
class CollectionState:
    """State of a machine's run collection, stored with the samples that led to it.

    revision: revision of the document. seen: time of the newest known sample [ns]. direction: direction of rotation, as last
    reported. late: windows of late samples. bins, rolled_at: bins of rolling collection, and when it last started anew [ns].
    slowest, fastest: the speeds between which it has turned since the document's revision, 0 before it has [rad/s].
    danger: what is known of vibration beyond the danger limit of that revision.
    """

    revision: int
    seen: int = 0
    direction: int = 1
    operating: OperatingState = field(default_factory=OperatingState)
    late: list[Window] = field(default_factory=list)
    bins: SpeedBins | None = None
    rolled_at: int = 0
    slowest: float = 0.0
    fastest: float = 0.0
    danger: DangerWatch = field(default_factory=DangerWatch)

    @classmethod
    def restored(cls, stored: dict[str, Any]) -> Self:
        """Return the state from the data that `stored` gave; older releases stored only the sweep."""
        operating = stored.get("operating", {"sweep": stored.get("sweep", {})})
        bins = stored.get("bins")
        return cls(
            revision=stored["revision"],
            seen=stored["seen"],
            direction=stored.get("direction", 1),
            operating=OperatingState.restored(operating),
            late=stored.get("late", []),
            bins=None if bins is None else SpeedBins(tuple(tuple(one) for one in bins)),
            rolled_at=stored.get("rolled_at", 0),
            slowest=stored.get("slowest", 0.0),
            fastest=stored.get("fastest", 0.0),
            danger=DangerWatch.restored(stored.get("danger")),
        )

    @property
    def is_of_the_future(self) -> bool:
        """Return whether the newest sample's time lies in the future: the clock was fast when it arrived."""
        return is_ahead(self.seen)

    @property
    def is_under_way(self) -> bool:
        """Return whether the machine's operating mode is known, so that silence would end it."""
        return self.operating.mode != "unknown" or bool(self.operating.sweep.sweep)

    def note_speed(self, speed: float) -> None:
        """Note a speed at which the machine turns [rad/s]."""
        self.slowest = min(speed, self.slowest) if self.slowest else speed
        self.fastest = max(speed, self.fastest)

    def stored(self) -> dict[str, Any]:
        """Return the state as plain data."""
        return {
            "revision": self.revision,
            "seen": self.seen,
            "direction": self.direction,
            "operating": msgspec.to_builtins(self.operating),
            "late": self.late,
            "bins": None if self.bins is None else self.bins.times,
            "rolled_at": self.rolled_at,
            "slowest": self.slowest,
            "fastest": self.fastest,
            "danger": self.danger.stored(),
        }


def state_of(session: Session, machine_id: str) -> CollectionState | None:
    """Return the state of a machine's run collection; None before its first sample."""
    stored = runs.collector_state(session, machine_id)
    return None if stored is None else CollectionState.restored(stored)


def states_of(session: Session, machine_ids: Collection[str]) -> dict[str, CollectionState]:
    """Return the states of run collection by machine; machines without one are left out."""
    return {row.machine_id: CollectionState.restored(row.state) for row in runs.collectors(session, machine_ids)}
