"""The machine document: one rotor train, described once for file, API and storage. Axes and units are those of its parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ModelWrapValidatorHandler, ValidationError, model_validator

from estimator.bearings.registry import place_of
from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.field_types import PATTERNS, Identifier, Length, Part, Text
from estimator.machine.calibration import Calibration
from estimator.machine.consistency import CONTRADICTION, reference_problems
from estimator.machine.films import StaticLoad
from estimator.machine.parts import Bearing, Coupling, Disc, Material, Pedestal, Probe, RayleighDamping, Seal, Shaft
from estimator.machine.rules import (
    Centreline,
    Collection,
    Condition,
    ImpactTest,
    Noise,
    Operation,
    ParameterRule,
    QualityRules,
    SpeedRange,
)
from estimator.machine.sparkplug import Sparkplug
from estimator.machine.unfinished_document import further_problems
from estimator.strict_model import field_at, fields_beside, own_words, repeatable
from estimator.usual_values import nearest_number, range_words

COUNTED = ("shafts", "discs", "bearings", "couplings", "probes")
"""Lists whose lengths tell what kind of machine it is."""
MOST_WITH_FURTHER = 100
"""Most wrong fields beside which contradictions are looked for."""


class Machine(Part):
    """One train. The document that a person writes and that everything else in the service is derived from."""

    model_config = ConfigDict(defer_build=False)  # at once, with all parts in it

    schema_version: Literal[1] = Field(default=1, description="of the document's form; there is one so far")
    id: Identifier
    plant: Identifier
    name: Annotated[Text, Field(min_length=1, max_length=200)] = Field(description="what people call the machine")
    rotation: Literal["positive", "negative"] = Field(default="positive", description="positive turns +x towards +y")
    speed_range: SpeedRange
    materials: Annotated[dict[Identifier, Material], Field(min_length=1, max_length=50)]
    shafts: Annotated[tuple[Shaft, ...], Field(min_length=1, max_length=20)]
    discs: Annotated[tuple[Disc, ...], Field(min_length=1, max_length=100)]
    bearings: Annotated[tuple[Bearing, ...], Field(min_length=1, max_length=60)]
    couplings: Annotated[tuple[Coupling, ...], Field(max_length=20)] = ()
    seals: Annotated[tuple[Seal, ...], Field(max_length=60)] = ()
    pedestals: Annotated[tuple[Pedestal, ...], Field(max_length=60)] = ()
    static_loads: Annotated[tuple[StaticLoad, ...], Field(max_length=60)] = ()
    probes: Annotated[tuple[Probe, ...], Field(min_length=1, max_length=120)]
    conditions: Annotated[tuple[Condition, ...], Field(max_length=16)] = ()
    # Defaults are right as declared: validating them here would build each part's validator twice.
    noise: Noise = Noise.model_construct()
    centreline: Centreline = Centreline.model_construct()
    operation: Operation = Operation.model_construct()
    collection: Collection = Collection.model_construct()
    quality: QualityRules = QualityRules.model_construct()
    damping: RayleighDamping = Field(default=RayleighDamping.model_construct(), description="external damping of the shafts")
    parameters: Annotated[tuple[ParameterRule, ...], Field(max_length=200)] = ()
    calibration: Calibration | None = Field(default=None, description="what runs with known unbalances have shown")
    impact_test: ImpactTest | None = Field(default=None, description="compared with the updated model")
    sparkplug: Sparkplug | None = Field(default=None, description="samples that come as Sparkplug B over MQTT")
    element_length: Length | None = Field(
        default=None, description="longest shaft element [m]; by default a twelfth of each shaft"
    )

    if not TYPE_CHECKING:  # type checkers know the fields by the declarations above

        def __init__(self, *given: Any, **fields: Any) -> None:
            """Make the machine of its fields. Raises DocumentError, a line for each wrong one."""
            if given:
                raise DocumentError(
                    [(field_path(()), "Machine(…) takes fields by name; documents are read by read_machine(…)")]
                )
            try:
                super().__init__(**fields)
            except ValidationError as error:
                raise DocumentError(problems_of(error.errors(), Machine)) from None

        __init__.__pydantic_base_init__ = True  # documents are validated as if it were BaseModel's own

    @model_validator(mode="wrap")
    @classmethod
    def _all_at_once(cls, value: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        """Return the machine; where fields are wrong, the error names contradictions between the other parts as well."""
        try:
            return validated(value)
        except ValidationError as error:
            # Of contradictions none is left to be found, and of very many errors nobody reads more.
            if error.error_count() > MOST_WITH_FURTHER or any(one["type"] == CONTRADICTION for one in error.errors()):
                raise
            more = further_problems(value, LISTS, SINGLE, {"materials": Material})
            if not more:
                raise
            raise ValidationError.from_exception_data(cls.__name__, [*repeatable(error.errors()), *more]) from None

    @model_validator(mode="after")
    def _references(self) -> Self:
        problems = list(reference_problems(self))
        if problems:
            raise ValidationError.from_exception_data("Machine", problems)
        return self

    def __repr__(self) -> str:
        """Name the machine and count its parts, in one line."""
        counts = ((name, len(getattr(self, name))) for name in COUNTED)
        counted = ", ".join(f"{count} {name.removesuffix('s') if count == 1 else name}" for name, count in counts)
        return f"{self.id}: {counted}; {self.speed_range.minimum_rpm:g} to {self.speed_range.maximum_rpm:g} r/min"

    __str__ = __repr__

    def describes_the_same_as(self, other: Machine) -> bool:
        """Check whether identifications under both documents can be compared: only name and rules of the service differ.

        Operating conditions may come and go, but not change their unit.

        Args:
            other: The other document.

        Returns:
            Whether they can.
        """
        units, others = ({condition.name: condition.unit for condition in one.conditions} for one in (self, other))
        return all(unit == others.get(name, unit) for name, unit in units.items()) and self.is_the_same_train_as(other)

    def is_the_same_train_as(self, other: Machine) -> bool:
        """Check whether both documents differ in name, operating conditions and rules of the service only.

        Args:
            other: The other document.

        Returns:
            Whether they do.
        """
        said: dict[str, Any] = dict.fromkeys(
            ("name", "conditions", "operation", "collection", "quality", "impact_test", "centreline", "sparkplug"), True
        )
        said["probes"] = {"__all__": {"gap_grows"}}  # gaps that are sent from now on do not make it another train
        return self.model_dump(exclude=said) == other.model_dump(exclude=said)

    def shaft(self, shaft_id: str) -> Shaft:
        """Return the shaft of an id.

        Args:
            shaft_id: Id of the shaft.

        Returns:
            The shaft.

        Raises:
            KeyError: There is no shaft of that id.
        """
        for shaft in self.shafts:
            if shaft.id == shaft_id:
                return shaft
        raise KeyError(shaft_id)

    def pedestal_under(self, probe: Probe) -> Pedestal | None:
        """Return the pedestal against which a probe measures.

        Args:
            probe: One of the probes.

        Returns:
            The pedestal; None for a probe that measures the shaft's own motion.
        """
        if probe.absolute:
            return None
        bearing = probe.mounted_on
        if bearing is None:
            own = [one for one in self.bearings if one.shaft == probe.shaft]
            bearing = min(own, key=lambda one: abs(one.station - probe.station)).id if own else None
        return None if bearing is None else self.pedestal_of(bearing)

    def pedestal_of(self, bearing: str) -> Pedestal | None:
        """Return the pedestal that a bearing stands on.

        Args:
            bearing: Id of the bearing.

        Returns:
            The pedestal; None for a bearing on rigid ground.
        """
        return next((one for one in self.pedestals if one.bearing == bearing), None)

    @property
    def direction(self) -> int:
        """Return +1 when the train turns from +x to +y, else -1."""
        return 1 if self.rotation == "positive" else -1

    @property
    def condition_names(self) -> tuple[str, ...]:
        """Return the names of the operating conditions in the document's order."""
        return tuple(condition.name for condition in self.conditions)

    @property
    def channels(self) -> tuple[str, ...]:
        """Return the channel ids in the document's order."""
        return tuple(probe.id for probe in self.probes)


