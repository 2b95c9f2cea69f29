"""Change of the static loads on a train's oil films between a baseline and a later run: errors that all runs share cancel.

Two runs' loads err alike: the difference of two loads with errors of their own would be told several times too wide
(`run_change`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.freed_coordinates import MovingCause
from estimator.alignment.run_change import RunChange, run_change
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.film_speeds import reported_rpm
from estimator.statics.journal_states import journal_states
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films
from estimator.updated_model.uncertainty import standard_errors

AXES = (("horizontal", 0), ("vertical", 1))
"""Directions of loads, with their axes."""
LEAST_PART = 0.1
"""Part of the whole load that a direction carries at least, for changes to be told as part of it."""
SOLUTION_ERROR = 1e-6
"""Standard error that solving for the equilibrium adds to a change, as part of the whole load."""


@dataclass(frozen=True)
class LoadChange:
    """Change of the load on a film at running speed.

    Attributes:
        name: Name of the load, such as `bearing.B2.load_vertical`.
        value: By how much it is larger than in the baseline [N].
        error: Standard error of that [N].
        before: The load in the baseline [N].
        carried: Size of the whole load in the baseline, of both directions together [N].
    """

    name: str
    value: float
    error: float
    before: float
    carried: float

    @property
    def half(self) -> float:
        """Return the half width of the 95 % interval [N]."""
        return CONFIDENCE_95 * self.error

    @property
    def part(self) -> float | None:
        """Return the change as part of the load before, in the same direction.

        Returns:
            The part [-]; None where the direction carries next to nothing of the load.
        """
        return self.value / abs(self.before) if abs(self.before) > LEAST_PART * self.carried else None


def load_changes(
    baseline: Sequence[UpdatedModel],
    later: UpdatedModel,
    *,
    variation: HealthyVariation | None = None,
    causes: Iterable[MovingCause] = (),
) -> tuple[LoadChange, ...]:
    """Estimate by how much the loads on a train's films differ from those of a baseline (JCGM 100:2008, 5.2).

    Where the oil's temperature is measured, both are at that of the later run.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.
        causes: Element of what else is known to have happened since, as `run_change` takes them.

    Returns:
        The changes, bearing by bearing; none of a train whose coefficients do not follow from films, or without equilibrium.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    change = run_change(baseline, later, variation=variation, causes=causes)
    return () if change is None else changed_loads(change)


def changed_loads(change: RunChange) -> tuple[LoadChange, ...]:
    """Derive the changes of the loads from that of the coordinates (JCGM 100:2008, 5.2).

    Args:
        change: Change of the coordinates.

    Returns:
        The changes, as `load_changes` gives them; none of a train without equilibrium.
    """
    later = change.later
    speed = np.array([rpm_to_rad_per_s(reported_rpm(later.machine)[-1])])
    placed_at = placed_films(later.coordinates_at(speed))
    if placed_at is None:
        return ()
    placed, films = placed_at
    first, last = (
        journal_states(films, placed.own(theta), speed=speed) for theta in (change.before, change.before + change.run)
    )
    if first is None or last is None:
        return ()
    slopes = last.force_slope[-1]
    own = placed.numbers[: slopes.shape[-1]]
    covariance = change.run_covariance[np.ix_(own, own)]
    carried = np.hypot(*first.force[-1].T)
    return tuple(
        LoadChange(
            name=f"bearing.{bearing.id}.load_{direction}",
            value=float(last.force[-1, number, axis] - first.force[-1, number, axis]),
            error=float(np.hypot(standard_errors(slopes[number, axis], covariance), SOLUTION_ERROR * carried[number])),
            before=float(first.force[-1, number, axis]),
            carried=float(carried[number]),
        )
        for number, bearing in enumerate(later.machine.bearings)
        for direction, axis in AXES
    )
