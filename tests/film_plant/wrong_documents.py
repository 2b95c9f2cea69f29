"""Truths of which a document says one thing wrong: an estimator must refuse them, or its intervals must hold."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.oil import HeatedOil, walther
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Alteration
from tests.film_plant.train import Bearing, Pedestal, Train

ELLIPTICAL_CLEARANCE = 1.5
"""Clearance of an elliptical bore's pads over that of the plain bore that it is said to be [-]."""
SOFT_FREQUENCY = (0.7, 1.1)
"""Frequencies of the soft pedestal with its mass, along x and y, over the highest speed [-]."""
CLEARANCE_PRIORS = 2.0
"""Error of the wrong clearance, in standard deviations of its prior [-]."""
SUPPORTS_OFF = 0.3
"""Part by which all coefficients of bearings that are no films are off, up or down [-]: some two priors."""
RAISED_BY = 3.0
"""Error of a wrong elevation, in what the document says it may be off, rms [-]."""
NEXT_GRADE = 1.45
"""Viscosity of an ISO VG grade over that of the one before (ISO 3448) [-]."""
_OfBearing = Callable[[Bearing], Bearing]

MEDIAN = 0.6
"""Part of the highest speed at which oil that warms has the viscosity that is believed [-]."""
USUAL_WAY = 0.6
"""Eccentricity for which that holds [-]."""


def elliptical(train: Train, rng: np.random.Generator, _: float) -> Train:
    """One bearing's bore is elliptical and said to be plain. Tables are kept for L/D 0.5 and 0.8."""

    def bored(one: Bearing) -> Bearing:
        return replace(one, profile="elliptical", clearance=ELLIPTICAL_CLEARANCE * one.clearance)

    return _at_one(train, rng, bored)


def soft_pedestal(train: Train, rng: np.random.Generator, fastest: float) -> Train:
    """One bearing stands on a pedestal with resonances inside the speed range, which is said to be rigid."""

    def softened(one: Bearing) -> Bearing:
        mass = 7850.0 * (2.2 * one.diameter) ** 3
        frequency = [part * fastest for part in SOFT_FREQUENCY]
        x, y = (mass * w**2 for w in frequency)
        cx, cy = (2 * 0.05 * mass * w for w in frequency)
        return replace(one, pedestal=Pedestal((mass, mass), (x, y), (cx, cy)))

    return _at_one(train, rng, softened)


def far_clearance(spread: float) -> Alteration:
    """One bearing's clearance is off by twice its prior's standard deviation more, given as that of the logarithm."""

    def altered(train: Train, rng: np.random.Generator, _: float) -> Train:
        factor = float(np.exp(CLEARANCE_PRIORS * spread * rng.choice([-1.0, 1.0])))
        return _at_one(train, rng, lambda one: replace(one, clearance=factor * one.clearance))

    return altered


def warming_oil(train: Train, _: np.random.Generator, fastest: float) -> Train:
    """All oil warms with speed, and is said to have one viscosity."""
    return replace(train, bearings=tuple(replace(one, oil=_warming(one, fastest)) for one in train.bearings))


def supports_off(rng: np.random.Generator, bearings: int) -> Floats:
    """All coefficients of n bearings that are no films are off by one factor, as of one calculation gone wrong (n, 4) [-]."""
    return np.full((bearings, 4), 1.0 + SUPPORTS_OFF * rng.choice([-1.0, 1.0]))


def with_lifting_force(said: dict[str, Any], plant: Plant) -> dict[str, Any]:
    """A plant's document with a force, said to be exact, that carries half the weight of the first disc and is not there."""
    disc = said["discs"][0]
    force = 0.5 * plant.train.gravity * plant.train.discs[0].mass
    return said | {"static_loads": [{"id": "gear", "shaft": disc["shaft"], "station": disc["station"], "force_y": force}]}


def with_raised_bearing(said: dict[str, Any], seed: int) -> dict[str, Any]:
    """A document in which one bearing of films lies far too high or too low, or too far to one side."""
    rng = np.random.default_rng(seed)
    chosen = int(rng.integers(len(said["bearings"])))
    bearing, axis = said["bearings"][chosen], str(rng.choice(["elevation_x", "elevation_y"]))
    error = RAISED_BY * bearing["speed_dependence"]["elevation_spread"] * float(rng.choice([-1.0, 1.0]))
    raised = bearing | {"film": bearing["film"] | {axis: error}}
    return said | {"bearings": [raised if k == chosen else one for k, one in enumerate(said["bearings"])]}


def loaded_on_pads(said: dict[str, Any]) -> dict[str, Any]:
    """A document whose tilting pads are all said to carry their load on a pad."""
    return _of_all_films(said, lambda film: film | {"pads": film["pads"] | {"load": "on_pad"}})


def oils_of_the_next_grade(said: dict[str, Any]) -> dict[str, Any]:
    """A document whose oils are all of the next ISO VG grade."""

    def thicker(film: dict[str, Any]) -> dict[str, Any]:
        return film | {"oil": film["oil"] | {"viscosity": NEXT_GRADE * film["oil"]["viscosity"]}}

    return _of_all_films(said, thicker)


def diametral_clearances(said: dict[str, Any]) -> dict[str, Any]:
    """A document whose clearances are all diametral ones, written as radial ones."""
    return _of_all_films(said, lambda film: film | {"radial_clearance": 2.0 * film["radial_clearance"]})


def shorter_bearings(said: dict[str, Any]) -> dict[str, Any]:
    """A document whose bearings are all a fifth shorter than they are."""
    return _of_all_films(said, lambda film: film | {"length": 0.8 * film["length"]})


def overdamped_pedestals(said: dict[str, Any]) -> dict[str, Any]:
    """A document whose pedestals are all damped five times as much as they are."""
    return said | {"pedestals": [one | {name: 5.0 * one[name] for name in ("cxx", "cyy")} for one in said["pedestals"]]}


def _of_all_films(said: dict[str, Any], change: Callable[[dict[str, Any]], dict[str, Any]]) -> dict[str, Any]:
    return said | {"bearings": [one | {"film": change(one["film"])} for one in said["bearings"]]}


def _warming(bearing: Bearing, fastest: float) -> HeatedOil:
    """Oil of ISO VG 46 that has the bearing's constant viscosity at the median speed."""
    due = bearing.oil.viscosity(bearing, speed=0.0, eccentricity=0.0)
    oil = HeatedOil(46, 35.0, carried=1.0, feed=0.0)
    for _ in range(30):
        temperature = oil.temperature(bearing, speed=MEDIAN * fastest, eccentricity=USUAL_WAY)
        oil = replace(oil, factor=due / walther(oil.grade, temperature))
    return oil


def _at_one(train: Train, rng: np.random.Generator, change: _OfBearing) -> Train:
    """The train with one of its bearings changed."""
    chosen = int(rng.integers(len(train.bearings)))
    return replace(train, bearings=tuple(change(one) if k == chosen else one for k, one in enumerate(train.bearings)))
