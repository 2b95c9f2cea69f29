"""Prints text on the terminal: nothing that is stored or came from elsewhere steers it.

Escaped are control characters (C0, DEL, C1) and those that turn the order of letters around or are not seen.
"""

import typer

from storage.encoding.text import plain_lines, plain_text


def say(line: str, *, err: bool = False) -> None:
    """Print one line on the standard output or the standard error output, whatever it holds."""
    typer.echo(plain_text(line), err=err)


def say_lines(text: str, *, err: bool = False) -> None:
    """Print a text whose line breaks are our own."""
    typer.echo(plain_lines(text), err=err)
