"""Stability of a train on its films: its least damped mode at a speed, and the speed from which on it would whirl.

Films act by their eight coefficients at the equilibrium (Lund, J. Tribol. 109 (1987) 37), tilting pads by states of their own.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.modes.eigenmodes import OSCILLATING, damping_ratio, log_decrement
from estimator.rotor.modal_reduction import modal_basis
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain
from estimator.statics.pad_states import state_matrix_with_pads

HIGHEST_MODE = 2.0
"""Highest frequency of modes that are told, as a multiple of the spin speed [-]: films whirl below it."""
HIGHEST_GROWING = 10.0
"""Highest frequency of modes that may grow, as such a multiple [-]: large cross-coupled terms of other bearings raise it."""
GROWING = -1e-5
"""Logarithmic decrement below which a mode grows, and is not merely undamped [-]."""
SPEED_STEP = 1.05
"""Factor from speed to speed in the search for the onset of whirl [-]."""
EXACT = 1e-3
"""Relative width of the range in which the onset is known in the end [-]."""


@dataclass(frozen=True)
class LeastDampedWhirl:
    """The least damped mode of a train on its films.

    Attributes:
        speed: Spin speed, without sign [rad/s].
        frequency: Its damped natural frequency [rad/s].
        log_decrement: Its logarithmic decrement, negative where it grows [-].
    """

    speed: float
    frequency: float
    log_decrement: float


def least_damped_whirl(
    machine: Machine, equilibrium: FilmEquilibrium, *, coefficients: Floats | None = None, up_to: float = HIGHEST_MODE
) -> LeastDampedWhirl | None:
    """Solve for the least damped mode at an equilibrium; pads that tilt are degrees of freedom of their own.

    Source: Lund, J. Tribol. 109 (1987) 37, pads by J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064.

    Args:
        machine: The machine.
        equilibrium: Its equilibrium at a speed.
        coefficients: Coefficients (K,) of the machine at that speed, of films that deviate from their model [SI]. None for
            those of the equilibrium.
        up_to: Highest frequency of modes that are looked at, as a multiple of the spin speed [-].

    Returns:
        The mode; None where none oscillates in the range of interest.
    """
    highest = up_to * equilibrium.speed
    basis = modal_basis(machine, highest)
    roots = np.linalg.eigvals(state_matrix_with_pads(machine, equilibrium, basis, coefficients=coefficients))
    slow = roots[(roots.imag > OSCILLATING * np.abs(roots)) & (roots.imag <= highest)]
    if slow.size == 0:
        return None
    root = slow[[int(np.argmin(damping_ratio(slow)))]]
    return LeastDampedWhirl(equilibrium.speed, float(root[0].imag), float(log_decrement(root)[0]))


def whirl_onset(machine: Machine, train: FilmTrain, *, first: float, last: float) -> float | None:
    """Find the lowest speed from which on a mode grows.

    Args:
        machine: The machine.
        train: Its films and statics.
        first: Speed at which the search begins [rad/s].
        last: Speed at which it ends [rad/s].

    Returns:
        The speed [rad/s]; None where no mode grows up to the last one.
    """
    low, high = first, first
    while not _grows(machine, train, high):
        if high >= last:
            return None
        low, high = high, min(last, SPEED_STEP * high)
    if high == first:
        return first
    while high - low > EXACT * high:
        middle = (low + high) / 2
        low, high = (low, middle) if _grows(machine, train, middle) else (middle, high)
    return high


def _grows(machine: Machine, train: FilmTrain, speed: float) -> bool:
    equilibrium = train.equilibrium(speed)
    if equilibrium is None:
        return False
    mode = least_damped_whirl(machine, equilibrium, up_to=HIGHEST_GROWING)
    return mode is not None and mode.log_decrement < GROWING
