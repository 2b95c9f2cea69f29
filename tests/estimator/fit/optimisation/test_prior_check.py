"""Check of fitted numbers against their prior: its chances are those of numbers drawn from it."""

import numpy as np
import pytest
import scipy

from estimator.fit.optimisation.prior_check import prior_check


def fitted(information: float, *, off: float, count: int, seed: int) -> list[float]:
    """Chances of estimates of k standard-normal numbers, off by a common amount, that data of an information determine."""
    rng = np.random.default_rng(seed)
    left = np.eye(count) / (1.0 + information)
    chances = []
    for _ in range(2000):
        true = off + rng.standard_normal(count)
        seen = true + rng.standard_normal(count) / np.sqrt(information)
        chances.append(prior_check(seen * information / (1.0 + information), left).chance)
    return chances


@pytest.mark.parametrize("information", [0.5, 10.0, 1e4])
def test_chances_of_right_priors_are_uniform(information: float) -> None:
    chances = fitted(information, off=0.0, count=4, seed=1)
    assert scipy.stats.kstest(chances, "uniform").pvalue > 1e-3


def test_a_prior_that_is_off_becomes_unlikely() -> None:
    assert np.median(fitted(100.0, off=3.0, count=4, seed=2)) < 1e-5


def test_how_far_the_prior_is_off_is_what_data_alone_would_say() -> None:
    found = prior_check(np.array([1.5, -1.5]), np.eye(2) / 2.0)  # data as good as the prior: drawn half of the way back
    assert found.misplaced == pytest.approx(3.0)
    assert found.directions.shape == (2, 2)


def test_directions_that_the_data_leave_open_count_for_nothing() -> None:
    found = prior_check(np.array([9.0, 0.0]), np.diag([0.99, 0.0]))
    assert found.directions.shape == (2, 1)
    assert found.chance == pytest.approx(1.0)
    nothing = prior_check(np.ones(2), np.eye(2))
    assert (nothing.chance, nothing.misplaced) == (1.0, 0.0)
