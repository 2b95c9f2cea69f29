"""Gains that are clearly off: on oil films the estimates of an accepted fit allow for them."""

import math

import numpy as np
import pytest

from estimator.diagnosis.observation import fit_observation, observed_fit
from estimator.diagnosis.open_channels import estimate_beside, named_errors
from estimator.fit import conclusion
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.fit.omitted_errors.open_errors import beside_its_errors
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import COMPONENTS, describe
from estimator.phasors.noise import error_size
from estimator.updated_model.fitted_response import fitted_gains, fitted_response
from tests.estimator.diagnosis import watched_machine
from tests.estimator.fit.omitted_errors.test_faulty_channel import healthy, machine, plant, with_errors
from tests.film_plant.documents import film_document
from tests.film_plant.wrong_documents import diametral_clearances

CHANNEL, GAIN = 5, 1.1
WORDS = "clearly has another gain than documented: estimates allow for that"
BEARING = ("B3X", "B3Y")
LEAST_WIDTH = 0.68
"""Standard error with a gain over that of the fit without it [-]; without the widening it falls to 0.64."""


def fitted(*channels: int, gain: complex = 1.0) -> Identification:
    return identify(machine(), with_errors(*channels, gain=gain), beginning=healthy().point)


def fitted_without_gains(machine_: Machine, monkeypatch: pytest.MonkeyPatch) -> Identification:
    """Return the fit of the run whose probe is off, its estimates with the document's gains."""
    with monkeypatch.context() as context:
        context.setattr(conclusion, "estimates_with_errors", lambda *_: None)
        return identify(machine_, with_errors(CHANNEL, gain=GAIN), beginning=healthy().point)


def test_estimates_allow_for_the_gain_and_are_those_of_a_run_that_is_right(monkeypatch: pytest.MonkeyPatch) -> None:
    right, off, plain = fitted(), fitted(CHANNEL, gain=GAIN), fitted_without_gains(machine(), monkeypatch)
    error = np.sqrt(np.diag(right.covariance))
    assert off.accepted
    assert np.abs((off.point - right.point) / error).max() < 0.5 * np.abs((plain.point - right.point) / error).max()
    assert np.abs((off.point - right.point) / np.sqrt(np.diag(off.covariance) + error**2)).max() < CONFIDENCE_95
    assert off.verdict.endswith(f"; of the probes {', '.join(BEARING)} one at least {WORDS}")
    assert WORDS not in plain.verdict


def test_errors_that_a_diagnosis_has_named_are_left_open_as_it_leaves_them_open() -> None:
    small, other = 0.985, 7
    named = [("sensor", f"probe.{machine().channels[other]}")]
    plain = fitted(other, gain=small)
    run = with_errors(other, gain=small)
    off = identify(machine(), run, Options(open_errors=tuple(named_errors(named))), beginning=healthy().point)
    assert WORDS not in plain.verdict
    assert off.verdict.endswith(f"estimates leave open what a diagnosis has named: probe.{machine().channels[other]}.gain")
    beside = estimate_beside(plain.point, plain.covariance, plain.channel_effects, named, channels=machine().channels)
    for told in (
        (off.point, off.covariance),
        estimate_beside(off.point, off.covariance, off.channel_effects, [], channels=machine().channels),
        estimate_beside(off.point, off.covariance, off.channel_effects, named, channels=machine().channels),
    ):
        np.testing.assert_allclose(told[0], beside[0], rtol=1e-7, atol=1e-12)
        np.testing.assert_allclose(told[1], beside[1], rtol=1e-5, atol=1e-7 * np.diag(beside[1]).min())
    seen, before = (fit_observation(observed_fit(one), machine().channels) for one in (off, plain))
    np.testing.assert_allclose(seen.information, before.information, rtol=1e-6, atol=1e-6 * np.abs(before.information).max())
    pull = before.gradient + before.information @ (before.reference - seen.reference)
    scale = np.sqrt(np.diag(before.information))
    np.testing.assert_allclose(seen.gradient / scale, pull / scale, atol=1e-5)


def test_what_the_fit_predicts_for_its_channels_has_the_gains() -> None:
    off, measured = fitted(CHANNEL, gain=GAIN), with_errors(CHANNEL, gain=GAIN)
    told = beside_its_errors(off.coordinates, off.point, off.covariance, off.channel_effects, channels=machine().channels)
    band = fitted_response(machine(), *told, speed=measured.speed, direction=measured.direction)
    noise = error_size(machine().noise, np.abs(measured.phasor), measured.scatter)
    misfit = np.sqrt(np.mean(np.abs(measured.phasor - band.value) ** 2 / noise**2, axis=0))
    assert misfit.max() < 1.15
    gains = fitted_gains(machine(), told[0], told[1])
    error = np.sqrt(np.diag(told[2])[told[0].index(f"probe.{machine().channels[CHANNEL]}.gain.real")])
    assert abs(gains[CHANNEL] - GAIN) < 3.0 * error
    without = fitted_response(
        machine(), off.coordinates, off.point, off.covariance, speed=measured.speed, direction=measured.direction
    )
    assert np.sqrt(np.mean(np.abs(measured.phasor - without.value) ** 2 / noise**2, axis=0)).max() > 2.0


