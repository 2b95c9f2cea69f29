"""The change of a parameter that a fit takes for known does not follow from where exactly the fit has stopped."""

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import best_excitations
from estimator.fit.problem_setup import fit_problem
from estimator.fit.validation.omitted_parameter import OmittedParameter, omitted_parameter
from estimator.machine.document import parse_machine
from estimator.statics.film_curves import FilmCurves
from tests.estimator.statics.test_process_forces import with_force
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant

STOPPED = 0.1
"""Standard errors by which the fit is stopped before its end, along what makes up for the force."""


def test_a_fit_that_stops_a_part_of_a_standard_error_early_asks_for_the_same_force() -> None:
    plant = random_plant(2, discrepancy=DiscrepancySize())
    force = 0.1 * plant.train.gravity * plant.train.discs[0].mass
    problem = fit_problem(parse_machine(with_force(film_document(plant), force_y=force)), measured(plant, seed=2), robust=True)
    coordinates = problem.coordinates
    start = best_excitations(problem, coordinates.centre, problem.weight(problem.first_amplitude, 0.5))
    found = fit(problem, start)
    assert found.converged
    covariance: Floats = np.asarray(np.linalg.inv(found.information + coordinates.prior.precision), dtype=float)
    final, (placed,) = with_fitted_noise(problem, found), coordinates.models
    assert isinstance(placed.curves, FilmCurves)
    changes: list[OmittedParameter] = []
    for stopped in (0.0, STOPPED, -STOPPED):
        theta = found.theta.copy()
        if changes:
            answer = changes[0].answer
            theta += stopped * answer / np.sqrt(answer @ np.linalg.solve(covariance, answer))
        change = omitted_parameter(final, theta, covariance, placed, placed.curves.by_load(placed.own(theta))[..., 1])
        assert change is not None
        changes.append(change)
    assert [one.score for one in changes] == pytest.approx([changes[0].score] * 3, abs=0.1)
