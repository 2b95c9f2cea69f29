"""Identification by films of other kinds of trains: on unknown pedestals, with warming oil, in other bores."""

from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.fluid_film.film_fits import COVERAGE, as_drawn
from benchmarks.fluid_film.film_trials import FilmTrial, mean_coverage, told_coverage, trials_of
from benchmarks.fluid_film.report_line import ReportLine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, with_pedestals
from tests.film_plant.oil import HeatedOil
from tests.film_plant.plant import Plant
from tests.film_plant.plants import mixed_plant, random_plant
from tests.film_plant.proportions import OTHER_SLENDERNESS, Design
from tests.film_plant.train import Bearing, Train

LEAST_ACCEPTED, LEAST_COVERAGE = 0.9, 0.92
MOST_PLANTS = 20
LEAST_MIXED, FEWEST_MIXED = 0.95, 12
"""Least part of trains of several kinds of bearings that is accepted [-]; fewest of which coverage is judged."""
BORES = ("elliptical", "grooved", "three_lobe", "four_lobe")
"""Bores that are not round or not whole."""
FIRST_SEED = 100
PEDESTAL_SPREAD = 0.2
"""Prior standard deviation of the logarithm of each of a pedestal's numbers, by which documents are off [-]."""
CARRIED, FED = (0.6, 1.0), (0.05, 0.25)
"""Between which the true heat balance draws the part of the heat carried off, and the oil fed besides [-]; 0.8 and 0.1 are
believed.
"""


def pedestals(plants: int) -> list[ReportLine]:
    """Return how often trains on unknown pedestals with resonances in the range are accepted, and the intervals that hold."""

    def document(plant: Plant, seed: int) -> dict[str, Any]:
        return with_pedestals(film_document(plant), plant, spread=PEDESTAL_SPREAD, seed=seed)

    design, seeds = Design(pedestals=True), _seeds(plants)
    trials = trials_of(
        "pedestals", lambda seed: random_plant(seed, design=design, discrepancy=DiscrepancySize()), seeds, document=document
    )
    return _figures("unknown pedestals, resonances in the range", trials)


def warming_oils(plants: int) -> list[ReportLine]:
    """Return the same of trains whose oil warms by another heat balance than the document's."""
    design, seeds = Design(heated=True), _seeds(plants)
    trials = trials_of(
        "warming-oil",
        lambda seed: random_plant(seed, design=design, discrepancy=DiscrepancySize(), alter=_other_balance),
        seeds,
    )
    return _figures("oil that warms by another balance", trials)


def lobes(plants: int) -> list[ReportLine]:
    """Return the same of trains in bores with two grooves and in elliptical, three- and four-lobe ones."""
    rows = []
    for profile in BORES:
        design = Design(profile=profile, slenderness=OTHER_SLENDERNESS)
        trials = trials_of(
            profile,
            lambda seed, design=design: random_plant(seed, design=design, discrepancy=DiscrepancySize()),  # type: ignore[misc]
            _seeds(plants),
        )
        rows += _figures(f"{profile.replace('_', '-')} bores", trials)
    return rows


def pads(plants: int) -> list[ReportLine]:
    """Return the same of trains on tilting pads: five offset pads in each bearing, loaded between two."""
    design = Design(profile="five_pads", slenderness=(0.5,))
    trials = trials_of("pads", lambda seed: random_plant(seed, design=design, discrepancy=DiscrepancySize()), _seeds(plants))
    return _figures("tilting pads", trials)


def mixed(plants: int) -> list[ReportLine]:
    """Return the same of trains of which one shaft runs on films, the other on rolling elements or by a maker's table."""
    trials = trials_of(
        "mixed", lambda seed: mixed_plant(seed, discrepancy=DiscrepancySize()), range(plants), document=as_drawn
    )
    judged = COVERAGE if plants >= FEWEST_MIXED else (0.0, 1.0)
    return _figures("films beside other bearings", trials, least_accepted=LEAST_MIXED, coverage=judged)


def other_trains(plants: int) -> list[ReportLine]:
    """Return the same of trains of one to three shafts of other proportions, bores, loads and speeds."""

    def document(plant: Plant, seed: int) -> dict[str, Any]:
        said = film_document(plant)
        standing = any(one.pedestal is not None for one in plant.train.bearings)
        return with_pedestals(said, plant, spread=PEDESTAL_SPREAD, seed=seed) if standing else said

    def make(seed: int) -> Plant:
        return random_plant(seed, design=None, discrepancy=DiscrepancySize())

    return _figures("trains of other proportions", trials_of("other-trains", make, range(plants), document=document))


def _seeds(plants: int) -> range:
    return range(FIRST_SEED, FIRST_SEED + min(plants, MOST_PLANTS))


def _other_balance(train: Train, rng: np.random.Generator, _: float) -> Train:
    carried, feed = rng.uniform(*CARRIED), rng.uniform(*FED)

    def warmed(one: Bearing) -> Bearing:
        assert isinstance(one.oil, HeatedOil)
        return replace(one, oil=replace(one.oil, carried=carried, feed=feed))

    return replace(train, bearings=tuple(warmed(one) for one in train.bearings))


def _figures(
    what: str,
    trials: list[FilmTrial],
    *,
    least_accepted: float = LEAST_ACCEPTED,
    coverage: tuple[float, float] = (LEAST_COVERAGE, 1.0),
) -> list[ReportLine]:
    taken = [one for one in trials if one.accepted]
    accepted, held = len(taken) / len(trials), mean_coverage(taken)
    low, high = coverage
    told = told_coverage(taken)
    kinds = ", ".join(f"{kind} {part:.0%}" for kind, part in told.items())
    median = float(np.median([one.took for one in trials]))
    slowest = max(one.took for one in trials)
    failed = sum(one.failed for one in trials)
    return [
        ReportLine(
            f"{what}, {len(trials)} plants: accepted",
            f">= {least_accepted:.0%}",
            f"{accepted:.0%}",
            accepted >= least_accepted,
        ),
        ReportLine(
            "    95 % intervals hold, mean of kinds",
            f">= {low:.0%}" if high == 1.0 else f"{100 * low:.0f}-{high:.0%}",
            f"{held:.1%}",
            low <= held <= high,
            told,
        ),
        ReportLine(f"        {kinds}", "", "", True),
        ReportLine("    ended with an error in place of a verdict", "0", f"{failed}", failed == 0),
        ReportLine("    time of one identification, median and slowest [s]", "", f"{median:.1f}, {slowest:.1f}", True),
    ]
