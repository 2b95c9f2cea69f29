"""The machine document: one rotor train, described once for file, API and storage.

Axes: z along the train from driver to driven, x horizontal, y vertical; positive rotation goes from +x to +y. Lengths in
metres, masses in kilograms and so on (SI), except where a field's name ends in another unit. A *station* is a distance
from the driver-side end of its own shaft [m].
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

Identifier = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="letters, digits, '_' and '-', up to 64")]
# Bounds far beyond any machine: they catch slips of the pen before they become numbers that no arithmetic survives.
Positive = Annotated[float, Field(gt=0, lt=1e15, allow_inf_nan=False)]
Direct = Annotated[float, Field(gt=1e-30, lt=1e15, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, lt=1e15, allow_inf_nan=False)]
Real = Annotated[float, Field(gt=-1e15, lt=1e15, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=1e-6, lt=100, allow_inf_nan=False)]
Angle = Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]
LARGEST_ELEMENT_COUNT = 500
"""Shaft elements of one train; more would take hours and gain nothing."""

STATION_TOLERANCE = 1e-9
"""Two stations closer than this [m] are the same place."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Material(_Part):
    """An isotropic shaft material."""

    young_modulus: Positive = Field(description="E [N/m²]")
    density: Positive = Field(description="ρ [kg/m³]")
    poisson_ratio: Annotated[float, Field(gt=-1, lt=0.5)] = Field(default=0.3, description="ν [-]")


class Section(_Part):
    """A piece of shaft of constant cross-section."""

    length: Length = Field(description="[m]")
    outer_diameter: Length = Field(description="[m]")
    inner_diameter: NotNegative = Field(default=0.0, description="[m]; 0 for a solid shaft")
    material: Identifier

    @model_validator(mode="after")
    def _wall(self) -> Self:
        if self.inner_diameter >= self.outer_diameter:
            raise ValueError(f"inner_diameter {self.inner_diameter} must be smaller than outer_diameter {self.outer_diameter}")
        return self


class Shaft(_Part):
    """One shaft: sections from the driver side to the driven side."""

    id: Identifier
    sections: Annotated[tuple[Section, ...], Field(min_length=1, max_length=200)]

    @property
    def length(self) -> float:
        """Length of the whole shaft [m]."""
        return math.fsum(section.length for section in self.sections)


class Unbalance(_Part):
    """A residual unbalance: mass times eccentricity, at an angle from the keyphasor mark in the sense +x to +y."""

    magnitude: NotNegative = Field(description="[kg m]")
    angle_deg: Angle = Field(description="[°]")


class Disc(_Part):
    """A rigid disc, which is also the plane in which a residual unbalance is identified."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    mass: Positive = Field(description="[kg]")
    diametral_inertia: NotNegative = Field(description="I_d [kg m²]")
    polar_inertia: NotNegative = Field(description="I_p [kg m²]")
    unbalance: Unbalance | None = Field(default=None, description="nominal residual unbalance, where known")


class LateralCoefficients(_Part):
    """Nominal stiffness and damping over (x, y); leave out what is not known."""

    kxx: Direct | None = Field(default=None, description="[N/m]")
    kxy: Real | None = Field(default=None, description="force along x per displacement along y [N/m]")
    kyx: Real | None = Field(default=None, description="force along y per displacement along x [N/m]")
    kyy: Direct | None = Field(default=None, description="[N/m]")
    cxx: Direct | None = Field(default=None, description="[N s/m]")
    cxy: Real | None = Field(default=None, description="[N s/m]")
    cyx: Real | None = Field(default=None, description="[N s/m]")
    cyy: Direct | None = Field(default=None, description="[N s/m]")


class Bearing(LateralCoefficients):
    """A bearing to ground with eight linear coefficients (thesis Eq. 3.7)."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")


class Coupling(LateralCoefficients):
    """A flexible coupling with ten linear coefficients (thesis Eq. 3.9) from the end of one shaft to the start of the next."""

    id: Identifier
    driver: Identifier = Field(description="shaft whose driven-side end carries one half")
    driven: Identifier = Field(description="shaft whose driver-side end carries the other half")
    k_phix: Direct | None = Field(default=None, description="moment about x per relative slope about x [N m/rad]")
    k_phiy: Direct | None = Field(default=None, description="moment about y per relative slope about y [N m/rad]")


