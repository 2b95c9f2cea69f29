"""The band of a baseline holds the next run as often as it says."""

import math

import numpy as np
import pytest

from estimator.trends.baseline_band import baseline_band, magnitude_band
from estimator.trends.between_run_scatter import PRIOR_WEIGHT, STIFFNESS_SCATTER


def test_of_equal_estimates_it_is_the_usual_scatter() -> None:
    band = baseline_band("bearing.B1.kxx", np.full(5, 2e6), np.full(5, 1e-9))
    assert band.centre == pytest.approx(2e6)
    assert math.log(band.upper / band.centre) == pytest.approx(math.log(band.centre / band.lower))
    # 1 % from run to run, ten degrees of freedom of it and four of none: t(14) is 2.145.
    assert math.log(band.upper / band.centre) == pytest.approx(2.1448 * 0.01 * math.sqrt(10 / 14 * 1.2), rel=1e-3)


@pytest.mark.parametrize("runs", [3, 5, 30])
def test_it_holds_nineteen_runs_in_twenty_of_machines_as_they_are_expected(runs: int) -> None:
    """The scatter of each machine is drawn from what is believed of it before any run is seen."""
    rng = np.random.default_rng(8)
    inside = 0
    for _ in range(2000):
        scatter = STIFFNESS_SCATTER * math.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT))
        values = 5e6 * np.exp(scatter * rng.standard_normal(runs + 1))
        band = baseline_band("coupling.C1.kxx", values[:-1], 1e-4 * values[:-1])
        inside += band.lower <= values[-1] <= band.upper
    assert inside / 2000 == pytest.approx(0.95, abs=0.015)


def test_of_an_unbalance_it_is_one_of_the_magnitude() -> None:
    rng = np.random.default_rng(9)
    true = 1e-3 * np.exp(0.7j)
    inside = 0
    for _ in range(1000):
        runs = true + 3e-5 * (rng.standard_normal(21) + 1j * rng.standard_normal(21))
        band = magnitude_band("disc.D1.unbalance", runs[:20], np.full(20, 1e-6 * (1 + 1j)))
        inside += band.lower <= abs(runs[20]) <= band.upper
    assert inside / 1000 == pytest.approx(0.95, abs=0.025)
    assert magnitude_band("disc.D1.unbalance", np.zeros(5, complex), np.full(5, 1e-6 * (1 + 1j))).lower == 0.0


def test_a_quantity_that_may_change_its_sign_has_a_band_of_values() -> None:
    band = baseline_band("bearing.B1.kxy", np.array([-1e4, 1e4, 0.0]), np.full(3, 1e3))
    assert band.lower < 0.0 < band.upper
    with pytest.raises(ValueError, match="at least one"):
        baseline_band("bearing.B1.kxy", np.array([]), np.array([]))
