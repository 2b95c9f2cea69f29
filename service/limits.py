"""Limits that a person sets for a machine: when a finding is an alert, when it is a danger, and how patient both are.

A level is reached when the change is as certain as its `sigma` and as large as any of the sizes that it names. Whatever a
document leaves out is as in the defaults, which are starting points; each says where it comes from.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_validator

from estimator.errors import Invalid
from estimator.machine import Machine
from estimator.written import Written
from service.alert_life import Severity

RuleName = Literal["misalignment", "bearing", "coupling", "unbalance", "run_out", "sensor", "rate_of_change"]
RULES: tuple[RuleName, ...] = get_args(RuleName)
RATE_OF_CHANGE: RuleName = "rate_of_change"
LONGEST_DELAY = 20
"""Identifications in a row that a rule may wait for."""
SIZES = ("per_cent", "force", "rate_per_cent_per_week")
"""Quantities of a level that are alternatives; `sigma` is needed beside them."""
QUANTITIES: Mapping[str, tuple[str, ...]] = {
    "misalignment": ("sigma", "per_cent", "force"),
    "bearing": ("sigma", "per_cent"),
    "coupling": ("sigma", "per_cent"),
    "unbalance": ("sigma", "per_cent"),
    "run_out": ("sigma", "per_cent"),
    "sensor": ("sigma", "per_cent"),
    "rate_of_change": ("rate_per_cent_per_week",),
}
"""What the levels of each rule may name."""
ELEMENTS: Mapping[str, tuple[str, ...]] = {
    "misalignment": ("coupling",),
    "bearing": ("bearing", "seal"),
    "coupling": ("coupling",),
    "unbalance": ("disc",),
    "run_out": ("shaft", "probe"),
    "sensor": ("probe",),
    "rate_of_change": ("bearing", "seal", "coupling", "disc"),
}
"""Kinds of elements that each rule speaks of."""

CHANGES: Mapping[str, RuleName] = {
    "bearing": "bearing",
    "seal": "bearing",
    "coupling": "coupling",
    "disc": "unbalance",
    "shaft": "run_out",
    "probe": "sensor",
}
"""The rule whose limits the changes of each kind of element are measured by."""

Limit = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class LimitsRefused(Invalid):
    """The limits do not suit the machine. `problems` holds what is wrong as (field, message)."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        super().__init__("; ".join(f"{field}: {message}" for field, message in problems))
        self.problems = problems

    @property
    def detail(self) -> str:
        """Say what is wrong as a whole; `field_errors` has the rest."""
        return "the limits do not suit the machine"

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Name each limit that does not suit, as a field of the question."""
        return [(f"limits.{field}", message) for field, message in self.problems]


class Level(Written):
    """From where on something is an alert, or a danger. What is null does not matter."""

    model_config = ConfigDict(frozen=True)

    sigma: Annotated[Limit, Field(le=100)] | None = Field(
        default=None, description="how certain the change must be, in standard deviations; needed beside any size"
    )
    per_cent: Annotated[Limit, Field(le=10_000)] | None = Field(
        default=None, description="size of the change against the baseline [%]"
    )
    force: Annotated[Limit, Field(le=1e9)] | None = Field(
        default=None, description="misalignment only: force in the coupling at running speed, 0-to-peak [N]"
    )
    rate_per_cent_per_week: Annotated[Limit, Field(le=10_000)] | None = Field(
        default=None, description="rate_of_change only: how fast a parameter drifts [%/week]"
    )

    @property
    def named(self) -> tuple[str, ...]:
        """Quantities that have a limit."""
        return tuple(name for name in type(self).model_fields if getattr(self, name) is not None)

    def reached(self, found: Mapping[str, float | None], *, sigma: float | None, part: float) -> bool:
        """Whether the quantities found reach so much of these limits, or of a `sigma` in the place of this level's."""

        def reaches(name: str, limit: float | None) -> bool:
            value = found[name]
            return limit is not None and value is not None and abs(value) >= part * limit

        certain = sigma is None or reaches("sigma", sigma)
        sizes = [name for name in SIZES if getattr(self, name) is not None]
        return certain and (not sizes or any(reaches(name, getattr(self, name)) for name in sizes))


