"""Observations and baseline of a train on oil films, in physical coordinates: clearances, viscosities, elevations, couplings.

Each fit contains what the document believes of the films. Runs that are taken together must count it once, so that it is
taken off each and stands in the baseline alone (`run_likelihood`). Viscosities count from those of each run's own
temperature, where that is measured.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from estimator.alignment.compliant_couplings import CompliantCouplings, compliant_couplings
from estimator.alignment.film_loads import FilmLoads
from estimator.alignment.healthy_films import coordinate_scales, machine_spread
from estimator.alignment.open_stiffness import OPEN
from estimator.alignment.run_likelihood import contained_prior
from estimator.arrays import Floats
from estimator.diagnosis.baseline_reference import UNKNOWN_PRECISION, Reference, channel_precision, through_variation
from estimator.diagnosis.healthy_variation import SCALE_FACTOR, channel_variation, slow_variation, typical_amplitude
from estimator.diagnosis.hypotheses import hypotheses
from estimator.diagnosis.observation import Observation, ObservedFit, fit_observation, inverse, names_in_common
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.parameter_description import SCALE_FACTORS, describe
from estimator.machine.under_conditions import under_conditions
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.identity_cache import cached_for_runs
from estimator.rotor.parameters import unknowns
from estimator.symmetric_eigen import symmetric_eigen
from estimator.updated_model.model import UpdatedModel, expected_model, model_at

STILL = 1e-3
"""Run-to-run standard deviation of a quantity that does not vary, such as a clearance, relative to its prior's [-]."""
LEAST = 1e-9
"""Least run-to-run standard deviation of anything, such as an unbalance of zero [kg m]."""


def is_of_films(fit: ObservedFit, machine: Machine) -> bool:
    """Check whether a fit has all coordinates of a train on oil films: one by an older release may lack some.

    Args:
        fit: The fit.
        machine: The machine.

    Returns:
        Whether it has.
    """
    return set(_coordinates(machine).names) <= set(fit.coordinates)


@cached_for_runs
def film_observation(fit: ObservedFit, machine: Machine, conditions: Mapping[str, float | None]) -> Observation:
    """Return the observation of a run of a train on oil films (derived here: a posterior over its prior).

    Args:
        fit: The run's fit.
        machine: The machine as its document describes it.
        conditions: Operating conditions of the run [unit of the document].

    Returns:
        The observation, without what the document believes of the films.
    """
    said = fit_observation(fit, machine.channels)
    nominal = _coordinates(machine)
    own = _coordinates(under_conditions(machine, conditions))
    known = np.array([said.names.index(name) for name in own.names])
    among = np.ix_(known, known)
    precision, pulling = contained_prior(fit.covariance[among], own.prior.precision / np.outer(own.unit, own.unit))
    theta = own.theta(said.reference[known])
    reference, gradient, information = said.reference.copy(), said.gradient.copy(), said.information.copy()
    gradient[known] += pulling @ (own.unit * (theta - own.centre))
    information[among] -= precision
    believed = np.zeros(len(said.names))
    believed[known] = np.diag(precision)
    # From what the run's conditions made of the document to what the document states: forces are scaled.
    slope = np.ones(len(said.names))
    slope[known] = _scaling(own, nominal)
    reference[known] = nominal.origin + slope[known] * (said.reference[known] - own.origin)
    gradient /= slope
    information /= np.outer(slope, slope)
    believed /= slope**2

    @cache
    def model() -> UpdatedModel:
        return model_at(under_conditions(machine, conditions), fit.coordinates, fit.point, fit.covariance)

    return replace(
        said,
        reference=reference,
        gradient=gradient,
        information=information,
        believed=believed,
        loads=FilmLoads.of(model),
        model=model,
    )


def _scaling(own: Coordinates, nominal: Coordinates) -> Floats:
    """Return by how much each coordinate's physical value (n,) changes in the document's machine for that in the run's [-]."""
    forces = np.array([describe(name).element_kind == "static_load" for name in own.names])
    reversed_ = forces & (own.point(own.centre) * nominal.point(nominal.centre) < 0.0)
    return np.where(reversed_, -1.0, 1.0) * nominal.unit / own.unit


