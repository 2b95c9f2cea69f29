"""Phasors of waveforms that are known in closed form, their scatter by Monte Carlo, and what must not change them."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.arrays import Floats
from estimator.signal.keyphasor import Edge, ShaftAngle, Threshold, read_keyphasor, shaft_angle
from estimator.signal.order_tracking import Block, track_orders

TURN = 2.0 * math.pi
RATE = 1000.0
FIRST = 3e-5 * cmath.exp(0.7j)
SECOND = 8e-6 * cmath.exp(-2.1j)


def steady(speed: float, *, first: float = 0.05, turns: int = 200) -> ShaftAngle:
    """Angle of constant speed [rad/s] with an edge at `first` [s]."""
    return shaft_angle(np.asarray(first + TURN / speed * np.arange(turns + 1)))


def waveform(angle: Floats) -> Floats:
    return np.asarray(2e-4 + (FIRST * np.exp(1j * angle) + SECOND * np.exp(2j * angle)).real)


def track(
    waveforms: Floats,
    angle: ShaftAngle,
    *,
    seconds: float | None = None,
    turns: int | None = None,
    rails: tuple[float, float] | None = None,
) -> tuple[Block, ...]:
    return track_orders(waveforms, sampling_rate=RATE, angle=angle, seconds=seconds, turns=turns, rails=rails).blocks


@pytest.mark.parametrize("speed", [40.0, 314.159, 2.0 * math.pi * 50.0, 700.0])
@pytest.mark.parametrize(("seconds", "turns"), [(1.0, None), (None, 7)])
def test_phasors_are_exact_without_noise(speed: float, seconds: float | None, turns: int | None) -> None:
    time = np.arange(3000) / RATE
    angle = steady(speed, turns=int(2.9 * speed / TURN))
    found = track(waveform(speed * (time - 0.05))[None], angle, seconds=seconds, turns=turns)
    assert len(found) >= 2
    for one in found:
        assert one.phasors[0] == pytest.approx(np.array([FIRST, SECOND]), abs=1e-9 * abs(FIRST))
        assert one.speed == pytest.approx(speed, rel=1e-9)
        assert one.residual[0] < 1e-9 * abs(FIRST)
        assert one.mean[0] == pytest.approx(2e-4, rel=1e-9)
        assert abs(FIRST) - abs(SECOND) < one.overall[0] < abs(FIRST) + abs(SECOND)
        assert one.faults == (None,)


def test_blocks_lie_where_they_were_asked_for() -> None:
    angle = steady(100.0, turns=47)
    waveforms = np.random.default_rng(1).normal(size=(2, 3100))
    tracking = track_orders(waveforms, sampling_rate=RATE, angle=angle, seconds=0.5)
    assert [one.time for one in tracking.blocks] == pytest.approx([0.3, 0.8, 1.3, 1.8, 2.3])
    assert [one.samples for one in tracking.blocks] == [500] * 5
    (rest,) = tracking.left_out
    assert (rest.start, rest.end) == pytest.approx((2.55, 0.05 + 0.47 * TURN))
    assert rest.reason == "shorter than a block"
    by_turns = track_orders(waveforms, sampling_rate=RATE, angle=angle, turns=10)
    assert [one.turns for one in by_turns.blocks] == pytest.approx([10.0] * 4)
    assert [one.time for one in by_turns.blocks] == pytest.approx([0.05 + TURN / 100.0 * (5 + 10 * k) for k in range(4)])
    late = track_orders(waveforms, sampling_rate=RATE, angle=angle, seconds=0.5, start=1.0)
    assert late.blocks[0].time == pytest.approx(1.25)


def test_a_ramp_of_speed_and_amplitude_biases_nothing() -> None:
    """100 rpm/s at 3000 rpm, amplitude as the square of the speed: X at the middle of the block, within its curvature."""
    speed, acceleration = 100.0 * math.pi, 100.0 * math.pi / 30.0
    time = np.arange(1100) / RATE
    phase = speed * time + acceleration * time**2 / 2.0
    instants = (np.sqrt(speed**2 + 2.0 * acceleration * TURN * np.arange(54)) - speed) / acceleration
    growth = (1.0 + acceleration * time / speed) ** 2
    (found,) = track((growth * (FIRST * np.exp(1j * phase)).real)[None], shaft_angle(instants), seconds=1.0)
    true = FIRST * (1.0 + acceleration * 0.5 / speed) ** 2
    assert found.speed == pytest.approx(speed + 0.5 * acceleration, rel=1e-6)
    # The curvature (αT/2Ω)²/3 of the amplitude over the block is all that is left: 1e-4.
    assert found.phasors[0, 0] == pytest.approx(true, rel=1.1 * (acceleration * 0.5 / speed) ** 2 / 3.0)


def test_scatter_and_residual_are_those_of_white_noise() -> None:
    """600 channels with noise of their own: rms error beside mean scatter, to 1/√600 each; σ from both, and 2σ/√N."""
    speed, sigma = 333.3, 1e-6
    time = np.arange(1200) / RATE
    noise = np.random.default_rng(7).normal(0.0, sigma, (600, time.size))
    (found,) = track(waveform(speed * (time - 0.05)) + noise, steady(speed), seconds=1.0)
    for order, true in enumerate((FIRST, SECOND)):
        error = math.sqrt(float(np.mean(np.abs(found.phasors[:, order] - true) ** 2)))
        claimed = math.sqrt(float(np.mean(found.scatter[:, order] ** 2)))
        assert error / claimed == pytest.approx(1.0, abs=0.08 + 3.5 / math.sqrt(600))
        # One block in twenty takes its noise for a line.
        assert claimed == pytest.approx(2.0 * sigma / math.sqrt(1000.0), rel=0.08)
    assert math.sqrt(float(np.mean(found.residual**2))) == pytest.approx(sigma, rel=0.01)


def test_scatter_is_right_in_a_block_of_three_turns() -> None:
    """This is where trends and orders overlap most."""
    speed, sigma = 100.0, 1e-6
    time = np.arange(300) / RATE
    noise = np.random.default_rng(8).normal(0.0, sigma, (2000, time.size))
    found = track(waveform(speed * (time - 0.05)) + noise, steady(speed, turns=4), turns=3)
    error = np.sqrt(np.mean(np.abs(found[0].phasors - np.array([FIRST, SECOND])) ** 2, axis=0))
    assert error / np.sqrt(np.mean(found[0].scatter ** 2, axis=0)) == pytest.approx(np.ones(2), abs=3.5 / math.sqrt(2000))


@settings(max_examples=30, deadline=None)
@given(factor=st.floats(0.01, 100.0), offset=st.floats(-10.0, 10.0), shift=st.floats(-3.0, 3.0), seed=st.integers(0, 99))
def test_scaling_offset_and_the_place_of_the_mark(factor: float, offset: float, shift: float, seed: int) -> None:
    """Scaling scales; an offset does nothing; a mark that passes `shift` radians later turns X_n by n·shift."""
    speed = 200.0
    signal = np.random.default_rng(seed).normal(size=1300)
    (found,) = track(signal[None], steady(speed, first=0.1), seconds=1.0)
    (scaled,) = track((factor * signal + offset)[None], steady(speed, first=0.1), seconds=1.0)
    assert scaled.phasors == pytest.approx(factor * found.phasors, rel=1e-9, abs=1e-11)
    assert scaled.scatter == pytest.approx(factor * found.scatter, rel=1e-9)
    assert scaled.residual == pytest.approx(factor * found.residual, rel=1e-9)
    # The same samples in the same block: the angle's curve alone is moved.
    old = steady(speed, first=0.1)
    moved = ShaftAngle(old.edge_time, old.edge_angle - shift, 0.0, (), ())
    (turned,) = track(signal[None], moved, seconds=1.0)
    assert turned.phasors == pytest.approx(found.phasors * np.exp(1j * shift * np.array([1, 2])), rel=1e-9, abs=1e-12)


def test_one_channel_alone_and_among_others_is_the_same() -> None:
    signals = np.random.default_rng(2).normal(size=(3, 1300))
    angle = steady(200.0)
    (together,) = track(signals, angle, seconds=1.0)
    (alone,) = track(signals[1:2], angle, seconds=1.0)
    assert together.phasors[1] == pytest.approx(alone.phasors[0], rel=1e-12)


def test_a_lost_probe_is_named_and_harms_no_other() -> None:
    signals = np.random.default_rng(2).normal(size=(4, 1300))
    angle = steady(200.0)
    (sound,) = track(signals, angle, seconds=1.0)
    signals[1] = -24.0
    signals[2, 700] = math.nan
    (found,) = track(signals, angle, seconds=1.0, rails=(-24.0, 24.0))
    assert found.faults == (None, "rail", "not finite", None)
    assert np.isnan(found.phasors[1:3]).all()
    assert np.isnan(found.scatter[1:3]).all()
    assert found.phasors[[0, 3]] == pytest.approx(sound.phasors[[0, 3]], rel=1e-12)


def test_a_clipped_channel_is_read_and_flagged() -> None:
    time = np.arange(1300) / RATE
    signal = np.minimum(np.cos(200.0 * (time - 0.05)), 0.8)
    (found,) = track(signal[None], steady(200.0), seconds=1.0)
    assert found.faults == ("clipped",)
    # First Fourier coefficient of a cosine cut at cos β: 1 - (β - sin β cos β)/π.
    angle = math.acos(0.8)
    assert found.phasors[0, 0].real == pytest.approx(1.0 - (angle - math.sin(angle) * 0.8) / math.pi, abs=0.003)


def test_blocks_that_cannot_be_fitted_say_why() -> None:
    noise = np.random.default_rng(3).normal(size=(1, 2000))

    def reasons(angle: ShaftAngle, seconds: float | None = None, turns: int | None = None) -> list[str]:
        tracking = track_orders(noise, sampling_rate=RATE, angle=angle, seconds=seconds, turns=turns)
        assert tracking.blocks == ()
        return [one.reason for one in tracking.left_out]

    assert "turns: at least 3" in reasons(steady(20.0, turns=5), seconds=0.5)[0]
    assert "turns: at least 3" in reasons(steady(20.0, turns=5), turns=2)[0]
    assert "too few" in reasons(steady(TURN * 220.0), seconds=0.5)[0]
    assert reasons(steady(100.0, first=9.0), seconds=0.5) == []
    with pytest.raises(ValueError, match="either"):
        reasons(steady(100.0))
    with pytest.raises(ValueError, match="longer than nothing"):
        reasons(steady(100.0), seconds=0.0)
    with pytest.raises(ValueError, match="channels, samples"):
        track_orders(noise[0], sampling_rate=RATE, angle=steady(100.0), seconds=1.0)


def test_a_gap_of_the_keyphasor_is_left_out_and_both_sides_are_read() -> None:
    speed = 200.0
    instants = 0.05 + TURN / speed * np.arange(120)
    angle = shaft_angle(np.delete(instants, np.arange(50, 60)))
    time = np.arange(4000) / RATE
    tracking = track_orders(waveform(speed * (time - 0.05))[None], sampling_rate=RATE, angle=angle, seconds=0.5)
    assert len(tracking.blocks) == 3 + 3
    assert any("do not fit together" in one.reason for one in tracking.left_out)
    for one in tracking.blocks:
        assert not instants[49] < one.time < instants[60]
        assert one.phasors[0] == pytest.approx(np.array([FIRST, SECOND]), abs=1e-9 * abs(FIRST))


@pytest.mark.parametrize(("edge", "passed"), [("rising", 0.0), ("falling", 0.006 * 157.0)])
def test_from_both_waveforms_to_the_phasor(edge: Edge, passed: float) -> None:
    """Straight flanks of 2 ms, pulses of 6 ms, at 157 rad/s: counted from the falling edge the phase leads by that angle."""
    speed, rate = 157.0, 5000.0
    time = 40.0 + np.arange(11_000) / rate
    turned = speed * (time - 40.03)
    since = (turned + 1.0) % TURN - 1.0
    keyphasor = np.clip(since / speed / 0.002 + 0.5, 0.0, 1.0) - np.clip((since / speed - 0.006) / 0.002 + 0.5, 0.0, 1.0)
    angle = read_keyphasor(keyphasor, sampling_rate=rate, start=40.0, edge=edge, threshold=Threshold(0.5, 0.4))
    (first, _) = track_orders(waveform(turned)[None], sampling_rate=rate, angle=angle, start=40.0, seconds=1.0).blocks
    true = np.array([FIRST, SECOND]) * np.exp(1j * passed * np.array([1, 2]))
    assert first.phasors[0] == pytest.approx(true, abs=1e-8 * abs(FIRST))
    assert first.speed == pytest.approx(speed, rel=1e-9)


def test_no_channels_give_blocks_without_phasors() -> None:
    (found,) = track(np.empty((0, 1300)), steady(200.0), seconds=1.0)
    assert found.phasors.shape == (0, 2)
    assert found.speed == pytest.approx(200.0)


def test_a_last_block_that_ends_with_the_waveform_is_not_lost() -> None:
    angle = steady(200.0, first=0.0)
    found = track(np.random.default_rng(1).normal(size=(1, 2100)), angle, seconds=0.7)
    assert [one.time for one in found] == pytest.approx([0.35, 1.05, 1.75])
    assert [one.samples for one in found] == [700] * 3
