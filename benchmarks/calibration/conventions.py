"""Figures of wrong conventions: how often each is named rightly on a refused run, and whether any is named on right runs.

`python -m benchmarks.calibration.conventions [--trials 3] [--runs 60] [--keep FILE]` prints them alone; with a file it goes
on where it was stopped. On a right run all conventions get their coarse fits first, whether its own fit would be accepted or
not: where none is far better, none of them can be named, and the fit itself, which costs most where it is refused, is left to
one run of `FITTED`. Factors on all amplitudes, which need a refused fit, are tried on those runs only.
"""

import argparse
import copy
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import threadpoolctl
import yaml

from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes, kept_or_computed
from estimator.arrays import Complexes
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.identification.convention_trials import ConventionVerdict, coarsely_better, with_named_conventions
from estimator.identification.quality_gate import GatedIdentification
from estimator.identification.wrong_conventions import WrongConvention, swapped_probes, wrong_conventions
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.recorded_run import RecordedRun
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law
from tests.estimator.trains import perturbed, without
from tests.paths import EXAMPLES

TRAINS = ("motor-pump", "thesis-chapter-3", "motor-compressor")
STIFFNESS = ("kxx", "kxy", "kyx", "kyy")
SPAN = 0.3
"""Largest error of the nominal coefficients, uniform either way [-]."""
LEAST_NAMED = 0.95
SAMPLES, DURATION_S = 120, 6000.0
TRIALS, RIGHT_RUNS = 3, 60
FITTED = 10
"""One of so many right runs is fitted in full whatever coarse fits say."""
SHOWN_EVERY = 50
"""Right runs after which progress is printed."""
MIRRORED = {"rotation", "every pair"}
"""Names of the hypotheses that a mirror image of the train makes the same."""


@dataclass(frozen=True)
class Sent:
    """A convention as a source has it wrong.

    wrong: what it does to the run. named: name of the hypothesis. words: part of what is said of amplitudes without known
    weights. weighed: whether a run with a known weight stands beside one without.
    """

    wrong: WrongConvention
    named: str
    words: str = ""
    weighed: bool = False


def conventions_figures(trials: int = TRIALS, right_runs: int = RIGHT_RUNS) -> Iterator[ReportLine]:
    """Yield on how many right runs a convention is named, and how often each wrong one is named rightly."""
    yield from _right_runs(right_runs)
    for name in TRAINS if trials else ():
        for nominal in (True, False):
            yield from _of_a_train(name, trials, nominal=nominal)


def _of_a_train(name: str, trials: int, *, nominal: bool) -> Iterator[ReportLine]:
    what = f"{name}, {'nominal stiffness within 30 %' if nominal else 'no nominal stiffness'}"
    worst: dict[str, list[bool]] = {}
    for seed in range(trials):
        for label, one in _conventions(_machine(name), np.random.default_rng(seed)).items():
            trial = partial(_named_rightly, name, one, seed, nominal=nominal)
            worst.setdefault(label, []).append(kept_or_computed(f"{what}: {label}, {seed}", bool, trial))
    every = [right for listed in worst.values() for right in listed]
    part = sum(every) / len(every)
    yield ReportLine(f"{what}: named rightly", ">= 95 %", f"{part:.0%} of {len(every)}", part >= LEAST_NAMED)
    for label, listed in worst.items():
        yield ReportLine(f"    {label}", "", f"{sum(listed)}/{len(listed)}", True)


def _conventions(machine: Machine, rng: np.random.Generator) -> dict[str, Sent]:
    leads = swapped_probes(machine)
    empty = Measurement.of(speed=np.ones(1), phasor=np.ones((1, len(machine.probes)), dtype=complex))
    pairs = next(one for one in wrong_conventions(machine, empty) if "every pair" in one.words)
    return {
        "phase lag for lead": Sent(WrongConvention("", "", phase=-1.0), "phase-sign"),
        "radians as degrees": Sent(WrongConvention("", "", phase=math.pi / 180.0), "phase-unit"),
        "rad/s as r/min": Sent(WrongConvention("", "", speed=math.pi / 30.0), "speed-unit"),
        "Hz as r/min": Sent(WrongConvention("", "", speed=1.0 / 60.0), "speed-unit"),
        "reversed rotation": Sent(WrongConvention("", "", turned=True), "rotation"),
        "every pair swapped": Sent(pairs, "every pair"),
        "two probes swapped": Sent(leads[int(rng.integers(len(leads)))], "swapped-probes"),
        "mm as µm": Sent(WrongConvention("", "", amplitude=1e-3), "", words="amplitudes in mm that were sent as µm"),
        "µm as mm": Sent(WrongConvention("", "", amplitude=1e3), "", words="amplitudes in µm that were sent as mm"),
        "0-to-peak as peak-to-peak, known weight": Sent(
            WrongConvention("", "", amplitude=0.5), "amplitude-kind", weighed=True
        ),
    }


def _named_rightly(name: str, sent: Sent, seed: int, *, nominal: bool) -> bool:
    """Send a run with a wrong convention and return whether that one is named, alone or with what is the same."""
    machine = _described_machine(name, seed, nominal=nominal)
    parts = _runs(name, seed, weighed=sent.weighed)
    found = _judged(machine, [(sent.wrong.run(run), sent.wrong.measurement(measured)) for run, measured in parts])
    verdict = "" if found.gated.identification is None else found.gated.identification.verdict
    if sent.words:
        return sent.words in verdict
    named = {"every pair" if "every pair" in one.convention.words else one.convention.name for one in found.named}
    if sent.named == "swapped-probes" and named == {"swapped-probes"}:
        return sent.wrong.order in [one.convention.order for one in found.named]
    return sent.named in named and (len(named) == 1 or named == MIRRORED)