LISTS: Mapping[str, type[BaseModel]] = {
    "shafts": Shaft,
    "discs": Disc,
    "bearings": Bearing,
    "couplings": Coupling,
    "seals": Seal,
    "pedestals": Pedestal,
    "static_loads": StaticLoad,
    "probes": Probe,
    "conditions": Condition,
}
"""Models of the parts of each list."""
SINGLE: Mapping[str, type[BaseModel]] = {"operation": Operation}
"""Models of the fields that are one object and that parts refer to."""


class DocumentError(Invalid):
    """Raised when a machine document is wrong.

    Attributes:
        problems: Pairs of a field, and what is wrong with it and what would be right.
    """

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        self.problems = problems
        super().__init__("\n".join(f"{field}: {message}" for field, message in problems))

    @property
    def listed(self) -> str:
        """Return the problems to stand behind a colon: one on its line, several each on a line of its own."""
        lines = str(self).splitlines()
        return f" {lines[0]}" if len(lines) == 1 else "".join(f"\n  {one}" for one in lines)

    @property
    def detail(self) -> str:
        """State that the document is wrong as a whole; `field_errors` has the rest."""
        return "the machine document is wrong"

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return each wrong field of the document with its message."""
        return self.problems


def parse_machine(document: Any) -> Machine:
    """Read the machine that a decoded YAML or JSON document describes.

    Args:
        document: The decoded document.

    Returns:
        The machine.

    Raises:
        DocumentError: The document is wrong; the error names every wrong field.
    """
    try:
        return Machine.model_validate(document)
    except ValidationError as error:
        raise DocumentError(problems_of(error.errors(), Machine)) from None


def problems_of(errors: Sequence[Any], model: type[BaseModel] | None = None) -> list[tuple[str, str]]:
    """List pydantic's errors, without those that only follow from another inside the same field.

    Args:
        errors: Errors as pydantic lists them.
        model: The model that they are of, for the fields that there are beside an unknown one; None where it is not known.

    Returns:
        Pairs of a field and a message.
    """
    places = [tuple(item["loc"]) for item in errors]

    def follows(item: Any) -> bool:
        place = tuple(item["loc"])
        return item["type"] == "too_short" and any(len(p) > len(place) and p[: len(place)] == place for p in places)

    return [(field_path(place_of(item)), _words(item, model)) for item in errors if not follows(item)]


def _words(item: Any, model: type[BaseModel] | None) -> str:
    """Return what pydantic says of an error, in plain words."""
    if item["type"] == "extra_forbidden" and model is not None:
        known = fields_beside(model, item["loc"])
        return "there is no such field" + (did_you_mean(str(item["loc"][-1]), known) or f": there are {', '.join(known)}")
    if item["type"] in ("model_type", "dict_type"):
        return "should be fields by name, each with its value"
    if item["type"] == "tuple_type":
        return "should be a list"
    if item["type"] == "float_parsing" and "," in str(item["input"]):
        return f"'{item['input']!s:.40}' is no number: write it with a decimal point"
    if item["type"] == "too_short":
        return f"should have at least {item['ctx']['min_length']} of them, not {item['ctx']['actual_length']}"
    if item["type"] == "literal_error":
        return str(item["msg"]) + nearest_number(item["input"], item["ctx"]["expected"])
    if item["type"] == "string_pattern_mismatch":
        return PATTERNS.get(item["ctx"]["pattern"], str(item["msg"]))
    field = None if model is None else field_at(model, item["loc"])
    return range_words(item, field) or own_words(str(item["msg"]))


def field_path(location: tuple[int | str, ...]) -> str:
    """Convert a location to a path: `bearings[1].shaft` from ("bearings", 1, "shaft").

    Args:
        location: Names and indices from the document down.

    Returns:
        The path; `document` for the document itself.
    """
    named = [part for part in location if not str(part).startswith("function-")]  # the library's own steps
    path = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in named)
    return path.removeprefix(".") or "document"
