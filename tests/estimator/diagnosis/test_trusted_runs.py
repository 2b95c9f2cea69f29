"""Refused runs that are trusted all the same: those which errors of channels explain that causes are."""

import numpy as np
import pytest

from estimator.diagnosis.data_faults import fits, is_trusted
from estimator.diagnosis.observation import Observation

NAMES = ("bearing.B1.kxx", "probe.A.gain.real", "probe.A.gain.imaginary", "probe.B.gain.real", "probe.B.gain.imaginary")
FREEDOM = 400
ERROR = 0.1


def refused(fall: float, *, alike: float = 0.0, at: bool = True) -> Observation:
    """A refused run whose χ² falls with the gain of channel A, from where its fit with that gain ended or from zero.

    alike: correlation of what A and B explain.
    """
    own = fall / ERROR**2
    information = np.diag([1.0, own, own, own, own])
    information[1, 3] = information[3, 1] = information[2, 4] = information[4, 2] = alike * own
    errors = np.array([ERROR, 0.0, 0.0, 0.0])
    return Observation(
        names=NAMES,
        coordinates=1,
        reference=np.concatenate([[0.0], errors if at else np.zeros(4)]),
        gradient=np.zeros(5) if at else information @ np.concatenate([[0.0], errors]),
        information=information,
        accepted=False,
        chi_square=FREEDOM + fall,
        degrees_of_freedom=FREEDOM,
        samples=100,
        phasors={"A": 100, "B": 100},
        outliers={},
        amplitude={"A": 1e-6, "B": 1e-6},
    )


@pytest.mark.parametrize("fall", [30.0, 100.0, 400.0])
def test_a_run_is_trusted_where_the_channel_that_explains_it_is_named(fall: float) -> None:
    assert is_trusted(refused(fall), frozenset("A"))
    assert fits(refused(fall), frozenset("A"))


def test_a_run_is_not_trusted_where_another_channel_is_named() -> None:
    assert not is_trusted(refused(400.0), frozenset("B"))
    assert not is_trusted(refused(400.0), frozenset())


@pytest.mark.parametrize("at", [True, False])
def test_a_channel_that_explains_the_same_does_as_well_wherever_the_fit_was_linearised(at: bool) -> None:
    assert is_trusted(refused(400.0, alike=0.99, at=at), frozenset("B"))
    assert not is_trusted(refused(400.0, alike=0.5, at=at), frozenset("B"))
