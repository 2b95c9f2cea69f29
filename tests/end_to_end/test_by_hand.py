"""The commands of README and first steps, run as printed."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from service.commands.help_panels import EXAMPLES as EXAMPLES_OF_HELP
from service.commands.help_panels import PANELS
from tests.end_to_end.processes import EXAMPLES, ROOT
from tests.ports import free_port

SCRIPT = EXAMPLES / "by-hand.sh"
LONGEST_S = 240.0
LARGEST_PICTURE = 150_000


FIRST_STEPS = ROOT / "docs" / "first-steps.md"
OFFLINE = ("Try it", "Analyse recorded runs")
"""Panels of the help whose commands need no service."""


def blocks(language: str, page: Path) -> list[str]:
    """Return a page's blocks in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the examples and the command `rundown`, as a checkout has them."""
    folder = tmp_path_factory.mktemp("checkout")
    (folder / "examples").symlink_to(EXAMPLES)
    (folder / "bin").mkdir()
    command = folder / "bin" / "rundown"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m service "$@"\n')
    command.chmod(0o755)
    return folder


def test_the_first_steps_print_the_script() -> None:
    _, script = blocks("sh", FIRST_STEPS)
    assert script in SCRIPT.read_text()


def test_the_readme_fits_a_screen_and_its_picture_is_small() -> None:
    readme = (ROOT / "README.md").read_text()
    assert len(readme.splitlines()) <= 60
    (picture,) = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", readme)
    assert (ROOT / picture).read_bytes().startswith(b"\x89PNG")
    assert (ROOT / picture).stat().st_size < LARGEST_PICTURE


def run_lines(lines: str, checkout: Path, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run lines of a shell in a folder, with the command `rundown`."""
    around = os.environ | {"PATH": f"{checkout / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["sh", "-c", f"set -e\n{lines}"],
        cwd=folder,
        env=around,
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done


def test_the_first_steps_run_as_printed_in_an_empty_folder(checkout: Path, tmp_path: Path) -> None:
    done = run_lines(blocks("sh", FIRST_STEPS)[0], checkout, tmp_path)
    assert done.stderr == ""
    assert "changed coefficients: better than equivalent load" in done.stdout
    assert "Correction" in done.stdout


@pytest.mark.long
def test_examples_of_the_help_go_on_from_the_first_steps(checkout: Path, tmp_path: Path) -> None:
    script = blocks("sh", FIRST_STEPS)[0]
    ran = {line.partition("#")[0].strip() for line in script.splitlines()} | {EXAMPLES_OF_HELP["demo"]}
    shown = [EXAMPLES_OF_HELP[name] for panel in OFFLINE for name in PANELS[panel]]
    examples = [one for one in shown if one not in ran]
    assert 0 < len(examples) < len(shown)
    run_lines("\n".join([script, *examples]), checkout, tmp_path)


def test_the_five_lines_are_five() -> None:
    for page in (ROOT / "README.md", ROOT / "docs" / "python.md"):
        assert len(blocks("python", page)[0].splitlines()) == 5


def test_by_hand_runs_as_printed_and_python_after_it(checkout: Path) -> None:
    around = os.environ | {
        "PATH": f"{checkout / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "PORT": str(free_port()),
        "STREAM": f"tcp/127.0.0.1:{free_port()}",
        "MPLBACKEND": "Agg",
    }
    done = subprocess.run(
        ["sh", str(SCRIPT)], cwd=checkout, env=around, capture_output=True, text=True, timeout=LONGEST_S, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "accepted: χ²/dof" in done.stdout
    assert "changed coefficients: better than equivalent load" in done.stdout
    assert '"parameter":"coupling.C1.kxx"' in done.stdout
    assert (checkout / "by-hand" / "monday.db").stat().st_size > 0
    (python,) = blocks("python", ROOT / "README.md")
    shown = subprocess.run(
        [sys.executable, "-c", python],
        cwd=checkout,
        env=around,
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        check=False,
    )
    assert shown.returncode == 0, shown.stderr
    assert shown.stdout.startswith("motor-pump: accepted")
