"""Two causes at once on machines on oil films: is each named, and is nothing called what it is not?

The coupling's second shaft sinks by twice what is allowed beside another cause, or there are two that are no misalignment.
"""

from collections.abc import Iterator
from itertools import product

from benchmarks.alignment.film_fleet import FleetRecord, record_name, record_of
from benchmarks.alignment.film_histories import LONGEST_BASELINE, FilmHistory, Happening, expected_alert
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import is_kept
from tests.film_plant.motor_compressor import CouplingKind

PAIRS: tuple[tuple[Happening, Happening], ...] = (
    ("beyond", "pedestal"),
    ("beyond", "wear"),
    ("beyond", "unbalance"),
    ("beyond", "oil"),
    ("wear", "unbalance"),
)
SOON = 3
"""Runs within which both are asked to be named, as each by itself."""
TRAINS = ("motor-compressor", "turbine-generator")
FOLLOWING = ("light_load", "heavy_load", "low_stability")
"""Findings that a misalignment brings with it."""
PAIR_SEEDS = 1000
"""Seeds of machines of one pair."""


def pair_figures(kind: CouplingKind, machines: int, *, kept_only: bool = False) -> Iterator[ReportLine]:
    """Yield of each pair of causes, for so many machines of each train with one kind of coupling, whether both are named.

    kept_only: only those of the machines of which it is kept what became of them.
    """
    yield ReportLine(f"{kind} coupling: two causes at once, both named within {SOON} runs", "", "", True)
    onset = LONGEST_BASELINE + 1
    for (number, pair), (of, train) in product(enumerate(PAIRS), enumerate(TRAINS)):
        seeds = [PAIR_SEEDS * (number + 1) + 2 * place + of for place in range(machines)]
        histories = [FilmHistory(seed, kind, pair[0], onset, pair[1]) for seed in seeds]
        if kept_only:
            histories = [one for one in histories if is_kept(record_name(one, weeks=onset + SOON))]
        lived = [(one, record_of(one, weeks=onset + SOON)) for one in histories]
        found = [(history, one) for history, one in lived if not one.missed]
        right, many = sum(both_named(*one) for one in found), len(found)
        said = f"{right}" + (f", {len(lived) - many} would whirl" if many < len(lived) else "")
        yield ReportLine(f"    {' and '.join(pair)}, {train}", f"{many} of {many}", said, right == many)
        others = sorted({f"{rule} {element}" for one in found for rule, element in called_otherwise(*one)})
        yield ReportLine("        called otherwise", "nothing", ", ".join(others) or "nothing", not others)


def both_named(history: FilmHistory, record: FleetRecord) -> bool:
    """Return whether each cause that has a name stood as an alert in some week since both happened."""
    standing = {(rule, element) for week in record.standing[record.onset :] for rule, element, _ in week}
    wanted = {expected_alert(history, cause) for cause in history.causes} - {None}
    return wanted <= standing


def called_otherwise(history: FilmHistory, record: FleetRecord) -> Iterator[tuple[str, str]]:
    """Yield alerts of what has not happened."""
    expected = {expected_alert(history, cause) for cause in history.causes}
    following = (*FOLLOWING, "oil") if "oil" in history.causes else FOLLOWING  # colder oil is called oil, or nothing
    for one in record.opened:
        if (one.rule, one.element) not in expected and one.rule not in following:
            yield one.rule, one.element