def test_a_gain_that_the_fit_identifies_along_is_no_error_left_out() -> None:
    said = film_document(plant())
    said = said | {"probes": [said["probes"][0] | {"gain_spread": 0.02}, *said["probes"][1:]]}
    off = identify(parse_machine(said), with_errors(CHANNEL, gain=GAIN))
    assert off.accepted
    assert off.verdict.endswith(WORDS)


def test_what_is_told_is_what_a_diagnosis_goes_by() -> None:
    """Histories, tables and alerts have the same number for the same thing."""
    off = fitted(CHANNEL, gain=GAIN)
    free, covariance = estimate_beside(off.point, off.covariance, off.channel_effects, [], channels=machine().channels)
    np.testing.assert_allclose(free, off.point, rtol=1e-9)
    np.testing.assert_allclose(covariance, off.covariance, rtol=1e-6, atol=1e-9 * np.diag(covariance).min())
    clearance = off.estimate("bearing.B2.clearance")
    assert clearance.value == pytest.approx(math.exp(free[off.coordinates.index("bearing.B2.clearance")]), rel=1e-9)
    seen = observed_fit(off)  # with the gain being what it is: the observation has its error beside
    assert np.all(np.diag(covariance) >= np.diag(seen.covariance))


def test_both_probes_of_a_bearing_are_free_where_either_may_be_off() -> None:
    effects = fitted(CHANNEL, gain=GAIN).channel_effects
    assert effects is not None
    assert effects.at is not None
    open_gains = {describe(name).channel for name, size in zip(effects.names, effects.at.tolist(), strict=True) if size}
    assert open_gains == set(machine().channels[CHANNEL - 1 : CHANNEL + 1])
    places = [effects.names.index(f"probe.{machine().channels[CHANNEL]}.gain.{part}") for part in COMPONENTS]
    error = np.sqrt(np.diag(np.linalg.inv(effects.information))[places])
    assert np.abs(effects.at[places] - [GAIN - 1.0, 0.0]).max() < CONFIDENCE_95 * error.max()


def test_a_gain_is_found_as_well_where_the_noise_is_estimated() -> None:
    """The misfit is then a variance [m²], whose falls are far less than those of χ²."""
    said = film_document(plant())
    estimated = parse_machine(said | {"noise": said["noise"] | {"estimated": True}})
    stated = fitted(CHANNEL, gain=GAIN)
    off = identify(estimated, with_errors(CHANNEL, gain=GAIN), beginning=healthy().point)
    assert off.accepted
    assert off.channel_effects is not None
    assert off.channel_effects.at is not None
    assert stated.channel_effects is not None
    assert np.array_equal(off.channel_effects.at != 0.0, stated.channel_effects.at != 0.0)


def test_a_second_gain_that_is_off_is_free_too() -> None:
    effects = fitted(0, 4, gain=1.12).channel_effects
    assert effects is not None
    assert effects.at is not None
    open_gains = {describe(name).channel for name, size in zip(effects.names, effects.at.tolist(), strict=True) if size}
    assert open_gains >= {machine().channels[0], machine().channels[4]}


def test_what_widens_a_fit_widens_the_estimates_with_the_gain_too(monkeypatch: pytest.MonkeyPatch) -> None:
    described = parse_machine(diametral_clearances(film_document(plant())))
    off = identify(described, with_errors(CHANNEL, gain=GAIN), beginning=healthy().point)
    plain = fitted_without_gains(described, monkeypatch)
    effects = off.channel_effects
    assert off.accepted
    assert "intervals are widened" in off.verdict
    assert effects is not None
    assert effects.covariance is not None
    assert np.sqrt(np.diag(effects.covariance) / np.diag(plain.covariance)).min() > LEAST_WIDTH


def test_fits_without_such_a_gain_or_without_films_are_about_their_own_estimates() -> None:
    pump = watched_machine.motor_pump()
    measured = watched_machine.measured(watched_machine.true_machine(), 7, watched_machine.gain(2, 1.15))
    for found in (healthy(), identify(pump, measured)):
        effects = found.channel_effects
        assert found.accepted
        assert effects is not None
        assert effects.point is None
        assert effects.at is None
        assert observed_fit(found).point is found.point
