"""Limits that a person sets for a machine: when a finding is an alert, when it is a danger, and the delays of both.

Fields that a document leaves out are taken from the defaults in the findings' declarations; they are starting points.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import ConfigDict, Field, ValidationInfo, create_model, field_validator

from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.strict_model import StrictModel
from service.alerts.lifecycle import Severity
from service.monitoring.rules.finding_catalogue import LIMITED_RULES, concerned_elements
from service.monitoring.rules.limit_rule import Rule

RULES = tuple(LIMITED_RULES)
if TYPE_CHECKING:
    RuleName = str
else:
    RuleName = Literal[RULES]
DEFAULTS: Mapping[str, Rule] = {name: one.limits for name, one in LIMITED_RULES.items() if one.limits is not None}
"""Limits in force while nobody has set others."""


def _deviation_rules() -> Mapping[str, str]:
    found: dict[str, str] = {}
    for rule in LIMITED_RULES.values():
        for kind in rule.deviations:
            if kind in found:
                raise ValueError(f"deviations of {kind} are measured by two rules, {found[kind]} and {rule.name}")
            found[kind] = rule.name
    return found


DEVIATION_RULES = _deviation_rules()
"""Name of the rule by whose limits the deviations of each kind of element are measured."""


class LimitsRefused(Invalid):
    """The limits do not suit the machine. `problems`: what is wrong, as (field, message)."""

    def __init__(self, problems: list[tuple[str, str]]) -> None:
        super().__init__("; ".join(f"{field}: {message}" for field, message in problems))
        self.problems = problems

    @property
    def detail(self) -> str:
        """Return a summary; `field_errors` has the details."""
        return "the limits do not suit the machine"

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return each unsuitable limit as a field of the request, with its message."""
        return [(f"limits.{field}", message) for field, message in self.problems]


_FIELDS: dict[str, Any] = {name: (Rule, Field(default=rule)) for name, rule in DEFAULTS.items()}
_RuleFields: Any = create_model("_RuleFields", __base__=StrictModel, **_FIELDS)
"""Model with one field for each alert rule that has limits."""


class Limits(_RuleFields, StrictModel):
    """Limits of one machine. A rule, or a field of one, that is left out is as in the defaults."""

    model_config = ConfigDict(frozen=True)

    elements: dict[str, dict[RuleName, Rule]] = Field(
        default_factory=dict, description="whole rules for single elements, such as coupling.C1, in the place of the machine's"
    )

    @field_validator(*RULES, mode="before")
    @classmethod
    def _completed(cls, value: Any, info: ValidationInfo) -> Any:
        """Return the value with missing fields taken from the defaults."""
        if not isinstance(value, dict) or info.field_name is None:
            return value
        return DEFAULTS[info.field_name].model_dump() | value

    @field_validator(*RULES, mode="after")
    @classmethod
    def _suited(cls, rule: Rule, info: ValidationInfo) -> Rule:
        if info.field_name is not None:
            LIMITED_RULES[info.field_name].require_quantities(rule)
        return rule

    @field_validator("elements", mode="after")
    @classmethod
    def _require_applicable(cls, elements: dict[str, dict[RuleName, Rule]]) -> dict[str, dict[RuleName, Rule]]:
        for rules in elements.values():
            for name, rule in rules.items():
                LIMITED_RULES[name].require_quantities(rule)
        return elements

    def rule(self, name: RuleName, element: str | None = None) -> Rule:
        """Return the rule in force for an element, or for the machine."""
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
    tolerance_per_cent: float | None = None,
    beyond_tolerance: float | None = None,
    present: Severity | None = None,
    element: str | None = None,
) -> Severity | None:
    """Return the severity of a change; None while it reaches no limit. Unknown quantities are None and reach nothing.

    sigma: standard deviations. per_cent: per cent of the baseline. force: in the coupling at running speed [N]. rate:
    [%/week]. tolerance_per_cent: per cent of what is allowed. beyond_tolerance: probability of more than that. All are taken
    by their magnitude. present: severity of the open alert, None without one: a reached level is left only below the
    hysteresis. element: such as `coupling.C1`, which may have limits of its own.
    """
    chosen = limits.rule(rule, element)
    found = {"sigma": sigma, "per_cent": per_cent, "force": force, "rate_per_cent_per_week": rate}
    found |= {"tolerance_per_cent": tolerance_per_cent, "beyond_tolerance": beyond_tolerance}
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


def deviation_rule(element: str) -> RuleName | None:
    """Return the rule by whose limits deviations of an element, such as `bearing.B1`, are measured; None without one."""
    return DEVIATION_RULES.get(describe(element).element_kind)


def require_suited(limits: Limits, machine: Machine) -> None:
    """Raise LimitsRefused for limits that a machine cannot have."""
    problems = [*_element_problems(limits, machine), *_force_problems(limits, machine)]
    if problems:
        raise LimitsRefused(problems)


def _element_problems(limits: Limits, machine: Machine) -> Iterator[tuple[str, str]]:
    concerned = {name: concerned_elements(rule) for name, rule in LIMITED_RULES.items()}
    # A rule that concerns the machine as a whole has its own levels: there is no part to have others.
    kinds = {kind for of_rule in concerned.values() for kind in of_rule} - {"machine"}
    known = [f"{kind}.{part.id}" for kind in sorted(kinds) for part in getattr(machine, _list_name(kind))]
    for element, rules in limits.elements.items():
        if element not in known:
            yield f"elements.{element}", f"'{element}' is not an element of machine '{machine.id}': {', '.join(known)}"
            continue
        for name in rules:
            if describe(element).element_kind not in concerned[name]:
                yield f"elements.{element}.{name}", f"{name} speaks of {' and '.join(map(_list_name, concerned[name]))}"


def _force_problems(limits: Limits, machine: Machine) -> Iterator[tuple[str, str]]:
    if machine.couplings:
        return
    for rule in LIMITED_RULES.values():
        chosen = limits.rule(rule.name)
        for name, level in (("alert", chosen.alert), ("danger", chosen.danger)):
            if level is not None and level.force is not None:
                yield f"{rule.name}.{name}.force", f"machine '{machine.id}' has no coupling that could carry a force"


def _list_name(kind: str) -> str:
    """Return the name of the document's list of such elements."""
    return f"{kind}s"
