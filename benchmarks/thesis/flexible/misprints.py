"""The flexible train with the rotary inertia of Appendix A as it is printed."""

import math
from dataclasses import replace

import numpy as np

from benchmarks.thesis.flexible.experiments import Subject
from estimator.arrays import Floats
from estimator.machine.parts import Material, Section
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.shaft_element import NODE_DOFS, shear_coefficient


def with_printed_rotary_inertia(subject: Subject) -> Subject:
    """Return the train whose elements have the rotary inertia of Eq. A.5-A.8: ρAl where ρI belongs, 10⁴ times too much
    here."""
    rotor = assemble_rotor(subject.machine)
    mass = subject.train.mass.copy()
    for shaft in subject.machine.shafts:
        (section,) = shaft.sections
        material = subject.machine.materials[section.material]
        stations = rotor.stations[shaft.id]
        for k, length in enumerate(np.diff(stations)):
            first = NODE_DOFS * (rotor.first_node[shaft.id] + k)
            block = slice(first, first + 2 * NODE_DOFS)
            mass[block, block] += _excess(section, material, float(length))
    return replace(subject, train=replace(subject.train, mass=mass))


def natural_frequencies(subject: Subject) -> Floats:
    """Return the natural frequencies [rad/s] at rest without damping, ascending."""
    train = subject.train
    elastic = ~train.viscous
    unknown = (train.left[:, elastic] * subject.coefficients[elastic]) @ train.right[:, elastic].T
    squares = np.linalg.eigvals(np.linalg.solve(train.mass, train.stiffness + unknown)).real
    return np.asarray(np.sqrt(np.sort(squares)))


def _excess(section: Section, material: Material, length: float) -> Floats:
    """Return the excess that the printed prefix adds to the mass matrix (8, 8) of an element of solid shaft."""
    area = math.pi / 4 * section.outer_diameter**2
    second_moment = math.pi / 64 * section.outer_diameter**4
    shear_modulus = material.young_modulus / (2 * (1 + material.poisson_ratio))
    kappa = shear_coefficient(poisson_ratio=material.poisson_ratio, diameter_ratio=0.0)
    phi = 12 * material.young_modulus * second_moment / (kappa * shear_modulus * area * length**2)
    prefix = material.density * (area * length - second_moment)
    return np.asarray(prefix * _rotation(length, phi))


def _rotation(length: float, phi: float) -> Floats:
    """Return [M_r] of Eq. A.5-A.8 without its prefix, over (x, y, φx, φy) of both ends."""
    stretch = 6 / (5 * length)
    tilt = 1 / 10 - phi / 2
    near = length * (2 / 15 + phi / 6 + phi**2 / 3)
    far = length * (-1 / 30 - phi / 6 + phi**2 / 6)
    plane = np.array([[stretch, tilt, -stretch, tilt], [tilt, near, -tilt, far], [-stretch, -tilt, stretch, -tilt]])
    plane = np.vstack([plane, [tilt, far, -tilt, near]])
    matrix = np.zeros((8, 8))
    turned = np.diag([1.0, -1.0, 1.0, -1.0])
    matrix[np.ix_([0, 3, 4, 7], [0, 3, 4, 7])] = plane
    matrix[np.ix_([1, 2, 5, 6], [1, 2, 5, 6])] = turned @ plane @ turned
    return matrix / (1 + phi) ** 2
