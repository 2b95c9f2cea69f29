"""Sizes that are expected to be alike: one where their differences are chance, each its own where they are not."""

import numpy as np

from estimator.calibration.like_sizes import shrunk_sizes


def test_sizes_that_differ_by_chance_become_one() -> None:
    rng = np.random.default_rng(0)
    freedom = np.full(12, 2.0)
    squares = rng.gamma(freedom)
    alone, together = np.sqrt(squares / freedom), shrunk_sizes(squares, freedom)
    assert np.std(np.log(alone)) > 0.3
    assert np.std(np.log(together)) < 0.1


def test_sizes_that_differ_and_are_well_known_stay_what_they_are() -> None:
    freedom, true = np.full(8, 200.0), np.tile([0.1, 1.0], 4)
    squares = true**2 * np.random.default_rng(1).gamma(freedom)
    assert np.allclose(shrunk_sizes(squares, freedom), true, rtol=0.15)


def test_a_size_of_which_nothing_is_seen_is_the_common_one() -> None:
    found = shrunk_sizes(np.array([8.0, 9.0, 10.0, 0.0]), np.array([2.0, 2.0, 2.0, 0.0]))
    assert np.isclose(found[3] ** 2, 27.2 / 6.2)


def test_without_any_data_the_stated_size_holds() -> None:
    assert np.allclose(shrunk_sizes(np.zeros(4), np.zeros(4)), 1.0)


def test_sizes_that_are_barely_shown_do_not_decide_how_far_all_differ() -> None:
    rng = np.random.default_rng(2)
    alone, beside = [], []
    for _ in range(100):
        true = np.exp(0.6 * rng.normal(size=13))
        freedom = np.r_[np.full(10, 6.0), np.full(3, 0.25)]
        squares = true**2 * rng.gamma(freedom)
        alone.append(shrunk_sizes(squares[:10], freedom[:10]) / true[:10])
        beside.append(shrunk_sizes(squares, freedom)[:10] / true[:10])
    assert np.std(np.log(beside)) < 1.1 * np.std(np.log(alone))
