"""Coast-downs integrated in time: against the closed form of one oscillator, the steady state, and smaller steps."""

import numpy as np
import pytest

from estimator.signal.keyphasor import shaft_angle
from estimator.signal.order_tracking import track_orders
from estimator.simulation.coast_down import coast_down
from tests.estimator.sweeps import light_chapter_3, linear_law, single_mass, single_mass_envelope, steady
from tests.estimator.trains import chapter_3

FREQUENCY = 150.0


@pytest.mark.parametrize(("first", "last", "duration"), [(90.0, 260.0, 8.0), (260.0, 60.0, 20.0)])
def test_one_oscillator_follows_the_closed_form(first: float, last: float, duration: float) -> None:
    machine = single_mass(natural_frequency=FREQUENCY, damping_ratio=0.02)
    found = coast_down(machine, linear_law(first=first, last=last, duration=duration), step=1e-3)
    expected = single_mass_envelope(
        found.time, first=first, rate=(last - first) / duration, natural_frequency=FREQUENCY, damping_ratio=0.02
    )
    largest = np.abs(expected).max()
    assert np.abs(found.phasor[:, 0] - expected).max() < 2e-3 * largest
    # y lags a quarter of a turn behind x.
    assert np.abs(found.phasor[:, 1] + 1j * expected).max() < 2e-3 * largest
    away = np.abs(expected - steady(machine, found.law.speed(found.time))[:, 0])
    assert away.max() > 0.2 * largest  # far from the steady state, so that the closed form is a test


def test_halving_the_step_quarters_the_error() -> None:
    machine = single_mass(natural_frequency=FREQUENCY, damping_ratio=0.02)
    law = linear_law(first=100.0, last=220.0, duration=6.0)
    errors = []
    for step in (8e-3, 4e-3, 2e-3):
        found = coast_down(machine, law, step=step)
        exact = single_mass_envelope(found.time, first=100.0, rate=20.0, natural_frequency=FREQUENCY, damping_ratio=0.02)
        errors.append(np.abs(found.phasor[:, 0] - exact).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


def test_slow_sweeps_come_near_the_steady_state() -> None:
    machine = chapter_3()
    away = []
    for duration in (20.0, 40.0):
        found = coast_down(machine, linear_law(first=300.0, last=200.0, duration=duration), step=4e-3)
        # The first part shows how the sweep began.
        late = found.time > duration / 4
        expected = steady(machine, found.law.speed(found.time[late]))
        away.append(np.sqrt(np.mean(np.abs(found.phasor[late] / expected - 1) ** 2)))
    assert away[0] < 0.02
    assert away[1] == pytest.approx(away[0] / 2, rel=0.15)


def test_waveforms_give_the_envelope_back_through_the_chain() -> None:
    machine = light_chapter_3()
    law = linear_law(first=420.0, last=400.0, duration=4.0)
    found = coast_down(machine, law, step=1e-3)
    instants = np.arange(0.0, 4.0, 1e-3)
    fine = np.linspace(0.0, 4.0, 40_001)
    edges = np.interp(2 * np.pi * np.arange(int(law.angle(fine)[-1] / (2 * np.pi))), law.angle(fine), fine)
    tracked = track_orders(found.waveforms(instants), sampling_rate=1e3, angle=shaft_angle(edges), seconds=0.1)
    for block in tracked.blocks:
        expected = found.envelope(np.array([block.time]))[0]
        assert np.abs(block.phasors[:, 0] - expected).max() < 5e-3 * np.abs(expected).max()


def test_rotation_the_other_way_is_the_mirror_image() -> None:
    machine = single_mass(natural_frequency=FREQUENCY, damping_ratio=0.05)
    other = machine.model_copy(update={"rotation": "negative"})
    law = linear_law(first=120.0, last=180.0, duration=3.0)
    one, mirrored = coast_down(machine, law, step=4e-3), coast_down(other, law, step=4e-3)
    np.testing.assert_allclose(mirrored.phasor[:, 0], one.phasor[:, 0], rtol=1e-9)
    np.testing.assert_allclose(mirrored.phasor[:, 1], -one.phasor[:, 1], rtol=1e-9)


def test_impossible_requests_are_named() -> None:
    machine = single_mass(natural_frequency=FREQUENCY, damping_ratio=0.05)
    law = linear_law(first=120.0, last=180.0, duration=3.0)
    with pytest.raises(ValueError, match="step is 0"):
        coast_down(machine, law, step=0.0)
    with pytest.raises(ValueError, match="1 excitations"):
        coast_down(machine, law, step=1e-2, excitations=np.zeros(3, dtype=complex))
    with pytest.raises(ValueError, match="positive throughout"):
        coast_down(machine, linear_law(first=10.0, last=-10.0, duration=3.0), step=1e-2)
