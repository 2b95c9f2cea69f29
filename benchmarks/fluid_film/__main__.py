"""Trains on fluid films: figures asked beside those measured, on plants that share no physics with the estimator.

The plants are those of `tests/film_plant`: films from finite volumes, truths drawn from priors. One line a figure; status 1
where one falls short. `--short` takes one plant, only the parts of seconds, and less than a minute; coverage and errors are
judged from 20 plants on. `--write` writes docs/evidence-films.md from the parts that were run.

    python -m benchmarks.fluid_film [--short] [--plants N [NAME=N …]] [--only NAME …] [--keep FILE] [--write]
"""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from benchmarks.fluid_film.film_fits import film_fits
from benchmarks.fluid_film.films import films
from benchmarks.fluid_film.kinds_of_trains import lobes, mixed, other_trains, pads, pedestals, warming_oils
from benchmarks.fluid_film.linear_forms import own_forms, wrong_forms
from benchmarks.fluid_film.page import write_page
from benchmarks.fluid_film.reference_arrays import reference_response, reference_statics
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.fluid_film.sweep import sweep
from benchmarks.fluid_film.tilting_pads import tilting_pads
from benchmarks.fluid_film.wrong_documents import wrong_documents
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes

PARTS: dict[str, Callable[[int], list[ReportLine]]] = {
    "films": films,
    "tilting-pads": tilting_pads,
    "reference": reference_response,
    "statics": reference_statics,
    "sweep": sweep,
    "film-fits": film_fits,
    "pedestals": pedestals,
    "warming-oil": warming_oils,
    "lobes": lobes,
    "pads": pads,
    "mixed": mixed,
    "other-trains": other_trains,
    "wrong-documents": wrong_documents,
    "wrong-forms": wrong_forms,
    "own-forms": own_forms,
}
SHORT_PLANTS, USUAL_PLANTS = 1, 100
LONG_PARTS = ("sweep", "pedestals", "lobes", "pads", "other-trains", "wrong-documents", "wrong-forms")
"""Parts that are left out where few plants are asked for, unless they are named."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each figure; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fluid_film", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--short", action="store_true", help="one plant, without the longest parts")
    words = "number of random plants, seeds 0, 1, …; another of some parts as NAME=N"
    parser.add_argument("--plants", nargs="+", type=counted, default=[("", USUAL_PLANTS)], metavar="N", help=words)
    parser.add_argument("--only", nargs="*", choices=tuple(PARTS))
    parser.add_argument("--write", action="store_true", help="write docs/evidence-films.md with its figures")
    parser.add_argument("--keep", type=Path, help="file that keeps trials, from which a run of this code goes on")
    chosen = parser.parse_args(arguments)
    if chosen.keep is not None:
        KEEPING.set(KeptOutcomes(chosen.keep, benchmark="benchmarks.fluid_film"))
    asked: dict[str, int] = dict(chosen.plants)
    usual = asked.get("", USUAL_PLANTS)
    plants = {name: SHORT_PLANTS if chosen.short else asked.get(name, usual) for name in PARTS}
    parts = chosen.only or [name for name in PARTS if not (chosen.short and name in LONG_PARTS)]
    found: dict[str, list[ReportLine]] = {}
    print(f"  {'fluid films':<76}{'asked':>12}{'measured':>24}")
    with threadpool_limits(limits=1):
        for name in parts:
            found[name] = PARTS[name](plants[name])
            for figure in found[name]:
                print(figure, flush=True)
        if chosen.write:
            print(f"written: {write_page(found, plants=plants, left_out=[name for name in PARTS if name not in found])}")
    if not all(figure.kept for figures in found.values() for figure in figures):
        raise SystemExit(1)


def counted(word: str) -> tuple[str, int]:
    """Return a number of plants with the part that it is for, "" for all. Raises ArgumentTypeError."""
    part, _, number = word.rpartition("=")
    if (part and part not in PARTS) or not number.isdigit() or int(number) < 1:
        raise argparse.ArgumentTypeError(f"'{word}' is neither a number of plants from 1 on nor NAME=N of a part")
    return part, int(number)


if __name__ == "__main__":
    main()
