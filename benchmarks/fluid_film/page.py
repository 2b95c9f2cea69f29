"""The evidence of films as a page: what was asked and measured in the parts that were run, with their plants and seeds."""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.figure_tables import fallen_words, figure_table
from benchmarks.fluid_film.drawings import coefficients_over_speed, coverage_by_kind
from benchmarks.fluid_film.film_fits import FEWEST
from benchmarks.fluid_film.kinds_of_trains import FIRST_SEED, MOST_PLANTS
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.fluid_film.wrong_documents import FIRST_SEED as FIRST_WRONG_SEED
from benchmarks.kept_outcomes import commit
from benchmarks.thesis.tables import paragraphs

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "evidence-films.md"
INTRODUCTION = """\
# The evidence: trains on fluid films

Plants whose films come from a solver of their own (finite volumes, with rupture; `tests/film_plant` shares no code with the
estimator) are measured with 1 % noise and 0.1 µm of floor, and identified by documents that describe their bearings by
geometry and oil. Truths are drawn from the priors that the documents state: clearance and viscosity 15 %, elevations 30 µm
(5 µm with a rigid coupling). Films deviate from the solver's by some 4 %, with a mean that is not zero; where nothing else is
said, documents allow for 5 %, the default. Seeds are stated, so that the same numbers come again; times are those of the
machine that ran it, on one core.

- **asked** is the figure that the project has set itself; an empty one is told only.
- **accepted** is the part of the identifications that the estimator accepts; the others are refused with a reason.
- **95 % intervals hold** is the part of the intervals of accepted ones that contain the truth, the mean over the kinds of
  quantities without elevations.
- **bound** is the Bayesian Cramér-Rao bound at the truth, the films' deviations included.
- **SHORT** marks what falls short."""
BY_HAND = "By a script "
"""Beginning of a paragraph that no part makes: it stays in its section, whose end it is, when the page is written anew."""
SECTIONS = {
    "films": "Single films",
    "tilting-pads": "Tilting pads",
    "reference": "Response of the reference motor and compressor",
    "statics": "Statics and films of the reference motor and compressor",
    "sweep": "Correction of the sweep",
    "film-fits": "Identification by films",
    "pedestals": "Unknown pedestals",
    "warming-oil": "Oil that warms",
    "lobes": "Bores that are not round",
    "pads": "Trains on tilting pads",
    "mixed": "Films beside other bearings",
    "other-trains": "Trains of other proportions",
    "wrong-documents": "Documents with one thing wrong",
    "wrong-forms": "Linear forms on films",
    "own-forms": "Linear forms that are right",
}


def write_page(found: Mapping[str, Sequence[ReportLine]], *, plants: Mapping[str, int], left_out: Sequence[str]) -> Path:
    """Write the page and its figures.

    Args:
        found: Figures by part.
        plants: Number of random plants that was asked for, by part.
        left_out: Parts that were not run.

    Returns:
        The page.
    """
    by_hand = paragraphs_by_hand(PAGE.read_text(encoding="utf-8")) if PAGE.exists() else {}
    told = paragraphs(INTRODUCTION, _run(found, plants, left_out), *_sections(found, plants, by_hand))
    PAGE.write_text(told + "\n", encoding="utf-8")
    return PAGE


def paragraphs_by_hand(page: str) -> dict[str, list[str]]:
    """Return the paragraphs of a page that were written by hand, by the heading of their section."""
    found: dict[str, list[str]] = {}
    heading = ""
    for paragraph in page.strip().split("\n\n"):
        if paragraph.startswith("## "):
            heading = paragraph.removeprefix("## ")
        elif paragraph.startswith(BY_HAND):
            found.setdefault(heading, []).append(paragraph)
    return found