class Probe(_Part):
    """A displacement probe: one measured channel. Its angle is counted from +x towards +y."""

    id: Identifier
    shaft: Identifier
    station: NotNegative = Field(description="[m] from the shaft's driver-side end")
    angle_deg: Angle = Field(description="[°] from +x towards +y: 0 measures x, 90 measures y")
    sensitivity: Positive | None = Field(default=None, description="[V/m]; needed only where a source publishes volts")


class SpeedRange(_Part):
    """Speeds at which samples are taken seriously [r/min]."""

    minimum_rpm: Positive = Field(description="below this a run-down is over")
    maximum_rpm: Positive = Field(description="trip speed or what the machine can never exceed")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.minimum_rpm >= self.maximum_rpm:
            raise ValueError(f"minimum_rpm {self.minimum_rpm} must be below maximum_rpm {self.maximum_rpm}")
        return self


class Noise(_Part):
    """What a phasor's measurement error is expected to be: rms of the complex error, sqrt((relative·|X|)² + floor²)."""

    relative: Annotated[float, Field(gt=0, lt=1)] = Field(default=0.01, description="part of the amplitude [-]")
    floor: NotNegative = Field(default=1e-7, description="0-to-peak [m]")


class Machine(_Part):
    """One train. The document that a person writes and that everything else in the service is derived from."""

    schema_version: Literal[1] = 1
    id: Identifier
    plant: Identifier
    name: Annotated[str, Field(min_length=1, max_length=200)]
    rotation: Literal["positive", "negative"] = Field(default="positive", description="positive turns +x towards +y")
    speed_range: SpeedRange
    materials: Annotated[dict[Identifier, Material], Field(min_length=1, max_length=50)]
    shafts: Annotated[tuple[Shaft, ...], Field(min_length=1, max_length=20)]
    discs: Annotated[tuple[Disc, ...], Field(min_length=1, max_length=100)]
    bearings: Annotated[tuple[Bearing, ...], Field(min_length=1, max_length=60)]
    couplings: Annotated[tuple[Coupling, ...], Field(max_length=20)] = ()
    probes: Annotated[tuple[Probe, ...], Field(min_length=1, max_length=120)]
    noise: Noise = Noise()
    element_length: Length | None = Field(
        default=None, description="longest shaft element [m]; by default a twelfth of each shaft"
    )

    @model_validator(mode="after")
    def _references(self) -> Self:
        problems = list(_reference_problems(self))
        if problems:
            raise ValidationError.from_exception_data("Machine", problems)
        return self

    def shaft(self, shaft_id: str) -> Shaft:
        """The shaft of that id. Raises KeyError."""
        for shaft in self.shafts:
            if shaft.id == shaft_id:
                return shaft
        raise KeyError(shaft_id)

    @property
    def direction(self) -> int:
        """+1 when the train turns from +x to +y, else -1."""
        return 1 if self.rotation == "positive" else -1

    @property
    def channels(self) -> tuple[str, ...]:
        """Channel ids in the document's order."""
        return tuple(probe.id for probe in self.probes)


class DocumentError(ValueError):
    """A machine document is wrong. `problems` holds (field, what is wrong and what would be right) pairs."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        self.problems = problems
        super().__init__("\n".join(f"{field}: {message}" for field, message in problems))


def parse_machine(document: Any) -> Machine:
    """The machine that a decoded YAML or JSON document describes.

    Raises DocumentError, which names every wrong field.
    """
    try:
        return Machine.model_validate(document)
    except ValidationError as error:
        raise DocumentError(problems_of(error.errors())) from None


def problems_of(errors: Sequence[Any]) -> list[tuple[str, str]]:
    """(field, message) pairs of pydantic's errors, without those that only follow from another inside the same field."""
    places = [tuple(item["loc"]) for item in errors]

    def follows(item: Any) -> bool:
        place = tuple(item["loc"])
        return item["type"] == "too_short" and any(len(p) > len(place) and p[: len(place)] == place for p in places)

    return [(field_path(item["loc"]), item["msg"]) for item in errors if not follows(item)]


