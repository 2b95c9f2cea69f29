"""Rewrites the tests' assertions as pytest does, once: its processes would each do it, as they import the same files at once.

python -m tests.rewritten_assertions
"""

import functools
import multiprocessing
import sys
from pathlib import Path

import pytest
from _pytest.assertion import AssertionState
from _pytest.assertion.rewrite import PYC_TAIL, _read_pyc, _rewrite_test, _write_pyc, get_cache_dir, try_makedirs
from _pytest.config import get_config

from tests.paths import ROOT


def main() -> None:
    """Rewrite what no process has rewritten since it was changed."""
    files = sorted([*(ROOT / "tests").rglob("test_*.py"), *(ROOT / "tests").rglob("conftest.py")])
    with multiprocessing.Pool() as pool:
        pool.map(rewrite, [one for one in files if "node_modules" not in one.parts])


def rewrite(file: Path) -> Path:
    """Rewrite a file; return where pytest looks for the outcome."""
    outcome = get_cache_dir(file) / (file.name[:-3] + PYC_TAIL)
    if _read_pyc(file, outcome) is None and not sys.dont_write_bytecode and try_makedirs(outcome.parent):
        stamp, code = _rewrite_test(file, configuration())
        _write_pyc(AssertionState(configuration(), "rewrite"), code, stamp, outcome)
    return outcome


@functools.cache
def configuration() -> pytest.Config:
    """Return what the project says to pytest."""
    config: pytest.Config = get_config()
    config.parse(["--noconftest", str(ROOT / "tests")])
    return config


if __name__ == "__main__":
    main()
