"""Raw waveforms of a simulated machine for the tests of the edge agent: a keyphasor and probes whose phasors are known."""

import math
from typing import Any

import numpy as np

from estimator.arrays import Complexes, Floats

RATE = 2048.0
START_NS = 1_700_000_000 * 1_000_000_000
"""14 November 2023, 22:13:20 UTC."""
FLANK = 0.02
PULSE = 0.1


def shaft(seconds: Floats, *, rpm: float, ramp: float = 0.0) -> Floats:
    """Angle [rad] at constant acceleration [rpm/s], the mark a third of a turn from zero."""
    speed, acceleration = (value * math.pi / 30.0 for value in (rpm, ramp))
    return np.asarray(2.0 + speed * seconds + acceleration * seconds**2 / 2.0)


def keyphasor(angle: Floats, *, marks: int = 1) -> Floats:
    """-10 V, and -2 V in a pulse whose rising flank passes the middle at angle 0."""
    part = (angle * marks / (2.0 * math.pi) + 0.5) % 1.0 - 0.5
    height = np.clip(part / FLANK + 0.5, 0.0, 1.0) - np.clip((part - PULSE) / FLANK + 0.5, 0.0, 1.0)
    return np.asarray(-10.0 + 8.0 * height)


def true_phasors(channels: int) -> tuple[Complexes, Complexes]:
    """1× and 2× of each channel [V]."""
    number = np.arange(channels)
    first = (0.5 + 0.1 * number) * np.exp(1j * (0.3 + number))
    return first, 0.2 * first * np.exp(0.7j)


def probes(angle: Floats, channels: int, *, noise: float = 0.0, seed: int = 0) -> Floats:
    """Waveforms (C, N) around -9 V."""
    first, second = true_phasors(channels)
    turning = np.exp(1j * angle)
    clean = -9.0 + (first[:, None] * turning + second[:, None] * turning**2).real
    return np.asarray(clean + noise * np.random.default_rng(seed).normal(size=clean.shape))


def recorded(seconds: float, *, channels: int = 2, rpm: float = 1800.0, ramp: float = 0.0, noise: float = 0.0) -> Floats:
    """Keyphasor and probes (1 + C, N)."""
    at = np.arange(round(seconds * RATE)) / RATE
    angle = shaft(at, rpm=rpm, ramp=ramp)
    return np.vstack([keyphasor(angle), probes(angle, channels, noise=noise)])


def edge_document(**changes: Any) -> dict[str, Any]:
    """A configuration of the agent for the waveforms above; their columns are K, A and B."""
    return {
        "plant": "plant-1",
        "machine": "pump-7",
        "speed_range": {"minimum_rpm": 300, "maximum_rpm": 3000},
        "waveforms": {"files": [{"path": "run.npz", "start": "2023-11-14T22:13:20Z"}], "sampling_rate": RATE},
        "keyphasor": {"column": "K"},
        "channels": [
            {"probe": "B2X", "column": "A", "sensitivity": 8000.0},
            {"probe": "B2Y", "column": "B", "sensitivity": 4000.0},
        ],
        "rails": [-20.0, -1.0],
        "block": {"seconds": 0.5},
        "log": {"path": "edge.log"},
    } | changes
