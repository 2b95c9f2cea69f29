"""What a backup is: a file with all data as of one moment, and beside it what that is, `<file>.json`, written last. A file
without it is no complete backup.
"""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from storage.database.private_files import PRIVATE
from storage.database.schema import KEPT_BY_ITSELF
from storage.tables import Base

FORMAT = 1


class BackupUnusable(RuntimeError):
    """A backup cannot be made or restored; the message says why and what would help."""


@dataclass(frozen=True)
class Backup:
    """What a backup is. made_at: RFC 3339; rows: of each table."""

    format: int
    kind: str
    schema_revision: str
    made_at: str
    size: int
    sha256: str
    rows: dict[str, int]


def description_path(file: Path) -> Path:
    """What stands beside a backup."""
    return file.with_name(file.name + ".json")


def read(file: Path) -> Backup:
    """What a backup is, its checksum verified. Raises BackupUnusable."""
    try:
        values: dict[str, Any] = json.loads(description_path(file).read_text())
        found = Backup(**values)
        digest = synced_digest(file)
    except (OSError, ValueError, TypeError) as error:
        raise BackupUnusable(f"{file} is no backup: {error}") from error
    if found.format != FORMAT:
        raise BackupUnusable(f"{file} is a backup of format {found.format}, not {FORMAT}")
    if digest != found.sha256:
        raise BackupUnusable(f"{file} is damaged: its SHA-256 is {digest}, {description_path(file).name} says {found.sha256}")
    return found


def newest_in(folder: Path) -> datetime | None:
    """When the newest complete backup in a folder was made, going by what stands beside it; None where there is none.

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
    """Raises BackupUnusable where a restored database does not have as many rows in each table as the backup says."""
    # A release may have let go of a table that the one that made the backup had.
    known = found.rows.keys() & Base.metadata.tables.keys() - KEPT_BY_ITSELF
    wrong = [name for name in sorted(known) if rows.get(name) != found.rows[name]]
    if wrong:
        raise BackupUnusable(f"{file} was not restored whole: {', '.join(wrong)} differ in their number of rows")


@contextmanager
def new_file(path: Path) -> Iterator[None]:
    """A new file, empty and private, which goes again when what is done with it fails. Raises FileExistsError."""
    path.touch(mode=PRIVATE, exist_ok=False)
    try:
        yield
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def finalise(part: Path, file: Path, made: Backup) -> None:
    """Give a backup its name, and write beside it what it is. Raises FileExistsError where somebody was faster."""
    with new_file(file):  # so that what is replaced is our own; links, which would do it in one step, not every disk has
        part.replace(file)
        with new_file(description_path(file)):
            description_path(file).write_text(json.dumps(asdict(made), indent=1) + "\n")
            synced_digest(description_path(file))
            sync_folder(file.parent)


def synced_digest(file: Path) -> str:
    """SHA-256 of a file, which is on the disk afterwards."""
    with file.open("rb") as opened:
        os.fsync(opened.fileno())
        return hashlib.file_digest(opened, "sha256").hexdigest()


def sync_folder(folder: Path) -> None:
    """So that a file's new name is on the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
