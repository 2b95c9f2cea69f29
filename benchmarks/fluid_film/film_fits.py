"""Identification by films on plants of other make: acceptance, intervals that hold, errors over their bound, time."""

from collections import defaultdict
from typing import Any

import numpy as np

from benchmarks.fluid_film.film_bound import document_as_drawn
from benchmarks.fluid_film.film_trials import (
    KINDS,
    FilmTrial,
    coverage_by_kind,
    kind_of,
    mean_coverage,
    told_coverage,
    trials_of,
)
from benchmarks.fluid_film.report_line import ReportLine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import FILM_DISCREPANCY
from tests.film_plant.plant import Plant
from tests.film_plant.plants import motor_compressor_plant, random_plant

LEAST_OF_A_KIND = 0.86
"""Least part of the intervals of one kind that must hold the truth [-]."""
LEAST_ACCEPTED = 0.95
COVERAGE = (0.93, 0.97)
ERROR_OVER_BOUND = (0.9, 1.15)
FEWEST = 20
"""Number of plants from which on coverage and errors are judged; of fewer they are told only."""


def film_fits(plants: int) -> list[ReportLine]:
    """Return how often right documents are accepted, how many intervals hold, errors over their bound, and times.

    Documents allow for as large deviations of films as the plants' are, and for the larger ones that are the default.
    """
    own = trials_of("film-fits", _random, range(plants), bounded=True, document=as_drawn)
    others = trials_of("motor-compressors", _motor_compressor, range(plants), bounded=True, document=as_drawn)
    rows = _figures(f"films of {len(own)} foreign plants", own) + _figures(f"films of {len(others)} motor-compressors", others)
    rows += _allowing_for_more(
        [
            *trials_of("film-fits by default", _random, range(plants)),
            *trials_of("motor-compressors by default", _motor_compressor, range(plants)),
        ]
    )
    cold = float(np.median([one.took for one in own]))
    warm = float(np.median([one.again for one in own if one.accepted] or [np.inf]))
    return [
        *rows,
        ReportLine("processor time of one identification by films, median [s]", "<= 1.0", f"{cold:.2f}", cold <= 1.0),
        ReportLine("    from the machine's last identification, median [s]", "<= 0.3", f"{warm:.2f}", warm <= 0.3),
    ]


def as_drawn(plant: Plant, _: int) -> dict[str, Any]:
    """Return the document that allows for deviations as they are drawn."""
    return document_as_drawn(plant)


def _random(seed: int) -> Plant:
    return random_plant(seed, discrepancy=DiscrepancySize())


def _motor_compressor(seed: int) -> Plant:
    return motor_compressor_plant(seed, "rigid" if seed % 2 else "flexible", discrepancy=DiscrepancySize())


def _figures(what: str, trials: list[FilmTrial]) -> list[ReportLine]:
    taken = [one for one in trials if one.accepted]
    accepted, coverage = len(taken) / len(trials), mean_coverage(taken)
    low, high = COVERAGE
    few = len(trials) < FEWEST
    rows = [
        ReportLine(f"{what}, deviating: accepted", f">= {LEAST_ACCEPTED:.0%}", f"{accepted:.0%}", accepted >= LEAST_ACCEPTED),
        ReportLine(
            "    95 % intervals hold, mean of kinds",
            "93-97 %",
            f"{coverage:.1%}",
            few or low <= coverage <= high,
            told_coverage(taken),
        ),
    ]
    for kind, (part, count) in coverage_by_kind(taken).items():
        if count == 0:
            continue
        rows.append(ReportLine(f"        {kind}, {count} told", ">= 86 %", f"{part:.1%}", few or part >= LEAST_OF_A_KIND))
    return [*rows, _errors_over_bound(taken)]


def _allowing_for_more(trials: list[FilmTrial]) -> list[ReportLine]:
    """Return the figures of documents that allow for larger deviations than there are: intervals are wide, never narrow."""
    taken = [one for one in trials if one.accepted]
    accepted, coverage = len(taken) / len(trials), mean_coverage(taken)
    what = f"the same {len(trials)} where documents allow for {FILM_DISCREPANCY:.0%}, the default"
    few = len(trials) < FEWEST
    return [
        ReportLine(f"{what}: accepted", f">= {LEAST_ACCEPTED:.0%}", f"{accepted:.0%}", accepted >= LEAST_ACCEPTED),
        ReportLine(
            "    95 % intervals hold, mean of kinds",
            f">= {COVERAGE[0]:.0%}",
            f"{coverage:.1%}",
            few or coverage >= COVERAGE[0],
        ),
    ]


def _errors_over_bound(trials: list[FilmTrial]) -> ReportLine:
    """Return the median over quantities of the rms error of each over its bound, and that of each kind."""
    squares: dict[str, list[float]] = defaultdict(list)
    for one in trials:
        for name, error in one.errors.items():
            squares[name].append(error**2)
    rms = {name: float(np.sqrt(np.mean(each))) for name, each in squares.items()}
    by_kind = [(kind, [value for name, value in rms.items() if kind_of(name) == kind]) for kind in KINDS]
    told = ", ".join(f"{kind} {np.median(values):.2f}" for kind, values in by_kind if values)
    median = float(np.median(list(rms.values()))) if rms else np.inf
    low, high = ERROR_OVER_BOUND
    kept = len(trials) < FEWEST or low <= median <= high
    return ReportLine(f"    rms error over its bound, median ({told})", f"{low}-{high}", f"{median:.2f}", kept)
