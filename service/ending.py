"""How a command ends that cannot do what it was asked for."""

from typing import NoReturn

import typer

from service.terminal import say_lines


def fail(message: str) -> NoReturn:
    """Say why, and end with status 1."""
    say_lines(f"rundown: {message}", err=True)
    raise typer.Exit(1)
