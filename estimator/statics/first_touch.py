"""Bearing whose journal touches first where films do not carry: named with the pressure on it.

A film carries the more the faster its journal turns, so that the train is followed from a speed at which all carry down to
where one no longer does (continuation; Allgower and Georg, Introduction to Numerical Continuation Methods, SIAM 2003).
"""

import math

import numpy as np

from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain
from estimator.statics.films_over_speed import equilibria_near

FASTER = 20.0
"""Factor from speed to speed in the search for one at which all films carry [-]."""
MOST_FASTER = 3
"""Most such steps: films that need more carry nothing that is theirs."""
HALVINGS = 12
"""Most times that the range in which the first one touches is halved."""


def first_touch_words(train: FilmTrain, speed: float) -> str:
    """State which bearing's journal touches first as the train slows to a speed, and its pressure at rest (continuation).

    Source: Allgower and Georg, Introduction to Numerical Continuation Methods, SIAM 2003, doi:10.1137/1.9780898719154.

    Args:
        train: The train on its films.
        speed: Spin speed at which they do not carry it [rad/s].

    Returns:
        The bearing, its load [N] and pressure [MPa], and what is usual; of the highest pressure where none touches first.
    """
    loads = np.linalg.norm(train.statics.film_force(train.elevation), axis=1)
    areas = {number: one.described.diameter * one.described.length for number, one in train.journals.items()}
    pressures = {number: float(loads[number]) / area for number, area in areas.items()}
    first = _first_touching(train, speed)
    named = max(pressures, key=lambda number: pressures[number]) if first is None else first
    carried = f"{loads[named]:.3g} N on bearing '{train.bearings[named].name}'"
    which = "" if first is None else ", whose journal touches first,"
    return f"{carried}{which} at rest are {1e-6 * pressures[named]:.3g} MPa over diameter and length; usual is 0.5 to 3 MPa"


def _first_touching(train: FilmTrain, speed: float) -> int | None:
    """Return the number of the bearing with the thinnest film at the lowest speed at which all films carry, if any."""
    low, high = speed, speed
    found: FilmEquilibrium | None = None
    for _ in range(MOST_FASTER):
        high *= FASTER
        found = train.equilibrium(high)
        if found is not None:
            break
        low = high
    if found is None:
        return None
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        near = equilibria_near(train, np.array([middle]), found.position[None])
        if near is None or not train.carried(near[0].position):
            low = middle
        else:
            high, found = middle, near[0]
    place = found.position
    thinnest = {number: one.thinnest(place[number]) / one.clearance for number, one in train.journals.items()}
    return min(thinnest, key=lambda number: thinnest[number])
