"""Bayesian Cramér-Rao bound of an identification by films, from the truth and by differences: none of the fit's own work.

Standard deviations of the posterior of the problem linearised at the truth (Van Trees, Detection, Estimation, and Modulation
Theory, 1968, sec. 2.4), with the priors from which the truth is drawn: films deviate as much as those of the plants, which is
less than what documents allow for.
"""

from typing import Any

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import model_at
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, without_run_scatter
from tests.film_plant.plant import NOISE_FLOOR, NOISE_PART, Plant
from tests.film_plant.scores import film_truths

_DRAWN = DiscrepancySize()
DRAWN_DISCREPANCY = float(np.sqrt(_DRAWN.spread**2 + (_DRAWN.stiffness_mean**2 + _DRAWN.damping_mean**2) / 2))
"""Rms of the deviations that plants are drawn with, their means included [-]."""
STEP = 1e-4
"""Part of a prior's standard deviation, or of an unbalance, by which a coordinate is moved [-]."""
LARGEST_STEP = 1e-4
"""Largest such step [-]."""


def document_as_drawn(plant: Plant) -> dict[str, Any]:
    """Return the document that allows for deviations of films as large as those that plants are drawn with."""
    return without_run_scatter(film_document(plant, discrepancy=DRAWN_DISCREPANCY))


def film_bound(plant: Plant, speed: Floats) -> dict[str, float]:
    """Return the least standard deviation that an estimate can have, by name of estimates and derived quantities [SI].

    That of a positive parameter is its logarithm's times its value.
    """
    machine = parse_machine(document_as_drawn(plant))
    scale = float(max(abs(one.unbalance) for one in plant.train.discs))
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    coordinates = Coordinates.of(train, unbalance_scale=scale)
    true = _true_point(plant, coordinates)
    empty = Measurement.of(speed=speed, phasor=np.zeros((speed.size, len(machine.probes)), dtype=complex))
    problem = FitProblem(train, empty, coordinates, machine.noise, np.zeros_like(empty.usable))
    covariance = _posterior(problem, true)
    error = np.sqrt(np.diag(covariance)) * coordinates.unit
    found = {}
    for place, one in enumerate(coordinates.parameters):
        found[one.name] = float(error[place] * (one.value(true[place : place + 1])[0] if one.positive else 1.0))
    model = model_at(
        machine, coordinates.names, coordinates.point(true), covariance * np.outer(coordinates.unit, coordinates.unit)
    )
    return found | {one.name: one.error for one in film_results(model)}


def _true_point(plant: Plant, coordinates: Coordinates) -> Floats:
    """Return the coordinates (n,) of the truth; of deviations, which no number says exactly, none."""
    truth = film_truths(plant)
    theta = coordinates.centre.copy()
    for place, one in enumerate(coordinates.parameters):
        if one.name in truth:
            theta[place] = one.fitted(truth[one.name].real)
    for disc, first in zip(plant.train.discs, coordinates.excitation_place, strict=False):
        theta[first : first + 2] = np.array([disc.unbalance.real, disc.unbalance.imag]) / coordinates.unit[first]
    return theta


def _posterior(problem: FitProblem, theta: Floats) -> Floats:
    """Return the covariance (n, n) of the linearised problem."""
    coordinates, clean = problem.coordinates, problem.model(theta)
    weight = np.sqrt(2.0) / np.hypot(NOISE_PART * np.abs(clean), NOISE_FLOOR)
    rows = []
    for place, spread in enumerate(coordinates.spread):
        step = np.zeros(theta.size)
        step[place] = min(STEP * spread, LARGEST_STEP)
        slope = (problem.model(theta + step) - problem.model(theta - step)) / (2 * step[place])
        rows.append((slope * weight).reshape(-1).view(float))
    jacobian = np.stack(rows)
    return np.linalg.inv(jacobian @ jacobian.T + np.diag(coordinates.spread**-2))
