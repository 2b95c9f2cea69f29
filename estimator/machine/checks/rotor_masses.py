"""Masses of shafts and rotors as a document states them, by which forces, masses and unbalances are judged."""

import math

from estimator.machine.document import Machine
from estimator.machine.parts import Shaft
from estimator.units import GRAVITY

LEAST_DENSITY = 500.0
"""Density of a shaft below which its unit is doubted [kg/m³]; models of shafts without mass have one near zero."""


def shaft_mass(machine: Machine, shaft: Shaft) -> float | None:
    """Compute the mass of a shaft without its discs.

    Args:
        machine: The machine.
        shaft: One of its shafts.

    Returns:
        The mass [kg]; None where a density is so low that it is doubted itself.
    """
    materials = [machine.materials[one.material] for one in shaft.sections]
    if any(one.density < LEAST_DENSITY for one in materials):
        return None
    areas = [math.pi / 4 * (one.outer_diameter**2 - one.inner_diameter**2) for one in shaft.sections]
    parts = zip(shaft.sections, materials, areas, strict=True)
    return sum(material.density * area * section.length for section, material, area in parts)


def rotor_mass(machine: Machine, shaft: Shaft) -> float | None:
    """Compute the mass of a rotor: a shaft with its discs.

    Args:
        machine: The machine.
        shaft: One of its shafts.

    Returns:
        The mass [kg]; None where that of the shaft is not known.
    """
    own = shaft_mass(machine, shaft)
    return None if own is None else own + math.fsum(disc.mass for disc in machine.discs if disc.shaft == shaft.id)


def train_weight(machine: Machine) -> float | None:
    """Compute the weight of all rotors with what is on them.

    Args:
        machine: The machine.

    Returns:
        The weight [N]; None where that of a shaft is not known.
    """
    rotors = [rotor_mass(machine, shaft) for shaft in machine.shafts]
    if any(mass is None for mass in rotors):
        return None
    halves = [half.mass for one in machine.couplings for half in (one.driver_half, one.driven_half) if half is not None]
    return GRAVITY * math.fsum([*filter(None, rotors), *halves])
