"""The schema of a message, the same for all encodings, with its version and limits."""

from collections.abc import Mapping

import msgspec

from estimator.phasors.channel_status import ChannelStatus
from formats.wire.keys import IDENTIFIER
from formats.wire.rejection import Rejected
from storage.encoding.source_key import SourceKey

WIRE_SCHEMA = 1
LARGEST_BATCH = 5_000
LARGEST_CHANNEL_COUNT = 128
LARGEST_CONDITION_COUNT = 16

STATUSES = {status.label: status for status in ChannelStatus}
DIRECTIONS = {"positive": 1, "negative": -1}

TABLES = ("amplitude", "phase", "status", "scatter", "amplitude_2x", "phase_2x", "gap", "overall")
"""Fields with a row per sample and a column per channel."""

ChannelTable = list[list[float | None]]


class SampleBatch(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Consecutive samples of one machine from one source.

    epoch: any number that grows with each start of the source, such as its start time; sequence: number of the first sample in
    this epoch, counted from 0; the others follow without a gap. time_ns: per sample, UTC since 1970. amplitude, phase, status,
    scatter: per sample a list over the channels; null where there is no value. status: `good`, `not_available`, `bad` or
    `out_of_range`; without it all are good. scatter: rms of the complex error, in the amplitude's unit. amplitude_2x,
    phase_2x: amplitude and phase of the 2×, in the same units, with phase counted in degrees of 2×. gap: mean of the probe's
    signal over the sample, in `gap_unit`; the machine's document says which way it grows. overall: unfiltered vibration, in
    the unit and kind of the amplitude: peak-to-peak the largest less the smallest displacement of the sample, peak the half of
    it. direction: `positive` turns +x towards +y. conditions: by name of an operating condition its value per sample, in the
    unit of the machine's document; null where it was not measured.
    """

    schema: int
    plant: str
    machine: str
    source: str
    epoch: int
    sequence: int
    channels: list[str]
    speed_unit: str
    amplitude_unit: str
    amplitude_kind: str
    phase_convention: str
    phase_unit: str
    direction: str
    time_ns: list[int]
    speed: list[float]
    amplitude: ChannelTable
    phase: ChannelTable
    status: list[list[str]] | None = None
    scatter: ChannelTable | None = None
    amplitude_2x: ChannelTable | None = None
    phase_2x: ChannelTable | None = None
    gap: ChannelTable | None = None
    gap_unit: str | None = None
    overall: ChannelTable | None = None
    conditions: dict[str, list[float | None]] | None = None


def source_key(batch: SampleBatch) -> SourceKey:
    """Return the source and epoch of a batch."""
    return SourceKey(batch.machine, batch.source, batch.epoch)


def require_schema(version: int) -> None:
    """Raise Rejected for a schema version that this service does not know."""
    if version < 1:
        raise Rejected("undecodable", f"there is no schema {version}; this service knows 1 to {WIRE_SCHEMA}")
    if version > WIRE_SCHEMA:
        raise Rejected("future_schema", f"schema {version} is newer than this service's {WIRE_SCHEMA}: upgrade it first")


def require_shape(batch: SampleBatch) -> None:
    """Raise Rejected for a batch whose parts do not match in size or exceed the limits."""
    count, channels = len(batch.time_ns), len(batch.channels)
    if not 1 <= count <= LARGEST_BATCH:
        raise Rejected("wrong_shape", f"{count} samples; a batch has 1 to {LARGEST_BATCH}")
    if not 1 <= channels <= LARGEST_CHANNEL_COUNT or len(set(batch.channels)) != channels:
        raise Rejected("wrong_shape", f"{channels} channels; a batch has 1 to {LARGEST_CHANNEL_COUNT}, each once")
    if not IDENTIFIER.match(batch.source):
        raise Rejected("wrong_shape", "source must be letters, digits, '_' and '-', up to 64")
    if not (0 <= batch.epoch < 2**63 and 0 <= batch.sequence < 2**62):
        raise Rejected("wrong_shape", "epoch and sequence must not be negative and must fit 63 bits")
    if len(batch.speed) != count:
        raise Rejected("wrong_shape", f"speed has {len(batch.speed)} values for {count} samples")
    _require_conditions(batch.conditions or {}, count)
    _require_tables(batch, count, channels)


def _require_conditions(conditions: Mapping[str, list[float | None]], count: int) -> None:
    """Raise Rejected for too many operating conditions, or one that has not a value for each sample."""
    if len(conditions) > LARGEST_CONDITION_COUNT:
        raise Rejected("wrong_shape", f"{len(conditions)} conditions; at most {LARGEST_CONDITION_COUNT} ride along")
    for name, values in conditions.items():
        if len(values) != count:
            raise Rejected("wrong_shape", f"condition {name[:64]} has {len(values)} values for {count} samples")


def _require_tables(batch: SampleBatch, count: int, channels: int) -> None:
    """Raise Rejected for a table that has not a value for each sample and channel."""
    if (batch.amplitude_2x is None) != (batch.phase_2x is None):
        raise Rejected("wrong_shape", "amplitude_2x and phase_2x come together or not at all")
    if (batch.gap is None) != (batch.gap_unit is None):
        raise Rejected("wrong_shape", "gap and gap_unit come together or not at all")
    for name in TABLES:
        rows = getattr(batch, name)
        if rows is not None and (len(rows) != count or any(len(row) != channels for row in rows)):
            raise Rejected("wrong_shape", f"{name} must have {count} rows of {channels} values")
