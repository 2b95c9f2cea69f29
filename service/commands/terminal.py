"""Prints text on the terminal, with control characters escaped: no stored or foreign text can control the terminal.

Escaped are control characters (C0, DEL, C1) and those that reverse the direction of writing or are invisible.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

from storage.encoding.text import plain_lines, plain_text


def print_line(line: str, *, err: bool = False) -> None:
    """Print one line on the standard output or the standard error output, with everything else escaped."""
    typer.echo(plain_text(line), err=err)


def print_text(text: str, *, err: bool = False) -> None:
    """Print a text that keeps its line breaks."""
    typer.echo(plain_lines(text), err=err)


@contextmanager
def working(what: str) -> Iterator[Callable[[int, int], None]]:
    """Show within the block that work goes on, and for how long, where a person looks at the standard error output.

    Yields a function that is told how much of how much is done, for work that knows it; a bar is shown from then on.
    """
    if not sys.stderr.isatty():
        yield _ignore_progress
        return
    # Only here: it takes a tenth of a second, and programs never see it.
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(plain_text(what), total=None)
        yield lambda done, total: progress.update(task, completed=done, total=max(total, 1))


def _ignore_progress(_done: int, _total: int) -> None:
    """Show no progress: the output goes to a file or a program."""
