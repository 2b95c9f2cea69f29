"""Figures of a fleet on oil films: steps that pedestals have grown against, and how rare false alerts are shown to be."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

from benchmarks.alignment.film_fleet import FleetRecord, OpenedAlert, record_name
from benchmarks.alignment.film_histories import HAPPENINGS, LONGEST_BASELINE, WEEKS_A_YEAR, FilmHistory
from benchmarks.alignment.fleet_figures import FleetRecords, false_figures, fleet_figures, fleet_of, together_figures
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes

WEEKS = 16
MISALIGNED = (("misalignment", "coupling.C1", "alert"),)


def record(history: FilmHistory, *, moved_um: float, named: bool) -> FleetRecord:
    standing = [MISALIGNED if named and week >= history.onset else () for week in range(WEEKS)]
    return FleetRecord(
        seed=history.seed,
        kind=history.kind,
        happening=history.happening,
        onset=history.onset,
        weeks=WEEKS,
        baseline=5,
        refused=(),
        missed=(),
        opened=(),
        standing=tuple(standing),
        offsets=(0.0,) * WEEKS,
        told_um=moved_um if named else None,
        true_um=moved_um,
        named=("misalignment", "coupling.C1"),
        processor_s=1.0,
    )


def test_steps_that_growth_has_made_smaller_are_told_apart(tmp_path: Path) -> None:
    kept = KeptOutcomes(tmp_path / "kept", benchmark="benchmarks.alignment")
    for seed, moved_um, named in ((0, -28.0, True), (1, -8.0, False)):
        history = FilmHistory(100 + seed, "rigid", "step", LONGEST_BASELINE + 2 + seed)
        kept.outcome(record_name(history, weeks=WEEKS), FleetRecord, partial(record, history, moved_um=moved_um, named=named))
    token = KEEPING.set(kept)
    try:
        found = fleet_of("rigid", 2, weeks=WEEKS, happenings=("step",), kept_only=True)
    finally:
        KEEPING.reset(token)
    told = {one.what.strip(): one.measured for one in fleet_figures("rigid", found)}
    assert told["step: named within 3 runs"].startswith("1 of 2")
    assert told["where pedestals have not grown against it"] == "1 of 1"


def test_weeks_in_which_a_named_step_stands_under_another_name_are_counted() -> None:
    right, wrong = ("misalignment", "coupling.C1", "warning"), ("wear", "bearing.B2", "warning")
    history = FilmHistory(100, "rigid", "step", LONGEST_BASELINE + 2)
    one = replace(record(history, moved_um=-28.0, named=True), standing=((), (right,), (right,), (), (right, wrong), (right,)))
    found: FleetRecords = {name: [] for name in HAPPENINGS} | {"step": [one]}
    told = {each.what.strip(): each for each in fleet_figures("rigid", found)}
    assert told["its kind stays while it stands"].measured == "3 of 5 weeks"
    assert not told["its kind stays while it stands"].kept


@pytest.mark.parametrize(
    ("machines", "false", "kept"), [(40, 0, True), (40, 1, False), (85, 0, True), (85, 1, False), (130, 1, True)]
)
def test_a_rate_is_as_low_as_asked_only_where_enough_years_show_it(machines: int, false: int, kept: bool) -> None:
    """Each lives a year behind its baseline: 3.69 / 0.044 = 84 years without a false alert are enough, 127 with one."""
    history = FilmHistory(1, "rigid", "healthy", WEEKS)
    weeks = 5 + WEEKS_A_YEAR
    quiet = replace(record(history, moved_um=0.0, named=False), weeks=weeks, offsets=(0.0,) * weeks)
    wrong = replace(quiet, opened=(OpenedAlert(30, "misalignment", "coupling.C1", "warning", 40.0),))
    found: FleetRecords = {name: [] for name in HAPPENINGS}
    found["healthy"] = [wrong] * false + [quiet] * (machines - false)
    told = {one.what.strip(): one for one in false_figures(found)}
    assert told["false misalignment alerts, healthy, upper bound a machine-year"].kept is kept


@pytest.mark.parametrize(
    ("machines", "missed", "kept"), [(30, 0, True), (36, 0, True), (36, 1, False), (60, 1, True), (60, 2, False)]
)
def test_the_lower_end_is_asked_for_where_the_machines_suffice(machines: int, missed: int, kept: bool) -> None:
    """Of 36 machines all must be named for a lower end of 0.9, of 60 all but one: 0.9026 and 0.9106; of 30 none."""
    history = FilmHistory(1, "rigid", "wear", LONGEST_BASELINE + 2)
    found: FleetRecords = {name: [] for name in HAPPENINGS}
    found["wear"] = [record(history, moved_um=0.0, named=place >= missed) for place in range(machines)]
    told = {one.what.strip(): one for one in together_figures(found)}
    assert told["wear: named within 3 runs"].kept is kept
