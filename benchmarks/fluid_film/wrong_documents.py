"""Documents of films with one thing wrong: refused, or intervals that hold; right ones are accepted and not much wider."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from benchmarks.fluid_film.film_fits import as_drawn
from benchmarks.fluid_film.film_trials import FilmTrial, coverage_by_kind, mean_coverage, trials_of
from benchmarks.fluid_film.report_line import ReportLine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, with_pedestals
from tests.film_plant.plant import Plant
from tests.film_plant.plants import PRIORS, Alteration, mixed_plant, random_plant, unaltered
from tests.film_plant.proportions import OTHER_SLENDERNESS, Design
from tests.film_plant.wrong_documents import (
    diametral_clearances,
    elliptical,
    far_clearance,
    loaded_on_pads,
    oils_of_the_next_grade,
    overdamped_pedestals,
    shorter_bearings,
    soft_pedestal,
    supports_off,
    warming_oil,
    with_lifting_force,
    with_raised_bearing,
)

LEAST_COVERAGE = 0.9
LEAST_RIGHT = 0.8
"""Least part of right documents that must be accepted with direct stiffness told nearly as well as it can be [-]."""
WIDEST = 1.3
"""Largest half width of direct stiffness, median of a plant, over its bound [-]."""
FIRST_SEED = 3000
WRONG: dict[str, tuple[Alteration, Design]] = {
    "an elliptical bore said to be plain": (elliptical, Design(slenderness=OTHER_SLENDERNESS)),
    "one pedestal soft, said to be rigid": (soft_pedestal, Design()),
    "one clearance off by two priors": (far_clearance(PRIORS.clearance), Design()),
    "oil that warms, said to be of one viscosity": (warming_oil, Design()),
}
PADS_SLENDERNESS = (0.5,)
"""Lengths of tilting pads over their diameter, for which tables are kept [-]."""
EVERYWHERE: dict[str, tuple[Callable[[dict[str, Any]], dict[str, Any]], Design]] = {
    "all oils said to be of the next grade": (oils_of_the_next_grade, Design()),
    "diametral clearances said to be radial": (diametral_clearances, Design()),
    "all bearings said to be a fifth shorter": (shorter_bearings, Design()),
    "all pedestals said to be damped five times as much": (overdamped_pedestals, Design(pedestals=True)),
    "loads between five pads said to be on a pad": (loaded_on_pads, Design(profile="five_pads", slenderness=PADS_SLENDERNESS)),
}
"""Mistakes that a document makes alike at all bearings."""
PEDESTAL_SPREAD = 0.2
"""Part by which each number of a pedestal may be off, rms [-]."""
RAISED = "one elevation off by three priors"
FORCED = "half a disc's weight lifted by an exact force that is not there"
SUPPORTS = ("rolling elements 30 % off, said to be within 15 %", "a table 30 % off, said to be within 15 %")
"""Mistakes of documents of mixed plants: of even seeds, with rolling elements beside films, and of odd ones, with tables."""


def wrong_documents(plants: int) -> list[ReportLine]:
    """Return what becomes of documents with one thing wrong, and of right ones."""
    seeds = range(FIRST_SEED, FIRST_SEED + plants)
    rows = [_wrong(name, trials_of(name, _altered(alteration, design), seeds)) for name, (alteration, design) in WRONG.items()]
    for name, (mistake, design) in EVERYWHERE.items():
        rows.append(_wrong(name, trials_of(name, _altered(unaltered, design), seeds, document=partial(_mistaken, mistake))))
    rows.append(_wrong(FORCED, trials_of(FORCED, _altered(unaltered, Design()), seeds, document=_with_force)))
    rows.append(_wrong(RAISED, trials_of(RAISED, _altered(unaltered, Design()), seeds, document=_raised)))
    for first, name in enumerate(SUPPORTS, start=FIRST_SEED):
        rows.append(_wrong(name, trials_of(name, _supported, range(first, first + 2 * plants, 2), document=as_drawn)))
    right = trials_of("right", lambda seed: random_plant(seed, discrepancy=DiscrepancySize()), seeds, bounded=True)
    good = float(np.mean([one.accepted and np.median(one.widths) <= WIDEST for one in right]))
    widths = [float(np.median(one.widths)) for one in right if one.accepted]
    told = f"{good:.0%}, {np.median(widths):.2f}"
    return [
        *rows,
        ReportLine(
            f"right ones: accepted, half width of K direct <= {WIDEST} bounds; median", ">= 80 %", told, good >= LEAST_RIGHT
        ),
    ]


def _with_force(plant: Plant, _: int) -> dict[str, Any]:
    return with_lifting_force(film_document(plant), plant)


def _raised(plant: Plant, seed: int) -> dict[str, Any]:
    return with_raised_bearing(film_document(plant), seed)


def _mistaken(mistake: Callable[[dict[str, Any]], dict[str, Any]], plant: Plant, seed: int) -> dict[str, Any]:
    """Return a document with a mistake, of pedestals too where the plant has them."""
    said = film_document(plant)
    on_pedestals = any(one.pedestal is not None for one in plant.train.bearings)
    return mistake(with_pedestals(said, plant, spread=PEDESTAL_SPREAD, seed=seed) if on_pedestals else said)


def _supported(seed: int) -> Plant:
    return mixed_plant(seed, discrepancy=DiscrepancySize(), supports=supports_off)


def _altered(alteration: Alteration, design: Design) -> Callable[[int], Plant]:
    return lambda seed: random_plant(seed, design=design, alter=alteration, discrepancy=DiscrepancySize())


def _wrong(name: str, trials: list[FilmTrial]) -> ReportLine:
    taken = [one for one in trials if one.accepted]
    coverage = mean_coverage(taken)
    worst = min(coverage_by_kind(taken).items(), key=lambda one: one[1][0])
    held = f"; {coverage:.0%}" if taken else ""
    told = f"{len(trials) - len(taken)}/{len(trials)}{held}, {max(one.took for one in trials):.1f} s"
    least = f"; coverage (least {worst[0]} {worst[1][0]:.0%})" if taken else ""
    return ReportLine(f"{name}: refused{least}; slowest", ">= 90 %", told, coverage >= LEAST_COVERAGE)
