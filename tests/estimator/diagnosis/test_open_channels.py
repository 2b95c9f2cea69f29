"""Estimates beside errors of channels that are free: where the fit was linearised makes no difference."""

import numpy as np
import pytest
from msgspec import structs

from estimator.diagnosis.open_channels import estimate_beside
from estimator.fit.omitted_errors.open_errors import OPEN_GAIN, OPEN_RUN_OUT
from estimator.fit.validation.channel_sensitivity import ChannelEffects

NAMES = (
    "probe.P1.gain.real",
    "probe.P1.gain.imaginary",
    "probe.P2.run_out.real",
    "probe.P2.run_out.imaginary",
    "coupling.C1.rotating_offset.real",
)
AMPLITUDE = (3e-6, 5e-6)
SPREAD = np.array([OPEN_GAIN, OPEN_GAIN, OPEN_RUN_OUT * AMPLITUDE[1], OPEN_RUN_OUT * AMPLITUDE[1]])


def told(seed: int, errors: list[float] | None) -> tuple[np.ndarray, np.ndarray, ChannelEffects]:
    """Return one Gaussian likelihood of three parameters and five errors, as a fit at some errors tells it."""
    rng = np.random.default_rng(seed)
    scale = np.concatenate([np.ones(3), SPREAD, [1e-5]])
    rows = rng.standard_normal((40, 8)) / scale
    truth = scale * rng.standard_normal(8)
    information = rows.T @ rows
    own, rest = slice(3), slice(3, None)
    at = np.zeros(5) if errors is None else np.array(errors) * scale[rest]
    covariance = np.linalg.inv(information[own, own])
    bias = covariance @ information[own, rest]
    among = information[rest, rest] - information[rest, own] @ bias
    point = truth[own] - bias @ (at - truth[rest])
    score = among @ (truth[rest] - at)
    return point, covariance, ChannelEffects(NAMES, bias, among, score, (40, 40), AMPLITUDE, None if errors is None else at)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "named", [[("sensor", "probe.P1")], [("run_out", "probe.P2")], [("sensor", "probe.P1"), ("run_out", "probe.P2")]]
)
def test_free_errors_are_the_same_wherever_the_fit_was_linearised(seed: int, named: list[tuple[str, str]]) -> None:
    free = [place for place in range(4) if any(NAMES[place].startswith(element) for _, element in named)]
    at = [0.7 if place in free else 0.0 for place in range(5)]
    point, covariance, effects = told(seed, None)
    expected = estimate_beside(point, covariance, effects, named, channels=("P1", "P2"))
    point, covariance, effects = told(seed, at)
    found = estimate_beside(point, covariance, effects, named, channels=("P1", "P2"))
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-9, atol=1e-12)


def test_errors_that_are_free_widen_the_covariance() -> None:
    point, covariance, effects = told(1, None)
    _, wide = estimate_beside(point, covariance, effects, [("sensor", "probe.P1")], channels=("P1", "P2"))
    assert np.linalg.eigvalsh(wide - covariance).min() > -1e-12
    assert np.all(np.diag(wide) > np.diag(covariance))


def test_an_estimate_stays_where_no_chain_is_named() -> None:
    point, covariance, effects = told(1, None)
    assert estimate_beside(point, covariance, effects, [("wear", "bearing.B1")], channels=("P1", "P2")) == (point, covariance)


def test_estimates_with_a_gain_that_is_clearly_off_take_the_place_of_the_fits_own() -> None:
    point, covariance, effects = told(2, [0.7, 0.7, 0.0, 0.0, 0.0])
    expected = estimate_beside(point, covariance, effects, [], channels=("P1", "P2"))
    about = structs.replace(effects, point=point, covariance=covariance)
    found = estimate_beside(point + 1.0, 9.0 * covariance, about, [], channels=("P1", "P2"))
    np.testing.assert_array_equal(found[0], expected[0])
    np.testing.assert_array_equal(found[1], expected[1])


def test_an_error_along_which_alone_a_fit_was_accepted_is_free_unnamed() -> None:
    point, covariance, effects = told(2, None)
    expected = estimate_beside(point, covariance, effects, [("sensor", "probe.P1")], channels=("P1", "P2"))
    point, covariance, effects = told(2, [0.7, 0.7, 0.0, 0.0, 0.0])
    found = estimate_beside(point, covariance, effects, [], channels=("P1", "P2"))
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-9, atol=1e-12)


def test_a_named_channel_without_phasors_leaves_an_estimate_as_it_is() -> None:
    point, covariance, effects = told(2, None)
    dead = structs.replace(effects, amplitude=(AMPLITUDE[0], 0.0), at=np.zeros(5))
    found = estimate_beside(point, covariance, dead, [("run_out", "probe.P2")], channels=("P1", "P2"))
    np.testing.assert_allclose(found[0], point)
    np.testing.assert_allclose(found[1], covariance)
