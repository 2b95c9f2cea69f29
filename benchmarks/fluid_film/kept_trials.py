"""Trials of a commit kept in a file, so that a benchmark that is stopped goes on where it was."""

import json
import subprocess
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class FilmTrial:
    """One identification by films.

    Attributes:
        accepted: Whether it was accepted.
        verdict: Its verdict.
        took: Processor time of the identification [s].
        again: Processor time of the identification of another run that starts from this one's end [s]; 0 where it was refused.
        inside: By kind, which intervals hold the truth; empty where it was refused.
        errors: By name, with the place of a speed in its stead, error over the bound; empty where it was refused or no bound
            was asked for.
        widths: Standard errors of direct stiffness terms over their bounds.
        failed: Whether it ended with an error of the linear algebra in place of a verdict.
        withheld: Part of the parameters that are not estimable, where that was asked for.
    """

    accepted: bool
    verdict: str
    took: float
    again: float = 0.0
    inside: dict[str, list[bool]] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    widths: tuple[float, ...] = ()
    failed: bool = False
    withheld: float = 0.0


class KeptTrials:
    """Trials in a file, a line each: those of this commit are taken from it, others are computed and added."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._commit = commit()
        self._known: dict[tuple[str, int], FilmTrial] = {}
        if file.exists():
            for line in file.read_text(encoding="utf-8").splitlines():
                row = json.loads(line)
                if row["commit"] == self._commit:
                    trial = row["trial"] | {"widths": tuple(row["trial"]["widths"])}
                    self._known[row["what"], row["seed"]] = FilmTrial(**trial)

    def trial(self, what: str, seed: int, compute: Callable[[], FilmTrial]) -> FilmTrial:
        """Return the trial of a seed. what: name of the trials, which no others have; compute: function that makes it."""
        found = self._known.get((what, seed))
        if found is None:
            found = self._known[what, seed] = compute()
            row = {"commit": self._commit, "what": what, "seed": seed, "trial": vars(found)}
            with self._file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row, default=bool) + "\n")
        return found


KEEPING: ContextVar[KeptTrials | None] = ContextVar("KEEPING", default=None)
"""Keeper of trials; None where none are kept."""


def kept_or_computed(what: str, seed: int, compute: Callable[[], FilmTrial]) -> FilmTrial:
    """Return the trial of a seed that is kept under a name, else the one that is computed."""
    keeping = KEEPING.get()
    return compute() if keeping is None else keeping.trial(what, seed, compute)


def commit() -> str:
    """Return the commit that is checked out, with a word where files differ from it; "unknown" outside a repository."""
    try:
        name = _git("rev-parse", "--short", "HEAD")
        changed = _git("status", "--porcelain", "--untracked-files=no", "--", "estimator", "tests/film_plant", "benchmarks")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{name} with changes" if changed else name


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
