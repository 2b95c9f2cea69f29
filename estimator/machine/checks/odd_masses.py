"""Masses, inertias and unbalances that are possible, but probably in another unit than the document's."""

import math
from collections.abc import Iterator

from estimator.machine.checks.rotor_masses import rotor_mass, shaft_mass, train_weight
from estimator.machine.document import Machine
from estimator.machine.parts import Disc, Half
from estimator.units import GRAVITY
from estimator.usual_values import question

HEAVIEST_DISC = 50.0
"""Mass of a disc over that of its shaft above which a warning asks whether its unit is right [-]: examples have 0.5 to 3."""
PEDESTALS = (0.02, 100.0)
"""Mass of a pedestal over a bearing's share of all rotors' mass beyond which a warning asks whether its unit is right [-]."""
USUAL_PEDESTAL = (0.1, 10.0)
"""Usual mass of a pedestal over that share [-]."""
GYRATION = (1e-3, 3.0)
"""Radius of gyration of a disc beyond which a warning asks whether the unit of its inertia is right [m]."""
USUAL_GYRATION = (0.01, 2.0)
"""Usual radius of gyration of a disc [m]."""
LARGEST_ECCENTRICITY = 5e-3
"""Residual unbalance over the rotor's mass above which a warning asks whether its unit is right [m]: G 6.3 allows 20 µm."""
USUAL_ECCENTRICITY = (1e-7, 2e-3)
"""Usual residual unbalance over the rotor's mass, with weights of trials [m]."""


def odd_masses(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find masses, inertias and unbalances of which the unit is doubtful.

    Args:
        machine: The machine.

    Yields:
        The field, and a sentence about it.
    """
    yield from _heavy_discs(machine)
    for number, disc in enumerate(machine.discs):
        yield from ((f"discs[{number}].{field}", words) for field, words in _odd_inertias(disc))
        yield from ((f"discs[{number}].{field}", words) for field, words in _odd_unbalance(machine, disc))
    for number, coupling in enumerate(machine.couplings):
        for name, half in (("driver_half", coupling.driver_half), ("driven_half", coupling.driven_half)):
            if half is not None:
                yield from ((f"couplings[{number}].{name}.{field}", words) for field, words in _odd_inertias(half))
    yield from _odd_pedestals(machine)


def _heavy_discs(machine: Machine) -> Iterator[tuple[str, str]]:
    """Yield discs that are so heavy that their shaft would not carry them."""
    for number, disc in enumerate(machine.discs):
        shaft = shaft_mass(machine, machine.shaft(disc.shaft))
        if shaft is not None and disc.mass > HEAVIEST_DISC * shaft:
            words = f"{disc.mass:g} kg is {disc.mass / shaft:.0f} times the mass of shaft '{disc.shaft}', {shaft:.3g} kg"
            meant = f"was {disc.mass:g} g meant, {disc.mass / 1e3:g} kg?"
            yield f"discs[{number}].mass", f"{words}: usual is 0.1 to 5 times; {meant}"


def _odd_inertias(part: Disc | Half) -> Iterator[tuple[str, str]]:
    """Yield moments of inertia that no body of this mass and a usual size has; 0 is one that is left out."""
    for name in ("diametral_inertia", "polar_inertia"):
        inertia = getattr(part, name)
        if inertia == 0.0 or part.mass == 0.0:
            continue
        radius = math.sqrt(inertia / part.mass)
        if not GYRATION[0] <= radius <= GYRATION[1]:
            usual = (part.mass * USUAL_GYRATION[0] ** 2, part.mass * USUAL_GYRATION[1] ** 2)
            words = f"{inertia:g} kg m² of {part.mass:g} kg is a radius of gyration of {radius:.2g} m"
            yield name, f"{words}: usual is 0.01 to 2 m{question(inertia, 'kg m²', usual)}"


def _odd_unbalance(machine: Machine, disc: Disc) -> Iterator[tuple[str, str]]:
    """Yield a residual unbalance that would shift its rotor's centre of mass by millimetres."""
    mass = rotor_mass(machine, machine.shaft(disc.shaft))
    if disc.unbalance is None or mass is None:
        return
    size = disc.unbalance.magnitude
    if size > LARGEST_ECCENTRICITY * mass:
        usual = (USUAL_ECCENTRICITY[0] * mass, USUAL_ECCENTRICITY[1] * mass)
        words = f"{size:g} kg m shifts the centre of mass of shaft '{disc.shaft}' with its discs, {mass:.3g} kg, by "
        shift = f"{1e3 * size / mass:.2g} mm"
        yield "unbalance.magnitude", f"{words}{shift}: usual is less than 0.1 mm{question(size, 'kg m', usual)}"


def _odd_pedestals(machine: Machine) -> Iterator[tuple[str, str]]:
    """Yield pedestals that are out of all proportion to what stands on them."""
    weight = train_weight(machine)
    if weight is None:
        return
    share = weight / GRAVITY / len(machine.bearings)
    for number, pedestal in enumerate(machine.pedestals):
        for name, mass in (("mxx", pedestal.mxx), ("myy", pedestal.myy)):
            if not PEDESTALS[0] * share <= mass <= PEDESTALS[1] * share:
                usual = (USUAL_PEDESTAL[0] * share, USUAL_PEDESTAL[1] * share)
                words = f"{mass:g} kg is {mass / share:.2g} times a bearing's share of all rotors, {share:.3g} kg"
                yield f"pedestals[{number}].{name}", f"{words}: usual is 0.1 to 10 times{question(mass, 'kg', usual)}"
