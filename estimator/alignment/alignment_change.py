"""Change of a train's alignment between a baseline and a later run: what the runs have in common cancels.

It is that of the coordinates (`run_change`: Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.freed_coordinates import MovingCause
from estimator.alignment.open_stiffness import open_alignments
from estimator.alignment.run_change import RunChange, run_change
from estimator.machine.alignment_rules import HealthyVariation
from estimator.updated_model.alignment_results import alignment_results
from estimator.updated_model.derived_quantities import Derived, interval
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors


@dataclass(frozen=True)
class AlignmentChange:
    """Change of an offset or an angle of a coupling against a baseline.

    Attributes:
        name: Name of the offset or angle, such as `coupling.C1.offset_vertical`.
        unit: SI unit.
        value: By how much it is larger than in the baseline [unit].
        error: Standard error of that [unit].
        believed: Standard deviation of a change that is believed possible beforehand [unit].
        undefined: Reason why there is none; None where there is one.
    """

    name: str
    unit: str
    value: float
    error: float
    believed: float
    undefined: str | None = None


def alignment_changes(
    baseline: Sequence[UpdatedModel],
    later: UpdatedModel,
    *,
    variation: HealthyVariation | None = None,
    causes: Iterable[MovingCause] = (),
) -> tuple[AlignmentChange, ...]:
    """Estimate by how much offsets and angles differ from those of a baseline (linear mixed model; Laird and Ware 1982).

    A change of each elevation is believed to be as large as the document says that the elevation may be off. Forces that only
    some of the runs doubt are no coordinates here: what they leave open is in the others' covariance.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.
        causes: Element of what else is known to have happened to the machine since, and what that moves and is not held at
            the baseline's.

    Returns:
        The changes, named as alignment is; none of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    change = run_change(baseline, later, variation=variation, causes=causes)
    return () if change is None else changed_alignment(change)


def changed_alignment(change: RunChange) -> tuple[AlignmentChange, ...]:
    """Derive the changes of offsets and angles from that of the coordinates (JCGM 100:2008, 5.2).

    Args:
        change: Change of the coordinates.

    Returns:
        The changes, as `alignment_changes` gives them.
    """
    coordinates, left_open = change.coordinates, open_alignments(change.runs)
    found = []
    for one in alignment_results(change.later):
        row = one.slope * coordinates.unit
        known = float(np.linalg.norm(row * coordinates.spread))
        changed, uncertain = float(row @ change.run), float(standard_errors(row, change.run_covariance))
        undefined = one.undefined or left_open.get(one.name)
        found.append(AlignmentChange(one.name, one.unit, changed, uncertain, known, undefined))
    return tuple(found)


def alignment_change_quantities(
    baseline: Sequence[UpdatedModel],
    later: UpdatedModel,
    *,
    variation: HealthyVariation | None = None,
    causes: Iterable[MovingCause] = (),
) -> tuple[Derived, ...]:
    """Derive by how much offset and angle of each coupling have changed against a baseline, or why that is not determined.

    Args:
        baseline: Models of the baseline's runs, at least one, of the same machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.
        causes: Element of what else is known to have happened since, as `alignment_changes` takes them.

    Returns:
        Changes [m, rad], named as alignment is; none of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    return tuple(
        interval(one.name, one.unit, one.value, error=one.error, believed=one.believed, undefined=one.undefined)
        for one in alignment_changes(baseline, later, variation=variation, causes=causes)
    )
