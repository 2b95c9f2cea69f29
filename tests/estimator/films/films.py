"""Films for the tests, from tables that are coarser than those of the product, and made in a second."""

from functools import lru_cache

import numpy as np

from estimator.arrays import Floats
from estimator.films.film import Film
from estimator.films.pad_table import PadTable
from estimator.films.profiles import elliptical, four_lobe, plain, three_lobe, two_axial_grooves

PROFILES = {
    "plain": (plain(), 0.5),
    "continuous": (plain(continuous=True), 0.5),
    "two_axial_grooves": (two_axial_grooves(), 0.5),
    "elliptical": (elliptical(preload=0.5), 1.0),
    "three_lobe": (three_lobe(preload=0.4), 0.7),
    "four_lobe": (four_lobe(preload=0.5), 0.5),
}
"""Profiles with a length over diameter each."""


@lru_cache(maxsize=16)
def coarse_table(*, arc: float, slenderness: float, continuous: bool = False) -> PadTable:
    """A table with an eighth of the nodes, on a mesh of a third of the cells."""
    return PadTable(arc=arc, slenderness=slenderness, continuous=continuous, around=80, radial_nodes=12, angular_nodes=48)


def film(name: str, slenderness: float | None = None) -> Film:
    """The film of a profile."""
    profile, own = PROFILES[name]
    return Film(profile, slenderness or own, table=coarse_table)


def positions(one: Film, count: int, *, seed: int = 0) -> Floats:
    """Positions (count, 2) all over a film, none of them close to where it ends."""
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (60 * count, 2))
    return drawn[one.covers(1.01 * drawn) & one.covers(drawn)][:count]
