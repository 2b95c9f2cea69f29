"""Figures of a fleet on oil films: what is named, how soon, how far off, and how often nothing was there."""

from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks.alignment.film_fleet import FleetRecord, record_name, record_of
from benchmarks.alignment.film_histories import (
    HAPPENINGS,
    LONGEST_BASELINE,
    RUN_OUTS,
    STEPS,
    WEEKS_A_YEAR,
    FilmHistory,
    Happening,
)
from benchmarks.fleet.report import part_interval, rate_bound
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import is_kept
from tests.film_plant.motor_compressor import CouplingKind

SOON: dict[Happening, int] = {
    "step": 3,
    "beyond": 4,
    "wear": 3,
    "unbalance": 3,
    "gain": 3,
    "bore": 3,
    "face": 3,
    "pedestal": 3,
}
"""Runs within which what happens is asked to be named."""
PARTS: dict[Happening, float] = {
    "step": 0.99,
    "beyond": 0.95,
    "wear": 0.9,
    "unbalance": 0.9,
    "gain": 0.9,
    "bore": 0.95,
    "face": 0.95,
    "pedestal": 0.9,
}
"""Part of the machines in which that is asked [-]."""
DISTURBANCES: tuple[Happening, ...] = ("wear", "unbalance", "gain", "pedestal")
"""Happenings that are no misalignment; of these the interval's lower end is asked for, where the machines suffice."""
NOTHING_MOVED = 0.125
"""Part of what is allowed up to which a misalignment that is told is a false one [-]: half of what is told."""
FALSE_RATE, DISTURBED_RATE, ALL_RATE = 0.044, 0.098, 0.2
"""False misalignment alerts a machine-year of healthy and of disturbed machines (upper ends of intervals), and false alerts of
any kind of healthy ones [1/year]."""
WHOLE_STEP = 0.9
"""Part of a step that is left, beside the growth of pedestals since the baseline, where it counts as a whole one [-]."""
NEAR, IN_PART = 0.3, 0.9
"""Error of a size that is told [-], and the part of the machines in which that is asked [-]."""


LEAST_STAYING = 0.95
"""Least part of the weeks in which a step that was named still stands under that name [-]."""

FleetRecords = dict[Happening, list[FleetRecord]]
"""Records of a fleet by what happened to its machines."""


def fleet_of(
    kind: CouplingKind, machines: int, *, weeks: int, happenings: Sequence[Happening], kept_only: bool = False
) -> FleetRecords:
    """Return what became of so many machines with one kind of coupling for each thing that happens.

    kept_only: only those of which it is kept what became of them.
    """
    found: FleetRecords = {happening: [] for happening in HAPPENINGS}
    for happening in happenings:
        for seed in range(machines):
            onset = weeks if happening == "healthy" else LONGEST_BASELINE + 2 + seed % 5
            history = FilmHistory(100 * HAPPENINGS.index(happening) + seed, kind, happening, onset)
            if not kept_only or is_kept(record_name(history, weeks=weeks)):
                found[happening].append(record_of(history, weeks=weeks))
    return found


def fleet_figures(kind: CouplingKind, found: FleetRecords) -> Iterator[ReportLine]:
    """Yield the figures of a fleet with one kind of coupling."""
    every = [one for records in found.values() for one in records]
    if not every:
        return
    yield from _beside(kind, every)
    for named, soon in SOON.items():
        if found[named]:
            yield _named(named, found[named], soon)
        if named == "step":
            yield from _whole_steps(kind, found[named])
            yield from _staying(found[named])
    if moved := [*found["step"], *found["beyond"]]:
        yield _sizes(moved)
    yield from _alarms(found["beyond"], found["within"])
    yield from false_figures(found)


def run_out_figures(kind: CouplingKind, machines: int) -> Iterator[ReportLine]:
    """Yield of a few machines, each no longer watched than is asked, whether run-outs of their coupling are named."""
    for happening in RUN_OUTS:
        soon = SOON[happening]
        onset = LONGEST_BASELINE + 1
        histories = [FilmHistory(seed, kind, happening, onset) for seed in range(machines)]
        found = [record_of(one, weeks=onset + soon) for one in histories]
        yield _named(happening, found, soon)
        others = {(alert.rule, alert.element) for one in found for alert in one.opened} - {found[0].named}
        told = ", ".join(f"{rule} {element}" for rule, element in sorted(others)) or "nothing"
        yield ReportLine("        called otherwise", "nothing", told, not others)


def _beside(kind: CouplingKind, every: Sequence[FleetRecord]) -> Iterator[ReportLine]:
    runs, refused = sum(one.weeks for one in every), sum(len(one.refused) for one in every)
    yield ReportLine(f"{kind} coupling, {len(every)} machines, {runs} runs: refused", "", f"{refused}", True)
    years = runs / WEEKS_A_YEAR
    took = sum(one.processor_s for one in every) / years
    middle = float(np.median([one.processor_s / one.weeks * WEEKS_A_YEAR for one in every]))
    said = f"{took:.0f} (median {middle:.0f})"
    yield ReportLine("    processor time of a machine-year [s]", "<= 45", said, took <= 45.0)


