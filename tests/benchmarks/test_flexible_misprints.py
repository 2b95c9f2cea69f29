"""The rotary inertia of Appendix A as printed, and what it explains."""

import math

import numpy as np
import pytest

from benchmarks.thesis.flexible.experiments import load
from benchmarks.thesis.flexible.misprints import natural_frequencies, with_printed_rotary_inertia
from benchmarks.thesis.flexible.printed import CRITICAL_SPEEDS

SUBJECT = load()
MISPRINTED = with_printed_rotary_inertia(SUBJECT)


def test_the_excess_is_that_of_a_rigid_tilt() -> None:
    """Both shafts tilted by one radian in a plane: kinetic energy ½ρ(Al - I) per unit length; moved sideways: none."""
    excess = MISPRINTED.train.mass - SUBJECT.train.mass
    station = np.tile(np.arange(6) * 0.25, 2)
    tilted, moved = np.zeros(48), np.zeros(48)
    tilted[0::4], tilted[3::4] = station, 1.0  # x = z, θy = 1
    moved[0::4] = 1.0
    area, second_moment = math.pi / 4 * 0.02**2, math.pi / 64 * 0.02**4
    assert tilted @ excess @ tilted == pytest.approx(2 * 1.25 * 7800 * (area * 0.25 - second_moment), rel=1e-9)
    assert abs(moved @ excess @ moved) < 1e-9
    in_y = np.zeros(48)
    in_y[1::4], in_y[2::4] = station, -1.0  # y = z, θx = -1
    assert in_y @ excess @ in_y == pytest.approx(tilted @ excess @ tilted, rel=1e-9)


def test_it_explains_the_printed_critical_speeds() -> None:
    printed = np.array(CRITICAL_SPEEDS)
    right = natural_frequencies(SUBJECT)[:8] / printed - 1
    misprinted = natural_frequencies(MISPRINTED)[:8] / printed - 1
    assert np.abs(misprinted).max() < 0.06
    assert np.sqrt(np.mean(misprinted**2)) < 0.035
    assert np.abs(right).max() > 0.6
