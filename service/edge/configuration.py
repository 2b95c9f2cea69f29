"""Configuration of the edge agent: one YAML or JSON file, described by this schema."""

from datetime import datetime
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, ValidationError, field_validator, model_validator

from estimator.field_types import Identifier, Positive, Real
from estimator.machine.document import problems_of
from estimator.machine.rules import SpeedRange
from estimator.signal.keyphasor import Edge
from estimator.strict_model import StrictModel
from estimator.units import METRES
from formats.files.document_files import UnreadableFile, read_yaml
from formats.measuring_systems.measured_files import READERS
from formats.wire import BINARY, JSON, LARGEST_CHANNEL_COUNT, MESSAGEPACK
from service.configuration.settings import DEFAULT_ZENOH_ENDPOINT
from service.sources.replay_log import LOG_BYTES, LOG_SAMPLES

ENCODINGS = {"binary": BINARY, "msgpack": MESSAGEPACK, "json": JSON}
SUFFIXES = {".csv", ".npz", ".h5", ".hdf5", ".wav", *READERS}

Range = tuple[Real, Real]


class _ConfigurationPart(StrictModel):
    model_config = ConfigDict(frozen=True)


class ProbeChannel(_ConfigurationPart):
    """A probe's waveform."""

    probe: Identifier = Field(description="id of the probe in the machine's document")
    column: str = Field(description="where its waveform is: CSV column, NPZ array, HDF5 dataset, number in a WAV from 1, …")
    sensitivity: Positive | None = Field(default=None, description="[V/m]; without it the machine's document gives it")
    rails: Range | None = Field(default=None, description="measuring range in the unit of the waveform; see `rails`")


class KeyphasorChannel(_ConfigurationPart):
    """The once-per-turn mark and how its edge is detected."""

    column: str
    edge: Edge = "rising"
    threshold: Real | None = Field(default=None, description="level of the edge; halfway between the signal's two without it")
    hysteresis: Positive | None = Field(default=None, description="how far around the threshold noise is ignored")
    pulses_per_turn: Annotated[int, Field(ge=1, le=1024)] = 1

    @model_validator(mode="after")
    def _together(self) -> Self:
        if (self.threshold is None) != (self.hysteresis is None):
            raise ValueError("threshold and hysteresis are given together or not at all")
        return self


class BlockLength(_ConfigurationPart):
    """Length of the waveform that makes one sample: some seconds, or some turns."""

    seconds: Annotated[float, Field(gt=0, le=60)] | None = None
    turns: Annotated[int, Field(ge=3, le=1000)] | None = None

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if (self.seconds is None) == (self.turns is None):
            raise ValueError("give either seconds or turns")
        return self


class InputFile(_ConfigurationPart):
    """A recorded waveform."""

    path: Path
    start: datetime | None = Field(default=None, description="time of the first sample; without it the file must say it")

    @field_validator("path")
    @classmethod
    def _known(cls, path: Path) -> Path:
        if path.suffix.lower() not in SUFFIXES:
            raise ValueError(f"'{path.name}' has none of the endings {', '.join(sorted(SUFFIXES))}")
        return path

    @field_validator("start")
    @classmethod
    def _zoned(cls, start: datetime | None) -> datetime | None:
        if start is not None and start.tzinfo is None:
            raise ValueError("needs a time zone, such as a Z at its end")
        return start


class Waveforms(_ConfigurationPart):
    """Origin of the waveforms: files, one after the other, or a zenoh topic."""

    files: list[InputFile] = Field(default_factory=list)
    topic: Annotated[str, Field(min_length=1, max_length=400)] | None = Field(default=None, description="a zenoh key")
    sampling_rate: Positive | None = Field(default=None, description="[Hz]; needed where the file or message says none")
    time: str | None = Field(default=None, description="column with seconds since the start")
    unit: Literal["V", "m", "mm", "um", "mil"] = "V"
    full_scale: Positive = Field(default=1.0, description="value in that unit of the largest number in a WAV file")

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if bool(self.files) == (self.topic is not None):
            raise ValueError("give either files or a topic")
        return self


class LogFileSettings(_ConfigurationPart):
    """The file in which samples are kept for replay, and how many."""

    path: Path
    samples: Annotated[int, Field(ge=1)] = LOG_SAMPLES
    megabytes: Positive = LOG_BYTES / (1 << 20)


