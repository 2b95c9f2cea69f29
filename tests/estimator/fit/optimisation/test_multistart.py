"""Fits that begin elsewhere, and fits that meet a place where the train cannot be condensed."""

import math
import sys

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.testing import assert_allclose

from estimator.arrays import Floats
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.fit.optimisation import maximum_likelihood, multistart
from estimator.fit.optimisation.multistart import best_fit
from estimator.fit.problem import fit_problem as fit_module
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem_setup import fit_problem
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.elimination import SingularCondensation
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from tests.estimator.trains import chapter_3
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document
from tests.film_plant.documents import measured as measured_on_films
from tests.film_plant.plants import random_plant


@pytest.fixture(scope="module")
def train() -> Machine:
    return chapter_3()


@pytest.fixture(scope="module")
def measured(train: Machine) -> Measurement:
    rng = np.random.default_rng(5)
    _, speed = speed_law(train, "run-down", duration=300.0, samples=80)
    return Measurement.of(speed=speed, phasor=measured_phasors(train, draw_truth(train, rng), speed, rng))


def test_a_fit_that_begins_at_its_end_stays_there(train: Machine, measured: Measurement) -> None:
    once = identify(train, measured)
    again = identify(train, measured, Options(starts=1), beginning=once.point)
    assert again.accepted
    assert again.iterations < once.iterations
    assert_allclose(again.point, once.point, atol=1e-4 * np.max(np.sqrt(np.diag(once.covariance))), rtol=1e-5)


def test_a_step_to_where_nothing_can_be_condensed_is_shortened(
    train: Machine, measured: Measurement, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = identify(train, measured)
    linearised, calls = fit_module.FitProblem.linearised, 0

    def sometimes_singular(self: fit_module.FitProblem, *arguments: object) -> object:
        nonlocal calls
        calls += sys._getframe(1).f_code.co_name == "descend"
        if calls in (2, 3):
            raise SingularCondensation("here")
        return linearised(self, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(fit_module.FitProblem, "linearised", sometimes_singular)
    found = identify(train, measured)
    assert calls > 3
    assert found.accepted
    assert_allclose(found.chi_square, expected.chi_square, rtol=1e-6)


def test_with_few_samples_the_best_optimum_is_reached_twice(train: Machine, measured: Measurement) -> None:
    few = measured.pick(np.arange(measured.speed.size) % 2 == 0)
    found = identify(train, few)
    assert found.accepted
    assert found.starts >= 2
    assert "reached once only" not in found.verdict
    assert identify(train, measured).starts == 1


def test_an_optimum_that_was_reached_once_is_said_to_be_open(train: Machine, measured: Measurement) -> None:
    few = measured.pick(np.arange(measured.speed.size) % 2 == 0)
    found = identify(train, few, Options(starts=1))
    assert found.accepted
    assert "the best of 1 starts was reached once only: whether there is a better one is open" in found.verdict


def test_a_fit_that_stays_unfinished_does_not_stop_the_other_starts(train: Machine, measured: Measurement) -> None:
    problem = fit_problem(train, measured, robust=True)
    judged: list[FitResult] = []

    def second(found: FitResult) -> bool:
        judged.append(found)
        return len(judged) == 2

    found = best_fit(problem, starts=3, seed=0, good=second, unfinished=lambda _: not judged)
    assert found.starts == 2
    assert found.fit is judged[1]
    assert best_fit(problem, starts=2, seed=0, good=lambda _: False, unfinished=lambda _: True).starts == 2


def test_a_beginning_that_leads_to_no_end_is_followed_by_other_starts(
    train: Machine, measured: Measurement, monkeypatch: pytest.MonkeyPatch
) -> None:
    once = identify(train, measured)
    monkeypatch.setattr(maximum_likelihood, "STAGE_ITERATIONS", (40, 40, 0))
    monkeypatch.setattr(maximum_likelihood, "STAGES", ((0.5, 40), (0.05, 40), (0.0, 0)))
    found = identify(train, measured, Options(starts=2), beginning=once.point)
    assert found.verdict.startswith("not converged")
    assert found.starts == 2


@pytest.fixture(scope="module")
def film_problem() -> FitProblem:
    plant = random_plant(1, discrepancy=DiscrepancySize())
    return fit_problem(parse_machine(film_document(plant)), measured_on_films(plant, seed=1), robust=True)


def scripted(monkeypatch: pytest.MonkeyPatch, problem: FitProblem, *coarse: float) -> None:
    """Let fits end at these coarse misfits, one after the other: infeasible at NaN, and given up where that is said."""
    ends = iter(coarse)

    def fit(_problem: FitProblem, start: Floats, *, give_up_from: float = math.inf, **_options: object) -> FitResult:
        value = next(ends)
        lost = not value < give_up_from
        return replace(at_nominal, theta=start, coarse_misfit=value, misfit=math.inf if lost else 100.0 * value)

    at_nominal = maximum_likelihood.fit(problem, problem.coordinates.centre, passes=0)
    monkeypatch.setattr(multistart, "fit", fit)


@pytest.mark.parametrize(
    ("coarse", "begins", "starts"),
    [
        ((5.0, 6.0, 1.0), False, 2),
        ((math.nan, 5.0, 1.0), False, 3),
        ((5.0, 6.0, 1.0), True, 3),
        ((5.0, 6.0, 7.0, 1.0), True, 3),
    ],
    ids=["two lead nowhere", "the first was infeasible", "the document's values after a beginning", "two after a beginning"],
)
def test_starts_on_films_end_once_two_of_the_documents_values_lead_nowhere(
    film_problem: FitProblem,
    monkeypatch: pytest.MonkeyPatch,
    coarse: tuple[float, ...],
    begins: bool,
    starts: int,
) -> None:
    scripted(monkeypatch, film_problem, *coarse)
    beginning = film_problem.coordinates.centre if begins else None
    found = best_fit(film_problem, starts=9, seed=0, good=lambda found: found.coarse_misfit < 2.0, beginning=beginning)
    assert found.starts == starts
