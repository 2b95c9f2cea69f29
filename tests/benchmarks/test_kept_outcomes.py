"""Outcomes kept in a file: a run goes on where it was stopped, with the same code only."""

import json
import math
from collections import defaultdict
from pathlib import Path
from typing import cast

import numpy as np

from benchmarks.fluid_film.film_trials import FilmTrial
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes, commit, is_kept, kept_or_computed
from tests.imports import imported_by

BENCHMARK = "benchmarks.alignment"


def test_a_kept_trial_is_not_computed_again_but_another_commits_is(tmp_path: Path) -> None:
    file, made = tmp_path / "trials", []

    def compute() -> FilmTrial:
        made.append(1)
        return FilmTrial(
            True,
            "accepted",
            0.5,
            inside=defaultdict(list, load=cast(list[bool], [np.True_, False])),
            errors={"a": 0.9},
            widths=(1.1, 1.2),
        )

    def trial(name: str) -> FilmTrial:
        return KeptOutcomes(file, benchmark=BENCHMARK).outcome(name, FilmTrial, compute)

    first = trial("lobes, 3")
    assert trial("lobes, 3") == first
    assert len(made) == 1
    trial("lobes, 4")
    trial("pads, 3")
    assert len(made) == 3
    rows = [json.loads(line) | {"commit": "another"} for line in file.read_text(encoding="utf-8").splitlines() if line]
    file.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    trial("lobes, 3")
    assert len(made) == 4
    assert commit(BENCHMARK)


def test_a_line_that_was_cut_short_is_computed_again_and_harms_no_other(tmp_path: Path) -> None:
    file = tmp_path / "outcomes"
    KeptOutcomes(file, benchmark=BENCHMARK).outcome("first", float, lambda: 0.5)
    with file.open("a", encoding="utf-8") as cut:
        cut.write('\n{"commit": "')
    assert "second" not in KeptOutcomes(file, benchmark=BENCHMARK)
    KeptOutcomes(file, benchmark=BENCHMARK).outcome("second", float, lambda: math.nan)
    kept = KeptOutcomes(file, benchmark=BENCHMARK)
    assert "first" in kept
    assert "second" in kept
    assert math.isnan(kept.outcome("second", float, lambda: 1.0))


def test_nothing_is_kept_where_no_file_is_named(tmp_path: Path) -> None:
    assert kept_or_computed("one", tuple[bool, bool], lambda: (True, False)) == (True, False)
    assert not is_kept("one")
    token = KEEPING.set(KeptOutcomes(tmp_path / "outcomes", benchmark=BENCHMARK))
    try:
        kept_or_computed("one", tuple[bool, bool], lambda: (True, False))
        assert is_kept("one")
        assert kept_or_computed("one", tuple[bool, bool], lambda: (False, False)) == (True, False)
    finally:
        KEEPING.reset(token)


def test_outcomes_rest_on_what_their_benchmark_imports_and_on_no_other() -> None:
    assert commit("benchmarks.alignment") != "unknown"
    run = imported_by("benchmarks.alignment.__main__")
    assert {"estimator.fit.identify", "tests.film_plant.motor_compressor", "storage.findings.identifications"} <= run
    assert not {one for one in run if one.startswith(("service.api", "benchmarks.calibration", "rotorundown"))}
