"""The estimator's figures: efficiency, coverage, convergence, model bias, outliers, speed, memory, and a user's own script.

Trains and noise: `benchmarks/estimator/trains.py`. Everything runs on one BLAS thread.

    python -m benchmarks.estimator [--seeds N] [--trials N] [--only NAME …] [--write]
"""

import argparse
import copy
import math
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import scipy.optimize
from threadpoolctl import threadpool_limits

from benchmarks.estimator.page import PAGE, SECTIONS, page
from benchmarks.estimator.trains import SimulatedTrain, cramer_rao, modelled, off, silent, three_shafts, two_shafts, values
from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense

SMALL_BOUND = 0.2
"""Efficiency is judged over parameters whose Cramér-Rao bound is below this part of their value."""
MEMORY_SPEEDS = 5000
LARGEST_POWER = 1.1
"""Largest power of the number of speeds with which the time may grow: it is to grow in proportion, and timings scatter."""


def converged(found: Identification) -> bool:
    """Return whether χ²/dof is within five standard deviations of 1."""
    return abs(found.chi_square / found.degrees_of_freedom - 1) <= 5 * math.sqrt(2 / found.degrees_of_freedom)


def model() -> list[ReportLine]:
    """Return the row on the model's response against the one that ROSS computed on the same mesh."""
    train = two_shafts()
    deviation = np.abs(modelled(train.machine, train.speed) - train.clean) / np.abs(train.clean)
    return [_row("model against ROSS, same mesh, relative", "<= 1e-9", f"{deviation.max():.1e}", kept=deviation.max() <= 1e-9)]


def efficiency(seeds: int) -> list[ReportLine]:
    """Return the rows on errors over their bound, and coverage of the intervals, over noise seeds."""
    lines = []
    for relative in (0.01, 0.05):
        train = two_shafts().stating(relative)
        machine, bound = train.machine, cramer_rao(train, relative)
        found = [values(identify(machine, train.measured(seed, relative))) for seed in range(seeds)]
        estimate, lower, upper = (np.array(column) for column in zip(*found, strict=True))
        small = bound < SMALL_BOUND * _size(train.truth)
        ratio = np.sqrt(np.nanmean((estimate - train.truth) ** 2, axis=0)) / bound
        inside = np.where(np.isnan(estimate), np.nan, (lower <= train.truth) & (train.truth <= upper))
        often = np.mean(~np.isnan(estimate), axis=0) >= 0.5
        coverage = np.nanmean(inside[:, often], axis=0)
        label = f"{100 * relative:g} % noise, seeds 0-{seeds - 1}"
        lines += [
            _within(f"rms error / bound, median of {small.sum()}; {label}", 0.9, 1.1, float(np.median(ratio[small]))),
            _at_most("    worst of them", 1.25, float(ratio[small].max())),
            _within(f"95 % intervals cover, of {often.sum()} estimable [%]", 93.0, 97.0, 100 * float(np.nanmean(inside))),
            _at_least("    worst parameter [%]", 88.0, 100 * float(coverage.min())),
        ]
    return lines


def convergence(trials: int) -> list[ReportLine]:
    """Return the rows on identifications from documents that are wrong by up to ±50 %."""
    lines = []
    for name, train, asked in (("two shafts", two_shafts(), 99.5), ("three shafts", three_shafts(), 98.0)):
        rng = np.random.default_rng(2024)
        good, seconds, starts = 0, [], []
        for trial in range(trials):
            machine = parse_machine(off(train.document, rng, 0.5))
            begin = time.perf_counter()
            found = identify(machine, train.measured(1000 + trial))
            seconds.append(time.perf_counter() - begin)
            starts.append(found.starts)
            good += found.accepted and converged(found)
        label = f"converged from ±50 %, {name}, {trials} documents (seed 2024) [%]"
        lines.append(_at_least(label, asked, 100 * good / trials))
        at_once, longest = f"{np.mean(np.array(starts) == 1):.1%}", f"{np.median(seconds):.2f}, {max(seconds):.2f}"
        lines.append(_row("    from the first start; seconds, median and longest", "", f"{at_once}; {longest}"))
    return lines