def _named(happening: Happening, records: Sequence[FleetRecord], soon: int) -> ReportLine:
    right = [_is_named(one, soon) for one in records]
    low, high = part_interval(sum(right), len(right))
    asked = PARTS[happening]
    enough = happening in DISTURBANCES and part_interval(len(right), len(right))[0] >= asked
    kept = low >= asked if enough else high >= asked  # of few machines no more can be said
    measured = f"{sum(right)} of {len(right)} ({low:.0%}-{high:.0%})"
    return ReportLine(f"    {happening}: named within {soon} runs", f">= {asked:.0%}", measured, kept)


def _staying(records: Sequence[FleetRecord]) -> Iterator[ReportLine]:
    """Yield in which part of the weeks since it was first named a step stands under its name and no other."""
    weeks = []
    for one in records:
        standing = [{(rule, element) for rule, element, _ in week} for week in one.standing]
        first = next((place for place, week in enumerate(standing) if one.named in week), len(standing))
        weeks += [week == {one.named} for week in standing[first:]]
    if weeks:
        part = sum(weeks) / len(weeks)
        said = f"{sum(weeks)} of {len(weeks)} weeks"
        yield ReportLine("        its kind stays while it stands", f">= {LEAST_STAYING:.0%}", said, part >= LEAST_STAYING)


def _whole_steps(kind: CouplingKind, records: Sequence[FleetRecord]) -> Iterator[ReportLine]:
    """Yield how many steps are named of those that the growth of pedestals since the baseline has not made smaller."""
    whole = [one for one in records if abs(one.true_um) >= WHOLE_STEP * 1e6 * STEPS[kind]]
    if whole:
        said = f"{sum(_is_named(one, SOON['step']) for one in whole)} of {len(whole)}"
        yield ReportLine("        where pedestals have not grown against it", "", said, True)


def _is_named(one: FleetRecord, soon: int) -> bool:
    weeks = one.standing[one.onset : one.onset + soon]
    return any((rule, element) == one.named for week in weeks for rule, element, _ in week)


def _sizes(records: Sequence[FleetRecord]) -> ReportLine:
    told = [one for one in records if one.told_um is not None]
    near = [abs((one.told_um or 0.0) - one.true_um) <= NEAR * abs(one.true_um) for one in told]
    part = float(np.mean(near)) if near else 0.0
    return ReportLine(
        f"    size told after 3 runs within 30 %, of {len(told)} of {len(records)} told",
        f">= {IN_PART:.0%}",
        f"{part:.0%}",
        part >= IN_PART,
    )


def _alarms(beyond: Sequence[FleetRecord], within: Sequence[FleetRecord]) -> Iterator[ReportLine]:
    if not beyond or not within:
        return
    alarmed = [any(_in_danger(week) for week in one.standing[one.onset : one.onset + SOON["beyond"]]) for one in beyond]
    low, high = part_interval(sum(alarmed), len(alarmed))
    said = f"{sum(alarmed)} of {len(alarmed)} ({low:.0%}-{high:.0%})"
    yield ReportLine("    alarm for twice what is allowed within 4 runs", ">= 95 %", said, high >= 0.95)
    weeks = [_in_danger(week) for one in within for week in one.standing[one.baseline :]]
    part = float(np.mean(weeks)) if weeks else 0.0
    yield ReportLine("    alarm for half of what is allowed, of all runs", "< 1 %", f"{part:.1%} of {len(weeks)}", part < 0.01)


def _in_danger(week: Sequence[tuple[str, str, str]]) -> bool:
    return any(rule == "misalignment" and severity == "danger" for rule, _, severity in week)


def together_figures(found: FleetRecords) -> Iterator[ReportLine]:
    """Yield of the machines with all couplings how many disturbances are named, and what is told that is not there."""
    for name in DISTURBANCES:
        if found[name]:
            yield _named(name, found[name], SOON[name])
    yield from false_figures(found)


def false_figures(found: FleetRecords) -> Iterator[ReportLine]:
    """Yield how often an alert is opened for what is not there."""
    healthy = found["healthy"]
    disturbed = [one for name in DISTURBANCES for one in found[name]]
    for what, records, asked in (("healthy", healthy, FALSE_RATE), ("disturbed", disturbed, DISTURBED_RATE)):
        if not records:
            continue
        years = sum(one.weeks - one.baseline for one in records) / WEEKS_A_YEAR
        wrong = sum(_is_false(one, alert.week) for one in records for alert in one.opened if alert.rule == "misalignment")
        bound = rate_bound(wrong, years)
        enough = years >= rate_bound(0, 1.0) / asked  # of fewer machine-years the bound cannot be as low as asked
        yield ReportLine(
            f"    false misalignment alerts, {what}, upper bound a machine-year",
            f"<= {asked:g}",
            f"{wrong} in {years:.1f}: {bound:.3f}",
            bound <= asked if enough else wrong == 0,
        )
    if not healthy:
        return
    years = sum(one.weeks - one.baseline for one in healthy) / WEEKS_A_YEAR
    others = sum(alert.rule != "misalignment" or _is_false(one, alert.week) for one in healthy for alert in one.opened)
    rate = others / max(years, 1e-9)
    yield ReportLine(
        "    false alerts of any kind, healthy, a machine-year", f"< {ALL_RATE:g}", f"{others} in {years:.1f}", rate < ALL_RATE
    )


def _is_false(one: FleetRecord, week: int) -> bool:
    """Check whether the coupling had hardly moved in that week."""
    return abs(one.offsets[week]) < NOTHING_MOVED
