"""Effects of a gain that is clearly off: an accepted fit holds the estimates with that gain beside its own."""

import numpy as np
import pytest

from estimator.diagnosis.observation import observed_fit
from estimator.diagnosis.open_channels import estimate_beside
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from tests.estimator.diagnosis import watched_machine as plant

CHANNEL, GAIN = 2, 1.15


@pytest.fixture(scope="module")
def machine() -> Machine:
    return plant.motor_pump()


def test_estimates_with_the_gain_are_those_of_a_fit_that_knows_it(machine: Machine) -> None:
    """The measuring chain read right, and the same with its gain: all but the gain is the same."""
    right = identify(machine, plant.measured(plant.true_machine(), 7))
    off = identify(machine, plant.measured(plant.true_machine(), 7, plant.gain(CHANNEL, GAIN)))
    effects, error = off.channel_effects, np.sqrt(np.diag(right.covariance))
    assert off.accepted
    assert effects is not None
    assert effects.at is not None
    told = dict(zip(effects.names, effects.at.tolist(), strict=True))
    name = f"probe.{machine.channels[CHANNEL]}.gain"
    assert complex(told[f"{name}.real"], told[f"{name}.imaginary"]) == pytest.approx(GAIN - 1.0, abs=0.02)
    seen = observed_fit(off)
    assert np.abs((seen.point - right.point) / error).max() < 1.0
    assert np.abs((off.point - right.point) / error).max() > 5.0  # the fit's own, which are trended
    assert np.sqrt(np.diag(seen.covariance)) == pytest.approx(error, rel=0.3)
    _, free = estimate_beside(off.point, off.covariance, effects, [], channels=machine.channels)
    assert np.all(np.diag(free) >= np.diag(seen.covariance))


def test_fits_without_such_a_gain_are_about_their_own_estimates(machine: Machine) -> None:
    right = identify(machine, plant.measured(plant.true_machine(), 7))
    effects = right.channel_effects
    assert effects is not None
    assert effects.point is None
    assert effects.at is None
    assert observed_fit(right).point is right.point