def film_reference(machine: Machine, baseline: Sequence[Observation], variation: HealthyVariation) -> Reference:
    """Build the baseline of a train on oil films.

    Source: own derivation: runs' likelihoods less their priors, and one prior, are added up (docs/method-diagnosis.md).

    Args:
        machine: The machine.
        baseline: Observations of the healthy machine, as `film_observation` returns them.
        variation: How it varies while it is healthy.

    Returns:
        The baseline.

    Raises:
        ValueError: There are no observations, or they are of different quantities.
    """
    names = names_in_common(baseline)
    couplings, left_open = _open_couplings(baseline)
    carried = partial(_by_compliance, couplings)
    baseline = [carried(one) for one in baseline]
    origin = np.median([one.reference for one in baseline], axis=0)
    coordinates = _coordinates(machine)
    known = np.array([names.index(name) for name in coordinates.names])
    scales = coordinate_scales(coordinates, origin[known])
    unit = np.array([channel_variation(name, baseline) for name in names])
    unit[known] = coordinates.unit * np.maximum(scales.own(variation), _still(coordinates))
    oil = np.zeros((len(names), 1))
    oil[known, 0] = variation.oil * scales.oil * coordinates.unit / unit[known]
    centre, error = _mean(baseline, coordinates, known, origin, unit, oil)
    unknown = unknowns(machine, assemble_rotor(machine))
    season = np.zeros((len(names), len(names)))
    season[np.ix_(known, known)] = scales.over_seasons(variation) * np.outer(coordinates.unit, coordinates.unit)
    season = (season + slow_variation(unknown, names, origin)) / np.outer(unit, unit)
    amplitude = {probe.id: typical_amplitude(probe.id, baseline) for probe in machine.probes}
    found = hypotheses(machine, unknown, names, typical=origin, amplitude=amplitude)
    doubt = error + season
    doubt = (doubt + doubt.T) / 2
    return Reference(names, origin, unit, centre, doubt, found, oil, _columns(doubt), carried, left_open)


def _open_couplings(baseline: Sequence[Observation]) -> tuple[CompliantCouplings, dict[str, float]]:
    """Return the couplings whose stiffness a baseline's runs usually leave open by a large factor, and its errors [-]."""
    names = baseline[0].names
    found = compliant_couplings(names, np.ones(len(names)), np.array([one.reference for one in baseline]))
    variance = np.median([_variances(one.fitted) for one in baseline], axis=0)
    kept = np.array([variance[place] > OPEN**2 for place in found.places], dtype=bool)
    places = tuple(place for place, one in zip(found.places, kept, strict=True) if one)
    errors = {names[place]: float(np.sqrt(variance[place])) for place in places}
    return CompliantCouplings(places, found.unit[kept], found.usual[kept]), errors


def _variances(information: Floats) -> Floats:
    """Return the variances (N,) that an information (N, N) leaves; infinite of what it says nothing of: a dead channel."""
    told = np.diag(information) > 0.0
    found = np.full(len(information), np.inf)
    found[told] = np.diag(inverse(information[np.ix_(told, told)]))
    return found


def _by_compliance(couplings: CompliantCouplings, one: Observation) -> Observation:
    """Return an observation with compliances in place of stiffnesses that lie far off (change of variables)."""
    at, slope = couplings.carried(one.reference)
    return replace(
        one,
        reference=at,
        gradient=slope * one.gradient,
        information=one.information * np.outer(slope, slope),
        believed=None if one.believed is None else one.believed * slope**2,
    )


def _mean(
    baseline: Sequence[Observation], coordinates: Coordinates, known: Floats, origin: Floats, unit: Floats, oil: Floats
) -> tuple[Floats, Floats]:
    """Return the baseline's mean (N,) and its covariance (N, N), in units of the run-to-run variation [-]."""
    believed = np.array([channel_precision(name, baseline) for name in baseline[0].names]) * unit**2
    believed[known] += (unit[known] / (machine_spread(coordinates) * coordinates.unit)) ** 2
    precision = np.diag(np.where(believed > 0.0, believed, UNKNOWN_PRECISION))
    pull = np.zeros(len(unit))
    pull[known] = believed[known] * (coordinates.point(coordinates.centre) - origin[known]) / unit[known]
    for one in baseline:
        seen, drawn = through_variation(one, origin, unit, oil)
        precision += seen
        pull += drawn
    error = np.linalg.inv(precision)
    return np.asarray(error @ pull), np.asarray(error)


def _coordinates(machine: Machine) -> Coordinates:
    return expected_model(machine).coordinates_at(np.ones(1))


def _still(coordinates: Coordinates) -> Floats:
    """Return the least run-to-run standard deviation of each coordinate (n,) [-]."""
    steel = [describe(name).quantity in SCALE_FACTORS for name in coordinates.names]
    unknown = coordinates.spread > 1.0  # of an unbalance nothing is believed
    return np.where(steel, SCALE_FACTOR, np.where(unknown, LEAST, STILL * coordinates.spread))


def _columns(covariance: Floats) -> Floats:
    """Return the columns (N, s) whose products a covariance is."""
    size, directions = symmetric_eigen(covariance)
    kept = size > 1e-12 * max(float(size[-1]), 1e-300)
    return np.asarray(directions[:, kept] * np.sqrt(size[kept]))
