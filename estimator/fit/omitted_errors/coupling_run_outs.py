"""Fits that only the run-out of couplings explains: refused ones, done again with it, and what they say of the machine.

A run-out enters the response linearly, but moves what a fit without it finds: score and information there say little of a
large one (`channel_sensitivity`). So a refused fit is done again with the run-outs of all couplings; where that is accepted,
what the data say of the machine, of its couplings and of its channels is taken from there (Gaussian approximation of the
likelihood at its maximum; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself
stays refused: its document has no run-out.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.omitted_errors.explained_fit import ExplainedFit
from estimator.fit.omitted_errors.large_gain_errors import channel_effects_at_large_gain
from estimator.fit.optimisation.maximum_likelihood import HOPELESS_MISFIT, STAGE_MISFITS, fit
from estimator.fit.optimisation.nuisance_parameters import deviates_too_far
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.validation.channel_sensitivity import ChannelEffects, with_run_outs
from estimator.fit.validation.goodness_of_fit import judge
from estimator.machine.parameter_description import COMPONENTS, ROTATING_ERRORS, describe
from estimator.rotor.condensation import condense


def fit_with_run_outs(problem: FitProblem, start: Floats, *, near: bool) -> ExplainedFit | None:
    """Fit a refused problem again with the run-outs of its couplings (module's docstring).

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The problem.
        start: Coordinates θ (n,) to start from [-].
        near: Whether these are an earlier fit's end.

    Returns:
        What the fit says; None where it is not accepted, or there is nothing to add.
    """
    machine = problem.train.machine
    described = None if machine is None else with_run_outs(machine, keep=True)
    if described is None:
        return None
    train = condense(described, speed=problem.train.speed, direction=problem.train.direction)
    scale = float(np.max(problem.coordinates.excitation_scale[: len(train.unknowns.unbalances)], initial=0.0)) or 1.0
    coordinates = Coordinates.of(train, unbalance_scale=scale)
    whole = FitProblem(train, problem.measurement, coordinates, problem.noise, np.zeros_like(problem.outlier), problem.robust)
    own = np.array([coordinates.names.index(name) for name in problem.coordinates.names], dtype=np.intp)
    theta = coordinates.centre.copy()
    theta[own] = (problem.coordinates.point(start) - coordinates.origin[own]) / coordinates.unit[own]
    theta = best_excitations(whole, theta, whole.weight(whole.first_amplitude, STAGE_MISFITS[0]))
    hopeless = np.inf if whole.noise.estimated else HOPELESS_MISFIT
    found = fit(whole, theta, near=near, give_up_from=hopeless)
    # One given up has neither its last weights nor its outliers: its χ² says nothing.
    if not np.isfinite(found.misfit) or not judge(whole, found).accepted or deviates_too_far(whole, found):
        return None
    return _run_out_fit(whole, found, own)


def _run_out_fit(whole: FitProblem, found: FitResult, own: NDArray[np.intp]) -> ExplainedFit:
    """Return what a fit with run-outs says, these counted among the errors that a fit without them leaves out."""
    coordinates, effects = whole.coordinates, channel_effects_at_large_gain(whole, found)
    turning = np.setdiff1d(np.arange(coordinates.size), own)
    turning = np.array(sorted(turning.tolist(), key=lambda place: _rank(coordinates.names[place])), dtype=np.intp)
    point, unit = coordinates.point(found.theta), coordinates.unit
    precision = (found.information + coordinates.prior.precision) / np.outer(unit, unit)
    across = precision @ effects.bias
    among = effects.information + effects.bias.T @ across
    count = len(effects.names)
    # Everything beside the fit's own: errors of channels, then of couplings.
    beside = np.block([[among, across[turning].T], [across[turning], precision[np.ix_(turning, turning)]]])
    mixed = np.hstack([across[own], precision[np.ix_(own, turning)]])
    size = np.sqrt(np.diag(precision)[own])
    covariance = np.linalg.inv(precision[np.ix_(own, own)] / np.outer(size, size)) / np.outer(size, size)
    bias = covariance @ mixed
    at = np.concatenate([np.zeros(count), point[turning]])
    told = ChannelEffects(
        names=(*effects.names, *(coordinates.names[place] for place in turning)),
        bias=bias,
        information=beside - mixed.T @ bias,
        score=np.concatenate([effects.score, np.zeros(turning.size)]),
        phasors=effects.phasors,
        amplitude=effects.amplitude,
        at=at,
    )
    names = sorted({describe(coordinates.names[place]).element_id for place in turning})
    words = f"with the run-out of coupling {', '.join(names)}, which turns with the shaft, it would be accepted"
    refused = found.chi_square + float(at @ told.information @ at)
    freedom = judge(whole, found).degrees_of_freedom
    return ExplainedFit(point[own], (covariance + covariance.T) / 2, told, refused, freedom, found.outlier, words)


def _rank(name: str) -> tuple[str, int, int]:
    """Return the order in which errors of couplings are reported, that of `channel_effects`."""
    said = describe(name)
    return said.element, ROTATING_ERRORS.index(said.quantity), COMPONENTS.index(said.component or "real")
