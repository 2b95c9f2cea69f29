"""Speed readings: medians of three, and the noise that they show."""

import numpy as np
import pytest

from estimator.runs.speed_filter import NO_READINGS, SpeedReadings, add_reading

SECOND = 1_000_000_000


def follow(speeds: list[float], times: list[float] | None = None) -> tuple[SpeedReadings, list[tuple[float, float]]]:
    readings, believed = NO_READINGS, []
    for second, speed in zip(times or range(1, len(speeds) + 1), speeds, strict=True):
        readings, new = add_reading(readings, time=round(second * SECOND), speed=speed)
        if new is not None:
            believed.append((new[0] / SECOND, new[1]))
    return readings, believed


def test_a_steady_change_is_believed_as_it_is_one_reading_later() -> None:
    assert follow([10.0, 20.0, 30.0, 40.0])[1] == [(1, 10.0), (2, 20.0), (3, 30.0)]


def test_one_wrong_reading_does_nothing() -> None:
    assert follow([10.0, 11.0, 300.0, 13.0, 14.0, 0.0, 16.0])[1] == [(1, 10), (2, 11), (3, 13), (4, 14), (5, 13), (6, 14)]


def test_no_steady_acceleration_passes_for_noise_whatever_the_spacing() -> None:
    times = np.cumsum(np.random.default_rng(1).uniform(0.1, 3.0, 100))
    readings, _ = follow((5.0 * times).tolist(), times.tolist())
    assert readings.noise == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (0.1, 3.0)])
@pytest.mark.parametrize("slope", [0.0, 2.0])
def test_the_noise_is_found_within_a_fifth_on_average(spacing: tuple[float, float], slope: float) -> None:
    found = []
    for seed in range(50):
        rng = np.random.default_rng(seed)
        times = np.cumsum(rng.uniform(*spacing, 300))
        readings, _ = follow((300.0 + slope * times + 3.0 * rng.standard_normal(300)).tolist(), times.tolist())
        found.append(readings.noise / 3.0)
    assert float(np.mean(found)) == pytest.approx(1.0, abs=0.2)
    assert 0.6 < min(found) <= max(found) < 1.6


def test_a_wrong_reading_is_soon_forgotten() -> None:
    quiet = [100.0] * 200
    readings, _ = follow([*quiet, 0.0, *quiet])
    assert readings.noise < 1.0
