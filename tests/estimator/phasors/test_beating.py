"""Beats behind a resonance: found in a measured run-up and in integrated sweeps, and not in steady-state runs."""

import csv

import numpy as np
import pytest

from estimator.phasors.beating import find_beats
from estimator.runs.segmentation import RunKind
from estimator.simulation.coast_down import coast_down
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from estimator.units import rpm_to_rad_per_s
from tests.estimator.sweeps import linear_law, noisy, single_mass
from tests.estimator.trains import chapter_3
from tests.paths import DATA

MEASURED = DATA / "rk4_runup_1x.csv"


def test_measured_run_up_beats_at_the_rate_that_its_turns_tell() -> None:
    with MEASURED.open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    rpm = np.array([row["rpm"] for row in rows])
    phasor = np.array([row["amp_1x_V"] * np.exp(1j * np.radians(row["phase_1x_deg"])) for row in rows])[:, None]
    (beat,) = find_beats(rpm_to_rad_per_s(1.0) * rpm, phasor, np.isfinite(phasor))
    assert beat is not None
    assert 1570 < beat.natural_frequency / rpm_to_rad_per_s(1.0) < 1660
    assert beat.turns > 4
    # Speed times its step is the same in all rows: they are one turn apart, which gives the rate without a clock.
    a_turn = np.median(np.diff(rpm) * rpm[1:] / 60.0)
    assert beat.acceleration / rpm_to_rad_per_s(1.0) == pytest.approx(a_turn, rel=0.05)
    ringing = rpm[beat.deviation > 0.012]
    assert ringing.min() < 1600
    assert 2000 < ringing.max() < 2200


@pytest.mark.parametrize(
    ("first", "last", "duration", "damping_ratio"),
    [(100.0, 230.0, 8.0, 0.01), (230.0, 100.0, 8.0, 0.01), (230.0, 90.0, 10.0, 0.005)],
)
def test_ringing_oscillator_is_found_with_its_frequency_rate_and_size(
    first: float, last: float, duration: float, damping_ratio: float
) -> None:
    machine = single_mass(natural_frequency=150.0, damping_ratio=damping_ratio)
    moved = coast_down(machine, linear_law(first=first, last=last, duration=duration), step=2e-3)
    time = np.linspace(0.2, duration, 250)
    speed, phasor = moved.law.speed(time), noisy(moved.envelope(time), 1)
    beats = find_beats(speed, phasor, np.isfinite(phasor))
    for c, beat in enumerate(beats):
        assert beat is not None, c
        assert beat.natural_frequency == pytest.approx(150.0, rel=0.01)
        assert beat.acceleration == pytest.approx((last - first) / duration, rel=0.05)
        assert beat.damping_ratio == pytest.approx(damping_ratio, rel=0.4)


def test_steady_state_runs_do_not_beat() -> None:
    machine = chapter_3()
    found = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        kind: RunKind = "run-up" if seed % 2 else "run-down"
        _, speed = speed_law(machine, kind, duration=600.0, samples=(60, 150, 300)[seed % 3])
        phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
        found += sum(beat is not None for beat in find_beats(speed, phasor, np.isfinite(phasor)))
    assert found == 0  # of 160 channels


def test_noise_and_short_or_constant_runs_do_not_beat() -> None:
    rng = np.random.default_rng(4)
    speed = np.linspace(100.0, 300.0, 120)
    noise = rng.standard_normal((120, 4)) + 1j * rng.standard_normal((120, 4))
    assert find_beats(speed, noise, np.isfinite(noise)) == (None,) * 4
    assert find_beats(speed[:5], noise[:5], np.isfinite(noise[:5])) == (None,) * 4
    assert find_beats(np.full(120, 100.0), noise, np.isfinite(noise)) == (None,) * 4
    assert find_beats(speed, noise, np.zeros(noise.shape, dtype=bool)) == (None,) * 4
