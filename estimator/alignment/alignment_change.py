"""Change of a train's alignment between a baseline and a later run: what the runs have in common cancels.

Errors of clearances and of the films' deviations are alike in all runs of one machine, so that a difference of two offsets is
known better than either. All runs are taken together: each fit gives a Gaussian likelihood of its coordinates, which are the
machine's, common to all, with a variation from run to run; the elevations of the later run have moved besides, and its oil may
be of another season (linear mixed model; Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.healthy_films import coordinate_scales, learnt_variation
from estimator.alignment.run_likelihood import run_likelihood
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.film_parameter_names import unknown_forces, with_open_forces
from estimator.machine.parameter_description import describe
from estimator.updated_model.alignment_results import alignment_results
from estimator.updated_model.derived_quantities import Derived, interval
from estimator.updated_model.film_results import placed_films
from estimator.updated_model.model import UpdatedModel, model_at
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
    baseline: Sequence[UpdatedModel], later: UpdatedModel, *, variation: HealthyVariation | None = None
) -> tuple[AlignmentChange, ...]:
    """Estimate by how much offsets and angles differ from those of a baseline (linear mixed model; Laird and Ware 1982).

    A change of each elevation is believed to be as large as the document says that the elevation may be off. Forces that only
    some of the runs doubt are no coordinates here: what they leave open is in the others' covariance.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.

    Returns:
        The changes, named as alignment is; none of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    *baseline, later = _in_common_coordinates([*baseline, later])
    if not baseline or any(one.coordinates != later.coordinates for one in baseline):
        raise ValueError("changes need a baseline of at least one run of the same machine")
    coordinates = later.coordinates_at(np.ones(1))
    moving = [place for place, name in enumerate(coordinates.names) if describe(name).quantity.startswith("elevation")]
    if placed_films(coordinates) is None or not moving:
        return ()
    chosen = learnt_variation(baseline) if variation is None else variation
    scales = coordinate_scales(coordinates, later.values)
    varying, season = scales.between_runs(chosen), scales.over_seasons(chosen)
    season[moving], season[:, moving] = 0.0, 0.0  # what elevations do over the seasons is a change of alignment
    before = [run_likelihood(one).marginalised(varying) for one in baseline]
    own = run_likelihood(later).marginalised(varying + season)
    size, believed = coordinates.size, coordinates.spread[moving]
    information = np.zeros((size + len(moving), size + len(moving)))
    information[:size, :size] = sum((one.information for one in before), own.information) + coordinates.prior.precision
    information[:size, size:], information[size:, :size] = own.information[:, moving], own.information[moving]
    information[size:, size:] = own.information[np.ix_(moving, moving)] + np.diag(believed**-2)
    vector = np.concatenate([sum((one.vector for one in before), own.vector), own.vector[moving]])
    scale = np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information / np.outer(scale, scale)) / np.outer(scale, scale)
    moved, error = (covariance @ vector)[size:], covariance[size:, size:]
    found = []
    for one in alignment_results(later):
        row = (one.slope * coordinates.unit)[moving]
        known = float(np.linalg.norm(row * believed))
        changed, uncertain = float(row @ moved), float(standard_errors(row, error))
        found.append(AlignmentChange(one.name, one.unit, changed, uncertain, known, one.undefined))
    return tuple(found)


def _in_common_coordinates(models: Sequence[UpdatedModel]) -> list[UpdatedModel]:
    """Return models without the forces, called exact by the document, that not all of them have as coordinates."""
    everywhere = set.intersection(*(set(one.coordinates) for one in models))
    found = []
    for one in models:
        alone = [name for name in unknown_forces(one.machine.static_loads) if name not in everywhere]
        if alone:
            machine, _ = with_open_forces(one.machine, dict.fromkeys(alone, 0.0))
            one = model_at(machine, one.coordinates, one.values, one.covariance)
        found.append(one)
    return found


def alignment_change_quantities(
    baseline: Sequence[UpdatedModel], later: UpdatedModel, *, variation: HealthyVariation | None = None
) -> tuple[Derived, ...]:
    """Derive by how much offset and angle of each coupling have changed against a baseline, or why that is not determined.

    Args:
        baseline: Models of the baseline's runs, at least one, of the same machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.

    Returns:
        Changes [m, rad], named as alignment is; none of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    return tuple(
        interval(one.name, one.unit, one.value, error=one.error, believed=one.believed, undefined=one.undefined)
        for one in alignment_changes(baseline, later, variation=variation)
    )
