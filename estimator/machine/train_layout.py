"""Layout of a train: place and size of its parts, for a drawing to scale."""

import math
from dataclasses import dataclass

from estimator.machine.document import Machine
from estimator.machine.parts import Disc

STEEL = 7850.0
"""Density for the size of a disc of which only mass and inertia are known [kg/m³]."""


@dataclass(frozen=True)
class DiscBody:
    """A plain disc with the mass and polar inertia of the document.

    Attributes:
        radius: Radius [m]; None without polar inertia.
        width: Width [m]; None without polar inertia.
    """

    radius: float | None
    width: float | None


def shaft_begins(machine: Machine) -> dict[str, float]:
    """Compute the distance of each shaft's driver-side end from that of the train.

    Shafts that no coupling joins to others follow behind.

    Args:
        machine: The machine.

    Returns:
        Distance by shaft id, from driver to driven [m].
    """
    follows = {coupling.driver: coupling.driven for coupling in machine.couplings}
    driven = set(follows.values())
    begins: dict[str, float] = {}
    end = 0.0
    firsts = [shaft.id for shaft in machine.shafts if shaft.id not in driven]
    for first in [*firsts, *(shaft.id for shaft in machine.shafts)]:
        shaft: str | None = first
        while shaft is not None and shaft not in begins:
            begins[shaft] = end
            end += machine.shaft(shaft).length
            shaft = follows.get(shaft)
    return begins


def disc_body(disc: Disc) -> DiscBody:
    """Compute the size of a solid steel disc with this mass and polar inertia: I_p = m r²/2, m = ρ π r² b.

    Args:
        disc: The disc.

    Returns:
        Its size [m].
    """
    if disc.polar_inertia <= 0.0:
        return DiscBody(None, None)
    radius = math.sqrt(2.0 * disc.polar_inertia / disc.mass)
    return DiscBody(radius, disc.mass / (STEEL * math.pi * radius**2))
