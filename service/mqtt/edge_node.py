"""One edge node of Sparkplug B: its count of messages, the names of its metrics, its life and death.

A node counts its messages modulo 256. What is missing between two of them is counted as missing samples of every machine that
it feeds: whose message it was is not known, and 256 missing ones in a row are not seen. What a message does not carry is as it
was before, as the specification says; after a gap or a death it is unknown until it comes again.
Source: Eclipse Sparkplug Specification 3.0.0 (2022), §6.4.5 to §6.4.26: births, data and DDEATH are counted by `seq`; a node's
NDEATH, its will at the broker, has the `bdSeq` of the birth that it ends instead.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from estimator.machine.document import Machine
from estimator.machine.sparkplug import Sparkplug
from formats.wire import Rejected
from service.mqtt.sparkplug_payload import SparkplugMetric, SparkplugPayload

COUNT = 256
REBIRTH_S, LONGEST_REBIRTH_S = 10.0, 600.0
"""Least time between two requests to one node for its names, twice as long after each in vain, up to the longest [s]."""
BIRTH_NUMBER = "bdSeq"
"""Name of the metric by which a node's death tells which birth it ends."""
NODE_BIRTH, DEVICE_BIRTH, NODE_DATA, DEVICE_DATA = "NBIRTH", "DBIRTH", "NDATA", "DDATA"
NODE_DEATH, DEVICE_DEATH = "NDEATH", "DDEATH"
COUNTED = frozenset({NODE_BIRTH, DEVICE_BIRTH, NODE_DATA, DEVICE_DATA, DEVICE_DEATH})
"""Kinds of messages that a node counts."""

MessageMark = tuple[int, int | None]
"""Count and time of a message."""


@dataclass
class MachineFeed:
    """A machine that a node feeds: its last values by metric, and the number of its next sample."""

    machine: Machine
    mapping: Sparkplug
    sequence: int = 0
    values: dict[str, float | None] = field(default_factory=dict)

    @property
    def device(self) -> str:
        """Return the device whose metrics it has; empty for the node's own."""
        return self.mapping.device or ""


@dataclass
class EdgeNode:
    """A Sparkplug edge node: its machines, metric names by device and alias, last sequence numbers, requested rebirths."""

    feeds: list[MachineFeed]
    names: dict[tuple[str, int], str] = field(default_factory=dict)
    recent: deque[MessageMark] = field(default_factory=lambda: deque(maxlen=COUNT))
    last: int | None = None
    birth_number: float | None = None
    asked_at: float = -LONGEST_REBIRTH_S
    rebirth_pause: float = REBIRTH_S
    wants_rebirth: bool = False
    missing: int = 0

    def count(self, payload: SparkplugPayload, kind: str) -> bool:
        """Follow the node's count; return False for a message that came before. Raises Rejected without a count."""
        if payload.sequence is None:
            raise Rejected("undecodable", "a Sparkplug message without seq: what is missing before it cannot be counted")
        mark = (payload.sequence, payload.timestamp)
        if mark in self.recent and (payload.timestamp is not None or mark == self.recent[-1]):
            return False
        if kind != NODE_BIRTH:
            if self.last is None:
                self.want_rebirth()  # what it said at its birth was not heard
            elif gap := (payload.sequence - self.last - 1) % COUNT:
                self._note_gap(gap)
        self.last = payload.sequence
        self.recent.append(mark)
        return True

    def is_born(self, payload: SparkplugPayload, device: str, kind: str) -> None:
        """Note the names of a birth; a birth states all values of its node or device again."""
        if kind == NODE_BIRTH:
            self.names.clear()
            self.birth_number = birth_number(payload.metrics)
        for metric in payload.metrics:
            if metric.name is not None and metric.alias is not None:
                self.names[device, metric.alias] = metric.name
        self.forget(None if kind == NODE_BIRTH else device)

    def dies(self, payload: SparkplugPayload) -> None:
        """Note the node's death, unless it is that of an earlier birth: a will may come after the node is back."""
        number = birth_number(payload.metrics)
        if number is None or self.birth_number is None or number == self.birth_number:
            self.last = None
            self.forget(None)

    def want_rebirth(self) -> None:
        """Note that the node must be asked for its names for a new reason: earlier unanswered requests do not count."""
        self.wants_rebirth, self.rebirth_pause = True, REBIRTH_S

    def claim_rebirth_request(self, moment: float) -> bool:
        """Return whether the node is to be asked for its names now, and note that it was. moment: by a monotonic clock [s]."""
        if not self.wants_rebirth or moment < self.asked_at + self.rebirth_pause:
            return False
        if self.asked_at >= 0.0:
            self.rebirth_pause = min(2.0 * self.rebirth_pause, LONGEST_REBIRTH_S)
        self.asked_at, self.wants_rebirth = moment, False
        return True

    def forget(self, device: str | None) -> None:
        """Make the values of a device unknown; None for all."""
        for feed in self.feeds:
            if device in (None, feed.device):
                feed.values.clear()

    def _note_gap(self, gap: int) -> None:
        self.missing += gap
        self.want_rebirth()
        for feed in self.feeds:
            feed.sequence += gap
        self.forget(None)


def birth_number(metrics: Sequence[SparkplugMetric]) -> float | None:
    """Return the birth's number among metrics; None without one."""
    return next((one.value for one in metrics if one.name == BIRTH_NUMBER), None)
