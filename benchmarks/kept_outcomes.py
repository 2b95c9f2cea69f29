"""Outcomes of trials kept in a file, so that a benchmark of hours that is stopped goes on where it was."""

import json
import subprocess
from collections.abc import Callable
from contextvars import ContextVar
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np

from tests.imports import ROOT, imported_by, path_of

DOCUMENTS = "examples"
"""Folder of the documents that benchmarks read."""
PAGE = "page.py"
"""Name of modules that only write outcomes down, whatever these are."""
T = TypeVar("T")


class KeptOutcomes:
    """Outcomes by name in a file, a line of JSON each: those of this code are taken from it, others computed and added."""

    def __init__(self, file: Path, *, benchmark: str) -> None:
        """Read what a benchmark's earlier runs kept with this code; a line that was cut short is computed again.

        file: where outcomes are kept. benchmark: module or package that is run, on whose code they rest.
        """
        self._file = file
        self._commit = commit(benchmark)
        self._known: dict[str, Any] = {}
        for line in file.read_text(encoding="utf-8").splitlines() if file.exists() else []:
            try:
                row = json.loads(line)
            except ValueError:
                continue
            if row["commit"] == self._commit:
                self._known[row["name"]] = row["outcome"]

    def __contains__(self, name: str) -> bool:
        """Return whether the outcome of a name is kept."""
        return name in self._known

    def outcome(self, name: str, kind: type[T], compute: Callable[[], T]) -> T:
        """Return an outcome, computed and kept where it is not known yet.

        name: name of the trial, which no other has. kind: type of its outcome. compute: function that makes it.
        """
        if name in self._known:
            return msgspec.convert(self._known[name], kind)
        found = compute()
        self._known[name] = msgspec.to_builtins(found, enc_hook=_without_numpy)
        with self._file.open("a", encoding="utf-8") as file:
            line = json.dumps({"commit": self._commit, "name": name, "outcome": self._known[name]})
            file.write(f"\n{line}")  # on a line of its own also after one that was cut short
        return found


KEEPING: ContextVar[KeptOutcomes | None] = ContextVar("KEEPING", default=None)
"""Outcomes that the running benchmark keeps; None where it keeps none."""


def kept_or_computed(name: str, kind: type[T], compute: Callable[[], T]) -> T:
    """Return the outcome that is kept under a name, else the one that is computed."""
    keeping = KEEPING.get()
    return compute() if keeping is None else keeping.outcome(name, kind, compute)


def is_kept(name: str) -> bool:
    """Return whether an outcome is kept under a name."""
    keeping = KEEPING.get()
    return keeping is not None and name in keeping


def commit(benchmark: str) -> str:
    """Return the commit that last changed what a benchmark runs, with a word where files differ from it.

    benchmark: module or package that is run; what counts are the modules of this project that it imports, and the documents.
    Outside a repository the commit is "unknown".
    """
    paths = (path_of(one) for one in imported_by(benchmark) | imported_by(f"{benchmark}.__main__"))
    code = [DOCUMENTS, *sorted(str(one) for one in paths if one is not None and one.name != PAGE)]
    try:
        name = _git("log", "-1", "--format=%h", "--", *code)
        changed = _git("status", "--porcelain", "--untracked-files=no", "--", *code)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{name} with changes" if changed else name


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def _without_numpy(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} cannot be kept as JSON")
