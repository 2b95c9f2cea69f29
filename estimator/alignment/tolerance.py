"""Tolerance of a coupling's alignment, and the probability that it lies beyond (JCGM 106:2012, conformance probability).

Where the document says nothing, the values are common practice and no standard: the acceptable ones of the table for short
flexible couplings that Prüftechnik prints in its manuals (Rotalign, Machinery alignment tolerance tables), which rests on the
sliding speed of lubricated steel, 12 mm/s. Between its speeds they follow straight lines of logarithms, beyond its ends the
nearest speed's. Rigid couplings have no value of their own there; they are held to the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.special

from estimator.alignment.alignment_change import AlignmentChange
from estimator.fit.estimates import CONFIDENCE_95, prior_alone, prior_alone_reason
from estimator.machine.document import Machine
from estimator.machine.film_speeds import reported_rpm
from estimator.machine.parameter_description import describe

USUAL_RPM = (750.0, 1500.0, 3000.0, 6000.0)
"""Speeds of the table [r/min]."""
USUAL_OFFSET = (190e-6, 90e-6, 60e-6, 30e-6)
"""Acceptable offsets at these speeds [m]."""
USUAL_ANGLE = (1.3e-3, 0.7e-3, 0.4e-3, 0.3e-3)
"""Acceptable angles at these speeds [rad]: mm of gap over 100 mm of diameter."""


@dataclass(frozen=True)
class AllowedAlignment:
    """Alignment that is allowed at a coupling, in either plane.

    Attributes:
        offset: Offset [m].
        angle: Angle [rad].
        rpm: Speed at which it is [r/min].
        stated: Quantities of which the document says so, of `offset` and `angle`; the others are usual.
    """

    offset: float
    angle: float
    rpm: float
    stated: frozenset[str]

    def of(self, quantity: str) -> float:
        """Return the tolerance of a quantity.

        Args:
            quantity: Its name, such as `offset_vertical`.

        Returns:
            The limit of its magnitude [m, rad].

        Raises:
            KeyError: It is no offset or angle of a coupling.
        """
        return {"offset": self.offset, "angle": self.angle}[quantity.partition("_")[0]]


@dataclass(frozen=True)
class ToleratedChange:
    """Change of an offset or angle of a coupling beside what is allowed.

    Attributes:
        name: Name, such as `coupling.C1.offset_vertical`.
        unit: SI unit.
        value: By how much it is larger than in the baseline [unit]; None where that is not determined.
        half: Half width of its 95 % interval [unit].
        allowed: What is allowed [unit].
        beyond: Probability that it lies beyond that [-].
        reason: Reason why it is not determined; None where it is.
    """

    name: str
    unit: str
    value: float | None
    half: float
    allowed: float
    beyond: float
    reason: str | None = None

    @property
    def part(self) -> float:
        """Return the magnitude over what is allowed [-]; 0 where it is not determined."""
        return 0.0 if self.value is None else abs(self.value) / self.allowed


def allowed_alignment(machine: Machine, coupling: str) -> AllowedAlignment:
    """Return the tolerances of a coupling at running speed (document, else Prüftechnik's table).

    Args:
        machine: The machine.
        coupling: Id of the coupling.

    Returns:
        The tolerances.
    """
    rpm = reported_rpm(machine)[-1]
    said = next((one for one in machine.operation.alignment_tolerances if one.coupling == coupling), None)
    given = {} if said is None else {"offset": said.offset, "angle": said.angle}
    stated = {name: value for name, value in given.items() if value is not None}
    usual = {"offset": _usual(rpm, USUAL_OFFSET), "angle": _usual(rpm, USUAL_ANGLE)} | stated
    return AllowedAlignment(usual["offset"], usual["angle"], rpm, frozenset(stated))


def tolerated_changes(machine: Machine, changes: Sequence[AlignmentChange]) -> tuple[ToleratedChange, ...]:
    """Compare changes of alignment with what is allowed (normal distribution of each).

    Args:
        machine: The machine.
        changes: Changes against its baseline.

    Returns:
        The changes, in their order.
    """
    found = []
    for one in changes:
        said = describe(one.name)
        allowed = allowed_alignment(machine, said.element_id).of(said.quantity)
        why = one.undefined or (prior_alone_reason(one.believed, one.unit) if prior_alone(one.error, one.believed) else None)
        value = one.value if why is None else None
        beyond = 0.0 if why is not None else probability_beyond(one.value, one.error, allowed)
        found.append(ToleratedChange(one.name, one.unit, value, CONFIDENCE_95 * one.error, allowed, beyond, why))
    return tuple(found)


def probability_beyond(value: float, error: float, allowed: float) -> float:
    """Compute the probability that a normal variable's magnitude exceeds a limit (JCGM 106:2012).

    Args:
        value: Its mean [any unit].
        error: Its standard error [same unit].
        allowed: The limit [same unit].

    Returns:
        Probability [-].
    """
    size = max(error, 1e-12 * allowed)
    return float(scipy.special.ndtr((-allowed - value) / size) + scipy.special.ndtr((value - allowed) / size))


def _usual(rpm: float, values: Sequence[float]) -> float:
    return math.exp(float(np.interp(math.log(rpm), np.log(USUAL_RPM), np.log(values))))
