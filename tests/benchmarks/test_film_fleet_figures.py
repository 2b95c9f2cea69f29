"""Figures of a fleet on oil films: a step that pedestals have grown against is told apart from a whole one."""

from functools import partial
from pathlib import Path

from benchmarks.alignment.film_fleet import FleetRecord, record_name
from benchmarks.alignment.film_histories import LONGEST_BASELINE, FilmHistory
from benchmarks.alignment.fleet_figures import fleet_figures
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
    kept = KeptOutcomes(tmp_path / "kept")
    for seed, moved_um, named in ((0, -28.0, True), (1, -8.0, False)):
        history = FilmHistory(100 + seed, "rigid", "step", LONGEST_BASELINE + 2 + seed)
        kept.outcome(record_name(history, weeks=WEEKS), FleetRecord, partial(record, history, moved_um=moved_um, named=named))
    token = KEEPING.set(kept)
    try:
        told = {one.what.strip(): one.measured for one in fleet_figures("rigid", 2, weeks=WEEKS, kept_only=True)}
    finally:
        KEEPING.reset(token)
    assert told["step: named within 3 runs"].startswith("1 of 2")
    assert told["where pedestals have not grown against it"] == "1 of 1"
