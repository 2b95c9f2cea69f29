"""Machines that are swept through resonance in tests: one of a single degree of freedom, and lightly damped Chapter 3."""

from functools import cache
from typing import Any

import numpy as np
import scipy.special
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import Measurement
from estimator.phasors.recorded_run import RecordedRun
from estimator.phasors.speed_law import SpeedLaw
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.simulation.coast_down import CoastDown, coast_down
from tests.estimator.trains import chapter_3_document

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
MASS, UNBALANCE = 10.0, 2e-4


def single_mass(*, natural_frequency: float, damping_ratio: float) -> Machine:
    """A rigid, weightless shaft on two equal isotropic bearings with a disc in its middle: x and y each one oscillator."""
    stiffness = MASS * natural_frequency**2 / 2
    damping = MASS * damping_ratio * natural_frequency
    lateral = {
        "kxx": stiffness,
        "kxy": 0.0,
        "kyx": 0.0,
        "kyy": stiffness,
        "cxx": damping,
        "cxy": 0.0,
        "cyx": 0.0,
        "cyy": damping,
    }
    document: dict[str, Any] = {
        "id": "single-mass",
        "plant": "tests",
        "name": "single mass",
        "speed_range": {"minimum_rpm": 100, "maximum_rpm": 6000},
        "materials": {"stiff": {"young_modulus": 1e14, "density": 1e-3}},
        "shafts": [{"id": "S", "sections": [{"length": 0.4, "outer_diameter": 0.1, "material": "stiff"}]}],
        "element_length": 0.2,
        "discs": [
            {"id": "D", "shaft": "S", "station": 0.2, "mass": MASS, "diametral_inertia": 0.1, "polar_inertia": 0.2,
             "unbalance": {"magnitude": UNBALANCE, "angle_deg": 0}}
        ],
        "bearings": [{"id": f"B{i}", "shaft": "S", "station": station, **lateral} for i, station in enumerate((0.0, 0.4))],
        "probes": [
            {"id": "X", "shaft": "S", "station": 0.2, "angle_deg": 0},
            {"id": "Y", "shaft": "S", "station": 0.2, "angle_deg": 90},
        ],
        "noise": {"relative": 0.01, "floor": 1e-8},
    }  # fmt: skip
    return parse_machine(document)


def single_mass_envelope(
    time: Floats, *, first: float, rate: float, natural_frequency: float, damping_ratio: float
) -> Complexes:
    """Envelope (n,) [m] of the oscillator that starts in the steady state of `first` [rad/s] and changes speed by `rate`.

    (Ω² - jα) e^{jφ} is -d²/dt² e^{jφ}; what is left after integrating by parts twice is ∫ e^{jφ - λs} ds, a complex error
    function, written with the Faddeeva function on the side where that does not overflow.
    """
    damped = natural_frequency * np.sqrt(1 - damping_ratio**2)
    roots = (-damping_ratio * natural_frequency + 1j * damped, -damping_ratio * natural_frequency - 1j * damped)
    phase = first * time + rate * time**2 / 2
    speed = first + rate * time
    size = UNBALANCE / MASS
    start = size * first**2 / (natural_frequency**2 - first**2 + 2j * damping_ratio * natural_frequency * first)
    motion = np.zeros(time.size, dtype=complex)
    for root, other in (roots, roots[::-1]):
        # q = Σ e^{λt} (start + driven) / (λ - λ'); q̇(0) is that of the steady state.
        free = start * (1j * first - other)
        kappa = np.sqrt(-0.5j * rate + 0j)
        edge = (first + 1j * root) / rate
        z = kappa * (time + edge)
        side = np.where(z.real < 0, -1.0, 1.0)
        exponent = 1j * phase - root * time
        inner = -side * np.exp(exponent) * scipy.special.wofz(1j * side * z)
        # erf = side - …: its constants cancel unless the side changes, which is what rings.
        constant = np.exp(-0.5j * rate * edge**2) * np.where(side == side[0], 0.0, side - side[0])
        whole = np.sqrt(np.pi) / (2 * kappa) * (inner - inner[0] + constant)
        boundary = (1j * speed + root) * np.exp(exponent)
        driven = -size * (boundary - boundary[0] + root**2 * whole)
        motion += np.exp(root * time) * (free + driven) / (root - other)
    return np.asarray(motion * np.exp(-1j * phase))


def linear_law(*, first: float, last: float, duration: float) -> SpeedLaw:
    """Constant acceleration between two speeds [rad/s]."""
    return SpeedLaw.through(np.array([0.0, duration]), np.array([first, last]))


def light_chapter_3() -> Machine:
    """Chapter 3 with half of its damping: modes of 1 to 10 %."""
    document = chapter_3_document()
    for part in (*document["bearings"], *document["couplings"]):
        for name in ("cxx", "cxy", "cyx", "cyy"):
            part[name] *= 0.5
    return parse_machine(document)


def steady(machine: Machine, speed: Floats) -> Complexes:
    """Steady-state phasors (S, m) of the nominal machine."""
    train = condense(machine, speed=speed, direction=np.full(speed.size, float(machine.direction)))
    coefficients = np.array([one.expected for one in train.unknowns.coefficients])
    excitations = np.array([one.nominal or 0.0 for one in train.unknowns.excitations])
    return response(train, coefficients=coefficients, excitations=excitations)


@cache
def fast_coast_down() -> CoastDown:
    """Light Chapter 3 from 5500 to 500 rpm in 100 s."""
    return coast_down(light_chapter_3(), linear_law(first=576.0, last=52.0, duration=100.0), step=4e-3)


def recorded(
    time: Floats | None, speed: Floats, phasor: Complexes, channels: tuple[str, ...]
) -> tuple[RecordedRun, Measurement]:
    """A run in which everything is good, and its measurement."""
    status = np.full(phasor.shape, ChannelStatus.GOOD, np.uint8)
    measurement = Measurement.of(speed=speed, phasor=phasor)
    return RecordedRun(time, speed, phasor, status, measurement.scatter, channels), measurement


def noisy(clean: Complexes, seed: int, relative: float = 0.01) -> Complexes:
    """Add circular complex noise of a part of each amplitude."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)
    return np.asarray(clean + relative / np.sqrt(2) * np.abs(clean) * noise)