class Rule(Written):
    """Levels of one kind of finding, and how patient its alerts are. Delays count identifications of the same kind of run."""

    # A rule of a machine is completed from the defaults, so that none of its fields is needed.
    model_config = ConfigDict(frozen=True, json_schema_extra=lambda schema: schema.pop("required", None))

    alert: Level = Field(description="needed in a rule of a single element; else by default as in the defaults")
    danger: Level | None = Field(default=None, description="null: it never becomes a danger")
    on_delay: int = Field(default=2, ge=1, le=LONGEST_DELAY, description="identifications in a row that must show it")
    off_delay: int = Field(
        default=2, ge=1, le=LONGEST_DELAY, description="identifications in a row that must no longer show it"
    )
    hysteresis: float = Field(
        default=0.2, ge=0, le=0.9, description="part of a limit by which a value must fall below it before the level is left"
    )
    latching: bool = Field(default=False, description="whether a person must reset the alert when its cause is gone")

    @model_validator(mode="after")
    def _levels(self) -> Self:
        for name, level in (("alert", self.alert), ("danger", self.danger)):
            if level is not None and not level.named:
                raise ValueError(f"{name} names no limit: one of {', '.join(Level.model_fields)} is needed")
        if self.danger is None:
            return self
        both = [name for name in self.alert.named if name in self.danger.named]
        for name in both:
            low, high = getattr(self.alert, name), getattr(self.danger, name)
            if high < low:
                raise ValueError(f"danger.{name} {high:g} lies below alert.{name} {low:g}: it must lie above")
        if self.danger == self.alert:
            raise ValueError("danger is the same as alert: one of its limits must lie above")
        return self


DEFAULTS: Mapping[str, Rule] = {
    # Thermal seasons move stiffnesses by some 2 %. The thesis's smallest misalignment raises natural frequencies by up to 2 %,
    # hence stiffnesses by 4 % at least.
    "misalignment": Rule(alert=Level(sigma=3, per_cent=3), danger=Level(per_cent=15)),
    # An oil film's stiffness and damping follow oil temperature and load more than a coupling's do.
    "bearing": Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    "coupling": Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    # ISO 20816-1 calls a change of a vibration vector by a quarter of the zone B limit significant.
    "unbalance": Rule(alert=Level(sigma=4, per_cent=25), danger=Level(per_cent=100)),
    "run_out": Rule(alert=Level(sigma=4, per_cent=25)),
    # API 670 allows a probe's scale factor 5 %. A wrong sensor is no danger to the machine.
    "sensor": Rule(alert=Level(sigma=4, per_cent=5)),
    # Seasons drift by 0.25 % a week at their steepest.
    "rate_of_change": Rule(alert=Level(rate_per_cent_per_week=0.5), danger=Level(rate_per_cent_per_week=2)),
}
"""In force where a person has set nothing else."""


def _default(name: RuleName) -> Any:
    return Field(default=DEFAULTS[name])


class Limits(Written):
    """All limits of one machine. A rule, or a field of one, that is left out is as in the defaults."""

    model_config = ConfigDict(frozen=True)

    misalignment: Rule = _default("misalignment")
    bearing: Rule = _default("bearing")
    coupling: Rule = _default("coupling")
    unbalance: Rule = _default("unbalance")
    run_out: Rule = _default("run_out")
    sensor: Rule = _default("sensor")
    rate_of_change: Rule = _default("rate_of_change")
    elements: dict[str, dict[RuleName, Rule]] = Field(
        default_factory=dict, description="whole rules for single elements, such as coupling.C1, in the place of the machine's"
    )

    @field_validator(*RULES, mode="before")
    @classmethod
    def _completed(cls, value: Any, info: ValidationInfo) -> Any:
        """With the default fields for those that are left out."""
        if not isinstance(value, dict) or info.field_name is None:
            return value
        return DEFAULTS[info.field_name].model_dump() | value

    @field_validator(*RULES, mode="after")
    @classmethod
    def _suited(cls, rule: Rule, info: ValidationInfo) -> Rule:
        if info.field_name is not None:
            _require_quantities(info.field_name, rule)
        return rule

    @field_validator("elements", mode="after")
    @classmethod
    def _each_suited(cls, elements: dict[str, dict[RuleName, Rule]]) -> dict[str, dict[RuleName, Rule]]:
        for rules in elements.values():
            for name, rule in rules.items():
                _require_quantities(name, rule)
        return elements

    def rule(self, name: RuleName, element: str | None = None) -> Rule:
        """The rule in force for an element, or for the machine."""
        own = self.elements.get(element, {}).get(name) if element is not None else None
        machine_wide: Rule = getattr(self, name)
        return own or machine_wide


