"""Timoshenko shaft element with rotary inertia and gyroscopic effect.

Right-handed rotations about the axes: without shear θy = dx/dz and θx = -dy/dz. Source: Nelson, J. Mech. Design 102 (1980)
793, doi:10.1115/1.3254824 (thesis Appendix A); shear coefficient: Cowper, J. Appl. Mech. 33 (1966) 335,
doi:10.1115/1.3625046.
"""

import math

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

NODE_DOFS = 4
"""Degrees of freedom of a node: (x, y, θx, θy)."""
PLANE_DOFS = 2
"""Degrees of freedom of a node in one bending plane: (displacement, slope)."""


class PlaneElement(Struct, frozen=True, eq=False):
    """Matrices of one shaft element in one bending plane, over (displacement, slope) at either end.

    The gyroscopic matrix per unit spin speed between the planes is twice `rotation`: a thin slice's polar inertia is twice its
    diametral one.

    Attributes:
        translation: Inertia of translation (4, 4) [kg, kg m, kg m²].
        rotation: Inertia of rotation (4, 4) [kg, kg m, kg m²].
        stiffness: Bending stiffness (4, 4) [N/m, N, N m].
    """

    translation: NDArray[np.float64]
    rotation: NDArray[np.float64]
    stiffness: NDArray[np.float64]


def shear_coefficient(*, poisson_ratio: float, diameter_ratio: float) -> float:
    """Compute Cowper's shear coefficient of a hollow circular section; 6(1+ν)/(7+6ν) when it is solid.

    Source: Cowper (1966, doi:10.1115/1.3625046).

    Args:
        poisson_ratio: Poisson's ratio ν [-].
        diameter_ratio: Inner over outer diameter [-].

    Returns:
        Shear coefficient [-].
    """
    nu, m2 = poisson_ratio, diameter_ratio**2
    return 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)


def plane_element(
    *,
    length: float,
    outer_diameter: float,
    inner_diameter: float,
    young_modulus: float,
    density: float,
    poisson_ratio: float,
) -> PlaneElement:
    """Compute the matrices of a uniform shaft element (Nelson 1980, doi:10.1115/1.3254824; thesis Eq. A.1-A.15).

    Args:
        length: Length [m].
        outer_diameter: Outer diameter [m].
        inner_diameter: Inner diameter, 0 for a solid shaft [m].
        young_modulus: Young's modulus [N/m²].
        density: Density [kg/m³].
        poisson_ratio: Poisson's ratio [-].

    Returns:
        The matrices.
    """
    area = math.pi / 4 * (outer_diameter**2 - inner_diameter**2)
    second_moment = math.pi / 64 * (outer_diameter**4 - inner_diameter**4)
    shear_modulus = young_modulus / (2 * (1 + poisson_ratio))
    kappa = shear_coefficient(poisson_ratio=poisson_ratio, diameter_ratio=inner_diameter / outer_diameter)
    phi = 12 * young_modulus * second_moment / (kappa * shear_modulus * area * length**2)
    return PlaneElement(
        translation=density * area * _plane_translation(length, phi),
        rotation=density * second_moment * _plane_rotation(length, phi),
        stiffness=young_modulus * second_moment * _plane_stiffness(length, phi),
    )


def _plane_stiffness(length: float, phi: float) -> NDArray[np.float64]:
    """Compute the bending stiffness over (displacement, slope) at both ends, per unit EI (Eq. A.9-A.11)."""
    l = length  # noqa: E741 - the field's letter
    matrix = np.array(
        [
            [12, 6 * l, -12, 6 * l],
            [6 * l, (4 + phi) * l**2, -6 * l, (2 - phi) * l**2],
            [-12, -6 * l, 12, -6 * l],
            [6 * l, (2 - phi) * l**2, -6 * l, (4 + phi) * l**2],
        ]
    )
    return matrix / ((1 + phi) * l**3)


def _plane_translation(length: float, phi: float) -> NDArray[np.float64]:
    """Compute the translational inertia, per unit ρA (Eq. A.1-A.4)."""
    l = length  # noqa: E741
    m1 = 156 + 294 * phi + 140 * phi**2
    m2 = (22 + 38.5 * phi + 17.5 * phi**2) * l
    m3 = 54 + 126 * phi + 70 * phi**2
    m4 = (13 + 31.5 * phi + 17.5 * phi**2) * l
    m5 = (4 + 7 * phi + 3.5 * phi**2) * l**2
    m6 = (3 + 7 * phi + 3.5 * phi**2) * l**2
    matrix = np.array([[m1, m2, m3, -m4], [m2, m5, m4, -m6], [m3, m4, m1, -m2], [-m4, -m6, -m2, m5]])
    return matrix * l / (420 * (1 + phi) ** 2)


def _plane_rotation(length: float, phi: float) -> NDArray[np.float64]:
    """Compute the rotary inertia, per unit ρI (Eq. A.5-A.8)."""
    l = length  # noqa: E741
    r1 = 36.0
    r2 = (3 - 15 * phi) * l
    r3 = (4 + 5 * phi + 10 * phi**2) * l**2
    r4 = (-1 - 5 * phi + 5 * phi**2) * l**2
    matrix = np.array([[r1, r2, -r1, r2], [r2, r3, -r2, r4], [-r1, -r2, r1, -r2], [r2, r4, -r2, r3]])
    return matrix / (30 * l * (1 + phi) ** 2)
