"""The figures of a rule on simulated fleets, each beside the figure asked for."""

import argparse
import math
import shlex
import statistics
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import scipy.stats

from benchmarks.fleet.amount import (
    PRINTED_RISE,
    RIG,
    case_a1,
    case_a1_least_squares,
    example,
    growth_for,
    rises,
)
from benchmarks.fleet.histories import WEEKS_A_YEAR, Seasonality
from benchmarks.fleet.judging import JudgedHistory, Named, judged, service_rule
from benchmarks.fleet.measuring import PROCESSES, Ordered, each, kept, watched
from benchmarks.fleet.page import write_page
from benchmarks.fleet.scenarios import DRIFT_WEEKS, SCENARIOS

SEED = 5
SMALL, MIDDLE, LARGE = "thesis-chapter-3", "motor-pump", "turbine-compressor-generator"
SEASONS: tuple[Seasonality, ...] = ("together", "apart")
SOON = 3
"""Runs within which a step should be seen."""
HEALTHY_ASKED, DISTURBED_ASKED = 1 / 20, 1 / 10
"""False misalignment alerts a machine-year."""
HEALTHY = ("healthy",)
DISTURBED = ("short baseline", "outliers", "unbalance step", "probe drifts", "probe lost", "all together")
NAMED = ("unbalance step", "probe drifts", "probe lost", "outliers", "bearing step", "run-out step", "misalignment step")
STEPS = ("misalignment step", "smaller misalignment step")


@dataclass(frozen=True)
class SimulatedFleet:
    """A scenario's fleet: how many machines of each example, and for how many weeks after the baseline."""

    scenario: str
    machines: dict[str, int]
    watched: int = WEEKS_A_YEAR

    def orders(self, seed: int) -> Iterator[Ordered]:
        """Yield every machine, half of them in each kind of season."""
        for machine, count in self.machines.items():
            for number in range(count):
                yield Ordered(machine, self.scenario, SEASONS[number % 2], seed, number, self.watched)


def fleets(scales: Mapping[str, float]) -> tuple[SimulatedFleet, ...]:
    """Return the simulated fleets. scales: factors on the number of machines by scenario, that of "" for all others."""

    def fleet(scenario: str, small: int, middle: int, large: int, *, watched: int = WEEKS_A_YEAR) -> SimulatedFleet:
        counts, scale = {SMALL: small, MIDDLE: middle, LARGE: large}, scales.get(scenario, scales.get("", 1.0))
        machines = {name: max(2, round(scale * count)) for name, count in counts.items() if count}
        return SimulatedFleet(scenario, machines, watched)

    return (
        fleet("healthy", 40, 40, 16),
        *(fleet(scenario, 12, 10, 2) for scenario in DISTURBED),
        fleet("misalignment step", 100, 100, 60, watched=10),
        fleet("smaller misalignment step", 20, 20, 10, watched=10),
        fleet("misalignment drift", 20, 20, 10),
        fleet("bearing step", 30, 30, 15, watched=16),
        fleet("run-out step", 10, 3, 0, watched=8),
    )


SHORT = (
    SimulatedFleet("healthy", {SMALL: 2}, watched=16),
    SimulatedFleet("unbalance step", {SMALL: 2}, watched=10),
    SimulatedFleet("probe lost", {SMALL: 2}, watched=10),
    SimulatedFleet("misalignment step", {SMALL: 2, MIDDLE: 2}, watched=8),
    SimulatedFleet("misalignment drift", {SMALL: 2}, watched=34),
    SimulatedFleet("bearing step", {SMALL: 2}, watched=10),
)
"""Enough to see that everything runs; says next to nothing about rates."""


@dataclass(frozen=True)
class FleetResult:
    """One machine's outcome. changes: kind and element of what befell it. refused: identifications that were not accepted."""

    ordered: Ordered
    changes: tuple[Named, ...]
    outcome: JudgedHistory
    refused: int


def result(ordered: Ordered, *, keep: Path | None = None) -> FleetResult:
    """Simulate, identify and judge one machine's history as the service would. keep: folder for what was identified."""
    one = watched(ordered) if keep is None else kept(ordered, keep)
    return FleetResult(
        ordered,
        tuple((change.kind, change.element) for change in one.history.changes),
        judged(one.history, service_rule(one.history, one.identifications)),
        sum(not identification.accepted for identification in one.identifications),
    )


def rate_bound(count: int, years: float) -> float:
    """Return the upper end of the 95 % interval, two-sided, of a rate of rare events: Garwood, Biometrika 28 (1936) 437."""
    return float(scipy.stats.chi2.ppf(0.975, 2 * count + 2)) / 2.0 / years


