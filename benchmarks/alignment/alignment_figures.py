"""Figures of alignment: how many intervals hold, how wide they are, how often an angle is determined."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.alignment.alignment_trials import AlignmentTrial, ReportedInterval, trial_name, trial_of
from benchmarks.fluid_film.film_fits import LEAST_OF_A_KIND
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import is_kept
from tests.film_plant.motor_compressor import CouplingKind

COVERAGE = (0.93, 0.97)
FEWEST = 20
"""Number of plants from which on coverage is judged; of fewer it is told only."""
LEAST_ACCEPTED = 0.95
WIDEST: dict[CouplingKind, float] = {"rigid": 17e-6, "flexible": 160e-6}
"""Median half width asked of the vertical offset of one run [m]."""
WIDEST_CHANGE: dict[CouplingKind, float] = {"rigid": 8e-6, "flexible": 52e-6}
"""Median half width asked of that offset's change against a baseline [m]."""
WIDEST_CENTRED: dict[CouplingKind, float] = {"rigid": 16e-6, "flexible": 120e-6}
"""Median half width asked of it in one run with its shaft centreline [m]."""
QUANTITIES = {
    "vertical offsets": ".offset_vertical",
    "horizontal offsets": ".offset_horizontal",
    "angles": ".angle_",
    "vertical loads": ".load_vertical",
    "horizontal loads": ".load_horizontal",
}
"""Part of the names of quantities whose intervals are judged together."""
VERTICAL = "coupling.C1.offset_vertical"


def figures(kind: CouplingKind, plants: int, *, kept_only: bool = False) -> Iterator[ReportLine]:
    """Yield the figures of plants with one kind of coupling.

    kept_only: only those of the plants whose trial is kept.
    """
    seeds = [seed for seed in range(plants) if not kept_only or is_kept(trial_name(seed, kind))]
    trials = [trial_of(seed, kind) for seed in seeds]
    plants = len(trials)
    if not trials:
        return
    runs = sum(one.runs for one in trials)
    accepted = 1.0 - sum(len(one.verdicts) for one in trials) / runs
    yield ReportLine(
        f"{kind} coupling, {plants} plants, {runs} runs: accepted",
        f">= {LEAST_ACCEPTED:.0%}",
        f"{accepted:.1%}",
        accepted >= LEAST_ACCEPTED,
    )
    for what, told in (
        ("absolute", [each for one in trials for each in one.absolute]),
        ("changes", [each for one in trials for each in one.changes]),
        ("absolute, with gap", [each for one in trials for each in one.centred]),
    ):
        yield from _coverage(what, told, judged=plants >= FEWEST)
    for which, odd in (("motor-compressors", 0), ("turbine-generators", 1)):
        own = [one for seed, one in zip(seeds, trials, strict=True) if seed % 2 == odd]
        if own:
            yield _width(f"vertical offset, {which}", [each for one in own for each in one.absolute], WIDEST[kind])
            yield _width("    with gap", [each for one in own for each in one.centred], WIDEST_CENTRED[kind])
            yield _width("    its change against six runs", [each for one in own for each in one.changes], WIDEST_CHANGE[kind])
    yield _determined(trials)


def _coverage(what: str, told: Sequence[ReportedInterval], *, judged: bool) -> Iterator[ReportLine]:
    """Yield the part of all intervals that hold the truth, then that of each kind."""
    low, high = COVERAGE
    part = _part(told)
    yield ReportLine(f"    {what}: 95 % intervals hold", "93-97 %", f"{part:.1%}", not judged or low <= part <= high)
    for quantities, named in QUANTITIES.items():
        own = [one for one in told if named in one.name]
        part = _part(own)
        kept = not judged or not own or part >= LEAST_OF_A_KIND
        yield ReportLine(f"        {quantities}, {len(own)} determined", ">= 86 %", f"{part:.1%}" if own else "-", kept)


def _part(told: Sequence[ReportedInterval]) -> float:
    return float(np.mean([one.holds for one in told])) if told else 0.0


def _width(what: str, told: Sequence[ReportedInterval], widest: float) -> ReportLine:
    """Return the median half width, with the rms error in parentheses."""
    own = [one for one in told if one.name == VERTICAL]
    half = float(np.median([one.half for one in own])) if own else np.inf
    error = float(np.sqrt(np.mean([((one.lower + one.upper) / 2 - one.true) ** 2 for one in own]))) if own else np.inf
    said = f"{1e6 * half:.1f} ({1e6 * error:.1f})"
    return ReportLine(f"    {what}: half width, median (rms error) [µm]", f"<= {1e6 * widest:.0f}", said, half <= widest)


def _determined(trials: Sequence[AlignmentTrial]) -> ReportLine:
    """Return of how many plants one run determines the angles."""
    taken = [one for one in trials if one.absolute]
    parts = [
        np.mean([f"coupling.C1.angle_{plane}" not in one.withheld for one in taken]) if taken else 0.0
        for plane in ("vertical", "horizontal")
    ]
    return ReportLine("    angle determined by one run: vertical, horizontal", "", f"{parts[0]:.0%}, {parts[1]:.0%}", True)
