"""Ends a command that cannot do what it was asked for."""

from typing import NoReturn

import typer

from service.commands.terminal import print_text


def fail(message: str) -> NoReturn:
    """Print the reason, and exit with status 1."""
    print_text(f"rundown: {message}", err=True)
    raise typer.Exit(1)