def field_path(location: tuple[int | str, ...]) -> str:
    """`bearings[1].shaft` from ("bearings", 1, "shaft"); the document itself is called `document`."""
    path = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return path.removeprefix(".") or "document"


def _problem(location: tuple[int | str, ...], value: Any, message: str) -> InitErrorDetails:
    # The message goes in as context: it may hold braces of its own.
    error = PydanticCustomError("machine_document", "{message}", {"message": message})
    return InitErrorDetails(type=error, loc=location, input=value)


def _reference_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    yield from _material_problems(machine)
    yield from _duplicate_problems(machine)
    yield from _station_problems(machine)
    if machine.element_length is not None:
        count = sum(shaft.length for shaft in machine.shafts) / machine.element_length
        if count > LARGEST_ELEMENT_COUNT:
            message = f"makes {count:.3g} elements of the shafts; at most {LARGEST_ELEMENT_COUNT} are sensible"
            yield _problem(("element_length",), machine.element_length, message)
    yield from _coupling_problems(machine)


def _material_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    known = ", ".join(machine.materials)
    for i, shaft in enumerate(machine.shafts):
        for j, section in enumerate(shaft.sections):
            if section.material not in machine.materials:
                message = f"'{section.material}' is not one of the materials: {known}"
                yield _problem(("shafts", i, "sections", j, "material"), section.material, message)


def _duplicate_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    for name in ("shafts", "discs", "bearings", "couplings", "probes"):
        parts = getattr(machine, name)
        counts = Counter(part.id for part in parts)
        for i, part in enumerate(parts):
            if counts[part.id] > 1:
                yield _problem((name, i, "id"), part.id, f"'{part.id}' stands more than once among the {name}")


def _station_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    lengths = {shaft.id: shaft.length for shaft in machine.shafts}
    for name in ("discs", "bearings", "probes"):
        for i, part in enumerate(getattr(machine, name)):
            if part.shaft not in lengths:
                message = f"'{part.shaft}' is not one of the shafts: {', '.join(lengths)}"
                yield _problem((name, i, "shaft"), part.shaft, message)
            elif part.station > lengths[part.shaft] + STATION_TOLERANCE:
                message = f"{part.station} lies beyond shaft '{part.shaft}', which is {lengths[part.shaft]:.6g} m long"
                yield _problem((name, i, "station"), part.station, message)


def _coupling_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    known = [shaft.id for shaft in machine.shafts]
    for i, coupling in enumerate(machine.couplings):
        for end in ("driver", "driven"):
            if getattr(coupling, end) not in known:
                message = f"'{getattr(coupling, end)}' is not one of the shafts: {', '.join(known)}"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)
        if coupling.driver == coupling.driven:
            yield _problem(("couplings", i, "driven"), coupling.driven, "a coupling joins two different shafts")
    yield from _ring_problems(machine)
    for end in ("driver", "driven"):
        counts = Counter(getattr(coupling, end) for coupling in machine.couplings)
        for i, coupling in enumerate(machine.couplings):
            if counts[getattr(coupling, end)] > 1:
                message = f"shaft '{getattr(coupling, end)}' is the {end} of more than one coupling"
                yield _problem(("couplings", i, end), getattr(coupling, end), message)


def _ring_problems(machine: Machine) -> Iterator[InitErrorDetails]:
    """A train has two ends: following its couplings from driver to driven must not come back."""
    behind = {coupling.driver: coupling.driven for coupling in machine.couplings}
    for i, coupling in enumerate(machine.couplings):
        shaft: str | None = coupling.driven
        for _ in machine.couplings:
            if shaft == coupling.driver != coupling.driven:
                yield _problem(("couplings", i, "driven"), coupling.driven, "the couplings join the shafts to a ring")
                break
            shaft = behind.get(shaft) if shaft is not None else None
