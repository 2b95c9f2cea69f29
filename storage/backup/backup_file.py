"""Files of a backup: all data as of one moment and, written last, a description in `<file>.json`. A file without its
description is not a complete backup."""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from storage.database.schema import KEPT_BY_ITSELF
from storage.files.private_files import PRIVATE
from storage.tables.base import Base

FORMAT = 1


class BackupUnusable(RuntimeError):
    """A backup cannot be made or restored; the message states the cause and the remedy."""


@dataclass(frozen=True)
class Backup:
    """Description of a backup. made_at: RFC 3339; rows: number of rows of each table."""

    format: int
    kind: str
    schema_revision: str
    made_at: str
    size: int
    sha256: str
    rows: dict[str, int]


def description_path(file: Path) -> Path:
    """Return the path of a backup's description."""
    return file.with_name(file.name + ".json")


def read(file: Path) -> Backup:
    """Return the description of a backup after verifying its checksum. Raises BackupUnusable."""
    try:
        values: dict[str, Any] = json.loads(description_path(file).read_text())
        found = Backup(**values)
        digest = synced_digest(file)
    except FileNotFoundError as error:
        raise BackupUnusable(f"{file} is no backup: there is no file {error.filename}") from error
    except (OSError, ValueError, TypeError) as error:
        raise BackupUnusable(f"{file} is no backup: {error}") from error
    if found.format != FORMAT:
        raise BackupUnusable(f"{file} is a backup of format {found.format}, not {FORMAT}")
    if digest != found.sha256:
        raise BackupUnusable(f"{file} is damaged: its SHA-256 is {digest}, {description_path(file).name} says {found.sha256}")
    return found


def newest_in(folder: Path) -> datetime | None:
    """Return when the newest complete backup in a folder was made, according to the descriptions; None without a backup.

    Raises OSError.
    """
    found = []
    for description in folder.iterdir():
        file = description.with_suffix("")
        if description.suffix == ".json" and file.is_file():
            try:
                one = Backup(**json.loads(description.read_text()))
                if one.size == file.stat().st_size:
                    found.append(datetime.fromisoformat(one.made_at).astimezone(UTC))
            except (ValueError, TypeError):
                continue  # no backup's
    return max(found, default=None)


def require_rows(rows: dict[str, int], file: Path, found: Backup) -> None:
    """Raise BackupUnusable unless each table of a restored database has as many rows as the backup states."""
    # A release may have let go of a table that the one that made the backup had.
    known = found.rows.keys() & Base.metadata.tables.keys() - KEPT_BY_ITSELF
    wrong = [name for name in sorted(known) if rows.get(name) != found.rows[name]]
    if wrong:
        raise BackupUnusable(f"{file} was not restored whole: {', '.join(wrong)} differ in their number of rows")


@contextmanager
def new_file(path: Path) -> Iterator[None]:
    """Create an empty private file; delete it when the block fails. Raises FileExistsError."""
    path.touch(mode=PRIVATE, exist_ok=False)
    try:
        yield
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def finalise(part: Path, file: Path, made: Backup) -> None:
    """Rename a finished backup to its name and write its description. Raises FileExistsError when the name was taken
    meanwhile."""
    # The name is reserved first, so that only our own file is replaced. A hard link would do both; not every disk has them.
    with new_file(file):
        part.replace(file)
        with new_file(description_path(file)):
            description_path(file).write_text(json.dumps(asdict(made), indent=1) + "\n")
            synced_digest(description_path(file))
            sync_folder(file.parent)


def synced_digest(file: Path) -> str:
    """Return the SHA-256 of a file after flushing it to the disk."""
    with file.open("rb") as opened:
        os.fsync(opened.fileno())
        return hashlib.file_digest(opened, "sha256").hexdigest()


def sync_folder(folder: Path) -> None:
    """Flush a folder to the disk, so that new names of its files are durable."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
