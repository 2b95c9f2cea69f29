"""Sidecars of recordings: YAML documents that say what the columns of a table mean."""

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator, model_validator
from pydantic_core import ErrorDetails

from estimator.field_types import Identifier, Positive
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import field_path
from estimator.strict_model import own_words
from estimator.unit_names import declared_unit, unknown_unit
from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS
from formats.files.document_files import UnreadableFile, read_yaml
from formats.recordings.trial_weights import EXAMPLE, TrialWeight

UNSTATED_START = datetime(2000, 1, 2, tzinfo=UTC)
"""Time of the first row of a recording that does not say it."""


class RecordedChannel(BaseModel):
    """The columns of one channel."""

    model_config = ConfigDict(extra="forbid", defer_build=True)

    channel: Identifier
    amplitude: str | None = None
    phase: str | None = None
    real: str | None = Field(default=None, description="with `imaginary` in place of amplitude and phase")
    imaginary: str | None = None
    scatter: str | None = Field(default=None, description="rms of the complex error, in the amplitude's unit and kind")
    gap: str | None = Field(
        default=None, description="mean gap, in `gap_unit`; the machine's document says which way it grows"
    )
    overall: str | None = Field(default=None, description="unfiltered vibration, in the amplitude's unit and kind")

    @model_validator(mode="after")
    def _one_pair(self) -> Self:
        polar, parts = (self.amplitude, self.phase), (self.real, self.imaginary)
        if None in polar + parts and (None not in polar or None not in parts) and (polar + parts).count(None) == 2:
            return self
        raise ValueError("give the columns of amplitude and phase, or of real and imaginary")


EXAMPLES = {
    "plant": "plant-1",
    "machine": "pump-7",
    "speed": "speed_rpm",
    "speed_unit": "rpm",
    "channels": "[{channel: B1X, amplitude: B1X_um_pp, phase: B1X_lag_deg}]",
    "amplitude_unit": "um",
    "amplitude_kind": "peak-to-peak",
    "phase_convention": "lag",
    "phase_unit": "deg",
}
"""Value of each field that a sidecar must have, as an example."""
UNITS: dict[str, tuple[str, ...]] = {
    "speed_unit": tuple(RAD_PER_S),
    "amplitude_unit": (*METRES, "V"),
    "amplitude_kind": tuple(PEAK),
    "phase_convention": tuple(LEAD),
    "phase_unit": tuple(RADIANS),
    "gap_unit": (*METRES, "V"),
}
"""Units that the fields of a sidecar may have."""


