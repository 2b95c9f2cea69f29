"""How a command ends that cannot do what it was asked for."""

from typing import NoReturn

import typer


def fail(message: str) -> NoReturn:
    """Say why, and end with status 1."""
    typer.echo(f"rundown: {message}", err=True)
    raise typer.Exit(1)
