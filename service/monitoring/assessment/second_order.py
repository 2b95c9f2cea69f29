"""The 2× as a tie-breaker: it decides between explanations that are about equally good. It is no evidence by itself, since
two-pole generators and asymmetric rotors have a 2× of their own.

A misalignment makes a 2× at the probes beside its coupling (J. Piotrowski, Shaft Alignment Handbook, 3rd ed., CRC Press 2006,
ch. 2), that of a generator or of an asymmetric rotor does not grow: so it counts where it has left its baseline's band there,
and at no other probe.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from estimator.machine.coupling_neighbours import probes_beside
from estimator.machine.parameter_description import describe
from service.monitoring.assessment.context import AssessmentContext, SecondOrderGrowth
from service.monitoring.assessment.load_changes import change_beyond_band
from service.monitoring.rules.coupling_and_bearing_findings import MISALIGNMENT
from service.monitoring.rules.diagnosis_rules import delays

if TYPE_CHECKING:
    from estimator.diagnosis.bayes_factors import Diagnosis
    from estimator.diagnosis.finding_kind import Cause

CLOSE = 3.0
"""Lead in evidence up to which the next explanation is worth a thought [-]: a factor of 20."""
TIE = 1.0
"""Lead in evidence up to which two explanations are about as good as each other [-]: a factor of 2.7."""
LEAST_GROWTH = 0.25
"""Least growth of a 2×, relative to its value before, that counts [-]."""


@dataclass(frozen=True)
class Explanation:
    """The explanation that was chosen, its runners-up, and the growth of the 2× that supports it."""

    cause: "Cause"
    runners_up: tuple["Cause", ...]
    second_order: SecondOrderGrowth | None = None


def explained(context: AssessmentContext, diagnosis: "Diagnosis", place: int) -> Explanation:
    """Return a cause of a diagnosis, or the runner-up that is about as good where the 2× speaks for it and not for the cause.

    An explanation whose alert is open is kept, and one beside others: what they leave is not compared.
    """
    cause, others = diagnosis.causes[place], diagnosis.runners_up[place]
    found = Explanation(cause, others)
    if not others or cause.evidence - others[0].evidence > CLOSE:
        return found
    for_cause, second = second_order_growth(context, cause), others[0]
    if for_cause is not None:
        return replace(found, second_order=for_cause)
    for_second = second_order_growth(context, second)
    alone = sum(bool(one.names) for one in diagnosis.causes) == 1
    needed, _ = delays(context.limits, second.kind, second.element)
    agreed = needed <= len(second.agreement) and min(second.agreement[-needed:]) > 0.0
    # One that was preferred before is not given up for a little more than a tie.
    close = CLOSE if (second.kind, second.element) in context.open_causes else TIE
    tied = cause.evidence - second.evidence <= close and (cause.kind, cause.element) not in context.open_causes
    if for_second is None or not (alone and agreed and tied):
        return found
    return Explanation(second, (cause, *others[1:]), replace(for_second, decided=True))


def second_order_growth(context: AssessmentContext, cause: "Cause") -> SecondOrderGrowth | None:
    """Return the largest growth of the 2× beside a misaligned coupling; None where there is none, or another one elsewhere."""
    if cause.kind != MISALIGNMENT.name:
        return None
    coupling = next(one for one in context.machine.couplings if f"coupling.{one.id}" == cause.element)
    beside = set(probes_beside(context.machine, coupling))
    grown = list(_grown(context))
    if not grown or any(one.probe not in beside for one in grown):
        return None
    return max(grown, key=lambda one: one.now / one.before)


def _grown(context: AssessmentContext) -> Iterator[SecondOrderGrowth]:
    """Yield the probes whose 2× is larger than the band of their baseline allows."""
    for one in context.second_orders:
        change = change_beyond_band(one)
        if change is not None and change.before is not None and change.value > LEAST_GROWTH * change.before > 0.0:
            yield SecondOrderGrowth(describe(one.element).element_id, change.before, one.newest)
