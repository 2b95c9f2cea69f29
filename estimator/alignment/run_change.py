"""Change of a machine's coordinates between a baseline and a later run: what the runs have in common cancels.

Errors of clearances and of the films' deviations are alike in all runs of one machine, so that a difference of two offsets is
known better than either. All runs are taken together: each fit gives a Gaussian likelihood of its coordinates, which are the
machine's, common to all, with a variation from run to run; the elevations of the later run have moved besides, its oil may
be of another season, and what named causes have moved is another's (linear mixed model; Laird and Ware, Biometrics 38 (1982)
963, doi:10.2307/2529876). The later run is told as it was: a micrometre by which its bearings stand otherwise than in the run
before is a part of its alignment, and no error of it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.alignment.compliant_couplings import compliant_couplings
from estimator.alignment.freed_coordinates import MovingCause, freed_directions
from estimator.alignment.healthy_films import coordinate_scales, learnt_variation, machine_precision
from estimator.alignment.run_likelihood import RunLikelihood, run_likelihood
from estimator.alignment.season_of_run import season_of_run
from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.film_parameter_names import unknown_forces, with_open_forces
from estimator.machine.parameter_description import describe
from estimator.symmetric_eigen import symmetric_eigen
from estimator.updated_model.model import UpdatedModel, model_at
from estimator.updated_model.placed_films import placed_films
from estimator.updated_model.uncertainty import standard_errors

NEGLIGIBLE = 1e-14
"""Variance of a direction, over the largest, that counts as none [-]."""


@dataclass(frozen=True)
class RunChange:
    """Change of a machine's n coordinates θ against a baseline.

    Attributes:
        runs: Models of the baseline's runs and of the later one, the last, in the coordinates that all of them have.
        coordinates: The coordinates.
        before: The machine in the baseline (n,) [-].
        run: Change (n,) of the later run: of its elevations, of what named causes have moved, and of what varies from run to
            run and over the seasons [-].
        run_covariance: Covariance (n, n) of that [-].
    """

    runs: tuple[UpdatedModel, ...]
    coordinates: Coordinates
    before: Floats
    run: Floats
    run_covariance: Floats

    @property
    def later(self) -> UpdatedModel:
        """Return the model of the later run."""
        return self.runs[-1]


def run_change(
    baseline: Sequence[UpdatedModel],
    later: UpdatedModel,
    *,
    variation: HealthyVariation | None = None,
    causes: Iterable[MovingCause] = (),
) -> RunChange | None:
    """Estimate by how much a later run's coordinates differ from a baseline's (linear mixed model; Laird and Ware 1982).

    A change of each elevation is believed to be as large as the document says that the elevation may be off. How far the
    season is another one is seen by the oil, in a first estimate. Forces that not all runs doubt alike are no coordinates:
    what they leave open is in the others' covariance.

    Source: mixed model of Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.
        later: Model of the later run.
        variation: How the machine varies while it is healthy; None to learn it from the baseline.
        causes: Element of what else is known to have happened to the machine since: what that moves is not held at
            the baseline's.

    Returns:
        The change; None of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    *baseline, later = runs = _in_common_coordinates([*baseline, later])
    if not baseline or any(one.coordinates != later.coordinates for one in baseline):
        raise ValueError("changes need a baseline of at least one run of the same machine")
    coordinates = later.coordinates_at(np.ones(1))
    moving = [place for place, name in enumerate(coordinates.names) if describe(name).physical_quantity == "elevation"]
    if placed_films(coordinates) is None or not moving:
        return None
    chosen = learnt_variation(baseline) if variation is None else variation
    scales = coordinate_scales(coordinates, later.values)
    varying = scales.between_runs(chosen)
    found_at = np.array([coordinates.theta(one.values) - coordinates.centre for one in (*baseline, later)])
    couplings = compliant_couplings(coordinates.names, coordinates.unit, found_at)
    *before, own = (
        couplings.likelihood(run_likelihood(one), at) for one, at in zip((*baseline, later), found_at, strict=True)
    )
    before = [one.marginalised(varying) for one in before]
    lasting = np.column_stack(
        [np.eye(coordinates.size)[:, moving] * coordinates.spread[moving], freed_directions(coordinates, causes)]
    )

    def in_season(season: HealthyVariation) -> RunChange:
        covariance = scales.over_seasons(season)
        covariance[moving], covariance[:, moving] = 0.0, 0.0  # what elevations do over the seasons is a change of alignment
        ways = np.column_stack([lasting, _columns(varying + covariance)])
        return _estimated(before, own, tuple(runs), coordinates, ways)

    found = in_season(chosen)
    if not scales.oil.any():
        return found
    together = scales.oil / scales.oil.sum()
    shift, error = float(together @ found.run), float(standard_errors(together, found.run_covariance))
    return in_season(season_of_run(chosen, baseline, later, shift=shift, error=error))


def _estimated(
    before: Sequence[RunLikelihood], own: RunLikelihood, runs: tuple[UpdatedModel, ...], coordinates: Coordinates, ways: Floats
) -> RunChange:
    """Estimate the machine and the change of a later run together.

    before: likelihoods of the machine by the baseline's runs. own: that of the later run. ways: directions (n, w) of the
    change, each as long as its standard deviation.
    """
    size = coordinates.size
    information = np.eye(size + ways.shape[1])
    information[:size, :size] = sum((one.information for one in before), own.information) + machine_precision(coordinates)
    information[:size, size:], information[size:, :size] = own.information @ ways, ways.T @ own.information
    information[size:, size:] += ways.T @ own.information @ ways
    vector = np.concatenate([sum((one.vector for one in before), own.vector), ways.T @ own.vector])
    scale = np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information / np.outer(scale, scale)) / np.outer(scale, scale)
    found = covariance @ vector
    return RunChange(
        runs=runs,
        coordinates=coordinates,
        before=coordinates.centre + found[:size],
        run=ways @ found[size:],
        run_covariance=ways @ covariance[size:, size:] @ ways.T,
    )


def _columns(covariance: Floats) -> Floats:
    """Return columns (n, s) whose products a covariance is."""
    size, directions = symmetric_eigen(covariance)
    kept = size > NEGLIGIBLE * max(float(size[-1]), 1e-300)
    return np.asarray(directions[:, kept] * np.sqrt(size[kept]))


def _in_common_coordinates(models: Sequence[UpdatedModel]) -> list[UpdatedModel]:
    """Return models without the forces that not all of them have as coordinates with one spread.

    The document calls these exact, and each run that doubts one does so by a size of its own.
    """
    spreads = [_force_spreads(one.machine) for one in models]
    everywhere = set.intersection(*(set(one.items()) for one in spreads))
    found = []
    for one, own in zip(models, spreads, strict=True):
        alone = [name for name in own if (name, own[name]) not in everywhere]
        if alone:
            machine, _ = with_open_forces(one.machine, dict.fromkeys(alone, 0.0))
            one = model_at(machine, one.coordinates, one.values, one.covariance)
        found.append(one)
    return found


def _force_spreads(machine: Machine) -> dict[str, float]:
    """Return how far each static force that is a coordinate may be off [N], by name."""
    loads = machine.static_loads
    return {
        name: (loads[number].force_x_spread, loads[number].force_y_spread)[component]
        for name, (number, component) in unknown_forces(loads).items()
    }
