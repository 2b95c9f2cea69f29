"""Calibration: figures asked beside those measured; status 1 where one falls short.

The measured rotor kit by its nameplate, calibrated anew without each fifth of its conditions, whose known unbalances are
then estimated; beside it plain least squares in the same folds. Then from three runs only, simulated kits, also some whose
gains change later, sweeps with weights stated rightly and wrongly, and their time; printed balancing cases, and influence
coefficients on the kit. `--short` takes three splits and a few kits, and a minute. `--only PART` computes some parts alone.
`--conventions` tries wrong conventions instead, for an hour or more. `--write` writes docs/evidence-calibration.md; with
`--keep FILE` parts that were computed by this code are not computed again.

    python -m benchmarks.calibration [--short] [--only PART …] [--keep FILE] [--write]
    python -m benchmarks.calibration --conventions
"""

import argparse
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.calibration.conventions import conventions_figures
from benchmarks.calibration.field_balancing import measured_kit, printed_balancing
from benchmarks.calibration.page import write_page
from benchmarks.calibration.rotor_kit import HeldOut, by_condition, by_least_squares, by_model, folds, gathered, kit
from benchmarks.calibration.simulated_kit import after_a_gain_changed, later_changes
from benchmarks.calibration.simulated_trains import TRAINS, train_lines
from benchmarks.calibration.sweep_time import SECONDS_ASKED, seconds_of_sweeps
from benchmarks.calibration.wrong_weights import wrong_weights
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes, kept_or_computed

