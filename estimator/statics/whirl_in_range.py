"""Tells whether a train as its document describes it would whirl, or its journals touch, at a speed that it is watched at.

By the eigenvalues at its highest speed (Lund, J. Eng. Ind. 96 (1974) 509), of the modes up to ten times that; of films, by
those at their equilibria (`film_stability`).
"""

import numpy as np

from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films, slowest_rpm
from estimator.modes.eigenmodes import OSCILLATING, damping_ratio
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.system_matrices import system_matrices_over_speed
from estimator.statics.equilibrium import film_train
from estimator.statics.film_model import film_model
from estimator.statics.film_stability import HIGHEST_GROWING, whirl_onset
from estimator.statics.solved_films import FilmTooThin
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

GROWING = -1e-4
"""Damping ratio below which a mode grows, and is not merely undamped [-]."""


def instability_words(machine: Machine) -> str:
    """State that a train as its document describes it would touch or whirl within its own speed range; films take seconds.

    Args:
        machine: The machine.

    Returns:
        The words of `touching_words` or `whirl_words`, or why there is no static state to judge; empty where it would run.
    """
    try:
        return touching_words(machine) or whirl_words(machine)
    except Invalid as error:  # nothing carries a shaft, for example
        return str(error)


def whirl_words(machine: Machine) -> str:
    """State that the document describes a train that whirls within its own speed range; tables of new films take seconds.

    Source: Lund, J. Eng. Ind. 96 (1974) 509.

    Args:
        machine: The machine.

    Returns:
        The words; empty where no mode grows.
    """
    if follows_films(machine):
        return _of_films(machine)
    spin = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    matrices = system_matrices_over_speed(machine, basis=modal_basis(machine, HIGHEST_GROWING * spin))(spin)
    roots = np.linalg.eigvals(matrices.state_matrix(spin=machine.direction * spin))
    roots = roots[(roots.imag > OSCILLATING * np.abs(roots)) & (roots.imag <= HIGHEST_GROWING * spin)]
    if roots.size == 0 or (least := float(damping_ratio(roots).min())) >= GROWING:
        return ""
    return (
        f"at {machine.speed_range.maximum_rpm:g} r/min a mode would grow (damping ratio {least:.2g}), so that the train could "
        "not run there: usual is more than 0.01; are damping and cross-coupled stiffness right?"
    )


def touching_words(machine: Machine) -> str:
    """State that films of the document do not carry their journals within its own speed range; new films take seconds.

    Args:
        machine: The machine.

    Returns:
        The words, with the bearing whose journal touches first; empty where all carry, or where nothing follows films.
    """
    if not follows_films(machine):
        return ""
    try:
        film_model(machine).nominal.equilibria  # noqa: B018  solved where it is asked for
    except FilmTooThin as error:
        return str(error)
    return ""


def _of_films(machine: Machine) -> str:
    low, high = rpm_to_rad_per_s(slowest_rpm(machine)), rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    train = film_train(machine)
    # Films whirl from a speed on: where they do not at the highest one, they do at none.
    if whirl_onset(machine, train, first=high, last=high) is None:
        return ""
    onset = whirl_onset(machine, train, first=low, last=high)
    rpm = rad_per_s_to_rpm(high if onset is None else onset)
    return (
        f"on the oil films as they are described the train would whirl from {rpm:.0f} r/min on, within its speed range up to "
        f"{machine.speed_range.maximum_rpm:g} r/min: are clearances, oil and preload right?"
    )
