"""Alignment on fluid films: figures asked beside those measured, on misaligned plants of other make than the estimator.

Each plant is identified seven times, six of them as a baseline before its coupling moves; runs differ by 1 % in stiffness, 5
% in damping and 5 % in the viscosity of their oil. One half of the plants are drawn around a motor and compressor, the other
half around a turbine and its generator; one supply oils all bearings, whose viscosities differ by 3 %. One line a figure;
status 1 where one falls short. Coverage is judged from 20 plants on. `--short` takes one plant of each kind and about a
minute. Run-outs of couplings are tried on two machines of each kind.

`--fleet N` lets N machines of each kind live through weeks of run-downs for each thing that can happen, through the gate and
the service's own assessment, or with `--happening` for some of these things; `--pairs N` lets two things happen at once to N
machines of each train. With `--keep FILE` what was computed by this code is not computed again, and with `--kept` besides
nothing is computed: the figures are those of the plants, or of the fleet's machines, that the file keeps. `--write` takes all
that is asked, a day's work of a machine less what is kept, and writes docs/evidence-alignment.md from it.

    python -m benchmarks.alignment [--short] [--plants N] [--keep FILE [--kept]] [--only flexible|rigid …]
    python -m benchmarks.alignment --fleet N [--happening healthy …] [--weeks W] [--keep FILE [--kept]] [--only …]
    python -m benchmarks.alignment --pairs N [--keep FILE [--kept]] [--only …]
    python -m benchmarks.alignment --write [--keep FILE [--kept]] [--only …]
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from threadpoolctl import threadpool_limits

from benchmarks.alignment.alignment_figures import figures
from benchmarks.alignment.cause_pairs import pair_figures
from benchmarks.alignment.film_histories import HAPPENINGS
from benchmarks.alignment.fleet_figures import FleetRecords, fleet_figures, fleet_of, run_out_figures, together_figures
from benchmarks.alignment.page import write_page
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes
from tests.film_plant.motor_compressor import CouplingKind

KINDS: tuple[CouplingKind, ...] = ("rigid", "flexible")
SHORT_PLANTS = 1
USUAL_PLANTS = 80
RUN_OUT_PLANTS = 2
"""Number of plants whose coupling's run-outs are tried, one in a short run; a fleet tries as many as it has machines."""
PAIRED_MACHINES = 2
"""Machines of each train that the page tells of, for each pair of causes."""
HEALTHY_FLEET, OTHER_FLEET = (44, 58), (20, 20)
"""Machines with each kind of coupling, for each thing that happens, and their weeks, that the page tells of."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each figure; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.alignment", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--short", action="store_true", help="one plant with each kind of coupling")
    parser.add_argument(
        "--plants", type=int, default=USUAL_PLANTS, help="number of plants with each kind of coupling, seeds 0, 1, …"
    )
    parser.add_argument("--fleet", type=int, help="number of machines with each kind of coupling, for each thing that happens")
    parser.add_argument("--pairs", type=int, help="number of machines of each train, for each pair of causes")
    parser.add_argument("--weeks", type=int, default=26, help="weeks that they live, the baseline's six included")
    parser.add_argument("--keep", type=Path, help="file that keeps outcomes, from which a run of this code goes on")
    parser.add_argument("--kept", action="store_true", help="tell only of what the file keeps")
    parser.add_argument("--only", nargs="*", choices=KINDS)
    parser.add_argument("--write", action="store_true", help="write docs/evidence-alignment.md with all that is asked")
    parser.add_argument("--happening", nargs="*", choices=HAPPENINGS, default=HAPPENINGS, help="what happens in the fleet")
    chosen = parser.parse_args(arguments)
    if chosen.keep is not None:
        KEEPING.set(KeptOutcomes(chosen.keep, benchmark="benchmarks.alignment"))
    sections = (
        _asked(chosen) if chosen.write else [("", _fleet_figures(chosen) if chosen.fleet is not None else _figures(chosen))]
    )
    found: dict[str, list[ReportLine]] = {}
    print(f"  {'alignment':<76}{'asked':>12}{'measured':>24}")
    with threadpool_limits(limits=1):
        for name, lines in sections:
            found[name] = []
            for figure in lines:
                print(figure, flush=True)
                found[name].append(figure)
    if chosen.write:
        print(f"written: {write_page(found)}")
    if not all(figure.kept for figures in found.values() for figure in figures):
        raise SystemExit(1)


def _asked(chosen: argparse.Namespace) -> Iterator[tuple[str, Iterator[ReportLine]]]:
    """Yield the sections of the page and their figures, of all that is asked."""
    kinds: Sequence[CouplingKind] = chosen.only or KINDS
    for kind in kinds:
        yield f"Runs with a {kind} coupling", figures(kind, USUAL_PLANTS, kept_only=chosen.kept)
    fleets = {kind: _asked_fleet(kind, kept_only=chosen.kept) for kind in kinds}
    for kind, fleet in fleets.items():
        yield f"Machines with a {kind} coupling over weeks", fleet_figures(kind, fleet)
    if len(fleets) > 1:
        yield "Machines with all couplings", _together(list(fleets.values()))
    for kind in kinds:
        yield f"Two causes at once, {kind} coupling", pair_figures(kind, PAIRED_MACHINES, kept_only=chosen.kept)


def _asked_fleet(kind: CouplingKind, *, kept_only: bool) -> FleetRecords:
    machines, weeks = OTHER_FLEET
    happenings = [one for one in HAPPENINGS if one != "healthy"]
    others = fleet_of(kind, machines, weeks=weeks, happenings=happenings, kept_only=kept_only)
    machines, weeks = HEALTHY_FLEET
    healthy = fleet_of(kind, machines, weeks=weeks, happenings=["healthy"], kept_only=kept_only)
    return others | {"healthy": healthy["healthy"]}


def _figures(chosen: argparse.Namespace) -> Iterator[ReportLine]:
    """Yield the figures of single plants, or of pairs of causes."""
    for kind in chosen.only or KINDS:
        if chosen.pairs is not None:
            yield from pair_figures(kind, chosen.pairs, kept_only=chosen.kept)
            continue
        yield from figures(kind, SHORT_PLANTS if chosen.short else chosen.plants, kept_only=chosen.kept)
        if not chosen.kept:
            yield from run_out_figures(kind, SHORT_PLANTS if chosen.short else RUN_OUT_PLANTS)


def _fleet_figures(chosen: argparse.Namespace) -> Iterator[ReportLine]:
    """Yield the figures of fleets, and last of all couplings together what is named and what is told that is not there."""
    fleets = []
    for kind in chosen.only or KINDS:
        found = fleet_of(kind, chosen.fleet, weeks=chosen.weeks, happenings=chosen.happening, kept_only=chosen.kept)
        yield from fleet_figures(kind, found)
        fleets.append(found)
    if len(fleets) > 1:
        yield ReportLine("all couplings together", "", "", True)
        yield from _together(fleets)


def _together(fleets: Sequence[FleetRecords]) -> Iterator[ReportLine]:
    """Yield the figures of several fleets as of one."""
    yield from together_figures({happening: [one for fleet in fleets for one in fleet[happening]] for happening in HAPPENINGS})


if __name__ == "__main__":
    main()