SPLITS, BOTH_SPLITS, SHORT_SPLITS = 20, 5, 3
KITS, SHORT_KITS = 60, 6
WORSE = 1.1
"""Factor by which the model's errors may exceed those of least squares [-]."""
CHI_SQUARE = (0.7, 1.3)
COVERED = (0.90, 1.0)
COVERED_SIMULATED = (0.93, 0.97)
THREE_RUNS = (9e-6, 18.0)
"""Errors asked of three runs: rms magnitude [kg m], median angle [°]."""
ONE_SET = ("A007", "A015")
"""Conditions with 48 g mm on disc 1, on disc 2."""
TRIALS = (("A005", "A007", "B009"), ("A013", "A015", "B023"))
"""All conditions with one weight from 24 g mm on at both speeds on disc 1, on disc 2."""
CHANGED_GAINS = (1.0, 1.04, 1.08, 1.15)
"""Factors on the gain of a channel after the calibration [-]."""
GAIN_DRIFTS = (0.0, 0.02)
"""Drift of gains that the calibration allows for [-]."""
CHANGED_KITS = 24
FEWEST_KITS = 20
"""Number of simulated kits from which on coverage is judged."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each figure; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibration", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--short", action="store_true", help="few splits and kits")
    parser.add_argument("--conventions", action="store_true", help="wrong conventions of sources instead")
    parser.add_argument("--only", action="append", choices=list(PARTS), help="a part of the figures; by default all")
    parser.add_argument("--keep", type=Path, help="file that keeps figures, from which a run of this code goes on")
    parser.add_argument("--write", action="store_true", help="write docs/evidence-calibration.md with the figures")
    asked = parser.parse_args(arguments)
    if asked.conventions and (asked.write or asked.only):
        parser.error("--conventions stands alone: its figures are no part of the page")
    if asked.keep is not None:
        KEEPING.set(KeptOutcomes(asked.keep, benchmark="benchmarks.calibration"))
    found: dict[str, list[ReportLine]] = {}
    print(f"  {'calibration':<76}{'asked':>12}{'measured':>24}")
    with threadpool_limits(limits=1):
        sections = [("", conventions_figures())] if asked.conventions else figures(asked.only, short=asked.short)
        for name, lines in sections:
            found[name] = []
            for line in lines:
                print(line, flush=True)
                found[name].append(line)
    if asked.write:
        print(f"written: {write_page(found)}")
    if not all(line.kept for lines in found.values() for line in lines):
        raise SystemExit(1)


def figures(parts: Sequence[str] | None = None, *, short: bool) -> Iterator[tuple[str, Iterable[ReportLine]]]:
    """Yield some parts, by default all, and their figures; a short run has few splits and leaves out what takes long."""
    for name in parts or [name for name in PARTS if not (short and name in LONG)]:
        yield name, _figures_of(name, short=short)


def _figures_of(part: str, *, short: bool) -> Iterable[ReportLine]:
    """Return the figures of a part one by one; as a list where they are kept in a file."""
    if KEEPING.get() is None:
        return PARTS[part](short)
    return kept_or_computed(f"{part}{', short' if short else ''}", list[ReportLine], lambda: list(PARTS[part](short)))


def _influence(short: bool) -> Iterator[ReportLine]:
    yield from measured_kit(SHORT_SPLITS if short else SPLITS)


def _simulated_kits(short: bool) -> Iterator[ReportLine]:
    kits = SHORT_KITS if short else KITS
    later = gathered([later_changes(seed) for seed in range(kits)])
    low, high = COVERED_SIMULATED
    held = not kits >= FEWEST_KITS or low <= later.covered <= high
    yield ReportLine(f"simulated kits, {kits}: 95 % intervals of later changes hold", "93-97 %", f"{later.covered:.1%}", held)
    few = gathered([later_changes(seed, mountings=3) for seed in range(kits)])
    small = few.magnitude_rms <= THREE_RUNS[0] and few.median_angle_deg <= THREE_RUNS[1]
    shown = f"{_both([few])}, {few.covered:.1%}"
    yield ReportLine("    the same from three runs only, and intervals that hold", "9 g mm, 18°", shown, small)


def _changed_gains(short: bool) -> Iterator[ReportLine]:
    """Yield how many fits with a gain that has changed since the calibration are accepted, and how many intervals hold.

    First of a calibration that takes gains for constant, then of one that allows for some drift.
    """
    for drift, factor in product(GAIN_DRIFTS, CHANGED_GAINS):
        told = [after_a_gain_changed(seed, factor, drift) for seed in range(SHORT_KITS if short else CHANGED_KITS)]
        fits, accepted, held = (sum(one[place] for one in told) for place in range(3))
        shown = f"{accepted / fits:.0%} of {fits}, {held / (4 * accepted):.1%}" if accepted else f"0 of {fits}"
        kept = not drift or accepted < FEWEST_KITS or held / (4 * accepted) >= COVERED[0]
        what = f"a gain {factor:g} times as large since, drift {drift:.0%}: fits accepted, intervals hold"
        yield ReportLine(what, "90-100 %" if drift else "", shown, kept)


def _sweeps(_: bool) -> Iterator[ReportLine]:
    seconds = seconds_of_sweeps()
    fast = seconds <= SECONDS_ASKED
    yield ReportLine("20 sweeps of 150 speeds and 8 channels", f"<= {SECONDS_ASKED:g} s", f"{seconds:.1f} s", fast)


def _trains(_: bool) -> Iterator[ReportLine]:
    for name, count in TRAINS.items():
        yield from train_lines([name], count)


def _shared_conditions(short: bool) -> Iterator[ReportLine]:
    splits = SHORT_SPLITS if short else SPLITS
    began = time.monotonic()
    model = [gathered([by_model(held) for held in folds(seed)]) for seed in range(splits)]
    each = (time.monotonic() - began) / splits / 5
    plain = [gathered([by_least_squares(held) for held in folds(seed)]) for seed in range(splits)]
    rms, asked_rms = _mean(model, "magnitude_rms"), WORSE * _mean(plain, "magnitude_rms")
    angle, asked_angle = _mean(model, "median_angle_deg"), WORSE * _mean(plain, "median_angle_deg")
    what = f"rotor kit, five folds, {splits} splits ({each:.1f} s a fold)"
    yield ReportLine(f"{what}: rms of magnitude", f"<= {1e6 * asked_rms:.2f}", f"{1e6 * rms:.2f} g mm", rms <= asked_rms)
    yield ReportLine("    median error of angles", f"<= {asked_angle:.2f}", f"{angle:.2f}°", angle <= asked_angle)
    yield ReportLine("    least squares in the same folds", "", f"{_both(plain)}", True)
    chi, covered = _mean(model, "reduced_chi_square"), _mean(model, "covered")
    yield ReportLine("    χ² of the errors", "0.7-1.3", f"{chi:.2f}", CHI_SQUARE[0] <= chi <= CHI_SQUARE[1])
    yield ReportLine("    95 % intervals hold", "90-100 %", f"{covered:.1%}", COVERED[0] <= covered <= COVERED[1])


def _both_speeds(short: bool) -> Iterator[ReportLine]:
    """Yield what all records of a condition in one fit give, at both speeds: in five folds, and from three runs."""
    splits = SHORT_SPLITS if short else BOTH_SPLITS
    parts = [by_condition(held) for seed in range(splits) for held in folds(seed)]
    used = frozenset({"BASE", *ONE_SET})
    for what, told in (
        (f"both speeds in one fit, five folds, {splits} splits", parts),
        ("both speeds in one fit, three runs", [by_condition(frozenset(kit()[2]) - used, used=used)]),
    ):
        found, refused = gathered([one for one, _ in told]), sum(one for _, one in told)
        yield ReportLine(f"{what}, {refused} of {len(found.true) + refused} refused", "", _both([found]), True)
        covered = COVERED[0] <= found.covered <= COVERED[1]
        yield ReportLine("    95 % intervals hold", "90-100 %", f"{found.covered:.1%}", covered)


def _three_runs(_: bool) -> Iterator[ReportLine]:
    """Yield what three runs give: with 48 g mm on each disc, and of all such sets of three that the kit has."""
    model, plain = {}, []
    for trials in product(*TRIALS):
        used = frozenset({"BASE", *trials})
        held = frozenset(kit()[2]) - used
        model[trials] = by_model(held, used=used)
        plain.append(by_least_squares(held, used=used))
    asked_rms, asked_angle = THREE_RUNS
    for what, sets in (("three runs", [model[ONE_SET]]), (f"    mean of {len(model)} such sets", list(model.values()))):
        rms, angle = _mean(sets, "magnitude_rms"), _mean(sets, "median_angle_deg")
        yield ReportLine(f"{what}: rms of magnitude", f"<= {1e6 * asked_rms:g}", f"{1e6 * rms:.2f} g mm", rms <= asked_rms)
        yield ReportLine("    median error of angles", f"<= {asked_angle:g}", f"{angle:.2f}°", angle <= asked_angle)
        covered = _mean(sets, "covered")
        yield ReportLine("    95 % intervals hold", "90-100 %", f"{covered:.1%}", COVERED[0] <= covered <= COVERED[1])
    yield ReportLine("    least squares from the same sets", "", f"{_both(plain)}", True)


def _mean(trials: Sequence[HeldOut], what: str) -> float:
    return float(np.mean([getattr(one, what) for one in trials]))


def _both(trials: Sequence[HeldOut]) -> str:
    return f"{1e6 * _mean(trials, 'magnitude_rms'):.2f} g mm, {_mean(trials, 'median_angle_deg'):.2f}°"


PARTS: dict[str, Callable[[bool], Iterator[ReportLine]]] = {
    "folds": _shared_conditions,
    "both-speeds": _both_speeds,
    "three-runs": _three_runs,
    "printed": lambda _: iter(printed_balancing()),
    "influence": _influence,
    "simulated": _simulated_kits,
    "changed-gains": _changed_gains,
    "trains": _trains,
    "sweeps": _sweeps,
    "wrong-weights": wrong_weights,
}
"""Parts of the figures by name; each takes whether it shall be short."""
LONG = ("changed-gains", "trains", "sweeps", "wrong-weights")
"""Parts that short figures leave out."""


if __name__ == "__main__":
    main()
