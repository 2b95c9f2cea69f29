"""Trials kept in a file: a run goes on where it was stopped, on the same commit only."""

import json
from collections import defaultdict
from pathlib import Path
from typing import cast

import numpy as np

from benchmarks.fluid_film.kept_trials import FilmTrial, KeptTrials, commit


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

    first = KeptTrials(file).trial("lobes", 3, compute)
    assert KeptTrials(file).trial("lobes", 3, compute) == first
    assert len(made) == 1
    KeptTrials(file).trial("lobes", 4, compute)
    KeptTrials(file).trial("pads", 3, compute)
    assert len(made) == 3
    rows = [json.loads(line) | {"commit": "another"} for line in file.read_text(encoding="utf-8").splitlines()]
    file.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    KeptTrials(file).trial("lobes", 3, compute)
    assert len(made) == 4
    assert commit()
