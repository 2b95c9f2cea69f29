"""Files as arguments of commands: machine documents and recordings, the examples that come with Rundown among them."""

from pathlib import Path
from typing import Annotated

import typer

from rotorundown.environment.example_machines import found_example, is_own_example, other_examples
from service.commands.exit import fail
from service.commands.terminal import print_line


def named_file(path: Path) -> Path:
    """Return a path, or that of the example of this name where the working folder has none, and say so.

    Ends the command where `examples/…` names no file in either.
    """
    found = found_example(path)
    if found != path:
        print_line(f"{path} is not in this folder: taken from the examples that come with Rundown, {found}", err=True)
    elif others := other_examples(path):
        fail(f"there is no file {path}{others}")
    return found


def named_files(paths: list[Path] | None) -> list[Path] | None:
    """Return the paths that `named_file` finds."""
    return None if paths is None else [named_file(path) for path in paths]


def require_another(baseline: Path, files: list[Path]) -> None:
    """End the command where one of the files is a copy of the baseline."""
    for file in files:
        if file.is_file() and baseline.is_file() and file.read_bytes() == baseline.read_bytes():
            fail(f"{baseline} and {file} hold the same samples: one is a copy, and tells nothing new")


def written_beside(path: Path, name: str) -> Path:
    """Return the path of a file to write beside another; in the working folder where that one came with Rundown."""
    return Path(name) if path.is_absolute() and is_own_example(path) else path.with_name(name)


MachineFile = Annotated[Path, typer.Argument(help="machine document", callback=named_file)]
RunFiles = Annotated[
    list[Path], typer.Argument(help="recorded runs, as for replay; several are fitted together", callback=named_files)
]
