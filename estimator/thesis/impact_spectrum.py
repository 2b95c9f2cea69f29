"""Impact test on a train at standstill (thesis §5.6): blows at some places, an accelerometer at another, the
spectrum's peaks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.phasors.half_power import peak_samples
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.parameters import dense, unknowns
from estimator.rotor.shaft_element import NODE_DOFS


@dataclass(frozen=True)
class Place:
    """A lateral direction at a station of a shaft.

    Attributes:
        shaft: Id of the shaft.
        station: Station from the driver-side end [m].
        angle_deg: Angle from +x towards +y [°].
        size: Size of a blow, negative against the direction [-].
    """

    shaft: str
    station: float
    angle_deg: float = 0.0
    size: float = 1.0


def impact_spectrum(
    machine: Machine, *, coefficients: Floats, blows: Sequence[Place], sensor: Place, frequency: Floats
) -> Complexes:
    """Compute the acceleration per impulse at a sensor after simultaneous, ideally short blows (thesis §5.6).

    The spectrum is -ω² sᵀ (K - ω²M + jωC)⁻¹ f.

    Args:
        machine: The machine.
        coefficients: Coefficients (K,), in the order of the machine's unknowns [SI].
        blows: Places of the blows.
        sensor: Place of the accelerometer.
        frequency: Frequencies (F,) [Hz].

    Returns:
        Spectrum (F,) [1/kg].

    Raises:
        ValueError: A place is no node of the model.
    """
    rotor = assemble_rotor(machine)
    elements = unknowns(machine, rotor).coefficients
    # Stiffness, damping and mass, by the power of jω that a coefficient goes with.
    matrices = [rotor.stiffness.copy(), rotor.damping.copy(), rotor.mass.copy()]
    for one, value in zip(elements, coefficients, strict=True):
        for left, right in one.pairs:
            matrices[one.order] += value * np.outer(*dense([left, right], rotor.size).T)
    stiffness, damping, mass = matrices
    force = np.sum([_direction(rotor, blow) for blow in blows], axis=0)
    reading = _direction(rotor, sensor)
    spectrum = np.empty(frequency.size, dtype=complex)
    for i, omega in enumerate(2.0 * math.pi * frequency):
        dynamic = stiffness - omega**2 * mass + 1j * omega * damping
        spectrum[i] = -(omega**2) * (reading @ np.linalg.solve(dynamic, force))
    return spectrum


def spectrum_peaks(frequency: Floats, spectrum: Complexes) -> tuple[Floats, Floats]:
    """Find the peaks of a spectrum.

    Args:
        frequency: Frequencies (F,), ascending [any unit].
        spectrum: Spectrum (F,) [any unit].

    Returns:
        Frequencies (k,) and magnitudes (k,) of the peaks, by ascending frequency [units of the arguments].
    """
    magnitude = np.abs(spectrum)
    peaks = peak_samples(magnitude)
    return frequency[peaks], magnitude[peaks]


def _direction(rotor: Rotor, place: Place) -> Floats:
    vector = np.zeros(rotor.size)
    x = NODE_DOFS * rotor.node(place.shaft, place.station)
    angle = math.radians(place.angle_deg)
    vector[x], vector[x + 1] = place.size * math.cos(angle), place.size * math.sin(angle)
    return vector
