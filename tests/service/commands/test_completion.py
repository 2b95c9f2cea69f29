"""A shell completes `rundown` as soon as completion is installed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.programs import program

FIRST_TAB = """
compdef() {}
_arguments() { print -r -- "$@" }
fpath=(~/.zfunc)
autoload -Uz _rundown
words=(rundown ide)
CURRENT=2
_rundown
"""
"""The first Tab of a session in zsh: it loads the function by its name and calls it."""


@pytest.fixture
def home(tmp_path: Path) -> dict[str, str]:
    """Return an environment with a home in which completion for zsh is installed, twice."""
    found = os.environ | {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    found["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for _ in range(2):
        subprocess.run(["rundown", "--install-completion", "zsh"], env=found, check=True, capture_output=True)
    return found


def test_what_is_installed_for_zsh_ends_with_a_call(home: dict[str, str]) -> None:
    script = (Path(home["HOME"]) / ".zfunc/_rundown").read_text()
    assert script.startswith("#compdef rundown")
    assert script.endswith("compdef _rundown_completion rundown\n_rundown_completion\n")


def test_zsh_completes_at_the_first_tab(home: dict[str, str]) -> None:
    done = subprocess.run([program("zsh"), "-fc", FIRST_TAB], env=home, check=True, capture_output=True, text=True)
    assert '"identify"' in done.stdout, done.stderr
