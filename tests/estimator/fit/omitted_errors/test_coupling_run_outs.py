"""Fits with the run-outs of couplings: one that was given up explains nothing, and few samples alone make none hopeless."""

import numpy as np
import pytest

from estimator.fit.coarse_fit import coarse_misfit
from estimator.fit.omitted_errors import coupling_run_outs
from estimator.fit.omitted_errors.coupling_run_outs import fit_with_run_outs
from estimator.fit.optimisation.maximum_likelihood import HOPELESS_MISFIT, fit
from estimator.fit.optimisation.multistart import chosen_start
from estimator.fit.problem_setup import fit_problem
from estimator.machine.document import parse_machine
from tests.estimator.diagnosis import watched_machine as plant
from tests.estimator.diagnosis.test_rotating_coupling import OFFSET, turning
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant


def test_a_fit_with_run_outs_that_was_given_up_explains_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    turned = plant.measured(plant.true_machine(), 200, turning(OFFSET, 0j))
    problem = fit_problem(plant.motor_pump(), turned, robust=True)
    start = problem.coordinates.centre
    assert fit_with_run_outs(problem, start, near=False) is not None
    monkeypatch.setattr(coupling_run_outs, "HOPELESS_MISFIT", 0.0)
    assert fit_with_run_outs(problem, start, near=False) is None


def test_deviations_that_a_prior_holds_do_not_make_few_samples_hopeless() -> None:
    """Fewer numbers than coordinates, most of which are deviations of films: a right model is not given up."""
    plant_ = random_plant(2, discrepancy=DiscrepancySize())
    whole = measured(plant_, seed=2)
    few = whole.pick(np.linspace(0, whole.speed.size - 1, 9).round().astype(np.intp))
    problem = fit_problem(parse_machine(film_document(plant_)), few, robust=True)
    assert 2 * np.count_nonzero(problem.used) < problem.coordinates.size
    start = chosen_start(problem, np.random.default_rng(0), first=True)
    assert fit(problem, start, passes=0).coarse_misfit < HOPELESS_MISFIT
    assert coarse_misfit(problem) < HOPELESS_MISFIT