def silence() -> list[ReportLine]:
    """Return the rows on documents without nominal values of some elements."""
    train = two_shafts()
    lines = []
    for kinds in (("discs", "bearings"), ("discs", "bearings", "couplings")):
        machine = parse_machine(silent(train.document, kinds))
        begin = time.perf_counter()
        found = [identify(machine, train.measured(seed)) for seed in range(3)]
        seconds = (time.perf_counter() - begin) / 3
        good = sum(one.accepted and converged(one) for one in found)
        lines.append(_row(f"no nominal values of {' and '.join(kinds)}: converged, of 3", "", f"{good}"))
        lines.append(_row("    seconds; starts", "", f"{seconds:.1f}; {', '.join(str(one.starts) for one in found)}"))
    return lines


def model_bias(seeds: int) -> list[ReportLine]:
    """Return the rows on E and density of the document 5 % off, with a stated spread of 5 %."""
    train = two_shafts()
    errors, deviations = [], []
    for elastic in (0.95, 1.05):
        for heavy in (0.95, 1.05):
            document = copy.deepcopy(train.document)
            steel = document["materials"]["steel"]
            steel.update(young_modulus=elastic * steel["young_modulus"], density=heavy * steel["density"])
            steel.update(young_modulus_spread=0.05, density_spread=0.05)
            for seed in range(seeds):
                found = identify(parse_machine(document), train.measured(seed))
                errors.append(np.nanmedian(np.abs(values(found)[0] - train.truth) / np.abs(train.truth)))
                freedom = found.degrees_of_freedom
                deviations.append(abs(found.chi_square / freedom - 1) / math.sqrt(2 / freedom))
    return [
        _at_most(f"E and ρ 5 % off, 4 signs x {seeds} seeds: median error, worst [%]", 2.0, 100 * float(max(errors))),
        _at_most("    distance of χ²/dof from 1 in standard deviations, worst", 5.0, max(deviations)),
    ]


def outlying(seeds: int) -> list[ReportLine]:
    """Return the rows on a twentieth of the points off: by 30 % with random phase, or of wholly random phase."""
    train = two_shafts()
    lines = []
    for whole in (False, True):
        ratio = []
        for seed in range(seeds):
            clean = train.measured(seed)
            rng = np.random.default_rng(5000 + seed)
            phasor = clean.phasor.copy()
            hit = rng.random(phasor.shape) < 0.05
            turn = np.exp(2j * math.pi * rng.random(hit.sum()))
            phasor[hit] = 1.3 * np.abs(phasor[hit]) * turn if whole else phasor[hit] * (1 + 0.3 * turn)
            pair = [
                np.nanmedian(np.abs(values(identify(train.machine, one))[0] - train.truth) / np.abs(train.truth))
                for one in (clean, Measurement.of(speed=train.speed, phasor=phasor))
            ]
            ratio.append(pair[1] / pair[0])
        what = "30 % too large, phase wholly random" if whole else "off by 30 % in a random phase"
        label = f"5 % of points {what}: median error over clean, {seeds} seeds"
        lines.append(_at_most(label, 1.5, float(np.median(ratio))))
        lines.append(_row("    worst seed", "", f"{max(ratio):.2f}"))
    return lines


def _identified(machine: Machine, train: SimulatedTrain) -> Identification:
    return identify(machine, train.measured(0))


