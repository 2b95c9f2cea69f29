"""Edges and the shaft's angle against pulse trains whose instants are known in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.arrays import Floats
from estimator.signal.keyphasor import (
    InconsistentIntervals,
    KeyphasorError,
    NoPulses,
    SeveralPulses,
    ShaftAngle,
    Threshold,
    edges,
    monotone_slopes,
    read_keyphasor,
    shaft_angle,
    threshold_of,
)

TURN = 2.0 * math.pi


def trapezoids(times: Floats, instants: Floats, *, rise: float = 0.002, width: float = 0.006) -> Floats:
    """Pulses from -10 to -2 whose rising edges pass the middle at the instants, straight over `rise` seconds."""
    height = np.zeros_like(times)
    for instant in instants:
        up = np.clip((times - instant) / rise + 0.5, 0.0, 1.0)
        down = np.clip((times - instant - width) / rise + 0.5, 0.0, 1.0)
        height += up - down
    return -10.0 + 8.0 * height


def ramp_instants(speed: float, acceleration: float, count: int, *, first: float = 0.0) -> Floats:
    """Instants at which ω s + α s²/2 is a multiple of 2π, s counted from `first` [s]."""
    angle = TURN * np.arange(count)
    return np.asarray(first + 2.0 * angle / (speed + np.sqrt(speed**2 + 2.0 * acceleration * angle)))


def test_edges_on_straight_flanks_are_exact() -> None:
    instants = 0.0137 + 0.0413 * np.arange(20.0)
    time = np.arange(8500) / 10_000.0
    signal = trapezoids(time, instants)
    threshold = threshold_of(signal)
    assert threshold.level == pytest.approx(-6.0)
    rising = edges(signal, sampling_rate=10_000.0, threshold=threshold)
    falling = edges(signal, sampling_rate=10_000.0, threshold=threshold, edge="falling")
    assert rising == pytest.approx(instants, abs=1e-12)
    assert falling == pytest.approx(instants + 0.006, abs=1e-12)
    later = edges(signal, sampling_rate=10_000.0, threshold=threshold, start=100.0)
    assert later - rising == pytest.approx(np.full(20, 100.0))
    higher = edges(signal, sampling_rate=10_000.0, threshold=Threshold(-4.0, 1.0))
    assert higher == pytest.approx(instants + 0.0005, abs=1e-12)


def test_noise_inside_the_hysteresis_makes_no_second_edge() -> None:
    instants = 0.0137 + 0.0413 * np.arange(20.0)
    time = np.arange(85_000) / 100_000.0
    noise = np.random.default_rng(1).uniform(-0.9, 0.9, time.size)
    signal = trapezoids(time, instants) + noise
    found = edges(signal, sampling_rate=100_000.0, threshold=Threshold(-6.0, 2.0))
    assert found.size == 20
    # The flank passes the noise's ±0.9 of its 8 in ±0.225 ms.
    assert np.max(np.abs(found - instants)) < 0.9 / 8.0 * 0.002 + 1e-5
    without = edges(signal, sampling_rate=100_000.0, threshold=Threshold(-6.0, 0.0))
    assert without.size > 20


def test_the_threshold_is_in_the_middle_whatever_the_noise_and_the_length_of_the_pulse() -> None:
    """Levels -10 for 90 % and -2 for 10 % of the time, noise of 0.1: medians to 1.25 · 0.1/√5000, and spikes do nothing."""
    signal = np.where(np.arange(50_000) % 100 < 10, -2.0, -10.0) + np.random.default_rng(5).normal(0.0, 0.1, 50_000)
    signal[::1000] = 30.0
    threshold = threshold_of(signal)
    assert threshold.level == pytest.approx(-6.0, abs=0.008)
    assert threshold.hysteresis == pytest.approx(0.4 * 8.0, abs=0.01)


@pytest.mark.parametrize("acceleration", [0.0, 1.3, -20.0])
def test_angle_and_speed_follow_constant_acceleration_exactly(acceleration: float) -> None:
    """Slowing down from 60 to 35 rad/s in eleven turns, by up to a tenth in a turn."""
    speed = 10.0 if acceleration >= 0.0 else 60.0
    instants = ramp_instants(speed, acceleration, 11, first=3.0)
    angle = shaft_angle(instants)
    time = np.linspace(instants[0], instants[-1], 1001)
    passed = time - 3.0
    assert angle.at(time) == pytest.approx(speed * passed + acceleration * passed**2 / 2.0, abs=1e-9)
    assert angle.speed(time) == pytest.approx(speed + acceleration * passed, rel=1e-9)
    assert angle.jitter < 1e-9
    assert angle.repairs == ()
    assert angle.gaps == ()


def test_there_is_no_angle_outside_the_edges() -> None:
    angle = shaft_angle(ramp_instants(50.0, 0.0, 10))
    outside = np.array([-0.01, angle.edge_time[-1] + 0.01])
    assert np.isnan(angle.at(outside)).all()
    assert np.isnan(angle.speed(outside)).all()
    assert np.isfinite(angle.at(angle.edge_time)).all()


@given(st.lists(st.floats(0.8, 1.25), min_size=4, max_size=20))
def test_the_angle_never_goes_back(intervals: list[float]) -> None:
    time = np.concatenate([[0.0], np.cumsum(intervals)])
    knots = TURN * np.arange(time.size, dtype=float)
    whole = ShaftAngle(time, knots, 0.0, (), ())
    fine = np.linspace(0.0, time[-1], 500)
    assert np.all(np.diff(whole.at(fine)) >= 0.0)
    assert whole.at(time) == pytest.approx(knots, abs=1e-9)
    assert np.all(monotone_slopes(time, knots) >= 0.0)


def test_a_sudden_change_of_speed_overshoots_nowhere() -> None:
    """Unlimited, the slope at the third knot would be (10·1 + 1·0.1)/11 = 0.92 of the fast secant, nine times the slow."""
    time = np.array([0.0, 1.0, 2.0, 12.0, 22.0])
    angle = TURN * np.arange(5.0)
    slopes = monotone_slopes(time, angle)
    secants = np.diff(angle) / np.diff(time)
    assert slopes[2] == pytest.approx(3.0 * secants[2])
    fine = ShaftAngle(time, angle, 0.0, (), ()).at(np.linspace(0.0, 22.0, 2000))
    assert np.all(np.diff(fine) >= -1e-12)


@pytest.mark.parametrize("acceleration", [0.0, 8.0])
def test_isolated_missing_and_extra_pulses_are_repaired_and_listed(acceleration: float) -> None:
    true = ramp_instants(100.0, acceleration, 60, first=0.02)
    extra = true[30] + 0.3 * (true[31] - true[30])
    early = true[45] - 0.15 * (true[45] - true[44])
    seen = np.sort(np.concatenate([np.delete(true, [10, 20, 21]), [extra, early]]))
    angle = shaft_angle(seen)
    assert [one.kind for one in angle.repairs] == ["missing", "missing", "missing", "extra", "extra"]
    assert [one.time for one in angle.repairs] == pytest.approx([true[10], true[20], true[21], extra, early], abs=3e-4)
    assert angle.gaps == ()
    assert angle.edge_time == pytest.approx(np.delete(true, [10, 20, 21]))
    time = np.linspace(true[0], true[-1], 777)
    passed = time - 0.02
    assert angle.at(time) == pytest.approx(100.0 * passed + acceleration * passed**2 / 2.0, abs=1e-8)


def test_many_missing_pulses_are_a_gap_and_the_phase_holds_behind_it() -> None:
    true = ramp_instants(100.0, 0.0, 60)
    angle = shaft_angle(np.delete(true, np.arange(20, 27)))
    (gap,) = angle.gaps
    assert (gap.start, gap.end) == pytest.approx((true[19], true[27]))
    assert angle.pieces == ((true[0], true[19]), (true[27], true[59]))
    assert np.isnan(angle.at(np.array([0.5 * (gap.start + gap.end)]))).all()
    behind = np.linspace(true[27], true[-1], 50)
    assert np.cos(angle.at(behind)) == pytest.approx(np.cos(100.0 * behind))


def test_behind_a_gap_several_marks_are_not_used() -> None:
    true = ramp_instants(100.0, 0.0, 90)
    angle = shaft_angle(np.delete(true, np.arange(60, 67)), pulses_per_turn=4)
    assert angle.edge_time[-1] == true[59]
    assert angle.edge_angle[-1] == pytest.approx(59 * TURN / 4)
    assert angle.speed(np.array([0.5])) == pytest.approx(25.0)


def test_a_first_pulse_that_is_none_is_not_the_reference() -> None:
    true = ramp_instants(100.0, 0.0, 30)
    angle = shaft_angle(np.concatenate([[true[0] - 0.02], true]))
    assert angle.edge_time == pytest.approx(true)


def test_jitter_is_measured() -> None:
    rng = np.random.default_rng(3)
    true = ramp_instants(100.0, 3.0, 4000)
    angle = shaft_angle(true + rng.normal(0.0, 0.0003, true.size) * 100.0 / (100.0 + 3.0 * true))
    assert angle.jitter == pytest.approx(0.03, rel=0.05)


def test_what_gives_no_angle_is_named() -> None:
    rng = np.random.default_rng(4)
    with pytest.raises(NoPulses, match="stays at -9"):
        read_keyphasor(np.full(1000, -9.0), sampling_rate=1000.0)
    with pytest.raises(NoPulses, match="no samples"):
        read_keyphasor(np.empty(0), sampling_rate=1000.0)
    with pytest.raises(NoPulses, match="2 pulses"):
        shaft_angle(np.array([0.0, 1.0]))
    with pytest.raises(KeyphasorError, match="1 samples"):
        read_keyphasor(np.array([1.0, math.nan]), sampling_rate=1000.0)
    with pytest.raises(ValueError, match="pulses_per_turn"):
        shaft_angle(ramp_instants(100.0, 0.0, 9), pulses_per_turn=0)
    with pytest.raises(InconsistentIntervals):
        read_keyphasor(rng.normal(size=20_000), sampling_rate=1000.0)
    with pytest.raises(InconsistentIntervals):
        shaft_angle(np.sort(rng.uniform(0.0, 10.0, 500)))
    with pytest.raises(InconsistentIntervals, match="scatter"):
        shaft_angle(ramp_instants(TURN, 0.0, 200) + rng.normal(0.0, 0.07, 200))
    with pytest.raises(InconsistentIntervals, match="no two intervals"):
        shaft_angle(np.cumsum([1.0, 3.0, 9.0, 27.0, 1.0, 9.0, 3.0, 27.0]))


@pytest.mark.parametrize("parts", [(0.3, 0.7), (0.49, 0.53), (1.0, 3.0, 9.0), (1.0, 1.0, 1.0, 1.3)])
@pytest.mark.parametrize("acceleration", [0.0, 5.0])
def test_several_marks_that_were_not_declared_are_named(parts: tuple[float, ...], acceleration: float) -> None:
    """Marks at fixed angles of a shaft at 100 rad/s and more."""
    marks = np.cumsum(parts) / sum(parts)
    turned = TURN * (np.arange(40)[:, None] + marks).ravel()
    times = 2.0 * turned / (100.0 + np.sqrt(100.0**2 + 2.0 * acceleration * turned))
    times = times + np.random.default_rng(6).normal(0.0, 5e-5, times.size)
    with pytest.raises(SeveralPulses, match=f"repeat every {len(parts)} pulses"):
        shaft_angle(times)


@pytest.mark.parametrize("seed", range(20))
def test_one_mark_is_not_taken_for_several(seed: int) -> None:
    """Jitter of 1 % of a turn, a steep ramp, few turns."""
    rng = np.random.default_rng(seed)
    times = ramp_instants(50.0, rng.uniform(-5.0, 5.0), int(rng.integers(9, 40)))
    assert shaft_angle(times + rng.normal(0.0, 0.01 * TURN / 50.0, times.size)).jitter > 0.0


def test_samples_that_are_no_numbers_cost_the_pulses_they_fall_on() -> None:
    instants = 0.0137 + 0.0413 * np.arange(20.0)
    time = np.arange(8500) / 10_000.0
    signal = trapezoids(time, instants)
    at = round(instants[7] * 10_000.0)
    signal[at - 15 : at + 15] = math.nan
    signal[4300:4305] = math.nan  # between two pulses
    angle = read_keyphasor(signal, sampling_rate=10_000.0)
    assert angle.edge_time == pytest.approx(np.delete(instants, 7), abs=1e-9)
    assert [one.kind for one in angle.repairs] == ["missing"]


@pytest.mark.parametrize("seed", range(20))
def test_random_pulses_never_pass_for_a_turning_shaft(seed: int) -> None:
    with pytest.raises(KeyphasorError):
        shaft_angle(np.sort(np.random.default_rng(seed).uniform(0.0, 10.0, 200)))


def test_several_pulses_per_turn_give_the_same_speed() -> None:
    time = np.arange(20_000) / 10_000.0
    instants = 0.01 + TURN / 60.0 / 3.0 * np.arange(55.0)
    angle = read_keyphasor(trapezoids(time, instants), sampling_rate=10_000.0, pulses_per_turn=3)
    assert angle.speed(np.array([0.5, 1.0, 1.5])) == pytest.approx(np.full(3, 60.0), rel=1e-9)
    assert angle.at(instants[:4]) == pytest.approx(TURN / 3.0 * np.arange(4), abs=1e-8)


def test_too_many_repairs_are_no_keyphasor() -> None:
    """Every fourth or fifth pulse missing: each one alone could be bridged."""
    true = ramp_instants(100.0, 0.0, 200)
    with pytest.raises(InconsistentIntervals, match="pulses missing or too many"):
        shaft_angle(np.delete(true, np.random.default_rng(8).choice(np.arange(3, 197), 45, replace=False)))
    # Pulses missing at even distances would be a pattern of several marks.
    some = np.random.default_rng(9).choice(np.arange(3, 197), 25, replace=False)
    assert len(shaft_angle(np.delete(true, some)).repairs) >= 20
