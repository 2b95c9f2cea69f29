"""Effects of a gain that is clearly off: on oil films an accepted fit holds the estimates with that gain beside its own."""

import numpy as np
import pytest

from estimator.diagnosis.observation import observed_fit
from estimator.diagnosis.open_channels import estimate_beside
from estimator.fit.identify import identify
from tests.estimator.diagnosis import watched_machine
from tests.estimator.fit.test_faulty_channel import healthy, machine, with_errors

CHANNEL, GAIN = 5, 1.1


def test_estimates_with_the_gain_are_near_those_of_a_run_that_is_right() -> None:
    right = identify(machine(), with_errors(), beginning=healthy().point)
    off = identify(machine(), with_errors(CHANNEL, gain=GAIN), beginning=healthy().point)
    effects, error = off.channel_effects, np.sqrt(np.diag(right.covariance))
    assert off.accepted
    assert effects is not None
    assert effects.at is not None
    told = dict(zip(effects.names, effects.at.tolist(), strict=True))
    name = f"probe.{machine().channels[CHANNEL]}.gain"
    assert complex(told[f"{name}.real"], told[f"{name}.imaginary"]) == pytest.approx(GAIN - 1.0, abs=0.02)
    seen = observed_fit(off)
    assert np.abs((seen.point - right.point) / error).max() < 0.5 * np.abs((off.point - right.point) / error).max()
    _, free = estimate_beside(off.point, off.covariance, effects, [], channels=machine().channels)
    assert np.all(np.diag(free) >= np.diag(seen.covariance))


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
