"""Fits with the errors of one or two channels: what they find, and that they explain nothing else."""

from functools import cache

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plant import Plant
from tests.film_plant.plants import random_plant

CHANNEL = 3
RUN_OUT = 2e-6 * np.exp(0.7j)
WORDS = "with another gain and run-out of probe {} it would be accepted"
BOTH = "with other gains and run-outs of the probes {} and {} it would be accepted"


@cache
def plant() -> Plant:
    return random_plant(2, discrepancy=DiscrepancySize())


@cache
def machine() -> Machine:
    return parse_machine(film_document(plant()))


@cache
def healthy() -> Identification:
    found = identify(machine(), measured(plant(), seed=1))
    assert found.accepted
    return found


def with_errors(*channels: int, gain: complex = 1.0, run_out: complex = 0.0) -> Measurement:
    whole = measured(plant(), seed=2)
    phasor = whole.phasor.copy()
    phasor[:, channels] = gain * phasor[:, channels] + run_out
    return replace(whole, phasor=phasor)


@pytest.mark.parametrize("begins_anew", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.parametrize(
    ("gain", "run_out"), [(1.0, RUN_OUT), (1.0, 10.0 * RUN_OUT), (1.4, 0.0)], ids=["run-out", "large run-out", "gain"]
)
def test_a_refused_fit_tells_the_errors_of_the_one_channel_that_explains_it(
    gain: complex, run_out: complex, *, begins_anew: bool
) -> None:
    beginning = None if begins_anew else healthy().point
    found = identify(machine(), with_errors(CHANNEL, gain=gain, run_out=run_out), beginning=beginning)
    name = machine().channels[CHANNEL]
    assert not found.accepted
    assert found.verdict.endswith(WORDS.format(name))
    effects = found.channel_effects
    assert effects is not None
    assert effects.at is not None
    told = dict(zip(effects.names, effects.at.tolist(), strict=True))
    error = np.sqrt(np.diag(np.linalg.pinv(effects.information, hermitian=True)))
    errors = dict(zip(effects.names, error.tolist(), strict=True))
    for quantity, true in (("gain", gain - 1.0), ("run_out", run_out)):
        for part, value in (("real", np.real(true)), ("imaginary", np.imag(true))):
            one = f"probe.{name}.{quantity}.{part}"
            assert told[one] == pytest.approx(value, abs=4.0 * errors[one])
    assert {one for one, size in told.items() if size} <= {f"probe.{name}.{of}" for of in _PARTS}
    # The machine is found as without the error, and χ² without it is far beyond what noise explains.
    right = identify(machine(), with_errors(), beginning=healthy().point)
    moved = (found.point - right.point) / np.sqrt(np.diag(right.covariance))
    assert np.abs(moved).max() < 3.0
    assert found.chi_square > 1.2 * found.degrees_of_freedom


_PARTS = [f"{quantity}.{part}" for quantity in ("gain", "run_out") for part in ("real", "imaginary")]


@pytest.mark.parametrize(
    ("two", "errors"),
    [pytest.param((1, 4), {"run_out": RUN_OUT}, marks=pytest.mark.long), ((3, 6), {"gain": 0.8})],
    ids=["run-outs", "gains"],
)
def test_a_refused_fit_tells_the_errors_of_two_channels_that_explain_it(
    two: tuple[int, int], errors: dict[str, complex]
) -> None:
    """The score suspects one of them first, or another pair."""
    found = identify(machine(), with_errors(*two, **errors), beginning=healthy().point)
    assert not found.accepted
    assert found.verdict.endswith(BOTH.format(*(machine().channels[one] for one in two)))
    right = identify(machine(), with_errors(), beginning=healthy().point)
    assert np.abs((found.point - right.point) / np.sqrt(np.diag(right.covariance))).max() < 3.5


@pytest.mark.long
def test_no_two_channels_explain_what_three_have_done() -> None:
    found = identify(machine(), with_errors(1, 4, 6, run_out=RUN_OUT), beginning=healthy().point)
    assert not found.accepted
    assert "it would be accepted" not in found.verdict


@pytest.mark.long
def test_a_beginning_without_a_model_is_left_out() -> None:
    """A bearing that stands in its shaft has no film."""
    beginning = healthy().point.copy()
    beginning[healthy().coordinates.index("bearing.B2.elevation_y")] += 50e-3
    found = identify(machine(), with_errors(CHANNEL, run_out=RUN_OUT), beginning=beginning)
    assert found.verdict.endswith(WORDS.format(machine().channels[CHANNEL]))


def test_an_accepted_fit_is_told_without_errors_of_channels() -> None:
    effects = healthy().channel_effects
    assert effects is not None
    assert effects.at is None