def _right_runs(count: int) -> Iterator[ReportLine]:
    """Yield on how many right runs a convention is named, with right documents and with wrong ones."""
    told: list[bool] = []
    for seed in range(count):
        told.append(kept_or_computed(f"right run {seed}, coarsely", bool, partial(_coarsely_better, seed)))
        if len(told) % SHOWN_EVERY == 0:
            print(f"    {len(told)} of {count} right runs tried coarsely", file=sys.stderr, flush=True)
    fitted = [seed for seed, better in enumerate(told) if better or seed % FITTED == 0]
    found = [kept_or_computed(f"right run {seed}", tuple[bool, bool], partial(_right_run, seed)) for seed in fitted]
    refused, named = (sum(one[place] for one in found) for place in (0, 1))
    words = f"named on {count} right runs ({sum(told)} doubted coarsely, {len(found)} fitted, {refused} of these refused)"
    yield ReportLine(words, "0", str(named), named == 0)


def _coarsely_better(seed: int) -> bool:
    """Return whether a wrong convention is far better in a coarse fit of a right run."""
    name = _of_right_run(seed)
    return bool(coarsely_better(_altered(name, seed), [measured for _, measured in _runs(name, 1000 + seed, weighed=False)]))


def _of_right_run(seed: int) -> str:
    return TRAINS[1] if seed % 3 else TRAINS[0]


def _right_run(seed: int) -> tuple[bool, bool]:
    """Return whether a right run is refused, and whether a wrong convention is named on it."""
    name = _of_right_run(seed)
    found = _judged(_altered(name, seed), _runs(name, 1000 + seed, weighed=False))
    identification = found.gated.identification
    assert identification is not None
    return not identification.accepted, bool(found.named) or "that were sent as" in identification.verdict


def _judged(machine: Machine, parts: list[tuple[RecordedRun, Measurement]]) -> ConventionVerdict:
    runs, measurements = [run for run, _ in parts], [measured for _, measured in parts]
    found = identify(machine, joined(measurements), Options(starts=1))
    return with_named_conventions(machine, runs, measurements, GatedIdentification((), found))


@cache
def _document(name: str) -> dict[str, Any]:
    read: dict[str, Any] = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return read


@cache
def _machine(name: str) -> Machine:
    return parse_machine(copy.deepcopy(_document(name)))


def _described_machine(name: str, seed: int, *, nominal: bool) -> Machine:
    """Return what the document says: coefficients off by up to 30 %, or no stiffness of the bearings."""
    document = _document(name)
    told = perturbed(document, seed=seed, span=SPAN) if nominal else without(document, ("bearings",), STIFFNESS)
    told["discs"] = copy.deepcopy(document["discs"])
    return parse_machine(told)


def _altered(name: str, seed: int) -> Machine:
    """Return a right document, or one with a wrong mass, a wrong diameter or a noise that is far too small."""
    told = perturbed(_document(name), seed=seed, span=SPAN)
    kind = seed % 4
    if kind == 1:
        told["discs"][seed % len(told["discs"])]["mass"] *= 1.3
    elif kind == 2:
        section = told["shafts"][seed % len(told["shafts"])]["sections"][0]
        section["outer_diameter"] *= 1.15
    elif kind == 3:
        told["noise"] = {"relative": 0.002, "floor": 0.0}
    return parse_machine(told)


def _runs(name: str, seed: int, *, weighed: bool) -> list[tuple[RecordedRun, Measurement]]:
    """Return a run-down as it should have been sent; weighed: and one with a known weight on the first disc."""
    machine, rng = _machine(name), np.random.default_rng(seed)
    truth = draw_truth(machine, rng)
    weight = np.zeros(len(machine.discs), dtype=complex)
    weight[0] = 2.0 * abs(truth.unbalances[0])
    added = [np.zeros_like(weight), weight] if weighed else [np.zeros_like(weight)]
    return [_run(machine, truth, one, rng, weighed=weighed) for one in added]


def _run(
    machine: Machine, truth: Truth, added: Complexes, rng: np.random.Generator, *, weighed: bool
) -> tuple[RecordedRun, Measurement]:
    seconds, speed = speed_law(machine, "run-down", duration=DURATION_S, samples=SAMPLES)
    phasor = measured_phasors(machine, replace(truth, unbalances=truth.unbalances + added), speed, rng)
    measured = Measurement.of(speed=speed, phasor=phasor)
    status = np.zeros(phasor.shape, dtype=np.uint8)
    run = RecordedRun(seconds, speed, phasor, status, measured.scatter, machine.channels)
    return run, measured.with_trial_weight(added) if weighed else measured


def main() -> None:
    """Print a line for each figure; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibration.conventions", description="Wrong conventions")
    parser.add_argument("--trials", type=int, default=TRIALS, help="of each wrong convention on each train")
    parser.add_argument("--runs", type=int, default=RIGHT_RUNS, help="right runs, on which none may be named")
    parser.add_argument("--keep", type=Path, help="file that keeps outcomes, from which a run of this code goes on")
    asked = parser.parse_args()
    if asked.keep is not None:
        KEEPING.set(KeptOutcomes(asked.keep, benchmark="benchmarks.calibration.conventions"))
    with threadpoolctl.threadpool_limits(1):
        lines = []
        for line in conventions_figures(asked.trials, asked.runs):
            print(line, flush=True)
            lines.append(line)
    sys.exit(0 if all(line.kept for line in lines) else 1)


if __name__ == "__main__":
    main()
