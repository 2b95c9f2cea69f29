"""Whirl: the ellipse that a point of the shaft runs through, and the sense in which a whole mode whirls.

x + jy = z₊ e^{jωt} + z₋ e^{-jωt} with z₊ = (X + jY)/2 and z₋ = conj(X - jY)/2: two circles, one turning from +x to +y, one
against it (Childs, Turbomachinery Rotordynamics, Wiley 1993, §1.4).
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.rotor.shaft_element import NODE_DOFS


@dataclass(frozen=True)
class Orbit:
    """Ellipses, arrays of any one shape (...).

    Attributes:
        semi_major: Semi-major axes (...), not negative [unit of the phasors].
        semi_minor: Semi-minor axes (...), positive when the point whirls with the rotation, negative against it [unit of the
            phasors].
        inclination: Inclinations (...) of the major axis from +x towards +y, in (-π/2, π/2] [rad].
        delay: Phases ωt (...) at which the point is at the end of the major axis that lies at `inclination` [rad].
    """

    semi_major: Floats
    semi_minor: Floats
    inclination: Floats
    delay: Floats


def orbit(x: Complexes, y: Complexes, *, direction: int) -> Orbit:
    """Compute the orbits of points from their displacement phasors (Childs 1993, §1.4).

    Args:
        x: Phasors (...) along x [any unit].
        y: Phasors (...) along y [unit of x].
        direction: Sense of rotation, +1 from +x to +y, else -1.

    Returns:
        The ellipses.
    """
    with_axes = (np.asarray(x) + 1j * np.asarray(y)) / 2
    against_axes = np.conj(np.asarray(x) - 1j * np.asarray(y)) / 2
    # On the major axis both circles point the same way.
    inclination = (np.angle(with_axes) + np.angle(against_axes)) / 2
    delay = (np.angle(against_axes) - np.angle(with_axes)) / 2
    turns = np.ceil(inclination / np.pi - 0.5)
    return Orbit(
        semi_major=np.abs(with_axes) + np.abs(against_axes),
        semi_minor=direction * (np.abs(with_axes) - np.abs(against_axes)),
        inclination=inclination - np.pi * turns,
        delay=delay + np.pi * turns,
    )


def whirl(shapes: Complexes, mass: Floats, *, direction: int) -> Floats:
    """Compute how far each mode whirls: +1 circular with the rotation, -1 circular against it, 0 in a plane or undecided.

    It is the mean over the train: a mode may whirl forward in one place and backward in another.

    Args:
        shapes: Displacements (N, n) of all degrees of freedom in n modes [any unit].
        mass: Mass matrix (N, N), by which the nodes count [SI].
        direction: Sense of rotation, +1 from +x to +y, else -1.

    Returns:
        Whirl (n,), -1 to 1 [-].
    """
    turned = np.empty_like(shapes)
    # (x, y, θx, θy) turned by 90° from +x to +y.
    for dof, source, sign in ((0, 1, -1.0), (1, 0, 1.0), (2, 3, -1.0), (3, 2, 1.0)):
        turned[dof::NODE_DOFS] = sign * shapes[source::NODE_DOFS]
    weighted = mass @ shapes
    with_rotation = np.imag(np.sum(np.conj(weighted) * turned, axis=0))
    return np.asarray(direction * with_rotation / np.real(np.sum(np.conj(weighted) * shapes, axis=0)))
