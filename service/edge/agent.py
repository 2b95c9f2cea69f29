"""The agent: waveforms → blocks → samples → log → network, with a report of its status."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from estimator.phasors.channel_status import ChannelStatus
from estimator.signal.keyphasor import Threshold
from estimator.signal.order_tracking import Block
from estimator.signal.waveform_faults import UNUSABLE
from estimator.units import rad_per_s_to_rpm
from formats.wire import WIRE_SCHEMA, SampleBatch
from service.edge.block_outcomes import BlockOutcome, BlockSettings, Position
from service.edge.blocks import BlockStream
from service.edge.condition import Conditions, WaveformFinding
from service.edge.configuration import EdgeConfiguration, InputFile
from service.edge.files import read_chunks
from service.edge.topic import Topic
from service.sources.publisher import Source
from service.sources.replay_log import LogError
from storage.clock import is_ahead

logger = logging.getLogger(__name__)

BATCH_SAMPLES = 20
"""Samples in one message."""
BATCH_S = 0.2
"""Longest time for which samples are collected into one message."""
LOG_RETRY_S = 0.5
"""Pause after the log refused a batch."""


class Progress(msgspec.Struct, kw_only=True):
    """Progress of the agent: the position that its log stores with each batch.

    time_ns: time of the last sample; only later samples are published. file: the file being read, as configured; place:
    position in it, None when it is finished. mark in place: see `blocks.Position`.
    """

    time_ns: int = 0
    file: str | None = None
    place: Position | None = None


class Agent:
    """The agent: it processes the configured input and publishes the samples. The source's log holds its progress."""

    def __init__(self, configuration: EdgeConfiguration, source: Source) -> None:
        self.conditions = Conditions()
        self._configuration = configuration
        self._source = source
        self._settings = block_settings(configuration)
        self._factors = np.array(configuration.factors)
        self._progress = Progress()
        if source.log.position is not None:
            self._progress = msgspec.json.decode(source.log.position, type=Progress)
        self._batch: SampleBatch | None = None
        self._batch_began = 0.0
        self._pace_began: tuple[float, int] | None = None
        self._samples = 0
        self._blocks = 0

    def read_files(self, stop: threading.Event, *, speedup: float | None = None) -> None:
        """Read all configured files from where it stopped, or until `stop`. speedup: pace relative to real time; None:
        unpaced."""
        files = self._configuration.waveforms.files
        names = [str(file.path) for file in files]
        at = names.index(self._progress.file) if self._progress.file in names else 0
        for file in files[at:]:
            place = self._progress.place if self._progress.file == str(file.path) else None
            if self._progress.file == str(file.path) and place is None:
                continue  # done with
            logger.info("reading %s", file.path)
            self._read(file, place, stop, speedup)
            if stop.is_set():
                return
            self._publish(stop)
        self._flush_log(stop)

    def follow(self, topic: Topic, stop: threading.Event) -> None:
        """Follow a topic until `stop`."""
        stream = BlockStream(self._settings)
        for chunk in topic.chunks(stop):
            if chunk is not None:
                for outcome in stream.feed(chunk):
                    self._take(outcome, self._progress_at(None, None), stop)
            if self._batch is not None and time.monotonic() - self._batch_began > BATCH_S:
                self._publish(stop)
        for outcome in stream.finish():
            self._take(outcome, self._progress_at(None, None), stop)
        self._publish(stop)

    def status(self) -> dict[str, Any]:
        """Return the status of the agent."""
        log = self._source.log.status()
        return {
            "source": self._source.name,
            "epoch": log.epoch,
            "next_sequence": log.next_sequence,
            "time_ns": self._progress.time_ns,
            "file": self._progress.file,
            "blocks": self._blocks,
            "samples": self._samples,
            "log": {name: value for name, value in asdict(log).items() if name not in ("epoch", "next_sequence")},
            **self.conditions.report(),
        }

    def _read(self, file: InputFile, place: Position | None, stop: threading.Event, speedup: float | None) -> None:
        stream = BlockStream(self._settings, place)
        waveforms = self._configuration.waveforms
        anchor = None if place is None else (place.anchor, place.anchor_ns)
        rate = None if place is None else place.sampling_rate
        columns, first = self._configuration.columns, stream.first_needed()
        chunks = read_chunks(file, waveforms, columns, self.conditions, first=first, anchor=anchor, rate=rate)
        for chunk in chunks:
            for outcome in stream.feed(chunk):
                if not self._paced(outcome.time_ns, stop, speedup):
                    return
                self._take(outcome, self._progress_at(file.path, outcome.position), stop)
        for outcome in stream.finish():
            if not self._paced(outcome.time_ns, stop, speedup):
                return
            self._take(outcome, self._progress_at(file.path, outcome.position), stop)
        self.conditions.block([])
        self._progress = self._progress_at(file.path, None)

    def _progress_at(self, file: Path | None, place: Position | None) -> Progress:
        return Progress(time_ns=self._progress.time_ns, file=None if file is None else str(file), place=place)

    def _paced(self, time_ns: int, stop: threading.Event, speedup: float | None) -> bool:
        """Wait until a block is due; return False when the agent is to stop."""
        if speedup is not None:
            if self._pace_began is None:
                self._pace_began = time.monotonic(), time_ns
            due = self._pace_began[0] + (time_ns - self._pace_began[1]) / 1e9 / speedup
            if due - time.monotonic() > 0.0:
                self._publish(stop)
                stop.wait(due - time.monotonic())
        return not stop.is_set()

    def _take(self, outcome: BlockOutcome, progress: Progress, stop: threading.Event) -> None:
        """Process one outcome, in order."""
        self._blocks += 1
        found = list(outcome.found)
        if outcome.block is not None:
            time_ns = outcome.time_ns
            # What a wrong clock once said is taken by no service, and must not shut out all that comes after it.
            if time_ns > self._progress.time_ns or is_ahead(self._progress.time_ns):
                progress.time_ns = time_ns
                self._add(outcome.block, time_ns, bad=any(one.name == "phase_reference_lost" for one in found))
            else:
                found.append(WaveformFinding("time_reversed", None, "the block is not later than what was published before"))
        self.conditions.block(found)
        self._progress = progress
        if self._batch is not None and (
            len(self._batch.time_ns) >= BATCH_SAMPLES or time.monotonic() - self._batch_began > BATCH_S
        ):
            self._publish(stop)

    def _add(self, block: Block, time_ns: int, *, bad: bool) -> None:
        if self._batch is None:
            self._batch, self._batch_began = self._empty_batch(), time.monotonic()
        batch = self._batch
        size = np.abs(block.phasors) * self._factors[:, None]
        phase = np.degrees(np.angle(block.phasors))
        scatter = block.scatter[:, 0] * self._factors
        batch.time_ns.append(time_ns)
        batch.speed.append(rad_per_s_to_rpm(block.speed))
        for table, row in (
            (batch.amplitude, size[:, 0]),
            (batch.phase, phase[:, 0]),
            (batch.amplitude_2x, size[:, 1]),
            (batch.phase_2x, phase[:, 1]),
            (batch.scatter, scatter),
            *([] if batch.gap is None else [(batch.gap, block.mean * self._factors)]),
            *([] if batch.overall is None else [(batch.overall, block.overall * self._factors)]),
        ):
            assert table is not None
            table.append([float(value) if np.isfinite(value) else None for value in row])
        assert batch.status is not None
        batch.status.append([status.label for status in channel_statuses(block, bad=bad)])

    def _publish(self, stop: threading.Event) -> None:
        """Publish the collected samples, retrying while the log refuses them."""
        batch, self._batch = self._batch, None
        if batch is None:
            return
        position = msgspec.json.encode(self._progress).decode()
        if self._publish_with_retry(lambda: self._source.publish(batch, position=position), stop):
            self._samples += len(batch.time_ns)

    def _flush_log(self, stop: threading.Event) -> None:
        """Wait until all samples are in the log."""
        if self._publish_with_retry(self._source.log.flush, stop):
            self.conditions.block([])

    def _publish_with_retry(self, action: Callable[[], None], stop: threading.Event) -> bool:
        """Retry an action while the log cannot be used; return False when stopped before it succeeded."""
        while True:
            try:
                action()
            except LogError as error:
                if not self.conditions.holds("log_unusable"):
                    self.conditions.begin("log_unusable", None, str(error))
                if stop.wait(LOG_RETRY_S):
                    return False
            else:
                return True

    def _empty_batch(self) -> SampleBatch:
        configuration = self._configuration
        return SampleBatch(
            schema=WIRE_SCHEMA,
            plant=configuration.plant,
            machine=configuration.machine,
            source=configuration.source,
            epoch=0,
            sequence=0,
            channels=[channel.probe for channel in configuration.channels],
            speed_unit="rpm",
            amplitude_unit=configuration.amplitude_unit,
            amplitude_kind="peak",
            phase_convention="lead",
            phase_unit="deg",
            direction=configuration.direction,
            time_ns=[],
            speed=[],
            amplitude=[],
            phase=[],
            status=[],
            scatter=[],
            amplitude_2x=[],
            phase_2x=[],
            gap=[] if configuration.gap else None,
            gap_unit=configuration.amplitude_unit if configuration.gap else None,
            overall=[] if configuration.overall else None,
        )


def channel_statuses(block: Block, *, bad: bool) -> list[ChannelStatus]:
    """Return the status of each channel. bad: whether all channels are bad."""
    return [
        ChannelStatus.BAD
        if bad or fault in UNUSABLE
        else ChannelStatus.OUT_OF_RANGE
        if fault is not None
        else ChannelStatus.GOOD
        for fault in block.faults
    ]


def block_settings(configuration: EdgeConfiguration) -> BlockSettings:
    """Return the part of the configuration that determines how waveforms become samples."""
    keyphasor = configuration.keyphasor
    threshold = None
    if keyphasor.threshold is not None and keyphasor.hysteresis is not None:
        threshold = Threshold(keyphasor.threshold, keyphasor.hysteresis)
    return BlockSettings(
        channels=tuple(channel.probe for channel in configuration.channels),
        lowest_rpm=configuration.speed_range.minimum_rpm,
        highest_rpm=configuration.speed_range.maximum_rpm,
        rails=tuple(configuration.all_rails),
        seconds=configuration.block.seconds,
        turns=configuration.block.turns,
        edge=keyphasor.edge,
        pulses_per_turn=keyphasor.pulses_per_turn,
        threshold=threshold,
    )
