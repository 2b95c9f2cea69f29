"""Tests what a fit says of errors of its channels, against fits that identify them along."""

import numpy as np
import pytest

from estimator.fit import identify as identification
from estimator.fit.identify import identify
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.document import Machine
from tests.estimator.diagnosis import watched_machine as plant

CHANNEL = 2


@pytest.fixture(scope="module")
def machine() -> Machine:
    return plant.motor_pump()


def effects(found: ChannelEffects | None) -> ChannelEffects:
    assert found is not None
    return found


def with_free_gain(machine: Machine, channel: int) -> Machine:
    probes = list(machine.probes)
    probes[channel] = probes[channel].model_copy(update={"gain_spread": 1.0})
    return machine.model_copy(update={"probes": tuple(probes)})


def places(found: ChannelEffects, stem: str) -> list[int]:
    return [found.names.index(f"{stem}.{part}") for part in ("real", "imaginary")]


def test_every_channel_has_a_gain_and_a_run_out_and_every_coupling_turns(machine: Machine) -> None:
    found = effects(plant.first_run().channel_effects)
    errors = [f"probe.{channel}.{what}" for channel in machine.channels for what in ("gain", "run_out")]
    errors += [f"coupling.{one.id}.rotating_{what}" for one in machine.couplings for what in ("offset", "angle")]
    assert set(found.names) == {f"{error}.{part}" for error in errors for part in ("real", "imaginary")}
    assert found.phasors == (plant.SAMPLES,) * len(machine.channels)
    assert all(np.linalg.eigvalsh(found.information / np.max(np.abs(found.information))) > -1e-9)


def test_they_foretell_what_a_fit_with_a_free_gain_finds(machine: Machine) -> None:
    data = plant.measured(plant.true_machine(), 7, plant.gain(CHANNEL, 1.03 * np.exp(0.02j)))
    plain = identify(machine, data)
    free = identify(with_free_gain(machine, CHANNEL), data)
    found = effects(plain.channel_effects)
    own = places(found, f"probe.{machine.channels[CHANNEL]}.gain")
    gain = np.linalg.solve(found.information[np.ix_(own, own)], found.score[own])
    name = f"probe.{machine.channels[CHANNEL]}.gain"
    exact = np.array([free.point[free.coordinates.index(f"{name}.{part}")] for part in ("real", "imaginary")])
    error = np.sqrt(np.diag(np.linalg.inv(found.information[np.ix_(own, own)])))
    assert np.all(np.abs(gain - exact) < 0.25 * error + 0.05 * np.abs(exact))
    # And the fit's own point moves by the bias that they tell.
    shared = [free.coordinates.index(one) for one in plain.coordinates]
    moved = free.point[shared] - plain.point
    spread = np.sqrt(np.diag(plain.covariance))
    assert np.max(np.abs(moved + found.bias[:, own] @ gain) / spread) < 0.6
    assert np.max(np.abs(moved) / spread) > 0.8  # so that there was something to foretell


@pytest.fixture
def unexplained(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave refused fits without another one that the errors of channels explain."""

    def none(*_: object) -> None:
        return None

    for name in ("fit_with_channel_errors", "fit_with_errors_of_two"):
        monkeypatch.setattr(identification, name, none)


@pytest.mark.usefixtures("unexplained")
def test_they_foretell_a_gain_that_is_far_off_beyond_first_order(machine: Machine) -> None:
    channel = 3
    data = plant.measured(plant.true_machine(), 7, plant.gain(channel, 1.2))
    plain = identify(machine, data)
    free = identify(with_free_gain(machine, channel), data)
    found = effects(plain.channel_effects)
    name = f"probe.{machine.channels[channel]}.gain"
    own = places(found, name)
    gain = np.linalg.solve(found.information[np.ix_(own, own)], found.score[own])
    exact = np.array([free.point[free.coordinates.index(f"{name}.{part}")] for part in ("real", "imaginary")])
    assert np.abs(gain - exact).max() < 0.005
    shared = [free.coordinates.index(one) for one in plain.coordinates]
    moved = free.point[shared] - plain.point
    spread = np.sqrt(np.diag(plain.covariance))
    assert np.max(np.abs(moved + found.bias[:, own] @ gain) / spread) < 0.5
    assert np.max(np.abs(moved) / spread) > 4.0  # so that there was something to foretell


@pytest.mark.usefixtures("unexplained")
def test_a_channel_that_the_fit_gave_up_is_judged_by_what_the_others_say_of_it(machine: Machine) -> None:
    size = 4e-6 * np.exp(1j)
    found = plant.run(plant.true_machine(), 8, plant.run_out(CHANNEL, size))
    assert found.outliers.get(machine.channels[CHANNEL], 0) > 0.3 * plant.SAMPLES
    held = effects(found.channel_effects)
    own = places(held, f"probe.{machine.channels[CHANNEL]}.run_out")
    estimate = np.linalg.solve(held.information[np.ix_(own, own)], held.score[own])
    assert complex(*estimate) == pytest.approx(size, abs=0.05 * abs(size))
    assert not held.bias[:, own].any()
