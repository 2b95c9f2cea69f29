"""Timoshenko's beam element, derived from the exact static bending line and integrated by Gauss's rule.

In one bending plane: deflection w and the section's slope β at either end. Without load along it w is a cubic, and
β = w' + (EI/κGA) w''' (moment balance with the shear force -EI w'''). Shear coefficient of a solid circle: Cowper, J. Appl.
Mech. 33 (1966) 335.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.train import Material

GAUSS = np.polynomial.legendre.leggauss(5)
"""Points and weights of the integration."""
ELEMENTS = 1000
"""Number of elements that are kept: a train is assembled anew for each guess of its films."""


@dataclass(frozen=True)
class Element:
    """Matrices (4, 4) over (w, β) at both ends: stiffness, inertia of translation, and of rotation about a diameter."""

    stiffness: Floats
    translation: Floats
    rotation: Floats


@lru_cache(maxsize=ELEMENTS)
def element(length: float, diameter: float, material: Material) -> Element:
    """Compute the matrices of a solid element of a length and a diameter [m]; nobody may change them."""
    area = np.pi / 4 * diameter**2
    bending = material.young * np.pi / 64 * diameter**4
    shear_modulus = material.young / (2 * (1 + material.poisson))
    shear = shear_modulus * area * 6 * (1 + material.poisson) / (7 + 6 * material.poisson)
    lag = bending / shear

    def powers(z: float) -> tuple[Floats, Floats]:
        """Deflection and slope at z of the four monomials 1, z, z², z³."""
        return np.array([1.0, z, z**2, z**3]), np.array([0.0, 1.0, 2 * z, 3 * z**2 + 6 * lag])

    ends = np.stack([*powers(0.0), *powers(length)])
    of_ends = np.linalg.inv(ends)
    points, weights = GAUSS
    stiffness, translation, rotation = np.zeros((3, 4, 4))
    shear_strain = np.array([0.0, 0.0, 0.0, -6 * lag]) @ of_ends
    for z, weight in zip((points + 1) / 2 * length, weights * length / 2, strict=True):
        deflection, slope = (row @ of_ends for row in powers(z))
        curvature = np.array([0.0, 0.0, 2.0, 6 * z]) @ of_ends
        stiffness += weight * (bending * np.outer(curvature, curvature) + shear * np.outer(shear_strain, shear_strain))
        translation += weight * material.density * area * np.outer(deflection, deflection)
        rotation += weight * material.density * np.pi / 64 * diameter**4 * np.outer(slope, slope)
    return Element(stiffness, translation, rotation)
