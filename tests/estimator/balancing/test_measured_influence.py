"""Influence coefficients from trial runs: the classical formulas, repeats, gaps, and intervals that hold the truth."""

import numpy as np
import pytest

from estimator.arrays import Complexes, Floats
from estimator.balancing.equivalent_unbalance import equivalent_unbalance
from estimator.balancing.influence_correction import correct
from estimator.balancing.measured_influence import measure_influence
from estimator.balancing.trial_runs import TrialRuns, TrialsUnusable, total_weights
from tests.estimator.balancing.printed_cases import trial_runs

RNG = np.random.default_rng(11)
INFLUENCE: Complexes = np.asarray(RNG.standard_normal((6, 2)) + 1j * RNG.standard_normal((6, 2)))
OFFSET = 3.0 * (RNG.standard_normal(6) + 1j * RNG.standard_normal(6))
CLASSICAL = np.array([[0.0, 0.0], [1.5, 0.0], [0.0, -1.0j]])


def normal(rng: np.random.Generator, *shape: int) -> Complexes:
    """Complex errors with an rms of 1."""
    return np.asarray((rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2))


def seen(added: Complexes, *, error: float = 0.0, seed: int = 0, mounting: float = 0.0) -> TrialRuns:
    """Runs with errors of each vector, and with unbalances that move from mounting to mounting."""
    rng = np.random.default_rng(seed)
    moved = added + mounting * normal(rng, *added.shape)
    vector = OFFSET + moved @ INFLUENCE.T + error * normal(rng, len(added), OFFSET.size)
    return trial_runs(vector, added, error or np.nan)


def test_two_trials_give_the_classical_coefficients() -> None:
    runs = seen(CLASSICAL)
    found = measure_influence(runs)
    assert found.influence[:, 0] == pytest.approx((runs.vector[1] - runs.vector[0]) / 1.5)
    assert found.influence == pytest.approx(INFLUENCE)
    assert found.offset == pytest.approx(OFFSET)


def test_weights_that_stay_on_are_counted_in_the_later_trials() -> None:
    weights = np.array([[1.5, 0.0], [0.0, -1.0j]])
    on = total_weights(weights, [True, False])
    assert on == pytest.approx(np.array([[1.5, 0.0], [1.5, -1.0j]]))
    found = measure_influence(seen(np.concatenate([np.zeros((1, 2)), on])))
    assert found.influence == pytest.approx(INFLUENCE)


def test_a_point_that_one_run_does_not_show_is_found_from_the_others() -> None:
    runs = seen(np.concatenate([CLASSICAL, 2 * CLASSICAL[1:]]))
    runs.vector[3, 2] = np.nan
    runs.vector[1:4, 4] = np.nan  # the initial state and the last trial say nothing of the first plane
    kept, left_out = runs.determined()
    assert left_out == ("V5",)
    assert measure_influence(kept).influence == pytest.approx(INFLUENCE[[0, 1, 2, 3, 5]])


@pytest.mark.parametrize("mounting", [0.0, 0.1], ids=["errors of vectors", "mounting"])
def test_intervals_hold_what_the_next_run_shows(mounting: float) -> None:
    """600 calibrations, whether each vector errs by itself or the rotor settles anew.

    Somewhat more than 95 % where the vectors' own errors are known: the larger of these and of the scatter counts.
    """
    added = np.concatenate([CLASSICAL, -CLASSICAL[1:], 1j * CLASSICAL[1:], np.zeros((1, 2))])
    put_on = np.array([0.8, 0.6j])
    inside, promised, truly = [], [], []
    for seed in range(600):
        found = measure_influence(seen(added, error=0.05, seed=seed, mounting=mounting))
        band = found.predicted(put_on)
        rng = np.random.default_rng(10_000 + seed)
        moved = put_on + mounting * normal(rng, 2)
        next_run = np.abs(OFFSET + INFLUENCE @ moved + 0.05 * normal(rng, 6))
        inside.append((next_run >= band.lower) & (next_run <= band.upper))
        another = OFFSET + INFLUENCE @ moved + 0.05 * normal(rng, 6)
        weight, covariance = equivalent_unbalance(found, another, beside_offset=True)
        error = found.widening * np.sqrt(np.real(np.diag(covariance)) / 2)
        truly.append(np.abs(weight - put_on) ** 2)
        promised.append(2 * error**2)
    assert np.mean(inside) == pytest.approx(0.96, abs=0.025)
    assert np.mean(truly, axis=0) / np.mean(promised, axis=0) == pytest.approx(np.ones(2), abs=0.45)


def test_the_error_of_a_correction_is_that_of_many_calibrations() -> None:
    corrections, errors = [], []
    for seed in range(800):
        found = correct(measure_influence(seen(CLASSICAL, error=0.05, seed=seed)))
        corrections.append(found.weight)
        errors.append(found.standard_error)
    truth = correct(measure_influence(seen(CLASSICAL))).weight
    spread = np.sqrt(np.mean(np.abs(np.array(corrections) - truth) ** 2, axis=0) / 2)
    assert np.mean(errors, axis=0) == pytest.approx(spread, rel=0.1)


def test_least_squares_weights_and_limits_are_kept() -> None:
    found = measure_influence(seen(CLASSICAL))
    weight: Floats = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    exact = correct(found, weight=weight)
    assert np.abs(exact.after.value[:2]) == pytest.approx(np.zeros(2), abs=1e-9), "two planes bring two points to rest"
    limited = correct(found, limit=np.array([0.1, np.inf]))
    assert abs(limited.weight[0]) == pytest.approx(0.1, rel=1e-6)
    with pytest.raises(ValueError, match="limit must hold 2 numbers that are not negative"):
        correct(found, limit=np.array([-1.0, 1.0]))


@pytest.mark.parametrize(
    ("added", "message"),
    [
        (CLASSICAL * np.array([1.0, 0.0]), "no trial weight was on P2"),
        (CLASSICAL[:2] + np.array([[0, 0], [0, 1]]), "2 runs with 2 different sets of trial weights cannot determine"),
        (np.array([[0, 0], [1, 2], [2, 4], [-1, -2]]), "always went together in one proportion: they tell only 1 of 2 planes"),
    ],
)
def test_trials_that_cannot_determine_the_planes_are_named(added: Complexes, message: str) -> None:
    with pytest.raises(TrialsUnusable, match=message):
        measure_influence(seen(np.asarray(added, dtype=complex), error=0.01))


def test_a_copied_run_is_named() -> None:
    runs = seen(CLASSICAL, error=0.01)
    runs.vector[2] = runs.vector[1]
    with pytest.raises(TrialsUnusable, match="run 2 and run 3 hold the same vectors: one is a copy"):
        measure_influence(runs)
