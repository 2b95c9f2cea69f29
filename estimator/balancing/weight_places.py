"""Weights at the places that a plane has: holes or blades at given angles, weights of given steps, several weights as one.

The weights at n places that together give an unbalance, with the least total mass: Σ m r e^{jθ} = U with 0 ≤ m ≤ M is a
linear program, whose basic solutions use two places beside those that are full (Dantzig, Linear programming and
extensions, Princeton, 1963). Where the places cannot give it, the nearest unbalance is taken (bounded least squares).
Whole steps are then tried around that, every combination.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.errors import Invalid

MOST_TRIED = 6
"""Largest number of places whose whole steps are tried in all combinations."""


class PlacesUnusable(Invalid):
    """Raised for places of weights that are none: no angle, a radius or a step that is not positive."""


@dataclass(frozen=True)
class WeightPlaces:
    """Places of a plane where weights can sit.

    Attributes:
        angles_deg: Angles (n,) of the places, +x to +y from the keyphasor mark [°].
        radius: Radius of the places [m].
        largest: Largest mass at one place [kg]; infinite for any.
        step: Step of the masses [kg]; 0 for any mass.
    """

    angles_deg: Floats
    radius: float
    largest: float = np.inf
    step: float = 0.0

    def __post_init__(self) -> None:
        sizes = (self.radius > 0.0, self.largest > 0.0, self.step >= 0.0, self.step <= self.largest)
        if len(self.angles_deg) == 0 or not all(sizes):
            raise PlacesUnusable(
                "a plane's places need at least one angle, a positive radius and largest mass, and a step below that mass"
            )

    @classmethod
    def evenly(
        cls, count: int, *, radius: float, first_deg: float = 0.0, largest: float = np.inf, step: float = 0.0
    ) -> "WeightPlaces":
        """Build evenly spaced places.

        Args:
            count: Number of places.
            radius: Their radius [m].
            first_deg: Angle of the first one [°].
            largest: Largest mass at one place [kg].
            step: Step of the masses [kg].

        Returns:
            The places.
        """
        return cls(first_deg + 360.0 * np.arange(count) / max(count, 1), radius, largest, step)


@dataclass(frozen=True)
class SplitWeight:
    """Masses at places that stand for one unbalance.

    Attributes:
        masses: Mass (n,) at each place [kg].
        unbalance: Unbalance that they give [kg m].
        wanted: Unbalance that was to be given [kg m].
    """

    masses: Floats
    unbalance: complex
    wanted: complex

    @property
    def shortfall(self) -> float:
        """Return the part of the wanted unbalance that is missed [-]."""
        return abs(self.unbalance - self.wanted) / abs(self.wanted) if self.wanted else 0.0


def combine_weights(masses: Sequence[float], *, radii: Sequence[float], angles_deg: Sequence[float]) -> complex:
    """Combine several weights on one plane into the unbalance that they give.

    Args:
        masses: Masses [kg].
        radii: Their radii [m].
        angles_deg: Their angles [°].

    Returns:
        Unbalance [kg m].
    """
    turned = np.exp(1j * np.radians(np.asarray(angles_deg, dtype=float)))
    return complex(np.sum(np.asarray(masses, dtype=float) * np.asarray(radii, dtype=float) * turned))


def split_weight(unbalance: complex, places: WeightPlaces) -> SplitWeight:
    """Divide an unbalance onto the places of a plane, with the least total mass (Dantzig, Princeton, 1963).

    Args:
        unbalance: Unbalance to give [kg m].
        places: The places.

    Returns:
        Masses at the places, and the unbalance that they really give.
    """
    arms = places.radius * np.exp(1j * np.radians(np.asarray(places.angles_deg, dtype=float)))
    masses = _masses(unbalance, arms, places.largest)
    if places.step > 0.0:
        masses = _in_steps(unbalance, arms, masses, places)
    return SplitWeight(masses, complex(arms @ masses), complex(unbalance))


def _masses(unbalance: complex, arms: np.ndarray, largest: float) -> Floats:
    # In units in which the unbalance is 1: a solver's tolerances are absolute.
    size = abs(unbalance)
    if size == 0.0:
        return np.zeros(arms.size)
    unit = size / float(np.abs(arms[0]))
    rows = np.stack([arms.real, arms.imag]) * unit / size
    side = np.array([unbalance.real, unbalance.imag]) / size
    most = largest / unit
    found = scipy.optimize.linprog(np.ones(arms.size), A_eq=rows, b_eq=side, bounds=[(0.0, most)] * arms.size, method="highs")
    if found.x is not None:
        return np.asarray(found.x) * unit
    return np.asarray(scipy.optimize.lsq_linear(rows, side, bounds=(0.0, most), method="bvls").x) * unit


def _in_steps(unbalance: complex, arms: np.ndarray, masses: Floats, places: WeightPlaces) -> Floats:
    """Return the masses in whole steps around the given ones that come nearest; the largest few are tried together."""
    near = np.argsort(-masses)[: min(MOST_TRIED, max(2, int(np.count_nonzero(masses > 0.0))))]
    whole = np.floor(masses / places.step)
    best, least = whole * places.step, np.inf
    for up in itertools.product((-1.0, 0.0, 1.0, 2.0) if near.size <= 3 else (0.0, 1.0), repeat=near.size):
        tried = whole.copy()
        tried[near] = np.maximum(tried[near] + up, 0.0)
        tried = np.minimum(tried, np.floor(places.largest / places.step)) if np.isfinite(places.largest) else tried
        missed = float(abs(arms @ (tried * places.step) - unbalance))
        if missed < least:
            best, least = tried * places.step, missed
    return np.asarray(best)
