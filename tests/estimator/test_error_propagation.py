"""Error propagation against Monte Carlo, closed-form distributions and the analytic slopes of the response."""

import math

import numpy as np
import pytest
import scipy.stats
from models import draws, model_of
from trains import chapter_3, noisy, ross

from estimator.condensation import condense
from estimator.error_propagation import (
    by_coordinate,
    phasor_band,
    principal_axes,
    propagated,
    shifted,
    standard_errors,
)
from estimator.identification import identify
from estimator.measurement import Measurement
from estimator.modes import natural_frequencies
from estimator.response import response
from estimator.sensitivity import sensitivity
from estimator.updated_model import NotDetermined, UpdatedModel, updated_model

SPEED, CLEAN = (one[1::2] for one in ross())
ISOTROPIC = np.array([[[1.0, 1j]]])
"""Derivatives of one phasor by two independent parts."""


def band_of(amplitude: float, sigma: float) -> tuple[float, float]:
    one = phasor_band(np.array([[amplitude + 0j]]), ISOTROPIC, sigma**2 * np.eye(2))
    return float(one.lower[0, 0]), float(one.upper[0, 0])


def test_well_known_amplitude_has_the_normal_interval() -> None:
    lower, upper = band_of(100.0, 1.0)
    assert lower == pytest.approx(100 - 1.959964, abs=1e-6)
    assert upper == pytest.approx(100 + 1.96, abs=0.03)


def test_amplitude_of_nothing_but_error_has_rayleighs_quantile() -> None:
    lower, upper = band_of(0.0, 2.0)
    assert lower == 0.0
    assert upper == pytest.approx(scipy.stats.rayleigh.ppf(0.975, scale=2.0), rel=1e-9)


@pytest.mark.parametrize("amplitude", [0.5, 1.0, 2.0, 4.0])
def test_upper_bound_between_is_rices_quantile(amplitude: float) -> None:
    """Patnaik's approximation: 1 % of the amplitude."""
    _, upper = band_of(amplitude, 1.0)
    assert upper == pytest.approx(scipy.stats.rice.ppf(0.975, amplitude), rel=0.01)


def test_nothing_uncertain_has_no_width() -> None:
    lower, upper = band_of(3.0, 0.0)
    assert (lower, upper) == (3.0, 3.0)
    assert band_of(0.0, 0.0) == (0.0, 0.0)


def test_covariance_of_a_phasor_is_that_of_its_parts() -> None:
    slope = np.array([[1.0 + 2j, -0.5j, 3.0]])
    covariance = np.array([[2.0, 0.3, 0.0], [0.3, 1.0, -0.2], [0.0, -0.2, 0.5]])
    parts = np.array([[1.0, 0.0, 3.0], [2.0, -0.5, 0.0]])
    found = phasor_band(np.array([1.0 + 1j]), slope, covariance)
    assert found.covariance[0] == pytest.approx(parts @ covariance @ parts.T)
    assert standard_errors(parts, covariance) == pytest.approx(np.sqrt(np.diag(parts @ covariance @ parts.T)))


def test_principal_axes_rebuild_the_covariance() -> None:
    covariance = model_of(chapter_3()).covariance
    axes = principal_axes(covariance)
    size = np.sqrt(np.diag(covariance))
    assert axes @ axes.T / np.outer(size, size) == pytest.approx(covariance / np.outer(size, size), abs=1e-12)


def test_shift_moves_direct_terms_by_a_factor_and_the_rest_by_a_sum() -> None:
    model = model_of(chapter_3())
    step = np.zeros(model.covariance.shape[0])
    count = model.coefficients.size
    step[[0, 1, count, count + 1]] = 0.1, 7.0, 1e-4, 2e-4
    moved = shifted(model, step)
    assert moved.coefficients[0] == pytest.approx(model.coefficients[0] * math.exp(0.1))
    assert moved.coefficients[1] == model.coefficients[1] + 7.0
    assert moved.coefficients[2:] == pytest.approx(model.coefficients[2:])
    assert moved.unbalances[0] == pytest.approx(model.unbalances[0] + 1e-4 + 2e-4j)
    assert moved.unbalances[1:] == pytest.approx(model.unbalances[1:])


def test_differences_agree_with_the_exact_slopes_of_the_response() -> None:
    model = model_of(chapter_3(), error=0.01)
    train = condense(model.machine, speed=np.array([100.0, 170.0]), direction=np.ones(2))

    def phasors(of: UpdatedModel) -> np.ndarray:
        found = response(train, coefficients=of.coefficients, excitations=of.unbalances).reshape(-1)
        return np.concatenate([found.real, found.imag])

    slope = sensitivity(train, coefficients=model.coefficients, excitations=model.unbalances).by_parameter
    exact = by_coordinate(model, slope).reshape(-1, slope.shape[-1])
    both = np.concatenate([exact.real, exact.imag])
    expected = both @ model.covariance @ both.T
    size = np.sqrt(np.diag(expected))
    assert propagated(phasors, model) / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=1e-4)


def test_natural_frequencies_scatter_as_propagated() -> None:
    """600 draws tell a standard deviation within 3 %; 12 % is four of those."""
    model = model_of(chapter_3(), error=0.01)

    def lowest(of: UpdatedModel) -> np.ndarray:
        return natural_frequencies(of.machine, coefficients=of.coefficients)[:6]

    drawn = [natural_frequencies(model.machine, coefficients=coefficients)[:6] for coefficients, _ in draws(model, 600)]
    found = np.sqrt(np.diag(propagated(lowest, model)))
    assert np.std(drawn, axis=0) == pytest.approx(found, rel=0.12)


def test_an_identification_becomes_a_model() -> None:
    found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=0)))
    model = updated_model(chapter_3(), found)
    assert model.coefficients[0] == found.estimates[0].value
    first = found.estimates[model.coefficients.size]
    assert model.unbalances[0] == complex(first.value or 0, first.imaginary or 0)
    assert model.covariance is found.covariance
    assert tuple(found.coordinates[: model.coefficients.size]) == tuple(one.name for one in model.unknowns.coefficients)


def test_an_open_parameter_is_named() -> None:
    slow = SPEED < 60.0
    found = identify(chapter_3(), Measurement.of(speed=SPEED[slow], phasor=noisy(CLEAN, seed=0)[slow]))
    names = [one.name for one in found.estimates if one.value is None]
    assert names, "so narrow a range leaves the coupling's coefficients open"
    with pytest.raises(NotDetermined, match=names[0].replace(".", r"\.")):
        updated_model(chapter_3(), found)


def test_wrong_shapes_are_refused() -> None:
    model = model_of(chapter_3())
    with pytest.raises(ValueError, match="coefficients has shape"):
        UpdatedModel(model.machine, model.coefficients[1:], model.unbalances, model.covariance)