def speed(repeats: int) -> list[ReportLine]:
    """Measure the time of one identification, and how it grows with the number of speeds."""
    lines = []
    for name, train, asked in (
        ("two shafts, 150 x 8, 50", two_shafts(), 0.15),
        ("three shafts, 290 x 12, 78", three_shafts(), 1.0),
    ):
        rng = np.random.default_rng(7)
        right = _median_time(partial(_identified, train.machine, train), repeats)
        wrong = [parse_machine(off(train.document, rng, 0.2)) for _ in range(repeats)]
        seconds = [_median_time(partial(_identified, machine, train), 1) for machine in wrong]
        lines.append(_at_most(f"{name} unknowns [s], nominal values right", asked, right))
        lines.append(_at_most("    nominal values off by ±20 %, median", asked, float(np.median(seconds))))
    # Derivatives of up to some 2,500 speeds are remembered during a fit, which saves half of the time: a step between the two.
    for said, counts in (("remembered", (500, 1000, 2000)), ("too many to be", (2700, 3700, 5000))):
        times = [_median_time(partial(_identified, train.machine, train), 5) for train in map(dense_speeds, counts)]
        slope = np.polyfit(np.log(counts), np.log(times), 1)[0]
        label = f"power of the number of speeds, {counts[0]}-{counts[-1]}, derivatives {said}"
        lines.append(_at_most(label, LARGEST_POWER, float(slope)))
        lines.append(_row(f"    {counts[-1]} speeds [s]", "", f"{times[-1]:.2f}"))
    for name in ("two_shafts", "three_shafts"):
        whole, added = _peak_memory(name)
        lines.append(_at_most(f"memory at {MEMORY_SPEEDS} speeds, {name.replace('_', ' ')} [MB]: process", 200.0, whole))
        lines.append(_row("    of which the identification", "", f"{added:.0f}"))
    return lines


def dense_speeds(count: int) -> SimulatedTrain:
    """Return the Chapter 3 train at many speeds."""
    train = two_shafts()
    speeds = np.linspace(train.speed[0], train.speed[-1], count)
    return SimulatedTrain(train.document, speeds, modelled(train.machine, speeds), train.truth)


def own_script() -> list[ReportLine]:
    """Return the rows on a user's own script: dense finite elements, least_squares, finite differences; same data, start and
    answer."""
    train = two_shafts()
    # Near the truth, for from 10 % off the script ends elsewhere.
    machine = parse_machine({**off(train.document, np.random.default_rng(3), 0.02), "discs": train.document["discs"]})
    measurement = train.measured(0)
    begin = time.perf_counter()
    found, _, _ = values(identify(machine, measurement))
    ours = time.perf_counter() - begin
    begin = time.perf_counter()
    theirs = _least_squares(machine, measurement)
    whole = time.perf_counter() - begin
    bound = cramer_rao(train, 0.01)
    return [
        _row(
            "a user's own script, seconds; same answer within bounds",
            "",
            f"{whole:.1f}; {np.max(np.abs(theirs - found) / bound):.2f}",
        ),
        _at_least("    times slower than the identification", 50.0, whole / ours),
    ]


def _least_squares(machine: Machine, measurement: Measurement) -> Floats:
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    rotor = assemble_rotor(machine)
    coefficients, planes = train.unknowns.coefficients, train.unknowns.unbalances
    probes = [4 * rotor.node(p.shaft, p.station) + (1 if p.angle_deg == 90 else 0) for p in machine.probes]
    size = np.concatenate([[abs(c.nominal or c.scale) for c in coefficients], np.full(2 * len(planes), 0.01)])

    def phasors(p: Floats) -> Complexes:
        stiffness, damping = rotor.stiffness.copy(), np.zeros_like(rotor.stiffness)
        for value, c in zip(p, coefficients, strict=False):
            for i, a in c.left.items():
                for j, b in c.right.items():
                    (damping if c.order else stiffness)[i, j] += value * a * b
        parts = p[len(coefficients) :].reshape(-1, 2)
        rows = []
        for omega in measurement.speed:
            force = np.zeros(rotor.size, dtype=complex)
            for plane, (real, imaginary) in zip(planes, parts, strict=True):
                push = omega**2 * (real + 1j * imaginary)
                force[4 * plane.node], force[4 * plane.node + 1] = push, -1j * push
            dynamic = stiffness - omega**2 * rotor.mass + 1j * omega * (damping + omega * rotor.gyroscopic)
            rows.append(np.linalg.solve(dynamic, force)[probes])
        return np.array(rows)

    weight = math.sqrt(2) / (0.01 * np.abs(measurement.phasor))

    def residual(x: Floats) -> Floats:
        return np.asarray(((phasors(x * size) - measurement.phasor) * weight).reshape(-1).view(float))

    start = np.concatenate(
        [[(c.nominal or 0.0) for c in coefficients] / size[: len(coefficients)], np.full(2 * len(planes), 0.1)]
    )
    result = scipy.optimize.least_squares(residual, start, x_scale="jac")
    return np.asarray(result.x * size)


