"""Ends a command that cannot do what it was asked for."""

from typing import NoReturn

import typer

from service.commands.json_output import is_awaited, print_json
from service.commands.terminal import print_text


def fail(message: str) -> NoReturn:
    """Print the reason, with --json also as `error` where no result was printed before it, and exit with status 1."""
    if is_awaited():
        print_json({"error": message})
    print_text(f"rundown: {message}", err=True)
    raise typer.Exit(1)


def words_of(error: Exception) -> str:
    """Return what an error says, of files without the system's number of it."""
    if isinstance(error, OSError) and error.filename is not None and error.strerror:
        return f"{error.filename}: {error.strerror}"
    return str(error)
