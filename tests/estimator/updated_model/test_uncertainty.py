"""Error propagation against Monte Carlo, closed-form distributions and the analytic slopes of the response."""

import math

import numpy as np
import pytest
import scipy.stats
from msgspec.structs import replace

from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import natural_frequencies
from estimator.phasors.measurement import Measurement
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.model import UpdatedModel, updated_model
from estimator.updated_model.uncertainty import phasor_band, standard_errors
from tests.estimator.models import draws, model_of
from tests.estimator.trains import chapter_3, chapter_3_document, noisy, ross, truth
from tests.estimator.updated_model.propagation import principal_axes, propagated

SPEED, CLEAN = ross()
SPEED, CLEAN = SPEED[1::2], CLEAN[1::2]
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


def test_coordinates_of_a_model_are_its_parameters() -> None:
    model = model_of(chapter_3())
    coefficients, unbalances = truth(chapter_3())
    assert model.coefficients(123.0) == pytest.approx(coefficients)
    assert model.excitations == pytest.approx(unbalances)
    count = coefficients.size
    step = np.zeros(model.values.size)
    step[[0, 1, count, count + 1]] = 0.1, 7.0, 1e-4, 2e-4
    moved = replace(model, values=model.values + step)
    assert moved.coefficients(123.0)[0] == pytest.approx(coefficients[0] * math.exp(0.1))
    assert moved.coefficients(123.0)[1] == pytest.approx(coefficients[1] + 7.0)
    assert moved.coefficients(123.0)[2:] == pytest.approx(coefficients[2:])
    assert moved.excitations[0] == pytest.approx(unbalances[0] + 1e-4 + 2e-4j)
    assert moved.excitations[1:] == pytest.approx(unbalances[1:])


def test_differences_agree_with_the_exact_slopes_of_the_response() -> None:
    model = model_of(chapter_3(), error=0.01)
    speed = np.array([100.0, 170.0])

    def phasors(of: UpdatedModel) -> np.ndarray:
        found = forced_response(of, speed=speed).phasor.reshape(-1)
        return np.concatenate([found.real, found.imag])

    exact = forced_response(model, speed=speed).slope.reshape(-1, model.values.size)
    both = np.concatenate([exact.real, exact.imag])
    expected = both @ model.covariance @ both.T
    size = np.sqrt(np.diag(expected))
    assert propagated(phasors, model) / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=1e-4)


def test_natural_frequencies_scatter_as_propagated() -> None:
    """600 draws tell a standard deviation within 3 %; 12 % is four of those."""
    model = model_of(chapter_3(), error=0.01)

    def lowest(of: UpdatedModel) -> np.ndarray:
        return natural_frequencies(of.machine, coefficients=of.coefficients(0.0))[:6]

    drawn = [natural_frequencies(model.machine, coefficients=coefficients)[:6] for coefficients, _ in draws(model, 600)]
    found = np.sqrt(np.diag(propagated(lowest, model)))
    assert np.std(drawn, axis=0) == pytest.approx(found, rel=0.12)


def test_an_identification_becomes_a_model() -> None:
    found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=0)))
    model = updated_model(chapter_3(), found)
    coefficients = model.coefficients(100.0)
    assert coefficients == pytest.approx([one.value for one in found.estimates[: coefficients.size]])
    first = found.estimates[coefficients.size]
    assert model.excitations[0] == pytest.approx(complex(first.value or 0, first.imaginary or 0))
    assert model.covariance == pytest.approx(found.covariance)
    assert model.coordinates == found.coordinates


def test_a_model_computes_with_what_is_not_estimable() -> None:
    """A narrow range leaves the coupling's coefficients open, but not what the train did where it was measured."""
    slow = SPEED < 60.0
    found = identify(chapter_3(), Measurement.of(speed=SPEED[slow], phasor=noisy(CLEAN, seed=0)[slow]))
    assert any(one.value is None for one in found.estimates)
    model = updated_model(chapter_3(), found)
    assert np.all(np.isfinite(model.coefficients(0.0)))
    band = forced_response(model, speed=SPEED[slow]).band(model)
    inside = (np.abs(CLEAN[slow]) >= band.lower) & (np.abs(CLEAN[slow]) <= band.upper)
    assert inside.mean() > 0.8
    assert np.median((band.upper - band.amplitude) / band.amplitude) < 0.02
    far = forced_response(model, speed=np.array([250.0])).band(model)
    assert np.median(far.upper / far.amplitude) > 1.5, "far outside nothing is known"


def test_an_identification_of_another_machine_is_refused() -> None:
    found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=0)))
    document = chapter_3_document()
    document["bearings"][0]["id"] = "B0"
    with pytest.raises(ValueError, match=r"it lacks bearing\.B0\.kxx"):
        updated_model(parse_machine(document), found)


def test_wrong_shapes_are_refused() -> None:
    model = model_of(chapter_3())
    with pytest.raises(ValueError, match="50 values and a covariance"):
        replace(model, values=model.values[1:])
    with pytest.raises(ValueError, match=r"other coordinates: bearing\.B1\.kxx"):
        replace(model, coordinates=model.coordinates[1:])
