"""Figures of alignment: how many intervals hold, how wide they are, how often an angle is determined."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.alignment.alignment_trials import AlignmentTrial, Told, alignment_trial
from benchmarks.fluid_film.figure import Figure
from tests.film_plant.motor_compressor import CouplingKind

COVERAGE = (0.93, 0.97)
FEWEST = 20
"""Number of plants from which on coverage is judged; of fewer it is told only."""
LEAST_ACCEPTED = 0.95
WIDEST: dict[CouplingKind, float] = {"rigid": 17e-6, "flexible": 160e-6}
"""Median half width asked of the vertical offset of one run [m]."""
WIDEST_CHANGE: dict[CouplingKind, float] = {"rigid": 8e-6, "flexible": 52e-6}
"""The same of its change against a baseline [m]."""
QUANTITIES = ("offset", "angle", "load")
VERTICAL = "coupling.C1.offset_vertical"


def figures(kind: CouplingKind, plants: int) -> Iterator[Figure]:
    """Yield the figures of plants with one kind of coupling."""
    trials = [alignment_trial(seed, kind) for seed in range(plants)]
    runs = sum(one.runs for one in trials)
    accepted = 1.0 - sum(len(one.verdicts) for one in trials) / runs
    yield Figure(
        f"{kind} coupling, {plants} plants, {runs} runs: accepted",
        f">= {LEAST_ACCEPTED:.0%}",
        f"{accepted:.1%}",
        accepted >= LEAST_ACCEPTED,
    )
    for what, told in (
        ("absolute, one run", [each for one in trials for each in one.absolute]),
        ("change", [each for one in trials for each in one.changes]),
    ):
        for quantity in QUANTITIES:
            yield _coverage(f"    {quantity}s, {what}: 95 % intervals hold", told, quantity, judged=plants >= FEWEST)
    yield _width("vertical offset, one run", [each for one in trials for each in one.absolute], WIDEST[kind])
    yield _width("its change against six runs", [each for one in trials for each in one.changes], WIDEST_CHANGE[kind])
    yield _determined(trials)


def _coverage(what: str, told: Sequence[Told], quantity: str, *, judged: bool) -> Figure:
    holds = [one.holds for one in told if f".{quantity}_" in one.name]
    if not holds:
        return Figure(what, "93-97 %", "none is determined", True)
    part = float(np.mean(holds))
    low, high = COVERAGE
    return Figure(what, "93-97 %", f"{part:.1%} of {len(holds)}", not judged or low <= part <= high)


def _width(what: str, told: Sequence[Told], widest: float) -> Figure:
    """Return the median half width, with the rms error in parentheses."""
    own = [one for one in told if one.name == VERTICAL]
    half = float(np.median([one.half for one in own])) if own else np.inf
    error = float(np.sqrt(np.mean([((one.lower + one.upper) / 2 - one.true) ** 2 for one in own]))) if own else np.inf
    said = f"{1e6 * half:.1f} ({1e6 * error:.1f})"
    return Figure(f"    {what}: half width, median (rms error) [µm]", f"<= {1e6 * widest:.0f}", said, half <= widest)


def _determined(trials: Sequence[AlignmentTrial]) -> Figure:
    """Return of how many plants one run determines the angles."""
    taken = [one for one in trials if one.absolute]
    parts = [
        np.mean([f"coupling.C1.angle_{plane}" not in one.withheld for one in taken]) if taken else 0.0
        for plane in ("vertical", "horizontal")
    ]
    return Figure("    angle determined by one run: vertical, horizontal", "", f"{parts[0]:.0%}, {parts[1]:.0%}", True)