def _peak_memory(name: str) -> tuple[float, float]:
    """Return the largest memory [MB] of a process that identifies at many speeds, and the part of the identification."""
    command = [sys.executable, "-m", "benchmarks.estimator", "--memory", name]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return float(printed[0]), float(printed[1])


def _measure_memory(name: str) -> None:
    train = dense_speeds(MEMORY_SPEEDS) if name == "two_shafts" else three_shafts(MEMORY_SPEEDS)
    machine, measurement = train.machine, train.measured(0)
    before = _own_peak_memory()
    identify(machine, measurement)
    after = _own_peak_memory()
    print(after, after - before)


def _own_peak_memory() -> float:
    """Return the largest memory of this process [MiB]; getrusage would tell that of the process that started it, if larger."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024


def _median_time(call: Callable[[], object], repeats: int) -> float:
    call()
    seconds = []
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - begin)
    return float(np.median(seconds))


def _size(truth: Floats) -> Floats:
    """Return the size that a bound is relative to: the value or, for the parts of an unbalance, the unbalance."""
    size = np.abs(truth)
    size[-8:] = np.repeat(np.hypot(truth[-8::2], truth[-7::2]), 2)
    return size


def _row(what: str, asked: str, measured: str, *, kept: bool = True) -> ReportLine:
    return ReportLine(what, asked, measured, kept)


def _at_most(what: str, asked: float, measured: float) -> ReportLine:
    return _row(what, f"<= {asked:g}", f"{measured:.3g}", kept=measured <= asked)


def _at_least(what: str, asked: float, measured: float) -> ReportLine:
    return _row(what, f">= {asked:g}", f"{measured:.4g}", kept=measured >= asked)


def _within(what: str, lowest: float, highest: float, measured: float) -> ReportLine:
    return _row(what, f"{lowest:g}-{highest:g}", f"{measured:.3g}", kept=lowest <= measured <= highest)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run and print; return 1 where a figure falls short of what was asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimator", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", type=int, default=200, help="noise seeds of the efficiency, default 200")
    parser.add_argument("--trials", type=int, default=300, help="random documents per train, default 300")
    parser.add_argument("--only", nargs="*", choices=SECTIONS, default=tuple(SECTIONS))
    parser.add_argument("--write", action="store_true", help=f"write docs/{PAGE.name} with all parts")
    parser.add_argument("--memory", help=argparse.SUPPRESS)
    chosen = parser.parse_args(arguments)
    if chosen.memory:
        _measure_memory(chosen.memory)
        return 0
    parts: dict[str, Callable[[], list[ReportLine]]] = {
        "model": model,
        "efficiency": lambda: efficiency(chosen.seeds),
        "convergence": lambda: convergence(chosen.trials),
        "silence": silence,
        "bias": lambda: model_bias(max(1, chosen.seeds // 40)),
        "outliers": lambda: outlying(max(1, chosen.seeds // 10)),
        "speed": lambda: speed(7),
        "script": own_script,
    }
    figures: dict[str, list[ReportLine]] = {}
    with threadpool_limits(limits=1):
        for name in SECTIONS if chosen.write else chosen.only:
            figures[name] = parts[name]()
            print("\n".join([SECTIONS[name][0], *map(str, figures[name])]), flush=True)
    if chosen.write:
        PAGE.write_text(page(figures), encoding="utf-8")
        print(PAGE)
    return 0 if all(one.kept for lines in figures.values() for one in lines) else 1


if __name__ == "__main__":
    raise SystemExit(main())
