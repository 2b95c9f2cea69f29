"""Charts against published run lengths and against simulation."""

import numpy as np
import pytest

from estimator.trends.control_charts import (
    change_began,
    cusum,
    cusum_run_length,
    ewma,
    ewma_run_length,
)
from tests.estimator.trends.chart_limits import cusum_limit, ewma_limit

# Upper CUSUM with reference 0.5: Hawkins, and Montgomery "Introduction to Statistical Quality Control", two-sided h = 4: 168,
# h = 5: 465; one side has twice that, 335.4 and 930.9 by Hawkins and Olwell. With a shift of 1 σ: 8.38 and 10.4.
PUBLISHED_CUSUM = [(4.0, 0.0, 335.4), (5.0, 0.0, 930.9), (4.0, 1.0, 8.38), (5.0, 1.0, 10.4), (4.0, 2.0, 3.34)]
# EWMA: Lucas and Saccucci 1990 as tabulated by Montgomery, weight and limit with a run length of 500, and with a shift of 1 σ.
PUBLISHED_EWMA = [(0.25, 2.998, 500.0, 0.0), (0.10, 2.814, 500.0, 0.0), (0.25, 2.998, 11.1, 1.0), (0.10, 2.814, 10.3, 1.0)]


@pytest.mark.parametrize(("limit", "shift", "expected"), PUBLISHED_CUSUM)
def test_run_lengths_of_the_cusum_are_those_published(limit: float, shift: float, expected: float) -> None:
    assert cusum_run_length(reference=0.5, limit=limit, shift=shift) == pytest.approx(expected, rel=0.003)


@pytest.mark.parametrize(("weight", "limit", "expected", "shift"), PUBLISHED_EWMA)
def test_run_lengths_of_the_ewma_are_those_published(weight: float, limit: float, expected: float, shift: float) -> None:
    assert ewma_run_length(weight=weight, limit=limit, shift=shift) == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize("limit", [0.1, 3.0, 8.0, 14.0])
def test_more_nodes_change_nothing(limit: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def lengths() -> list[float]:
        shifts = (-1.0, 0.0, 2.0)
        of_steps = [cusum_run_length(reference=0.5, limit=limit, shift=shift) for shift in shifts[1:]]
        return of_steps + [ewma_run_length(weight=0.2, limit=min(limit, 5.0), shift=shift) for shift in shifts]

    usual = lengths()
    monkeypatch.setattr("estimator.trends.control_charts.NODES_PER_WIDTH", 8.0)
    assert usual == pytest.approx(lengths(), rel=1e-5)


def test_limits_give_the_run_length_asked_for() -> None:
    rng = np.random.default_rng(1)
    limit = cusum_limit(reference=0.5, run_length=100.0)
    lengths = [int(np.argmax(cusum(rng.standard_normal(2000), reference=0.5) > limit)) + 1 for _ in range(1500)]
    assert np.mean(lengths) == pytest.approx(100.0, rel=0.08)
    assert ewma_run_length(weight=0.2, limit=ewma_limit(weight=0.2, run_length=370.0)) == pytest.approx(370.0, rel=1e-3)


def test_the_ewma_is_standardised_from_the_first_value_on() -> None:
    rng = np.random.default_rng(2)
    charts = np.array([ewma(rng.standard_normal(30), weight=0.2) for _ in range(4000)])
    assert np.std(charts, axis=0) == pytest.approx(np.ones(30), abs=0.05)


def test_the_cusum_says_when_a_step_began() -> None:
    deviation = np.concatenate([np.full(20, -0.5), np.full(5, 3.0)])
    assert change_began(deviation, reference=0.5) == 20
    assert change_began(np.full(5, -1.0), reference=0.5) is None
    assert change_began(np.full(5, 2.0), reference=0.5) == 0


def test_an_absurd_weight_is_said() -> None:
    with pytest.raises(ValueError, match="between 0 and 1"):
        ewma(np.zeros(3), weight=0.0)
