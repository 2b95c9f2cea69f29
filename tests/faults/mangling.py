"""A network between a source and the service that damages messages: seeded, and it knows what it did."""

import random

import zenoh

from service.sources.publisher import Source
from service.sources.replay_log import LogEntry
from tests.plant import KEY, listened_to

TWICE, SWAPPED, FLIPPED, DROPPED = 0.10, 0.10, 0.05, 0.05
"""Parts of the messages that come twice, come after their successor, have one bit flipped, do not come."""


class Mangler:
    """Publishes what it is given, in its own way. intact: numbers of the samples of which a message went out whole."""

    def __init__(self, session: zenoh.Session, *, seed: int) -> None:
        self._rng = random.Random(seed)
        self._publisher = session.declare_publisher(KEY.samples, congestion_control=zenoh.CongestionControl.BLOCK)
        self._held: LogEntry | None = None
        self.intact: set[int] = set()
        self.flipped = 0
        self.twice = 0
        self.swapped = 0

    @property
    def heard(self) -> bool:
        """Return whether anybody listens."""
        return listened_to(self._publisher)

    def send(self, entry: LogEntry) -> None:
        """Deliver a message, or not, or otherwise."""
        held, self._held = self._held, None
        if held is None and self._rng.random() < SWAPPED:
            self._held = entry
            self.swapped += 1
            return
        self._deliver(entry)
        if held is not None:
            self._deliver(held)

    def finish(self, entry: LogEntry) -> None:
        """The last message arrives as it is, so that nothing is left that nobody knows of."""
        if self._held is not None:
            self._deliver(self._held)
            self._held = None
        self._put(entry, entry.payload)

    def close(self) -> None:
        """No more."""
        self._publisher.undeclare()

    def _deliver(self, entry: LogEntry) -> None:
        chance = self._rng.random()
        if chance < DROPPED:
            return
        if chance < DROPPED + FLIPPED:
            payload = bytearray(entry.payload)
            payload[self._rng.randrange(len(payload))] ^= 1 << self._rng.randrange(8)
            self.flipped += 1
            self._publisher.put(bytes(payload), encoding=entry.encoding)
            return
        self._put(entry, entry.payload)
        if self._rng.random() < TWICE:
            self.twice += 1
            self._put(entry, entry.payload)

    def _put(self, entry: LogEntry, payload: bytes) -> None:
        self._publisher.put(payload, encoding=entry.encoding)
        self.intact |= set(range(entry.first, entry.first + entry.count))


class MangledSource(Source):
    """A source with a log whose published messages go through a mangler; what its log answers does not."""

    def __init__(self, session: zenoh.Session, mangler: Mangler) -> None:
        super().__init__(session, KEY, name="edge")
        self.mangler = mangler

    def _send(self, entry: LogEntry) -> None:
        self.mangler.send(entry)
