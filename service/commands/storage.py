"""The commands that keep data safe: `rundown backup`, `restore`, `move` and `export`."""

from pathlib import Path
from typing import Annotated

import typer

from service.commands.exit import fail, fail_for_unknown_machine, words_of
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, working
from service.configuration.settings import SettingsWrong, settings_of

DatabaseUrl = Annotated[str | None, typer.Option(help="SQLAlchemy URL; by default the setting `database`")]


def backup(
    file: Annotated[Path, typer.Argument(help="file to write; FILE.json beside it says what it is")],
    database: DatabaseUrl = None,
    as_json: JsonOption = False,
) -> None:
    """Copy the database as of one moment, while the service runs."""
    from storage.backup import backup as backups
    from storage.backup.backup_file import BackupUnusable
    from storage.database.claim import DatabaseUnusable

    try:
        with working("copying the database") as report:
            made = backups.back_up(database_url(database), file, report)
    except (BackupUnusable, DatabaseUnusable) as error:
        fail(str(error))
    if as_json:
        print_json({"file": file, "made_at": made.made_at, "rows": made.rows, "bytes": made.size, "sha256": made.sha256})
        return
    print_line(f"{file}: {sum(made.rows.values())} rows of {made.made_at}, {made.size / 1e6:.1f} MB, SHA-256 {made.sha256}")


def restore(
    file: Annotated[Path, typer.Argument(help="file that `rundown backup` wrote")],
    database: DatabaseUrl = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="lose what the database holds now")] = False,
    without_keys: Annotated[
        bool, typer.Option("--without-keys", help="though the backup has no API key: nobody is asked who they are")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Replace the database by a backup, while no service runs."""
    from storage.backup import backup as backups
    from storage.backup.backup_file import BackupUnusable
    from storage.database.claim import DatabaseUnusable

    try:
        with working("restoring the database") as report:
            restored = backups.restore(database_url(database), file, report, overwrite=overwrite, without_keys=without_keys)
    except (BackupUnusable, DatabaseUnusable) as error:
        fail(str(error))
    found, access = restored.backup, restored.access
    if as_json:
        print_json({"made_at": found.made_at, "rows": found.rows, "access": access})
        return
    print_line(f"{sum(found.rows.values())} rows of {found.made_at} restored")
    if access.sessions:
        print_line(f"{access.sessions} browser sessions of the backup are over: people log in again")
    if access.revoked:
        print_line(f"keys revoked since the backup stay revoked: {', '.join(access.revoked)}")
    if access.waiting:
        waiting = ", ".join(access.waiting)
        print_line(f"keys that open nothing before they are confirmed, as they may have been revoked since: {waiting}")
        print_line("rundown key list shows whose they are; rundown key confirm PREFIX, or --all, lets them be good again")
    if access.keyless:
        print_line(
            "the backup is older than the first API key: without one nobody is asked who they are. Before the start, "
            "rundown key create makes one, or set authentication=required",
            err=True,
        )


def move(
    source: Annotated[str, typer.Argument(metavar="FROM_URL", help="database with the data")],
    target: Annotated[str, typer.Argument(metavar="TO_URL", help="a new database, SQLite or PostgreSQL")],
    as_json: JsonOption = False,
) -> None:
    """Copy all data into a new database, while no service runs: from SQLite to PostgreSQL, or back."""
    from sqlalchemy.exc import DBAPIError

    from storage.backup.transfer import TransferFailed
    from storage.backup.transfer import move as move_data
    from storage.database.claim import DatabaseUnusable

    try:
        with working("moving the data") as report:
            moved = move_data(source, target, report)
    except (TransferFailed, DatabaseUnusable) as error:
        fail(str(error))
    except DBAPIError as error:
        fail(f"the data were not taken over, the new database is empty: {error.orig}")
    if as_json:
        print_json({"rows": moved.rows, "texts_with_escaped_nul": moved.escaped})
        return
    for name, count in moved.rows.items():
        print_line(f"{name:24s} {count:12d}")
    for name, count in moved.escaped.items():
        print_line(
            f"{name}: NUL in {count} texts, which PostgreSQL cannot hold, is \\x00 there, and their backslashes are doubled"
        )
    print_line("all of them compared: the same on both sides")


def export(
    machine: Annotated[str, typer.Argument(help="id of the machine")],
    folder: Annotated[Path, typer.Argument(help="new or empty folder")],
    database: DatabaseUrl = None,
    as_json: JsonOption = False,
) -> None:
    """Write a machine's history as CSV and Parquet; columns.json explains each column.

    Identifications, trends, derived quantities, diagnoses, baselines, alerts and their events, suppressions, limits, the
    timeline, calibrations, slow-roll vectors, operating states, runs and their samples, and the machine's documents.
    """
    from service.export.column_writer import ParquetMissing
    from service.export.history import export as export_history
    from storage.database.claim import DatabaseUnusable
    from storage.database.engine import Database, require_file
    from storage.machines.machines import MachineUnknown

    try:
        url = database_url(database)
        require_file(url)
        opened = Database(url)
    except DatabaseUnusable as error:
        fail(str(error))
    try:
        with working("writing the history") as report:
            written = export_history(opened, machine, folder, report)
        if as_json:
            print_json({"machine": machine, "folder": folder, "rows": written})
        else:
            for name, count in written.items():
                print_line(f"{name:24s} {count:12d}")
    except MachineUnknown:
        fail_for_unknown_machine(opened, machine)
    except (ParquetMissing, OSError) as error:
        fail(words_of(error))
    finally:
        opened.close()


def database_url(given: str | None) -> str:
    """Return the given URL, or that of the settings."""
    try:
        return given or settings_of().database
    except SettingsWrong as error:
        fail(str(error))