def part_interval(count: int, of: int) -> tuple[float, float]:
    """Return the 95 % interval of a part: Clopper and Pearson, Biometrika 26 (1934) 404."""
    if of == 0:
        return 0.0, 1.0
    found = scipy.stats.binomtest(count, of).proportion_ci(0.95, method="exact")
    return float(found.low), float(found.high)


def report(found: Sequence[FleetResult]) -> list[list[list[str]]]:
    """Return tables of all figures, each with its header first."""
    return [_amount(), _false_alarms(found), _power(found), _drift(found), _names(found), _matrix(found)]


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Write rows under a header, the first column to the left and the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(f"{cell:{'>' if place else '<'}{widths[place]}}" for place, cell in enumerate(row)).rstrip() for row in rows
    )


def _amount() -> list[list[str]]:
    rows = [["case A1, rise of natural frequencies [%]", "coefficients", "1st", "2nd", "3rd"]]
    rows.append(["thesis, Table 5.5", "", *(f"{100 * rise:.2f}" for rise in PRINTED_RISE)])
    for mode, name in enumerate(("1st", "2nd", "3rd")):
        rows.append(_rises(f"{name} as printed", RIG, 0, growth_for(mode)))
    for name, growth in (("mean as printed", case_a1()), ("least squares", case_a1_least_squares())):
        for machine in (RIG, SMALL, MIDDLE, LARGE):
            rows += [_rises(name, machine, place, growth) for place in range(len(example(machine).couplings))]
    return rows


def _rises(name: str, machine_id: str, place: int, growth: float) -> list[str]:
    machine = example(machine_id)
    coupling = machine.couplings[place]
    rise = (f"{100 * one:.2f}" for one in rises(machine, coupling, growth))
    return [f"{name}: {machine.id} {coupling.id}", f"{100 * growth:+.1f} %", *rise]


def _false_alarms(found: Sequence[FleetResult]) -> list[list[str]]:
    columns = ["machine-years", "alerts", "a year", "97.5 % below", "asked", "fits refused"]
    rows = [["false misalignment alerts", "machine", "season", *columns]]
    for name, scenarios, asked in (("healthy", HEALTHY, HEALTHY_ASKED), ("disturbed", DISTURBED, DISTURBED_ASKED)):
        groups = _grouped(found, scenarios, lambda one: (one.scenario, one.machine, one.seasonality), (name, "all", ""))
        for key, group in groups.items():
            rows.append([*key, *_rate(group), f"{asked:.2f}", str(sum(one.refused for one in group))])
    return rows


def _rate(group: Sequence[FleetResult]) -> list[str]:
    years = math.fsum(one.outcome.years for one in group)
    count = sum(one.outcome.false_misalignments for one in group)
    return [f"{years:.1f}", str(count), f"{count / years:.3f}", f"{rate_bound(count, years):.3f}"]


def _power(found: Sequence[FleetResult]) -> list[list[str]]:
    rows = [[f"detected within {SOON} runs", "machine", "season", "machines", "part", "95 % interval", "asked"]]
    for scenario in STEPS:
        groups = _grouped(found, (scenario,), lambda one: (one.scenario, one.machine, one.seasonality), (scenario, "all", ""))
        for key, group in groups.items():
            soon = sum(runs is not None and runs <= SOON for one in group for runs in one.outcome.runs)
            rows.append([*key, *_part(soon, len(group)), "99 %"])
    return rows


def _part(count: int, of: int) -> list[str]:
    low, high = part_interval(count, of)
    return [str(of), f"{100 * count / of:.1f} %", f"{100 * low:.1f} to {100 * high:.1f} %"]


def _drift(found: Sequence[FleetResult]) -> list[list[str]]:
    rows = [[f"drift to A1 in {DRIFT_WEEKS} weeks", "machines", "detected", "median part", "asked"]]
    groups = _grouped(found, ("misalignment drift",), lambda one: (one.machine,), ("all",))
    for (machine,), group in groups.items():
        # Not detected at all counts as later than everything.
        parts = [math.inf if one.outcome.part[0] is None else one.outcome.part[0] for one in group]
        detected = sum(map(math.isfinite, parts))
        rows.append([machine, str(len(parts)), str(detected), f"{statistics.median(parts):.2f}", "below 0.60"])
    return rows


