"""State matrix of a train on its films in which the pads that tilt are degrees of freedom of their own.

A pad without inertia adds one state (J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064): modes are exact at
their own frequency, which the synchronous reduction of the pads is not.
"""

from dataclasses import replace

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.films.tilted_pads import HeldPads
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import Basis
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.rotor.system_matrices import system_matrices
from estimator.statics.equilibrium import FilmEquilibrium
from estimator.statics.film_coefficients import film_coefficients


def state_matrix_with_pads(
    machine: Machine, equilibrium: FilmEquilibrium, basis: Basis, *, coefficients: Floats | None = None
) -> Floats:
    """Compute A of ż = A z with z = (q, q̇, w), w being the states of the pads that tilt (Lund 1964).

    Source: J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064.

    Args:
        machine: The machine.
        equilibrium: Its equilibrium at a speed.
        basis: Basis of the coordinates q.
        coefficients: Coefficients (K,) at the spin speed, with the pads following; by what they differ from those of the
            equilibrium's films, films deviate at every frequency [SI]. None for those of the equilibrium.

    Returns:
        A (2N + P, 2N + P), P being the number of all pads that tilt [SI].
    """
    held = [None if one.pads is None else one.pads.held for one in equilibrium.film]
    films = tuple(
        film if pads is None else replace(film, stiffness=pads.stiffness, damping=pads.damping)
        for film, pads in zip(equilibrium.film, held, strict=True)
    )
    values = film_coefficients(machine, replace(equilibrium, film=films))
    if coefficients is not None:
        values = values + (coefficients - film_coefficients(machine, equilibrium))
    matrices = system_matrices(machine, coefficients=values, basis=basis)
    rotor = matrices.state_matrix(spin=machine.direction * equilibrium.speed)
    pads = [one for one in held if one is not None]
    if not pads:
        return rotor
    along = _axes(machine, equilibrium, basis)
    push, rate, drive, drag = (np.concatenate([getattr(one, name) for one in pads]) for name in _STATES)
    accelerated = scipy.linalg.cho_solve(scipy.linalg.cho_factor(matrices.mass), -along * push)
    beside = np.concatenate([np.zeros_like(accelerated), accelerated])
    below = -np.concatenate([along * drive, along * drag]).T
    return np.block([[rotor, beside], [below, -np.diag(rate)]])


_STATES = tuple(name for name in HeldPads.__dataclass_fields__ if name not in ("stiffness", "damping"))


def _axes(machine: Machine, equilibrium: FilmEquilibrium, basis: Basis) -> Floats:
    """Return what a force along each pad's axis is on the coordinates (N, P)."""
    rotor = assemble_rotor(machine)
    columns = [np.zeros((rotor.size, 0))]
    for bearing, film in zip(machine.bearings, equilibrium.film, strict=True):
        if film.pads is not None:
            first = NODE_DOFS * rotor.node(bearing.shaft, bearing.station)
            part = np.zeros((rotor.size, len(film.pads.axis)))
            part[first : first + 2] = film.pads.axis.T
            pedestal = machine.pedestal_of(bearing.id)
            if pedestal is not None:
                below = NODE_DOFS * rotor.pedestal_node[pedestal.id]
                part[below : below + 2] = -film.pads.axis.T
            columns.append(part)
    return np.asarray(basis.project(np.concatenate(columns, axis=1)))
