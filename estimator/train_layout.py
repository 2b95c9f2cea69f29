"""Where the parts of a train lie along it, and how large they are: what a drawing to scale needs."""

import math
from dataclasses import dataclass

from estimator.machine import Machine
from estimator.parts import Disc

STEEL = 7850.0
"""Density for the size of a disc of which only mass and inertia are known [kg/m³]."""


@dataclass(frozen=True)
class DiscBody:
    """A plain disc with the mass and polar inertia of the document. radius, width: [m]; None without polar inertia."""

    radius: float | None
    width: float | None


def shaft_begins(machine: Machine) -> dict[str, float]:
    """Distance [m] of each shaft's driver-side end from that of the train, in order from driver to driven.

    Shafts that no coupling joins to others follow behind.
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
    """Size of a solid steel disc with this mass and polar inertia: I_p = m r²/2, m = ρ π r² b."""
    if disc.polar_inertia <= 0.0:
        return DiscBody(None, None)
    radius = math.sqrt(2.0 * disc.polar_inertia / disc.mass)
    return DiscBody(radius, disc.mass / (STEEL * math.pi * radius**2))
