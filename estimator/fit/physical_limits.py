"""What no machine that ran can have: modes that grow at its running speeds, and films that give energy back.

A fit may end there all the same, where data are few or the model is wrong; balancing masses computed from such a model are
worthless.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.machine.scaled_materials import with_scaled_materials
from estimator.modes.eigenmodes import damping_ratio
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.system_matrices import system_matrices
from estimator.units import rad_per_s_to_rpm

SPEEDS = 5
"""Number of speeds of the range at which modes are looked at."""
HIGHEST_MODE = 2.0
"""Multiple of the highest speed up to which modes are looked at [-]: coefficients are known at the speeds that were run."""
SMALLEST_DAMPING_RATIO = -1e-4
"""Damping ratio below which a mode grows [-]; an undamped one is computed with rounding errors."""


SMALLEST_ROOT = 1e-3
"""Part of that frequency below which a root is zero but for rounding [-]: a train that nothing holds."""


@dataclass(frozen=True)
class GrowingMode:
    """A mode that grows.

    Attributes:
        speed: Spin speed [rad/s, without sign].
        frequency: Its damped natural frequency [rad/s].
        damping_ratio: Its damping ratio, negative [-].
    """

    speed: float
    frequency: float
    damping_ratio: float

    @property
    def words(self) -> str:
        """Return the sentence about it."""
        speed, frequency = rad_per_s_to_rpm(self.speed), rad_per_s_to_rpm(self.frequency)
        return (
            f"not physically possible: at {speed:.0f} rpm a mode of {frequency:.0f} cycles per minute grows (damping ratio "
            f"{self.damping_ratio:.2g}), and the machine ran there"
        )


def growing_mode(
    machine: Machine, coefficients: Callable[[Floats], Floats], factors: Mapping[str, float], *, speed: Floats
) -> GrowingMode | None:
    """Look for a mode that grows at speeds at which the machine ran.

    Args:
        machine: The machine.
        coefficients: Function that returns the coefficients at some speeds (G,) [rad/s]: (K,), or (G, K) when one of them
            follows the speed [SI].
        factors: Factors on its materials' moduli and densities, by name [-].
        speed: Speeds of the samples (S,), without sign [rad/s].

    Returns:
        The mode that grows most; None where all decay.
    """
    low, high = float(speed.min()), float(speed.max())
    speeds = np.linspace(low, high, SPEEDS) if high > low else np.array([low])
    held = coefficients(speeds)
    if held.ndim == 1:
        # Gyroscopic moments alone change the modes.
        speeds, held = speeds[[0, -1]], np.stack([held, held])
    scaled = with_scaled_materials(machine, factors) if factors else machine
    basis = modal_basis(scaled, HIGHEST_MODE * high)
    worst: GrowingMode | None = None
    for spin, values in zip(speeds.tolist(), held, strict=True):
        matrices = system_matrices(scaled, coefficients=values, basis=basis)
        found = _slow(np.linalg.eigvals(matrices.state_matrix(spin=machine.direction * spin)), HIGHEST_MODE * high)
        ratio = damping_ratio(found)
        if found.size and ratio.min() < min(SMALLEST_DAMPING_RATIO, worst.damping_ratio if worst else 0.0):
            k = int(np.argmin(ratio))
            worst = GrowingMode(spin, float(found[k].imag), float(ratio[k]))
    return worst


def _slow(roots: Complexes, highest: float) -> Complexes:
    """Return one root of each pair, and real ones, that are no faster than the highest frequency."""
    return np.asarray(roots[(roots.imag >= 0.0) & (roots.imag <= highest) & (np.abs(roots) > SMALLEST_ROOT * highest)])