def seeds(part: str, plants: int) -> str:
    """Return which plants a part tries, in words; empty where it tries none that are random."""
    if part == "film-fits":
        return f"Random plants, and the motor and compressor, of seeds {_span(0, plants)}."
    if part in ("pedestals", "warming-oil", "lobes", "pads"):
        each = ", for each bore" if part == "lobes" else ""
        return f"Random plants of seeds {_span(FIRST_SEED, min(plants, MOST_PLANTS))}{each}."
    if part == "mixed":
        return f"Random trains of seeds {_span(0, plants)}: one shaft on films, the other on rolling elements or by a table."
    if part == "other-trains":
        return f"Random trains of seeds {_span(0, plants)}."
    if part == "wrong-documents":
        beside = f"those beside films every second of seeds {FIRST_WRONG_SEED} to {FIRST_WRONG_SEED + 2 * plants - 1}"
        return f"Random plants of seeds {_span(FIRST_WRONG_SEED, plants)}, for each line; {beside}."
    if part in ("wrong-forms", "own-forms"):
        return f"Random plants of seeds {_span(0, plants)}, for each form."
    return "The motor and compressor of seed 1." if part == "sweep" else ""


def _span(first: int, count: int) -> str:
    return f"{first}" if count == 1 else f"{first} to {first + count - 1} ({count} plants)"


def _run(found: Mapping[str, Sequence[ReportLine]], plants: Mapping[str, int], left_out: Sequence[str]) -> str:
    only = f" --only {' '.join(found)}" if left_out else ""
    fallen = fallen_words([one for figures in found.values() for one in figures])
    parts = [
        f"This page was written by `python -m benchmarks.fluid_film{only} --plants {counts(found, plants)} --write` on commit",
        f"{commit('benchmarks.fluid_film')}:",
        f"{fallen} short of what was asked, as far as they are judged.",
    ]
    if any(plants[name] < FEWEST for name in found if name == "film-fits"):
        parts.append(
            f"Coverage and errors of identifications by films are judged from {FEWEST} plants on: here they are told only."
        )
    if left_out:
        parts.append(f"Not run for it: {', '.join(left_out)}.")
    return textwrap.fill(" ".join(parts), 120, break_on_hyphens=False)


def counts(found: Mapping[str, Sequence[ReportLine]], plants: Mapping[str, int]) -> str:
    """Return the numbers of plants as they are asked for: that of most parts, then others."""
    counts = [plants[name] for name in found if seeds(name, plants[name])]
    usual = max(set(counts), key=counts.count, default=1)
    others = [f"{name}={plants[name]}" for name in found if seeds(name, plants[name]) and plants[name] != usual]
    return " ".join([str(usual), *others])


def _sections(
    found: Mapping[str, Sequence[ReportLine]], plants: Mapping[str, int], by_hand: Mapping[str, Sequence[str]]
) -> list[str]:
    parts = []
    for name, figures in found.items():
        parts += [f"## {SECTIONS[name]}", seeds(name, plants[name]), figure_table(figures)]
        if name == "film-fits":
            parts += [
                "The films of bearing B1 of the plant of seed 0 as they were found, with 95 % bands; dashed the truth.",
                *(f"![{what} over speed]({place})" for what, place in coefficients_over_speed(0)),
            ]
        parts += by_hand.get(SECTIONS[name], ())
    rows = dict(_coverages(found))
    if rows:
        words = "Solid: 95 %; dashed: 86 %, the least that is asked of a kind. What is less than 70 % is drawn there."
        parts += ["## Intervals that hold, by kind", words, f"![coverage by kind]({coverage_by_kind(rows)})"]
    return [one for one in parts if one]


def _coverages(found: Mapping[str, Sequence[ReportLine]]) -> list[tuple[str, Mapping[str, float]]]:
    """Return the coverages by kind, each with the name of the line before, which says of what they are."""
    named = []
    for figures in found.values():
        of = ""
        for one in figures:
            if not one.what.startswith(" "):
                of = one.what.partition(":")[0]
            if one.coverage:
                named.append((of, one.coverage))
    return named
