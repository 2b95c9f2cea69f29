"""Edge nodes of Sparkplug B: their metrics become samples of the machines whose documents name them.

A node counts its messages modulo 256. What is missing between two of them is counted as missing samples of every machine that
it feeds: whose message it was is not known, and 256 missing ones in a row are not seen. What a message does not carry is as it
was before, as the specification says; after a gap it is unknown until it comes again.
Source: Eclipse Sparkplug Specification 3.0.0 (2022), §6.4.5 to §6.4.26.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from estimator.machine.document import Machine
from estimator.machine.sparkplug import Sparkplug
from service.mqtt.sparkplug_payload import SparkplugMetric, SparkplugPayload, decoded, rebirth
from service.wire import Rejected, SampleBatch

NAMESPACE = "spBv1.0"
SOURCE = "sparkplug"
"""Source of the samples in the store."""
COUNT = 256
REBIRTH_S = 10.0
"""Least time between two requests to one node for its names [s]."""

NodeId = tuple[str, str]
"""Group and node."""


@dataclass
class MachineFeed:
    """A machine that a node feeds: its last values by metric, and the number of its next sample."""

    machine: Machine
    mapping: Sparkplug
    sequence: int = 0
    values: dict[str, float | None] = field(default_factory=dict)


@dataclass
class EdgeNode:
    """A node: names by device and alias, the last count and its time, the machines that it feeds."""

    feeds: list[MachineFeed]
    names: dict[tuple[str, int], str] = field(default_factory=dict)
    last: int | None = None
    last_timestamp: int | None = None
    asked_at: float = -REBIRTH_S
    wants_rebirth: bool = False


class SparkplugNodes:
    """All nodes that documents name. epoch: epoch of the samples, grows with each start of the service."""

    def __init__(self, epoch: int) -> None:
        self._epoch = epoch
        self._nodes: dict[NodeId, EdgeNode] = {}
        self.missing = 0
        """Messages that never came, as far as the nodes' counts tell."""

    def follow(self, machines: Sequence[Machine]) -> None:
        """Take the documents in force; values of machines whose mapping is the same are kept."""
        known = {feed.machine.id: feed for node in self._nodes.values() for feed in node.feeds}
        nodes: dict[NodeId, EdgeNode] = {}
        for machine in machines:
            mapping = machine.sparkplug
            if mapping is None:
                continue
            feed = known.get(machine.id) or MachineFeed(machine, mapping)
            if feed.mapping != mapping:
                feed.values.clear()
            feed.machine, feed.mapping = machine, mapping
            place = (mapping.group, mapping.node)
            if place not in nodes:
                nodes[place] = self._nodes.get(place) or EdgeNode([])
                nodes[place].feeds = []
            nodes[place].feeds.append(feed)
        self._nodes = nodes

    @property
    def filters(self) -> list[str]:
        """Return the topics to subscribe to."""
        return [f"{NAMESPACE}/{group}/+/{node}/#" for group, node in self._nodes]

    def machines_of(self, topic: str) -> list[Machine]:
        """Return the machines that a topic's node feeds."""
        _, node, _ = self._place(topic)
        return [] if node is None else [one.machine for one in node.feeds]

    def batches(self, topic: str, body: bytes) -> list[SampleBatch]:
        """Return the samples in a message, one for each machine that it has values of. Raises Rejected."""
        kind, node, device = self._place(topic)
        if node is None or kind not in ("NBIRTH", "DBIRTH", "NDATA", "DDATA"):
            return []
        payload = decoded(body)
        if not self._count(node, payload, kind):
            return []
        if kind.endswith("BIRTH"):
            self._name(node, payload, device, kind)
        return list(self._samples(node, payload, device))

    def rebirths(self) -> Iterator[tuple[str, bytes]]:
        """Yield topic and payload for each node whose names are not known; each node is asked now and then only."""
        for (group, name), node in self._nodes.items():
            if node.wants_rebirth and time.monotonic() >= node.asked_at + REBIRTH_S:
                node.asked_at, node.wants_rebirth = time.monotonic(), False
                yield f"{NAMESPACE}/{group}/NCMD/{name}", rebirth(time.time_ns() // 1_000_000)

    def _place(self, topic: str) -> tuple[str, EdgeNode | None, str]:
        """Return what kind of message a topic is for, its node where a document names it, and its device."""
        parts = topic.split("/")
        if len(parts) not in (4, 5) or parts[0] != NAMESPACE:
            return "", None, ""
        return parts[2], self._nodes.get((parts[1], parts[3])), parts[4] if len(parts) == 5 else ""

    def _count(self, node: EdgeNode, payload: SparkplugPayload, kind: str) -> bool:
        """Follow the node's count; return False for a message that came before."""
        if payload.sequence is None:
            raise Rejected("undecodable", "a Sparkplug message without seq: what is missing before it cannot be counted")
        if kind == "NBIRTH":
            node.names.clear()
        elif node.last is not None:
            if payload.sequence == node.last and payload.timestamp == node.last_timestamp:
                return False
            gap = (payload.sequence - node.last - 1) % COUNT
            if gap:
                self._note_gap(node, gap)
        node.last, node.last_timestamp = payload.sequence, payload.timestamp
        return True

    def _note_gap(self, node: EdgeNode, gap: int) -> None:
        self.missing += gap
        node.wants_rebirth = True
        for feed in node.feeds:
            feed.sequence += gap
            feed.values.clear()

    def _name(self, node: EdgeNode, payload: SparkplugPayload, device: str, kind: str) -> None:
        """Note the names of a birth; all values of what was born are told anew in it."""
        for metric in payload.metrics:
            if metric.name is not None and metric.alias is not None:
                node.names[device, metric.alias] = metric.name
        for feed in node.feeds:
            if kind == "NBIRTH" or (feed.mapping.device or "") == device:
                feed.values.clear()

    def _samples(self, node: EdgeNode, payload: SparkplugPayload, device: str) -> Iterator[SampleBatch]:
        found = self._named(node, payload.metrics, device)
        for feed in node.feeds:
            if (feed.mapping.device or "") != device:
                continue
            wanted = _metrics_of(feed.mapping)
            new = {name: one for name, one in found.items() if name in wanted}
            if not new:
                continue
            if any(one.is_historical for one in new.values()):
                values = {name: one.value for name, one in new.items()}
            else:
                feed.values |= {name: one.value for name, one in new.items()}
                values = feed.values
            moment = payload.timestamp or max((one.timestamp or 0 for one in new.values()), default=0)
            if values.get(feed.mapping.speed) is not None:
                yield self._batch(feed, values, moment * 1_000_000)

    def _named(self, node: EdgeNode, metrics: Sequence[SparkplugMetric], device: str) -> dict[str, SparkplugMetric]:
        """Return metrics by name; without the birth that says what an alias stands for, the node is asked for it."""
        found = {}
        for one in metrics:
            name = one.name if one.name is not None else node.names.get((device, one.alias if one.alias is not None else -1))
            if name is None:
                node.wants_rebirth = True
            else:
                found[name] = one
        return found

    def _batch(self, feed: MachineFeed, values: dict[str, float | None], time_ns: int) -> SampleBatch:
        mapping, machine = feed.mapping, feed.machine
        sequence, feed.sequence = feed.sequence, feed.sequence + 1
        conditions = {name: [values.get(metric)] for name, metric in mapping.conditions.items()}
        return SampleBatch(
            schema=1,
            plant=machine.plant,
            machine=machine.id,
            source=SOURCE,
            epoch=self._epoch,
            sequence=sequence,
            channels=list(mapping.channels),
            speed_unit=mapping.speed_unit,
            amplitude_unit=mapping.amplitude_unit,
            amplitude_kind=mapping.amplitude_kind,
            phase_convention=mapping.phase_convention,
            phase_unit=mapping.phase_unit,
            direction=machine.rotation,
            time_ns=[time_ns],
            speed=[float(values.get(mapping.speed) or 0.0)],
            amplitude=[[values.get(one.amplitude) for one in mapping.channels.values()]],
            phase=[[values.get(one.phase) for one in mapping.channels.values()]],
            conditions=conditions or None,
        )


def _metrics_of(mapping: Sparkplug) -> set[str]:
    """Return the names of all metrics that a machine's values come from."""
    of_channels = {name for one in mapping.channels.values() for name in (one.amplitude, one.phase)}
    return {mapping.speed, *of_channels, *mapping.conditions.values()}