def _names(found: Sequence[FleetResult]) -> list[list[str]]:
    rows = [
        ["right kind and element", "machine", "changes", "named", "95 % interval", "asked", "first", "wrong alerts a year"]
    ]
    for scenario in (*NAMED, "all together"):
        groups = _grouped(found, (scenario,), lambda one: (one.scenario, one.machine), (scenario, "all"))
        for key, group in groups.items():
            right = [one for result in group for one in result.outcome.right]
            first = [named == change for one in group for named, change in zip(one.outcome.named, one.changes, strict=True)]
            alone = f"{100 * sum(first) / len(first):.1f} %" if scenario in NAMED else ""
            rows.append([*key, *_part(sum(right), len(right)), "95 %", alone, _wrong(group)])
    return rows


def _wrong(group: Sequence[FleetResult]) -> str:
    years = math.fsum(one.outcome.years for one in group)
    wrong = Counter(opening.named[0] for one in group for opening in one.outcome.wrong)
    return ", ".join(f"{kind} {number / years:.2f}" for kind, number in sorted(wrong.items())) or "none"


def _matrix(found: Sequence[FleetResult]) -> list[list[str]]:
    """Return the findings of the first alert after a change, in the scenarios with one change."""
    groups = _grouped(found, NAMED, lambda one: (one.scenario,), ())
    counts = {key[0]: Counter(_called(one) for one in group) for key, group in groups.items()}
    called = sorted({name for one in counts.values() for name in one})
    rows = [[scenario, *(str(counter[name]) for name in called)] for scenario, counter in counts.items()]
    return [["first alert after a", *called], *rows]


def _called(one: FleetResult) -> str:
    """Return the kind, and whether it was at another element."""
    named, change = one.outcome.named[0], one.changes[0]
    if named is None:
        return "nothing"
    return named[0] if named[0] != change[0] or named == change else f"{named[0]} elsewhere"


def _grouped(
    found: Sequence[FleetResult], scenarios: Sequence[str], key: Callable[[Ordered], tuple[str, ...]], whole: tuple[str, ...]
) -> dict[tuple[str, ...], list[FleetResult]]:
    """Return the results of some scenarios by key, and all of them together at the end, if that has a name."""
    groups: dict[tuple[str, ...], list[FleetResult]] = defaultdict(list)
    chosen = [one for one in found if one.ordered.scenario in scenarios]
    for one in chosen:
        groups[key(one.ordered)].append(one)
    return groups | ({whole: chosen} if whole and chosen else {})


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet", description="Simulated fleets, identified and judged")
    parser.add_argument("--short", action="store_true", help="a few machines, half a minute")
    words = "times as many machines, default 1; another factor of some scenarios as NAME=FACTOR"
    parser.add_argument("--scale", nargs="+", type=scaled, default=[("", 1.0)], metavar="FACTOR", help=words)
    parser.add_argument("--seed", type=int, default=SEED, help=f"default {SEED}")
    parser.add_argument("--only", nargs="*", help="these scenarios only")
    parser.add_argument("--processes", type=int, default=PROCESSES, help=f"default {PROCESSES}")
    parser.add_argument("--keep", type=Path, help="folder that keeps what was identified, to judge it again")
    parser.add_argument("--write", action="store_true", help="write docs/evidence-fleets.md with its figures")
    options = parser.parse_args(arguments)
    chosen = SHORT if options.short else fleets(dict(options.scale))
    orders = [order for one in chosen if one.scenario in (options.only or SCENARIOS) for order in one.orders(options.seed)]
    began = time.monotonic()
    found = each(partial(result, keep=options.keep), orders, processes=options.processes)
    years = sum(order.watched for order in orders) / WEEKS_A_YEAR
    amount = f"{len(orders)} machines, {years:.0f} machine-years of real identifications; seed {options.seed}"
    print(f"{amount}, {time.monotonic() - began:.0f} s\n")
    parts = report(found)
    print("\n\n".join(map(_table, parts)))
    if options.write:
        command = figures_command(sys.argv[1:] if arguments is None else arguments)
        print(f"\nwritten: {write_page(parts, command=command, amount=amount)}")


def figures_command(arguments: Sequence[str]) -> str:
    """Return the arguments that figures depend on: not in how many processes, nor what is kept where."""
    left_out = {place + more for place, one in enumerate(arguments) if one in ("--processes", "--keep") for more in (0, 1)}
    return shlex.join(one for place, one in enumerate(arguments) if place not in left_out)


def scaled(word: str) -> tuple[str, float]:
    """Return a factor with the scenario that it is for, "" for all others. Raises ArgumentTypeError."""
    scenario, _, factor = word.rpartition("=")
    try:
        if scenario and scenario not in SCENARIOS:
            raise ValueError(scenario)
        return scenario, float(factor)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{word}' is neither a factor nor NAME=FACTOR of a scenario") from None
