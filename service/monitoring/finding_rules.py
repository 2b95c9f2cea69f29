"""The findings that are reported to people, each declared once: its alert rule, its limits and its sentence.

`FINDING_RULES` has one declaration for each of the estimator's `FINDING_KINDS`; otherwise the import of this module fails.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from estimator.diagnosis.finding_kinds import FINDING_KINDS, finding_kind
from estimator.machine.parameter_description import describe
from service.monitoring.film_sentences import (
    alignment_sentence,
    film_sentence,
    oil_sentence,
    settlement_sentence,
    wear_sentence,
)
from service.monitoring.limit_rule import Level, Quantity, Rule

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import Cause, ChangeSize, ElementKind


class SizedCause(Protocol):
    """A cause with its size, and its form when the data determine one."""

    @property
    def cause(self) -> "Cause":
        """Return the cause."""

    @property
    def size(self) -> "ChangeSize":
        """Return its size."""

    @property
    def form(self) -> str | None:
        """Return its form, such as `parallel`; None when unknown."""


@dataclass(frozen=True)
class AlertRule:
    """Rule by which alerts are raised. Raises ValueError when its parts contradict each other.

    limits: the defaults; None when the finding has no size: it is then always an alert, never a danger. quantities: those that
    its levels may name. deviations: kinds of elements whose deviations of single parameters are also measured by it. elements:
    kinds of elements that it concerns besides those of its findings.
    """

    name: str
    limits: Rule | None = None
    quantities: tuple[Quantity, ...] = ()
    deviations: tuple["ElementKind", ...] = ()
    elements: tuple["ElementKind", ...] = ()

    def __post_init__(self) -> None:
        if (self.limits is None) != (not self.quantities):
            raise ValueError(f"alert rule '{self.name}' needs both limits and quantities that they may name, or neither")
        if self.limits is not None:
            self.require_quantities(self.limits)

    def require_quantities(self, rule: Rule) -> None:
        """Raise ValueError for a level that names a quantity which this rule does not have."""
        for level_name, level in (("alert", rule.alert), ("danger", rule.danger)):
            for quantity in level.named if level is not None else ():
                if quantity not in self.quantities:
                    raise ValueError(
                        f"{level_name}.{quantity} is no limit of {self.name}: it has {', '.join(self.quantities)}"
                    )


@dataclass(frozen=True)
class FindingRule:
    """Declaration of how one kind of finding is reported. Raises ValueError when a part is missing.

    sentence: describes the finding, to be followed by "against the baseline, since …". force: the derived value of the element
    that is its force [N], such as `misalignment_force`; required when the rule's levels may name a force.
    """

    kind: str
    rule: AlertRule
    sentence: Callable[[SizedCause], str]
    force: str | None = None

    def __post_init__(self) -> None:
        if "force" in self.rule.quantities and self.force is None:
            raise ValueError(f"finding '{self.kind}' can have a limit for a force, and does not say which value that is")


# --- sentences ---------------------------------------------------------------------------------------------------------------


def _misalignment_sentence(one: SizedCause) -> str:
    if "allowed_at_rpm" in one.size.quantities:
        return alignment_sentence(_id(one), one.size)
    described = [(describe(name), value) for name, value in one.size.quantities.items()]
    parts = [f"{own.element} {value:+.0f} %" for own, value in described if own.quantity == "stiffness_per_cent"]
    form = f" ({one.form})" if one.form else ""
    return f"Coupling {_id(one)} is going out of alignment{form}: stiffness {', '.join(parts)}"


def _element_sentence(one: SizedCause) -> str:
    if "deviation_times_allowed" in one.size.quantities:
        return film_sentence(_id(one), one.size)
    described = [(describe(name), value) for name, value in one.size.quantities.items()]
    parts = [f"{own.quantity.removesuffix('_per_cent')} {value:+.0f} %" for own, value in described]
    return f"{describe(one.cause.element).element_kind.capitalize()} {_id(one)} has changed by itself: {', '.join(parts)}"


def _settlement_sentence(one: SizedCause) -> str:
    return settlement_sentence(_id(one), one.size)


def _wear_sentence(one: SizedCause) -> str:
    return wear_sentence(_id(one), one.size)


def _oil_sentence(one: SizedCause) -> str:
    return oil_sentence(one.size)


def _light_load_sentence(one: SizedCause) -> str:
    return f"Bearing {_id(one)} carries hardly any load: less than a tenth of what it carried, so that it may whirl"


def _heavy_load_sentence(one: SizedCause) -> str:
    return f"Bearing {_id(one)} carries more than 5 MPa of its area, the most that white metal takes (ISO 7902-3)"


def _unbalance_sentence(one: SizedCause) -> str:
    q = one.size.quantities
    return (
        f"The unbalance of disc {_id(one)} has changed by {rounded(q['change_g_mm'], 3)} g·mm at {q['change_deg']:.0f}°, "
        f"from {rounded(q['before_g_mm'], 3)} to {rounded(q['after_g_mm'], 3)} g·mm"
    )


def _rotating_coupling_sentence(one: SizedCause) -> str:
    q = one.size.quantities
    parts = [
        f"{what} by {rounded(q[f'{name}_{unit}'], 2)} {shown} at {q[f'{name}_deg']:.0f}°"
        for what, name, unit, shown in (("bore", "offset", "um", "µm"), ("face", "angle", "urad", "µrad"))
        if f"{name}_{unit}" in q
    ]
    return (
        f"The run-out of coupling {_id(one)} has changed, {' and '.join(parts)}: it turns with the shaft, whatever the speed"
    )


def _sensor_sentence(one: SizedCause) -> str:
    if not one.cause.names:
        return f"Probe {_id(one)} gives no usable phasors any more"
    q = one.size.quantities
    return f"Probe {_id(one)} or its chain reads differently: gain {q['gain_per_cent']:+.0f} %, phase {q['phase_deg']:+.0f}°"


def _run_out_sentence(one: SizedCause) -> str:
    return f"The run-out at probe {_id(one)} has changed by {_largest(one)}"


def _bow_sentence(one: SizedCause) -> str:
    return f"The bow, or the run-out at all probes, of shaft {_id(one)} has changed by {_largest(one)}"


def _misfit_sentence(_one: SizedCause) -> str:
    return "No fit explains the machine's newest runs: its model does not hold any more, or its data are wrong"


def _outliers_sentence(_one: SizedCause) -> str:
    return "Many single phasors of the newest runs do not fit and are left out: look at cables, connections and interference"


def _largest(one: SizedCause) -> str:
    return f"{rounded(one.size.quantities['largest_um'], 2)} µm"


def _id(one: SizedCause) -> str:
    return describe(one.cause.element).element_id


def rounded(value: float, digits: int) -> str:
    """Return a number with so many significant digits in plain notation: nobody reads 1.3e+04 g·mm aloud."""
    shown = float(f"{value:.{digits}g}")
    decimals = 0 if shown == 0.0 else max(0, digits - 1 - math.floor(math.log10(abs(shown))))
    return f"{shown:.{decimals}f}"


# --- alert rules, with the sources of their limits ---------------------------------------------------------------------------

MISALIGNMENT = AlertRule(
    "misalignment",
    # Thermal seasons move stiffnesses by some 2 %. The thesis's smallest misalignment raises natural frequencies by up to 2 %,
    # hence stiffnesses by 4 % at least. On oil films a quarter of what is allowed is told, and more than that is a danger.
    limits=Rule(alert=Level(sigma=3, per_cent=3, tolerance_per_cent=25), danger=Level(per_cent=15, beyond_tolerance=0.95)),
    quantities=("sigma", "per_cent", "force", "tolerance_per_cent", "beyond_tolerance"),
)
SETTLEMENT = AlertRule(
    "settlement",
    limits=Rule(alert=Level(sigma=4, tolerance_per_cent=50), danger=Level(tolerance_per_cent=200)),
    quantities=("sigma", "tolerance_per_cent"),
)
WEAR = AlertRule(
    "wear",
    # A clearance is known to some 3 % against its baseline; makers replace bearings at about twice the new clearance.
    limits=Rule(alert=Level(sigma=4, per_cent=8), danger=Level(per_cent=50)),
    quantities=("sigma", "per_cent"),
)
OIL = AlertRule(
    "oil",
    # Grades of ISO 3448 are 50 % apart; 10 K are some 50 % as well.
    limits=Rule(alert=Level(sigma=4, per_cent=60)),
    quantities=("sigma", "per_cent"),
)
BEARING = AlertRule(
    "bearing",
    # An oil film's stiffness and damping follow oil temperature and load more than a coupling's do. Films that are described
    # by geometry and oil may deviate from their model by what the document says.
    limits=Rule(alert=Level(sigma=4, per_cent=5, tolerance_per_cent=100), danger=Level(per_cent=25, tolerance_per_cent=300)),
    quantities=("sigma", "per_cent", "tolerance_per_cent"),
    deviations=("bearing", "seal"),
)
PEDESTAL = AlertRule(
    "pedestal",
    # Neither oil nor load moves it: what does is a bolt, a crack, grout or a pipe's pull.
    limits=Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("pedestal",),
)
COUPLING = AlertRule(
    "coupling",
    limits=Rule(alert=Level(sigma=4, per_cent=5), danger=Level(per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("coupling",),
)
UNBALANCE = AlertRule(
    "unbalance",
    # ISO 20816-1 calls a change of a vibration vector by a quarter of the zone B limit significant.
    limits=Rule(alert=Level(sigma=4, per_cent=25), danger=Level(per_cent=100)),
    quantities=("sigma", "per_cent"),
    deviations=("disc",),
)
ROTATING_COUPLING = AlertRule(
    "rotating_coupling",
    # 100 % is a reading of 0.05 mm at rim and face, usually allowed. Rigid couplings pull hard with a tenth of that.
    limits=Rule(alert=Level(sigma=4, tolerance_per_cent=3), danger=Level(tolerance_per_cent=100)),
    quantities=("sigma", "tolerance_per_cent"),
)
RUN_OUT = AlertRule(
    "run_out",
    limits=Rule(alert=Level(sigma=4, per_cent=25)),
    quantities=("sigma", "per_cent"),
    deviations=("shaft",),
)
SENSOR = AlertRule(
    "sensor",
    # API 670 allows a probe's scale factor 5 %. A wrong sensor is no danger to the machine.
    limits=Rule(alert=Level(sigma=4, per_cent=5)),
    quantities=("sigma", "per_cent"),
    deviations=("probe",),
)
RATE_OF_CHANGE = AlertRule(
    "rate_of_change",
    # Seasons drift by 0.25 % a week at their steepest.
    limits=Rule(alert=Level(rate_per_cent_per_week=0.5), danger=Level(rate_per_cent_per_week=2)),
    quantities=("rate_per_cent_per_week",),
    elements=("bearing", "seal", "pedestal", "coupling", "disc"),
)
"""Rule for parameters that drift too fast, whatever the diagnosis: see `service.monitoring.rate_of_change`."""

FINDING_RULES: tuple[FindingRule, ...] = (
    FindingRule("misalignment", MISALIGNMENT, _misalignment_sentence, force="misalignment_force"),
    FindingRule("bearing", BEARING, _element_sentence),
    FindingRule("coupling", COUPLING, _element_sentence),
    FindingRule("pedestal", PEDESTAL, _element_sentence),
    FindingRule("settlement", SETTLEMENT, _settlement_sentence),
    FindingRule("wear", WEAR, _wear_sentence),
    FindingRule("oil", OIL, _oil_sentence),
    FindingRule("light_load", AlertRule("light_load"), _light_load_sentence),
    FindingRule("heavy_load", AlertRule("heavy_load"), _heavy_load_sentence),
    FindingRule("unbalance", UNBALANCE, _unbalance_sentence),
    FindingRule("rotating_coupling", ROTATING_COUPLING, _rotating_coupling_sentence),
    FindingRule("bow", RUN_OUT, _bow_sentence),
    FindingRule("run_out", RUN_OUT, _run_out_sentence),
    FindingRule("sensor", SENSOR, _sensor_sentence),
    FindingRule("misfit", AlertRule("misfit"), _misfit_sentence),
    FindingRule("outliers", AlertRule("outliers"), _outliers_sentence),
)


def require_complete(declared: Sequence[FindingRule], kinds: Iterable[str]) -> Mapping[str, FindingRule]:
    """Return the declarations by kind. Raises ValueError unless there is exactly one for each kind of finding."""
    found = {one.kind: one for one in declared}
    if len(found) < len(declared):
        raise ValueError(f"a finding is declared twice: {', '.join(one.kind for one in declared)}")
    missing, unknown = sorted(set(kinds) - set(found)), sorted(set(found) - set(kinds))
    if missing:
        raise ValueError(f"findings without sentence and alert rule in FINDING_RULES: {', '.join(missing)}")
    if unknown:
        raise ValueError(f"FINDING_RULES has what is no kind of finding of the estimator: {', '.join(unknown)}")
    return found


_BY_KIND = require_complete(FINDING_RULES, [one.kind for one in FINDING_KINDS])


def finding_rule(kind: str) -> FindingRule:
    """Return the declaration of a kind of finding. Raises KeyError when there is none."""
    return _BY_KIND[kind]


def is_finding(kind: str) -> bool:
    """Return whether a kind of finding exists."""
    return kind in _BY_KIND


def _rules_by_name() -> Mapping[str, AlertRule]:
    """Return the alert rules of all findings. Raises ValueError for two different ones of one name."""
    found: dict[str, AlertRule] = {}
    for one in FINDING_RULES:
        if found.setdefault(one.rule.name, one.rule) is not one.rule:
            raise ValueError(f"two alert rules are called '{one.rule.name}': finding '{one.kind}' needs one of its own name")
    return found


DIAGNOSIS_RULES = _rules_by_name()
"""Alert rules of the findings of a diagnosis, by name."""
LIMITED_RULES: Mapping[str, AlertRule] = {
    name: rule for name, rule in {**DIAGNOSIS_RULES, RATE_OF_CHANGE.name: RATE_OF_CHANGE}.items() if rule.limits is not None
}
"""Alert rules with limits, by name, in the order of display."""


def concerned_elements(rule: AlertRule) -> tuple["ElementKind", ...]:
    """Return the kinds of elements that a rule concerns."""
    of_findings = (kind for one in FINDING_RULES if one.rule is rule for kind in finding_kind(one.kind).elements)
    return tuple(dict.fromkeys((*of_findings, *rule.elements)))
