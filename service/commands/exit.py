"""Ends a command that cannot do what it was asked for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

import typer

from estimator.close_matches import did_you_mean
from service.commands.json_output import is_awaited, print_json
from service.commands.terminal import print_text

if TYPE_CHECKING:
    from storage.database.engine import Database

MOST_LISTED = 10
"""Most machines that are listed where none has a name like the one given."""


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


def fail_for_unknown_machine(database: "Database", name: str) -> NoReturn:
    """Print that there is no machine of this id, and which there are, and exit with status 1."""
    from storage.machines.machines import list_ids

    with database.reading() as session:
        known = list_ids(session)
    fail(f"no machine '{name}' is known{did_you_mean(name, known) or _listed(known)}")


def fail_for_unknown_key(database: "Database", prefix: str) -> NoReturn:
    """Print that no key has this prefix, and which are like it, and exit with status 1."""
    from storage.operation.api_keys import list_all

    with database.reading() as session:
        known = [row.prefix for row in list_all(session)]
    fail(f"no key '{prefix}' is known{did_you_mean(prefix, known) or '; rundown key list shows all'}")


def _listed(known: Sequence[str]) -> str:
    if not known:
        return "; the database holds none"
    return f"; there are {', '.join(known[:MOST_LISTED])}{', …' if len(known) > MOST_LISTED else ''}"
