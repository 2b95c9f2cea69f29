"""Tests that pytest takes what was rewritten ahead of it, and works out again what has changed since."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.rewritten_assertions import rewrite

FAILING = "def test_it():\n    one = {one}\n    assert one == 2\n"


def said_of(file: Path) -> str:
    """Run a file of tests in a process of its own; return what it says."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--noconftest", "-c", os.devnull, str(file)]
    around = os.environ | {"PYTHONDONTWRITEBYTECODE": ""}
    return subprocess.run(command, cwd=file.parent, env=around, capture_output=True, text=True, check=False).stdout


def test_what_was_rewritten_is_taken_until_the_file_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    file = tmp_path / "test_ahead.py"
    file.write_text(FAILING.format(one=1))
    outcome = rewrite(file)
    os.utime(outcome, (0.0, 0.0))
    assert "assert 1 == 2" in said_of(file)
    assert outcome.stat().st_mtime == 0.0, "taken as it is"
    file.write_text(FAILING.format(one=1_234))
    assert "assert 1234 == 2" in said_of(file)
    assert outcome.stat().st_mtime > 0.0
