"""Change of a train's alignment between a baseline and a later run: what the runs have in common cancels.

Errors of clearances and of the films' deviations are alike in all runs of one machine, so that a difference of two offsets is
known better than either. All runs are taken together: each fit gives a Gaussian likelihood of its coordinates, which are the
machine's, common to all, with a variation from run to run; the elevations of the later run have moved besides (linear mixed
model; Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.terms import TERMS
from estimator.fit.coordinates import Coordinates
from estimator.machine.parameter_description import ParameterDescription, describe
from estimator.statics.film_deviations import SHARED
from estimator.updated_model.alignment_results import alignment_results
from estimator.updated_model.film_results import placed_films
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors

DEVIATION = "_deviation"
"""Middle of the names of films' deviations, behind the term that deviates."""
LEVELS = {"stiffness": 0, "damping": 1}
"""Power of jω of the terms whose deviations all films share, by the word that their names begin with."""


@dataclass(frozen=True)
class RunVariation:
    """Standard deviations by which a healthy machine varies from run to run.

    Attributes:
        stiffness: Of each stiffness of films and couplings, relative [-].
        damping: Of each damping, relative [-].
        oil: Of the viscosity of all films together, of its logarithm [-]: some 2 K of oil temperature.
        viscosity: Of each film's viscosity by itself, of its logarithm [-].
        unbalance: Of each unbalance, as a part of it [-].
        elevation: Of each bearing's elevation in each direction [m].
    """

    stiffness: float = 0.01
    damping: float = 0.05
    oil: float = 0.05
    viscosity: float = 0.01
    unbalance: float = 0.03
    elevation: float = 1e-6


USUAL = RunVariation()
"""Variation of machines of which nothing else is known."""


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
    baseline: Sequence[UpdatedModel], later: UpdatedModel, *, variation: RunVariation = USUAL
) -> tuple[AlignmentChange, ...]:
    """Estimate by how much offsets and angles differ from those of a baseline (linear mixed model; Laird and Ware 1982).

    A change of each elevation is believed to be as large as the document says that the elevation may be off.

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine.
        later: Model of the later run.
        variation: How the machine varies from run to run.

    Returns:
        The changes, named as alignment is; none of a train whose coefficients do not follow from films.

    Raises:
        ValueError: There is no baseline, or it is of another machine.
    """
    if not baseline or any(one.coordinates != later.coordinates for one in baseline):
        raise ValueError("changes need a baseline of at least one run of the same machine")
    coordinates = later.coordinates_at(np.ones(1))
    moving = [place for place, name in enumerate(coordinates.names) if describe(name).quantity.startswith("elevation")]
    if placed_films(coordinates) is None or not moving:
        return ()
    varying = _varying(coordinates, later, variation)
    before = [_seen_through(*_likelihood(one, coordinates), varying) for one in baseline]
    own, pull = _seen_through(*_likelihood(later, coordinates), varying)
    size, believed = coordinates.size, coordinates.spread[moving]
    information = np.zeros((size + len(moving), size + len(moving)))
    information[:size, :size] = sum((one for one, _ in before), own) + coordinates.prior.precision
    information[:size, size:], information[size:, :size] = own[:, moving], own[moving]
    information[size:, size:] = own[np.ix_(moving, moving)] + np.diag(believed**-2)
    vector = np.concatenate([sum((one for _, one in before), pull), pull[moving]])
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


def _likelihood(model: UpdatedModel, coordinates: Coordinates) -> tuple[Floats, Floats]:
    """Return information (n, n) and vector (n,) of what one fit's data say of the coordinates less their prior's centre."""
    covariance = model.covariance / np.outer(coordinates.unit, coordinates.unit)
    scale = np.sqrt(np.diag(covariance))
    posterior = np.linalg.inv(covariance / np.outer(scale, scale)) / np.outer(scale, scale)
    away = coordinates.theta(model.values) - coordinates.centre
    return posterior - coordinates.prior.precision, np.asarray(posterior @ away)


def _seen_through(information: Floats, vector: Floats, varying: Floats) -> tuple[Floats, Floats]:
    """Return what is left for the common coordinates when each run's own lie about them with the covariance `varying`."""
    through = np.linalg.solve(np.eye(len(vector)) + information @ varying, np.column_stack([information, vector]))
    return np.asarray((through[:, :-1] + through[:, :-1].T) / 2), np.asarray(through[:, -1], dtype=float)


def _varying(coordinates: Coordinates, model: UpdatedModel, variation: RunVariation) -> Floats:
    """Return the covariance (n, n) of the coordinates from run to run."""
    found = placed_films(coordinates)
    assert found is not None
    size = {one.name: form.discrepancy for one, form in zip(found[1].own.train.bearings, found[1].own.forms, strict=True)}
    unbalances = dict(zip(coordinates.names, model.values, strict=True))
    own = np.zeros(coordinates.size)
    oil = np.zeros(coordinates.size)
    for place, name in enumerate(coordinates.names):
        said = describe(name)
        if said.quantity in ("viscosity", "viscosity_factor"):
            oil[place], own[place] = variation.oil, variation.viscosity
        elif said.quantity.startswith("elevation"):
            own[place] = variation.elevation / coordinates.unit[place]
        elif said.quantity == "unbalance":
            parts = [unbalances[f"{said.whole}.{part}"] for part in ("real", "imaginary")]
            own[place] = variation.unbalance * float(np.hypot(*parts)) / coordinates.unit[place]
        elif said.term is not None:
            own[place] = _of_order(said.term.order, variation)
        elif DEVIATION in said.quantity:
            own[place] = _of_deviation(said, size, variation)
    return np.diag(own**2) + np.outer(oil, oil)


def _of_deviation(said: ParameterDescription, size: dict[str, float], variation: RunVariation) -> float:
    """Return the variation of one of a film's deviations, whose unit is its part of what the document allows for; those that
    all films share stay."""
    term = said.quantity.partition(DEVIATION)[0]
    if term in LEVELS:
        return 0.0
    return _of_order(TERMS[term].order, variation) / (size[said.element_id] * float(np.sqrt(1.0 - SHARED)))


def _of_order(order: int, variation: RunVariation) -> float:
    return (variation.stiffness, variation.damping)[order] if order < 2 else 0.0
