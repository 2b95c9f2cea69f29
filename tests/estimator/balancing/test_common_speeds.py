"""Speeds to balance at: they cover the range, and are among those where the machine responds most."""

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.balancing.vectors_at_speeds import WINDOW, common_speeds
from estimator.phasors.measurement import Measurement

RESONANCES = (190.0, 260.0)
"""Speeds at which the channels respond most [rad/s]."""
LOWEST, HIGHEST = 30.0, 320.0


def run_at(speed: Floats) -> Measurement:
    phasor = np.stack([1e-5 / (1.0 - (speed / peak) ** 2 + 0.03j) for peak in RESONANCES], axis=-1)
    return Measurement.of(speed=speed, phasor=phasor)


def run_down(*, samples: int) -> Floats:
    """Speeds of a run-down whose braking is proportional to the speed, evenly in time [rad/s]."""
    return 315.0 * np.exp(-np.linspace(0.0, 2.3, samples))


@pytest.mark.parametrize("samples", [40, 120, 200, 1000])
def test_a_run_down_sampled_evenly_in_time_is_covered_in_speed_with_its_resonances(samples: int) -> None:
    """By the number of the sample five of ten speeds lay in the lowest fifth, and none within 5 % of a resonance."""
    run = run_at(run_down(samples=samples))
    found = common_speeds([run, run], lowest=LOWEST, highest=HIGHEST)
    assert found.size == 10
    assert np.all(np.diff(found) > 0.0)
    spacing = 2.3 / samples
    for peak in RESONANCES:
        assert np.min(np.abs(found / peak - 1.0)) <= WINDOW + spacing
    assert np.max(np.diff(found)) < 0.25 * (found[-1] - found[0])
    assert np.count_nonzero(found < 31.5 + 0.2 * (315.0 - 31.5)) <= 3


def test_dwells_are_all_taken_where_they_are_few() -> None:
    dwells = np.repeat([100.0, 150.0, 190.0, 300.0], 20) * (1.0 + 1e-3 * np.sin(np.arange(80)))
    found = common_speeds([run_at(dwells), run_at(dwells)], lowest=LOWEST, highest=HIGHEST)
    assert found == pytest.approx([100.0, 150.0, 190.0, 300.0], rel=2e-3)


def test_of_many_dwells_those_at_the_resonances_are_among_them() -> None:
    dwells = np.concatenate([np.linspace(35.0, 100.0, 30), np.linspace(120.0, 310.0, 20)])
    found = common_speeds([run_at(dwells), run_at(dwells)], lowest=LOWEST, highest=HIGHEST)
    assert found.size == 10
    for peak in RESONANCES:
        assert np.min(np.abs(found - peak)) <= 6.0
    assert np.max(np.diff(found)) < 70.0