class Sidecar(BaseModel):
    """Description of a recording's columns; `FILE.yaml` beside `FILE.csv`."""

    model_config = ConfigDict(extra="forbid", defer_build=True)

    plant: Identifier
    machine: Identifier
    source: Identifier = "recording"
    direction: Literal["positive", "negative"] = "positive"
    kind: Literal["sweep", "dwells"] = Field(
        default="sweep", description="a run-up or run-down, or rows that each were taken at a constant speed"
    )
    start: datetime = Field(default=UNSTATED_START, description="time of the first row")
    time: str | None = Field(default=None, description="column with seconds since the start, or with dates and times")
    interval_s: Positive | None = Field(default=None, description="time between rows, where there is no such column")
    speed: str = Field(description="column")
    speed_unit: str
    channels: Annotated[list[RecordedChannel], Field(min_length=1)]
    amplitude_unit: str
    amplitude_kind: str
    phase_convention: str
    phase_unit: str
    gap_unit: Literal["um", "mil", "mm", "m", "V"] | None = Field(default=None, description="unit of the columns of gaps")
    conditions: dict[Identifier, str] = Field(default_factory=dict, description="column of each operating condition by name")
    added_unbalance: dict[Identifier, TrialWeight] | Literal["none"] | None = Field(
        default=None, description="trial weights that were on: disc, and what they add to its unbalance; `none` for none"
    )
    disc_scale: DiscScale = DiscScale.model_construct()
    mounting: str | None = Field(
        default=None,
        description="column that tells rows apart between which the machine was taken apart or stood; "
        "by default a recording is one mounting",
    )

    @field_validator(*UNITS, mode="before")
    @classmethod
    def _declared(cls, given: object, of: ValidationInfo) -> object:
        field = str(of.field_name)
        unit = declared_unit(field, given)
        if isinstance(given, str) and unit not in UNITS[field]:
            raise ValueError(unknown_unit(field, given, UNITS[field]))
        return unit

    @field_validator("added_unbalance", mode="before")
    @classmethod
    def _weights_listed(cls, given: object) -> object:
        if given is not None and given != "none" and not isinstance(given, dict):
            raise ValueError(f"trial weights are `none`, or listed by disc, as in {{D1: {EXAMPLE}}}")
        return given

    @model_validator(mode="after")
    def _mapped_once(self) -> Self:
        columns = [
            one
            for part in self.channels
            for one in (part.amplitude, part.phase, part.real, part.imaginary, part.scatter, part.gap, part.overall)
        ]
        ids = [part.channel for part in self.channels]
        again = sorted({one for one in ids if ids.count(one) > 1})
        if again:
            raise ValueError(f"channel {', '.join(again)} is listed twice: each probe of the document has one entry")
        mapped = [one for one in (self.speed, self.time, *columns) if one is not None]
        twice = sorted({one for one in mapped if mapped.count(one) > 1})
        if twice:
            raise ValueError(f"column {', '.join(twice)} is mapped twice: each amplitude, phase and speed has one of its own")
        if (self.gap_unit is None) != all(part.gap is None for part in self.channels):
            raise ValueError("gap_unit and the columns of gaps come together or not at all")
        return self

    @property
    def columns(self) -> set[str]:
        """Return the columns that it names."""
        own = (self.time, self.speed, self.mounting, *self.conditions.values())
        of_channels = (one for part in self.channels for one in part.model_dump(exclude={"channel"}).values())
        of_weights = (one for part in self.trial_weights.values() for one in (part.amount, part.angle_deg))
        return {one for one in (*own, *of_channels, *of_weights) if isinstance(one, str)}

    @property
    def trial_weights(self) -> dict[str, TrialWeight]:
        """Return the trial weights that were on by disc."""
        return {} if self.added_unbalance in (None, "none") else dict(self.added_unbalance)  # type: ignore[arg-type]


def read_sidecar(path: Path) -> Sidecar:
    """Return a sidecar; raise UnreadableFile, naming every wrong field."""
    try:
        content = read_yaml(path)
        if not isinstance(content, dict):
            raise UnreadableFile(f"{path} is not a recording's sidecar: it should be fields by name, each with its value")
        return Sidecar.model_validate(content)
    except ValidationError as error:
        if {"shafts", "bearings"} <= content.keys():
            raise UnreadableFile(
                f"{path} is a machine document and not the recording's sidecar: give one of the two another name"
            ) from error
        problems = list(dict.fromkeys(_fault_text(item["loc"], item["msg"]) for item in _chosen(error)))
        listed = f" {problems[0]}" if len(problems) == 1 else "".join(f"\n  {one}" for one in problems)
        raise UnreadableFile(f"{path} is not a recording's sidecar:{listed}") from error


def _chosen(error: ValidationError) -> list[ErrorDetails]:
    """Return what is wrong, without the alternatives of a field that was meant otherwise.

    Such as `none`, where weights are listed, or the name of a column, where a number is given.
    """
    whole = error.errors()
    numbers = {item["loc"][:-1] for item in whole if item["loc"][-1:] != ("str",)}
    found = [item for item in whole if item["loc"][-1:] != ("str",) or item["loc"][:-1] not in numbers]
    listed = {item["loc"][0] for item in found if _is_alternative(item["loc"][1:2], "dict[") and len(item["loc"]) > 2}
    return [item for item in found if not (item["loc"][:1] and item["loc"][0] in listed and len(item["loc"]) == 2)]


def _is_alternative(names: tuple[int | str, ...], kind: str) -> bool:
    return bool(names) and str(names[0]).startswith(kind)


def _fault_text(location: tuple[int | str, ...], message: str) -> str:
    """Return one fault: the field, where it is one field's, and what would be right."""
    if message == "Field required" and location[0] in EXAMPLES and len(location) == 1:
        return f"{location[0]}: it is missing; one is `{location[0]}: {EXAMPLES[str(location[0])]}`"
    fields = tuple(one for one in location if not str(one).startswith(("dict[", "literal[", "constrained-", "function-")))
    message = own_words(message)
    return f"{field_path(fields)}: {message}" if fields else message