class EdgeConfiguration(_ConfigurationPart):
    """Configuration of one agent: one machine, one keyphasor."""

    plant: Identifier
    machine: Identifier
    source: Identifier = "edge"
    direction: Literal["positive", "negative"] = "positive"
    speed_range: SpeedRange = Field(description="as in the machine's document")
    connect: list[str] = Field(default=[DEFAULT_ZENOH_ENDPOINT], min_length=1)
    encoding: Literal["binary", "msgpack", "json"] = "binary"
    waveforms: Waveforms
    keyphasor: KeyphasorChannel
    channels: Annotated[list[ProbeChannel], Field(min_length=1, max_length=LARGEST_CHANNEL_COUNT)]
    rails: Range | None = Field(default=None, description="measuring range of all channels that have none of their own")
    gap: bool = Field(
        default=False,
        description="send the mean of each waveform as the probe's gap; only where the inputs are coupled for direct current",
    )
    overall: bool = Field(default=False, description="send the overall level of each waveform, unfiltered")
    block: BlockLength
    log: LogFileSettings

    @model_validator(mode="after")
    def _channels(self) -> Self:
        probes = [channel.probe for channel in self.channels]
        twice = sorted({probe for probe in probes if probes.count(probe) > 1})
        if twice:
            raise ValueError(f"probe {', '.join(twice)} is there more than once")
        shared = sorted({column for column in self.columns if self.columns.count(column) > 1})
        if shared:
            raise ValueError(f"column {', '.join(shared)} is mapped twice: the keyphasor and each probe have one of their own")
        given = sum(channel.sensitivity is not None for channel in self.channels)
        if self.waveforms.unit == "V" and given not in (0, len(self.channels)):
            raise ValueError("give the sensitivity of every channel, or of none")
        if self.waveforms.unit != "V" and given:
            raise ValueError(f"waveforms in {self.waveforms.unit} have no sensitivity")
        for low, high in filter(None, self.all_rails):
            if low >= high:
                raise ValueError(f"rails from {low:g} to {high:g}: the lower one comes first")
        return self

    @property
    def columns(self) -> list[str]:
        """Return the columns of the keyphasor, then of the channels."""
        return [self.keyphasor.column, *(channel.column for channel in self.channels)]

    @property
    def all_rails(self) -> list[Range | None]:
        """Return the rails of each channel."""
        return [channel.rails or self.rails for channel in self.channels]

    @property
    def amplitude_unit(self) -> str:
        """Return the unit in which amplitudes are published."""
        return "V" if self.waveforms.unit == "V" and self.channels[0].sensitivity is None else "um"

    @property
    def factors(self) -> list[float]:
        """Return the factor of each channel from the unit of its waveform to that of the amplitudes."""
        unit = self.waveforms.unit
        if unit != "V":
            return [METRES[unit] / METRES["um"]] * len(self.channels)
        return [1.0 / (channel.sensitivity * METRES["um"]) if channel.sensitivity else 1.0 for channel in self.channels]


def read_configuration(path: Path) -> EdgeConfiguration:
    """Read a configuration file; paths in it are relative to it. Raises UnreadableFile, which names every wrong field."""
    fields = read_yaml(path)
    if not isinstance(fields, dict):
        held = "is empty" if fields is None else "holds no fields"
        raise UnreadableFile(
            f"{path} {held}: an edge agent's configuration has machine, waveforms, keyphasor, channels, block, log"
        )
    try:
        read = EdgeConfiguration.model_validate(fields)
    except ValidationError as error:
        problems = "\n".join(f"  {field}: {words}" for field, words in problems_of(error.errors(), EdgeConfiguration))
        raise UnreadableFile(f"{path} is not an edge agent's configuration:\n{problems}") from error
    # The log identifies files by their path, which must not depend on where the agent is started.
    folder = path.resolve().parent
    files = [one.model_copy(update={"path": folder / one.path}) for one in read.waveforms.files]
    return read.model_copy(
        update={
            "waveforms": read.waveforms.model_copy(update={"files": files}),
            "log": read.log.model_copy(update={"path": folder / read.log.path}),
        }
    )
