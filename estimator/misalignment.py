"""The sign of misalignment: a coupling and the bearings beside it become stiffer together.

On the thesis's rig (§5.7-5.8) angular, parallel and combined misalignment raised the coefficients of the coupling and of
its neighbouring bearings, the more the larger it was, while an unbalance raises none of them. One bearing that changes
alone is no misalignment, so coupling and bearings must both have moved.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.baseline import CommonShift, Point, common_shift
from estimator.machine import Bearing, Coupling, Machine

CHANCE_TOGETHER = 1e-4
"""Probability, while nothing has changed, with which the common shift may pass in one identification."""
CHANCE_APART = 0.01
"""The same for the coupling alone and for the bearings alone."""
SMALLEST_SHIFT = 0.02
"""Stiffening below 2 % is not called misalignment, however certain it is."""
LARGEST_ERROR = 0.15
"""An identification that leaves ln k of a watched stiffness less certain than this says nothing about misalignment."""
STIFFNESSES = ("kxx", "kyy")


@dataclass(frozen=True)
class MisalignmentEvidence:
    """What speaks for misalignment at one coupling. bearings_alone: None where no bearing is beside it."""

    coupling: str
    together: CommonShift
    coupling_alone: CommonShift
    bearings_alone: CommonShift | None

    @property
    def found(self) -> bool:
        """Whether this identification, taken alone, shows misalignment."""
        if self.bearings_alone is None:
            return False
        return (
            self.together.shift >= SMALLEST_SHIFT
            and self.together.probability <= CHANCE_TOGETHER
            and self.coupling_alone.probability <= CHANCE_APART
            and self.bearings_alone.probability <= CHANCE_APART
        )


def neighbouring_bearings(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """Ids of the last bearing before a coupling and of the first one behind it, past shafts that have none."""
    towards_driver = {one.driven: one.driver for one in machine.couplings}
    towards_driven = {one.driver: one.driven for one in machine.couplings}
    before = _first_with_bearings(machine, coupling.driver, towards_driver)
    behind = _first_with_bearings(machine, coupling.driven, towards_driven)
    last = [max(before, key=lambda b: b.station).id] if before else []
    first = [min(behind, key=lambda b: b.station).id] if behind else []
    return tuple(last + first)


def _first_with_bearings(machine: Machine, shaft: str | None, onward: dict[str, str]) -> list[Bearing]:
    """Bearings of a shaft, or of the next one onward that has any. A train's couplings make no ring, so this ends."""
    while shaft is not None:
        found = [bearing for bearing in machine.bearings if bearing.shaft == shaft]
        if found:
            return found
        shaft = onward.get(shaft)
    return []


def watched(machine: Machine, coupling: Coupling) -> tuple[str, ...]:
    """Names of the stiffnesses that tell of misalignment at a coupling: its own, then those of the bearings beside it."""
    elements = [f"coupling.{coupling.id}", *(f"bearing.{bearing}" for bearing in neighbouring_bearings(machine, coupling))]
    return tuple(f"{element}.{name}" for element in elements for name in STIFFNESSES)


def determines(point: Point, names: Sequence[str]) -> bool:
    """Whether an identification knows all these parameters well enough to say anything about their change."""
    if not set(names) <= set(point.names):
        return False
    return bool(np.all(np.sqrt(np.diag(point.of(names).covariance)) <= LARGEST_ERROR))


def misalignment_evidence(machine: Machine, coupling: Coupling, baseline: Sequence[Point], now: Point) -> MisalignmentEvidence:
    """Evidence at one coupling, from points that all determine what is `watched` there.

    Raises ValueError for an empty baseline or a point that lacks one of the parameters.
    """
    names = watched(machine, coupling)
    own, bearings = names[: len(STIFFNESSES)], names[len(STIFFNESSES) :]
    return MisalignmentEvidence(
        coupling=coupling.id,
        together=common_shift(baseline, now, names),
        coupling_alone=common_shift(baseline, now, own),
        bearings_alone=common_shift(baseline, now, bearings) if bearings else None,
    )
