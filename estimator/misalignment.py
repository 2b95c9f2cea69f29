"""The sign of misalignment: a coupling and the bearings beside it become stiffer together.

On the thesis's rig (§5.7-5.8) angular, parallel and combined misalignment raised the coefficients of the coupling and of
its neighbouring bearings, the more the larger it was, while an unbalance raises none of them. One bearing that changes
alone is no misalignment, so coupling and bearings must both have moved.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.baseline import CommonShift, Point, common_shift
from estimator.machine import Coupling, Machine

CHANCE_TOGETHER = 1e-4
"""Probability, while nothing has changed, with which the common shift may pass in one identification."""
CHANCE_APART = 0.01
"""The same for the coupling alone and for the bearings alone."""
SMALLEST_SHIFT = 0.02
"""Stiffening below 2 % is not called misalignment, however certain it is."""
STIFFNESSES = ("kxx", "kyy")


@dataclass(frozen=True)
class MisalignmentEvidence:
    """What speaks for misalignment at one coupling. Each part is None where the data determine none of its parameters."""

    coupling: str
    together: CommonShift | None
    coupling_alone: CommonShift | None
    bearings_alone: CommonShift | None

    @property
    def found(self) -> bool:
        """Whether this identification, taken alone, shows misalignment."""
        if self.together is None or self.coupling_alone is None or self.bearings_alone is None:
            return False
        return (
            self.together.shift >= SMALLEST_SHIFT
            and self.together.probability <= CHANCE_TOGETHER
            and self.coupling_alone.probability <= CHANCE_APART
            and self.bearings_alone.probability <= CHANCE_APART
        )


def neighbouring_bearings(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """Ids of the last bearing before a coupling and of the first one behind it."""
    before = [b for b in machine.bearings if b.shaft == coupling.driver]
    behind = [b for b in machine.bearings if b.shaft == coupling.driven]
    last = [max(before, key=lambda b: b.station).id] if before else []
    first = [min(behind, key=lambda b: b.station).id] if behind else []
    return tuple(last + first)


def misalignment_evidence(machine: Machine, baseline: Sequence[Point], now: Point) -> tuple[MisalignmentEvidence, ...]:
    """Evidence at each coupling of a machine, from logarithms of direct stiffnesses over the baseline's and now."""
    known = set(now.names).intersection(*(point.names for point in baseline))

    def shift(elements: Sequence[str]) -> CommonShift | None:
        names = [name for e in elements for k in STIFFNESSES if (name := f"{e}.{k}") in known]
        return common_shift(baseline, now, names) if names else None

    result = []
    for coupling in machine.couplings:
        own = [f"coupling.{coupling.id}"]
        bearings = [f"bearing.{bearing}" for bearing in neighbouring_bearings(machine, coupling)]
        result.append(MisalignmentEvidence(coupling.id, shift(own + bearings), shift(own), shift(bearings)))
    return tuple(result)
