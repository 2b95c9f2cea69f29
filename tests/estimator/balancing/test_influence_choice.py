"""Influence coefficients from trials, from a model or from both: what predicts held-out runs best is taken and told."""

import numpy as np
import pytest

from estimator.balancing.influence_choice import choose_influence, fit_influence
from estimator.balancing.trial_runs import TrialRuns, TrialsUnusable
from tests.estimator.balancing.test_measured_influence import CLASSICAL, INFLUENCE, seen

MANY = np.concatenate([CLASSICAL, -CLASSICAL[1:], 1j * CLASSICAL[1:], 0.5 * CLASSICAL[1:]])
RNG = np.random.default_rng(5)
DEVIATION = 1.0 + 0.1 * (RNG.standard_normal(INFLUENCE.shape) + 1j * RNG.standard_normal(INFLUENCE.shape))
WRONG = RNG.standard_normal(INFLUENCE.shape) + 1j * RNG.standard_normal(INFLUENCE.shape)


def few(error: float = 0.6) -> TrialRuns:
    return seen(MANY, error=error, seed=3)


def test_an_exact_model_is_taken_where_the_trials_are_noisy() -> None:
    found = choose_influence(few(), model=INFLUENCE)
    assert found.method == "model"
    assert found.influence.influence == pytest.approx(INFLUENCE)
    assert found.words.startswith("model taken, which predicts best: model ")
    assert "influence coefficients" in found.words


def test_a_model_seen_through_wrong_gains_is_scaled() -> None:
    gain = np.array([[0.4], [2.0], [1.0], [-1.0], [1j], [0.5]], dtype=complex)
    found = choose_influence(few(), model=np.asarray(INFLUENCE * gain, dtype=complex))
    assert found.method in ("scaled model", "corrected model")
    errors = {one.method: one.error for one in found.compared}
    assert (errors["model"] or 0.0) > 2 * (errors["scaled model"] or 1e9)


def test_trials_alone_are_taken_where_the_model_is_wrong() -> None:
    found = choose_influence(few(0.05), model=WRONG)
    assert found.method == "influence coefficients"
    assert found.influence.influence == pytest.approx(INFLUENCE, abs=0.15)


def test_a_model_that_is_nearly_right_is_corrected_to_less_error_than_either() -> None:
    """Mean over 30 sets of trials."""
    missed = dict.fromkeys(("influence coefficients", "model", "corrected model"), 0.0)
    for seed in range(30):
        runs = seen(np.concatenate([CLASSICAL, -CLASSICAL[1:]]), error=0.3, seed=seed)
        for name in missed:
            found = fit_influence(runs, INFLUENCE * DEVIATION, name)  # type: ignore[arg-type]
            missed[name] += float(np.mean(np.abs(found.influence - INFLUENCE) ** 2))
    assert missed["corrected model"] < 0.9 * missed["influence coefficients"]
    assert missed["corrected model"] < 1.1 * missed["model"]


def test_trials_that_cannot_be_left_out_are_taken_as_they_are() -> None:
    found = choose_influence(seen(CLASSICAL, error=0.1), model=INFLUENCE)
    assert found.method == "influence coefficients"
    assert "no run can be left out to compare them with the model" in found.words
    assert next(one for one in found.compared if one.method == "influence coefficients").error is None
    with pytest.raises(TrialsUnusable, match="needs a model"):
        choose_influence(seen(CLASSICAL, error=0.1), method="corrected model")
