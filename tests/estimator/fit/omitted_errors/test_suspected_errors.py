"""Errors that a refused fit's score suspects: those of the channel, or of the coupling, whatever has changed."""

import numpy as np
import pytest

from estimator.fit.omitted_errors.suspected_errors import SuspectedErrors, suspected_errors
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.multistart import chosen_start
from estimator.fit.problem_setup import fit_problem
from estimator.phasors.measurement import Measurement
from tests.estimator.diagnosis import watched_machine as plant
from tests.estimator.diagnosis.test_rotating_coupling import OFFSET, turning

CHANNEL = 3
ANGLE = 3e-5 * np.exp(0.2j)


def suspected(measurement: Measurement) -> SuspectedErrors:
    problem = fit_problem(plant.motor_pump(), measurement, robust=True)
    return suspected_errors(problem, fit(problem, chosen_start(problem, np.random.default_rng(0), first=True)))


def test_a_channel_with_another_gain_is_suspected_first() -> None:
    found = suspected(plant.measured(plant.true_machine(), 7, plant.gain(CHANNEL, 1.2)))
    assert found.channels[0] == CHANNEL
    assert not found.couplings_first


@pytest.mark.parametrize(("offset", "angle"), [(OFFSET, 0j), (0j, ANGLE)], ids=["bore", "face"])
def test_couplings_that_turn_are_suspected_before_channels(offset: complex, angle: complex) -> None:
    assert suspected(plant.measured(plant.true_machine(), 200, turning(offset, angle))).couplings_first
