"""Coefficients of a machine with those of its films at an equilibrium."""

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.terms import LATERAL
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.statics.equilibrium import FilmEquilibrium


def film_coefficients(machine: Machine, equilibrium: FilmEquilibrium) -> Floats:
    """Return all coefficients of a machine with those of its bearings at an equilibrium.

    Args:
        machine: The machine, with K coefficients.
        equilibrium: Its equilibrium at a speed.

    Returns:
        Coefficients (K,), those that are no bearing's as expected [SI].
    """
    numbers = {bearing.id: number for number, bearing in enumerate(machine.bearings)}
    places = {term.name: ("xy".index(term.force), "xy".index(term.motion)) for term in LATERAL}
    found = []
    for one in unknowns(machine, assemble_rotor(machine)).coefficients:
        described = describe(one.name)
        if described.element_kind != "bearing":
            found.append(one.expected)
            continue
        film = equilibrium.film[numbers[described.element_id]]
        found.append(float((film.stiffness if one.order == 0 else film.damping)[places[one.term.name]]))
    return np.array(found)
