"""Tests what one run's data say by themselves: what was believed beforehand is taken off, widened or not."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.run_likelihood import contained_prior, run_likelihood
from tests.estimator.alignment.drawn_runs import COORDINATES, drawn_machine, fitted

FEW = 60
"""Numbers of a run that leave directions open."""


def test_a_prior_is_counted_once_however_many_runs_are_taken_together() -> None:
    """Two fits of the same data, each with the prior, are the fit of the data twice with the prior once."""
    rng = np.random.default_rng(0)
    one = fitted(drawn_machine(rng), rng, rows=FEW)
    said = run_likelihood(one)
    covariance = one.covariance / np.outer(COORDINATES.unit, COORDINATES.unit)
    prior = np.diag(COORDINATES.spread**-2)
    assert np.linalg.inv(covariance) == pytest.approx(said.information + prior, rel=1e-6, abs=1e-6)
    away = np.linalg.solve(said.information + prior, said.vector)
    assert away == pytest.approx(COORDINATES.theta(one.values) - COORDINATES.centre, rel=1e-5, abs=1e-9)


def test_a_widened_fit_has_its_prior_widened_with_it() -> None:
    rng = np.random.default_rng(1)
    one = fitted(drawn_machine(rng), rng, rows=FEW)
    plain, widened = run_likelihood(one), run_likelihood(replace(one, covariance=2.0 * one.covariance))
    size = np.sqrt(np.diag(plain.information))
    assert widened.information / np.outer(size, size) == pytest.approx(plain.information / np.outer(size, size) / 2, abs=1e-6)


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_a_fit_widened_in_one_direction_beyond_its_prior_has_its_prior_taken_off_in_the_others(factor: float) -> None:
    """Ten runs and the prior: of what it alone holds they say nothing, and the direction widened is where it was before."""
    rng = np.random.default_rng(3)
    size, seen = 40, 10
    spread = np.exp(rng.standard_normal(size))
    precision = np.diag(spread**-2)
    root = np.linalg.cholesky(precision)
    basis = np.linalg.qr(rng.standard_normal((size, size)))[0]
    known = np.where(np.arange(size) < seen, 0.01, 1.0)  # variance over the prior's
    ways = np.linalg.inv(root.T) @ basis
    covariance = factor * (ways * known @ ways.T)
    widened = covariance + 5.0 * np.outer(ways[:, 0], ways[:, 0])
    taken, pulling = contained_prior(widened, precision)
    information = np.linalg.inv(widened) - taken
    among = np.linalg.inv(precision + 10 * information)
    said = ways.T @ precision @ among @ precision @ ways  # in the prior's units
    expected = np.where(np.arange(size) < seen, 1.0 / (1.0 + 10 * (99.0 / factor)), 1.0)
    expected[0] = 1.0
    assert np.diag(said) == pytest.approx(expected, rel=1e-6)
    assert (information + pulling) @ ways[:, 0] == pytest.approx(np.zeros(size), abs=1e-6)
    assert pulling @ ways[:, 1] == pytest.approx(precision @ ways[:, 1] / factor)


def test_what_varies_from_run_to_run_is_seen_less_sharply() -> None:
    rng = np.random.default_rng(2)
    said = run_likelihood(fitted(drawn_machine(rng), rng))
    still = said.marginalised(np.zeros_like(said.information))
    assert still.information == pytest.approx(said.information, rel=1e-6, abs=1e-3)
    varying = np.diag((0.1 * COORDINATES.spread) ** 2)
    blurred = said.marginalised(varying)
    expected = np.linalg.inv(np.linalg.inv(said.information) + varying)
    assert blurred.information == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())
