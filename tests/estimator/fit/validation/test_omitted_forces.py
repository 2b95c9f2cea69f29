"""Forces that a document calls exact: limits by how many are looked at, all doubtful ones widen, likeness counts."""

from collections.abc import Iterator

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem_setup import fit_problem
from estimator.fit.validation import omitted_forces
from estimator.fit.validation.omitted_forces import DOUBTFUL_CHANCE, REFUSED_CHANCE, judge_exact_forces, largest_score
from estimator.fit.validation.omitted_parameter import OmittedParameter
from estimator.machine.document import parse_machine
from estimator.statics.film_model import FilmModel
from tests.estimator.statics.test_process_forces import FORCE_Y, with_force
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant


@pytest.fixture(scope="module")
def ended() -> tuple[FitProblem, FitResult, Floats]:
    """The end of a fit with half a disc's weight stated wrongly, and its covariance."""
    plant = random_plant(2, discrepancy=DiscrepancySize())
    lifted = 0.5 * plant.train.gravity * plant.train.discs[0].mass
    problem = fit_problem(
        parse_machine(with_force(film_document(plant), force_y=lifted)), measured(plant, seed=2), robust=True
    )
    centre = problem.coordinates.centre
    found = fit(problem, best_excitations(problem, centre, problem.weight(problem.first_amplitude, 0.5)))
    information = found.information + problem.coordinates.prior.precision
    return problem, found, np.asarray(np.linalg.inv(information), dtype=float)


def test_limits_are_those_of_one_component_and_rise_with_their_number() -> None:
    assert largest_score(REFUSED_CHANCE, 1) == pytest.approx(2.576, abs=1e-3)
    assert largest_score(DOUBTFUL_CHANCE, 1) == pytest.approx(1.645, abs=1e-3)
    scores = np.abs(np.random.default_rng(0).standard_normal((200_000, 6))).max(axis=1)
    assert np.mean(scores > largest_score(REFUSED_CHANCE, 6)) == pytest.approx(REFUSED_CHANCE, rel=0.1)


def test_every_doubtful_component_widens_and_two_are_not_judged_as_one(
    ended: tuple[FitProblem, FitResult, Floats], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, found, covariance = ended
    ways = np.eye(found.theta.size)[:2]

    def changes() -> Iterator[OmittedParameter]:
        yield from (OmittedParameter(2.7, 1.0, ways[0]), OmittedParameter(-2.2, 1.0, ways[1]))

    asked = changes()
    monkeypatch.setattr(omitted_forces, "omitted_parameter", lambda *_, **__: next(asked))
    verdict = judge_exact_forces(problem, found, covariance)
    assert not verdict.words
    assert "force_x" in verdict.remark
    assert "force_y" in verdict.remark
    grown = np.diag(verdict.covariance - covariance)
    assert np.all(grown[:2] > 1.0)
    assert grown[2:] == pytest.approx(0.0)
    assert [one.name for one in verdict.forces] == ["static_load.gear.force_x", FORCE_Y]
    assert [one.size**2 for one in verdict.forces] == pytest.approx(grown[:2])


def test_a_force_that_the_films_hardly_see_is_said_to_be_what_loads_rest_on(
    ended: tuple[FitProblem, FitResult, Floats], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, found, covariance = ended
    way = np.eye(found.theta.size)[0]
    model = problem.coordinates.models[0].model
    assert isinstance(model, FilmModel)
    stated = next(value for name, value, _ in model.own.exact_forces if name == FORCE_Y)

    def remark(along_y: OmittedParameter | None) -> str:
        asked = iter((OmittedParameter(0.0, 1.0, way), along_y))
        monkeypatch.setattr(omitted_forces, "omitted_parameter", lambda *_, **__: next(asked))
        verdict = judge_exact_forces(problem, found, covariance)
        assert not verdict.words
        assert verdict.covariance is covariance
        assert not verdict.remark
        return verdict.resting

    assert remark(OmittedParameter(0.1 * stated, 0.5 * stated, way)) == (
        f"; loads of bearings rest on {FORCE_Y} being {stated:.3g} N: the films would not show an error of "
        f"{largest_score(DOUBTFUL_CHANCE, 2) * 0.5 * stated:.3g} N in it"
    )
    assert remark(OmittedParameter(0.01 * stated, 0.02 * stated, way)) == ""
    assert remark(None).endswith("the films would not show any error in it")


def test_a_refused_force_widens_too_and_is_less_certain_where_residuals_are_alike(
    ended: tuple[FitProblem, FitResult, Floats],
) -> None:
    problem, found, covariance = ended
    refused = judge_exact_forces(problem, found, covariance)
    assert FORCE_Y in refused.words
    assert np.linalg.eigvalsh(refused.covariance - covariance)[-1] > 1e-3
    assert not judge_exact_forces(problem, found, covariance, inflation=10.0).words
