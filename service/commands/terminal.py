"""Prints text on the terminal, with control characters escaped: no stored or foreign text can control the terminal.

Escaped are control characters (C0, DEL, C1) and those that reverse the direction of writing or are invisible.
"""

import typer

from storage.encoding.text import plain_lines, plain_text


def say(line: str, *, err: bool = False) -> None:
    """Print one line on the standard output or the standard error output, with everything else escaped."""
    typer.echo(plain_text(line), err=err)


def say_lines(text: str, *, err: bool = False) -> None:
    """Print a text that keeps its line breaks."""
    typer.echo(plain_lines(text), err=err)