def severity_of(
    limits: Limits,
    rule: RuleName,
    *,
    sigma: float | None = None,
    per_cent: float | None = None,
    force: float | None = None,
    rate: float | None = None,
    present: Severity | None = None,
    element: str | None = None,
) -> Severity | None:
    """How severe a change is; None while it reaches no limit. What is not known is None and reaches nothing.

    sigma: standard deviations. per_cent: of the baseline. force: in the coupling at running speed [N]. rate: [%/week]. All are
    taken by their magnitude. present: of the open alert, None without one: a level that was reached is left only below the
    hysteresis. element: such as `coupling.C1`, where it may have limits of its own.
    """
    chosen = limits.rule(rule, element)
    found = {"sigma": sigma, "per_cent": per_cent, "force": force, "rate_per_cent_per_week": rate}
    for severity, level in ((Severity.DANGER, chosen.danger), (Severity.ALERT, chosen.alert)):
        held = present is not None and present >= severity
        part = 1.0 - chosen.hysteresis if held else 1.0
        if level is None:
            continue
        # What is too uncertain to be an alert is no danger either.
        needed = chosen.alert.sigma if level.sigma is None else level.sigma
        if level.reached(found, sigma=needed, part=part):
            return severity
    return None


def rule_of(element: str) -> RuleName | None:
    """The rule whose limits changes of an element, such as `bearing.B1`, are measured by; None where there is none."""
    return CHANGES.get(element.split(".", 1)[0])


def require_suited(limits: Limits, machine: Machine) -> None:
    """Raises LimitsRefused for limits that a machine cannot have."""
    problems = [*_element_problems(limits, machine), *_force_problems(limits, machine)]
    if problems:
        raise LimitsRefused(problems)


def _require_quantities(name: str, rule: Rule) -> None:
    for level_name, level in (("alert", rule.alert), ("danger", rule.danger)):
        for quantity in level.named if level is not None else ():
            if quantity not in QUANTITIES[name]:
                raise ValueError(f"{level_name}.{quantity} is no limit of {name}: it has {', '.join(QUANTITIES[name])}")


def _element_problems(limits: Limits, machine: Machine) -> Iterator[tuple[str, str]]:
    kinds = {kind for named in ELEMENTS.values() for kind in named}
    known = [f"{kind}.{part.id}" for kind in sorted(kinds) for part in getattr(machine, _place(kind))]
    for element, rules in limits.elements.items():
        if element not in known:
            yield f"elements.{element}", f"'{element}' is not an element of machine '{machine.id}': {', '.join(known)}"
            continue
        for name in rules:
            if element.split(".", 1)[0] not in ELEMENTS[name]:
                yield f"elements.{element}.{name}", f"{name} speaks of {' and '.join(map(_place, ELEMENTS[name]))}"


def _force_problems(limits: Limits, machine: Machine) -> Iterator[tuple[str, str]]:
    if machine.couplings:
        return
    for name, level in (("alert", limits.misalignment.alert), ("danger", limits.misalignment.danger)):
        if level is not None and level.force is not None:
            yield f"misalignment.{name}.force", f"machine '{machine.id}' has no coupling that could carry a force"


def _place(kind: str) -> str:
    """The document's list of such elements."""
    return f"{kind}s"
