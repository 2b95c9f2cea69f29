"""A rigid rotor on two equal bearings whose bounce and conical modes are known in closed form."""

import math

from estimator.machine.document import Machine, parse_machine
from tests.estimator.trains import one_disc_document

LENGTH, STIFFNESS, MASS = 0.2, 1e5, 5.0
"""Between the bearings [m]; of each bearing [N/m]; of the disc in the middle [kg]. The shaft weighs 6e-5 kg."""


def rigid_rotor(*, diametral: float, polar: float, damping: float = 1e-9) -> Machine:
    """The rotor with moments of inertia [kg m²] and bearing damping [N s/m]."""
    return parse_machine(
        one_disc_document(
            length=LENGTH,
            diameter=0.2,
            density=1e-2,
            mass=MASS,
            diametral_inertia=diametral,
            polar_inertia=polar,
            kxx=STIFFNESS,
            kyy=STIFFNESS,
            cxx=damping,
            cyy=damping,
            element_length=LENGTH / 2,
        )
    )


def bounce() -> float:
    """Frequency [rad/s] of the mode in which both ends move together."""
    return math.sqrt(2 * STIFFNESS / MASS)


def tilting_stiffness() -> float:
    """Moment per tilt [N m/rad]."""
    return 2 * STIFFNESS * (LENGTH / 2) ** 2


def conical(spin: float, *, diametral: float, polar: float, forward: bool) -> float:
    """Frequency [rad/s] of a conical mode: I_d ω² ∓ I_p Ω ω - k = 0."""
    turn = (1 if forward else -1) * polar * spin
    return (turn + math.sqrt(turn**2 + 4 * diametral * tilting_stiffness())) / (2 * diametral)
