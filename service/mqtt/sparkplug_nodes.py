"""Edge nodes of Sparkplug B: their metrics become samples of the machines whose documents name them.

Source: Eclipse Sparkplug Specification 3.0.0 (2022), §6.4.5 to §6.4.26; counts, births and deaths: `edge_node.py`.
"""

import logging
import time
from collections.abc import Iterator, Mapping, Sequence

from estimator.machine.document import Machine
from estimator.machine.sparkplug import Sparkplug
from formats.wire import SampleBatch
from service.mqtt.edge_node import (
    COUNTED,
    DEVICE_BIRTH,
    DEVICE_DEATH,
    NODE_BIRTH,
    NODE_DEATH,
    EdgeNode,
    MachineFeed,
)
from service.mqtt.sparkplug_payload import SparkplugMetric, SparkplugPayload, decoded, rebirth

logger = logging.getLogger(__name__)

NAMESPACE = "spBv1.0"
SOURCE = "sparkplug"
"""Source of the samples in the store."""
LATEST_NS = 2**62
"""Latest time that a sample can say; later ones are refused as out of range like it [ns]."""

NodeId = tuple[str, str]
"""Group and node."""


class SparkplugNodes:
    """All nodes that documents name. epoch: epoch of the samples, grows with each start of the service."""

    def __init__(self, epoch: int) -> None:
        self._epoch = epoch
        self._nodes: dict[NodeId, EdgeNode] = {}
        self._sequences: dict[str, int] = {}
        self._missing_before = 0

    @property
    def missing(self) -> int:
        """Return how many messages were lost, by the nodes' sequence numbers."""
        return self._missing_before + sum(one.missing for one in self._nodes.values())

    def follow(self, machines: Sequence[Machine]) -> None:
        """Update the machines after the documents in force; values of machines with an unchanged mapping are kept."""
        known = {feed.machine.id: feed for node in self._nodes.values() for feed in node.feeds}
        # Numbers go on where a mapping comes back: samples of numbers that the store knows would be taken for duplicates.
        self._sequences |= {machine: feed.sequence for machine, feed in known.items()}
        nodes: dict[NodeId, EdgeNode] = {}
        for machine in machines:
            mapping = machine.sparkplug
            if mapping is None:
                continue
            place = (mapping.group, mapping.node)
            if place not in nodes:
                nodes[place] = self._nodes.get(place) or EdgeNode([])
                nodes[place].feeds = []
            feed = known.get(machine.id)
            if feed is None or feed.mapping != mapping:
                # Earlier values of these metrics were not kept: a rebirth is requested when the node next sends.
                feed = MachineFeed(machine, mapping, self._sequences.get(machine.id, 0))
                if nodes[place].last is not None:
                    nodes[place].want_rebirth()
            feed.machine = machine
            nodes[place].feeds.append(feed)
        self._missing_before += sum(one.missing for place, one in self._nodes.items() if place not in nodes)
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
        if node is None or kind not in COUNTED | {NODE_DEATH}:
            return []
        payload = decoded(body)
        if kind == NODE_DEATH:
            node.dies(payload)
            return []
        if not node.count(payload, kind):
            return []
        if kind == DEVICE_DEATH:
            node.forget(device)
            return []
        if kind in (NODE_BIRTH, DEVICE_BIRTH):
            node.is_born(payload, device, kind)
            _log_missing_metrics(node, payload, topic, device)
        return list(self._samples(node, payload, device))

    def rebirths(self) -> Iterator[tuple[str, bytes]]:
        """Yield topic and payload for each node whose names are not known; each node is asked now and then only."""
        for (group, name), node in self._nodes.items():
            if node.claim_rebirth_request(time.monotonic()):
                yield f"{NAMESPACE}/{group}/NCMD/{name}", rebirth(time.time_ns() // 1_000_000)

    def _place(self, topic: str) -> tuple[str, EdgeNode | None, str]:
        """Return what kind of message a topic is for, its node where a document names it, and its device."""
        parts = topic.split("/")
        if len(parts) not in (4, 5) or parts[0] != NAMESPACE:
            return "", None, ""
        return parts[2], self._nodes.get((parts[1], parts[3])), parts[4] if len(parts) == 5 else ""

    def _samples(self, node: EdgeNode, payload: SparkplugPayload, device: str) -> Iterator[SampleBatch]:
        found = _named(node, payload.metrics, device)
        for feed in node.feeds:
            if feed.device != device:
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
            if values.get(feed.mapping.speed) is None:
                node.wants_rebirth = True
            else:
                yield self._batch(feed, values, min(moment * 1_000_000, LATEST_NS))

    def _batch(self, feed: MachineFeed, values: Mapping[str, float | None], time_ns: int) -> SampleBatch:
        mapping, machine = feed.mapping, feed.machine
        sequence, feed.sequence = feed.sequence, feed.sequence + 1
        conditions = {name: [values.get(metric)] for name, metric in mapping.conditions.items()}
        gap = _row(values, [one.gap for one in mapping.channels.values()])
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
            gap=gap,
            gap_unit=None if gap is None else mapping.gap_unit,
            overall=_row(values, [one.overall for one in mapping.channels.values()]),
            conditions=conditions or None,
        )


def _named(node: EdgeNode, metrics: Sequence[SparkplugMetric], device: str) -> dict[str, SparkplugMetric]:
    """Return metrics by name; without the birth that says what an alias stands for, the node is asked for it."""
    found = {}
    for one in metrics:
        name = one.name if one.name is not None else node.names.get((device, one.alias if one.alias is not None else -1))
        if name is None:
            node.wants_rebirth = True
        else:
            found[name] = one
    return found


def _log_missing_metrics(node: EdgeNode, payload: SparkplugPayload, topic: str, device: str) -> None:
    """Log which metrics a document names that the birth does not have: their values will never come."""
    born = {one.name for one in payload.metrics}
    for feed in node.feeds:
        missing = sorted(_metrics_of(feed.mapping) - born) if feed.device == device else []
        if missing:
            words = "%s has no metric %s, which the document of machine '%s' names; it has %d others"
            logger.warning(words, topic, ", ".join(missing), feed.machine.id, len(born))


def _row(values: Mapping[str, float | None], metrics: Sequence[str | None]) -> list[list[float | None]] | None:
    """Return the values of metrics, one a channel, as the table of one sample; None where no channel has such a metric."""
    if not any(metrics):
        return None
    return [[None if one is None else values.get(one) for one in metrics]]


def _metrics_of(mapping: Sparkplug) -> set[str]:
    """Return the names of all metrics that a machine's values come from."""
    of_channels = {
        name for one in mapping.channels.values() for name in (one.amplitude, one.phase, one.gap, one.overall) if name
    }
    return {mapping.speed, *of_channels, *mapping.conditions.values()}
