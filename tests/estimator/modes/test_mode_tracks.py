"""Modes followed over the speed: where their frequencies cross, where one is overdamped, and on the Chapter 3 train."""

import numpy as np
import pytest

from estimator.modes.eigenmodes import modes
from estimator.modes.mode_tracks import mode_tracks
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.rotor.system_matrices import system_matrices_over_speed
from tests.estimator.sweeps import MASS, single_mass
from tests.estimator.trains import Floats, chapter_3

SLOW, FAST = 80.0, 123.0
MACHINE = single_mass(natural_frequency=100.0, damping_ratio=0.02)
NAMES = [one.name for one in unknowns(MACHINE, assemble_rotor(MACHINE)).coefficients]


def vertical(speed: float, *, damping_ratio: float = 0.02) -> Floats:
    """Coefficients of the single mass, whose vertical natural frequency is the speed."""
    along_x = {"kxx": MASS * 100.0**2 / 2, "cxx": MASS * 0.02 * 100.0}
    values = along_x | {"kyy": MASS * speed**2 / 2, "cyy": MASS * damping_ratio * speed}
    return np.array([values.get(name.split(".")[-1], 0.0) for name in NAMES])


def lowest_pair(speeds: Floats, **changed: float) -> Floats:
    """Natural frequencies |λ| (G, n) of the tracks below 200 rad/s at all speeds."""
    matrices = system_matrices_over_speed(MACHINE, coefficients=lambda speed: vertical(speed, **changed))
    found = np.abs(mode_tracks(matrices, speeds, direction=1, highest=400.0).eigenvalue)
    return np.asarray(found[:, found.max(axis=0) < 200.0])


def test_modes_that_cross_keep_their_own_frequency() -> None:
    speeds = np.linspace(SLOW, FAST, 7)
    found = lowest_pair(speeds)
    translation = found[:, np.argsort(np.ptp(found, axis=0))]
    assert np.ptp(translation[:, 0]) < 1e-3 * FAST
    assert any(np.allclose(column, speeds, rtol=1e-3) for column in found.T)


def test_a_mode_that_is_overdamped_at_some_speeds_is_left_out() -> None:
    def matrices_of(speed: float) -> Floats:
        return vertical(speed, damping_ratio=0.02 if speed < 100.0 else 1.5)

    matrices = system_matrices_over_speed(MACHINE, coefficients=matrices_of)
    found = np.abs(mode_tracks(matrices, np.array([80.0, 90.0, 110.0, 120.0]), direction=1, highest=400.0).eigenvalue)
    assert any(np.allclose(column, 100.0, rtol=1e-3) for column in found.T)
    assert not any(np.allclose(column[:2], [80.0, 90.0], rtol=1e-3) for column in found.T)


def test_tracks_of_a_constant_train_are_its_modes_at_each_speed() -> None:
    machine = chapter_3()
    matrices = system_matrices_over_speed(machine)
    speeds = np.linspace(50.0, 600.0, 5)
    tracks = mode_tracks(matrices, speeds, direction=machine.direction, highest=2000.0)
    assert tracks.eigenvalue.shape[1] > 5
    for speed, row in zip(speeds, tracks.eigenvalue, strict=True):
        solved = modes(matrices(speed), spin=machine.direction * speed).eigenvalue
        assert max(np.abs(solved - one).min() / abs(one) for one in row) < 1e-9


def test_shapes_change_as_little_as_they_can() -> None:
    """Each overlaps the one before by 1, and is scaled with its left vector as a mode is."""
    machine = chapter_3()
    matrices = system_matrices_over_speed(machine)
    speeds = np.linspace(50.0, 600.0, 9)
    tracks = mode_tracks(matrices, speeds, direction=machine.direction, highest=2000.0)
    middle = 4
    here, there = tracks.modes[middle], tracks.modes[middle + 1]
    held = matrices(speeds[middle])
    resistance = held.damping + machine.direction * speeds[middle] * held.gyroscopic
    for k in range(here.eigenvalue.size):
        whole = (here.eigenvalue[k] + there.eigenvalue[k]) * held.mass + resistance
        assert np.vdot(here.left[:, k], whole @ there.shape[:, k]) == pytest.approx(1.0, abs=0.1)
        own = matrices(speeds[middle + 1])
        turned = own.damping + machine.direction * speeds[middle + 1] * own.gyroscopic
        momentum = (2 * there.eigenvalue[k] * own.mass + turned) @ there.shape[:, k]
        assert np.vdot(there.left[:, k], momentum) == pytest.approx(1.0, abs=1e-6)
