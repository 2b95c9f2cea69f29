"""Bode data of an identification, through the API: measured points, the fit, residuals."""

import math

import numpy as np
import pytest

from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.fitted_response import fitted_response
from tests.api_in_process import Api
from tests.plant import machine
from tests.service.api.findings.modelled import LEFT_OUT, values

MICROMETRE_PP = 5e-7


def test_bode_of_measured_points_fit_and_residuals(modelled: Api) -> None:
    body = modelled.value("/identifications/1/bode", points=50)
    assert body["slow_roll_subtracted"] is False
    names, point, covariance = values()
    speed = np.linspace(rpm_to_rad_per_s(400.0), rpm_to_rad_per_s(2900.0), 50)
    band = fitted_response(machine(), names, point, covariance, speed=speed, direction=np.ones(50))
    assert [one["channel"] for one in body["fitted"]["channels"]] == list(machine().channels)
    for number, one in enumerate(body["fitted"]["channels"]):
        assert one["amplitude"] == pytest.approx((band.amplitude[:, number] / MICROMETRE_PP).tolist())
        assert one["upper"] == pytest.approx((band.upper[:, number] / MICROMETRE_PP).tolist())
        assert one["phase"] == pytest.approx(np.mod(-np.degrees(band.phase[:, number]), 360.0).tolist())
    (measured,) = body["measured"]
    assert measured["run"] == 1
    assert measured["time"][0] == "2023-11-14T22:13:20.000000Z"
    sigmas = np.array([one["residual_sigma"] for one in measured["channels"]], dtype=float)
    # Squares of a complex error over its expected square: exponential with mean 1.
    used = np.array([one["used"] for one in measured["channels"]])
    assert np.mean(sigmas[used] ** 2) == pytest.approx(1.0, abs=4 / math.sqrt(used.sum()))
    assert not used[LEFT_OUT[1], LEFT_OUT[0]]
    assert np.count_nonzero(~used) == 1


def test_bode_of_an_identification_whose_runs_are_gone_is_the_fit_alone(modelled: Api) -> None:
    body = modelled.value("/identifications/2/bode", points=10)
    assert body["measured"] == []
    assert len(body["fitted"]["speed"]) == 10
