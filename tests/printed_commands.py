"""Runs commands that a page of the documentation prints."""

import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path


def run_printed(lines: Iterable[str], folder: Path) -> tuple[str, dict[str, str]]:
    """Run lines of a shell in a folder; return what they print, and the settings of the service that they export."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    script = "\n".join([*lines, "env -0 > environment"])
    command = ["bash", "-euc", script]
    done = subprocess.run(command, cwd=folder, env=os.environ | {"PATH": path}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = dict(one.split("=", 1) for one in (folder / "environment").read_text().split("\0") if one)
    return done.stdout, {name: value for name, value in found.items() if name.startswith("RUNDOWN_")}
