"""Times of simulated recordings: each is placed behind those of its machine in the same folder, so that none hides another."""

from datetime import datetime, timedelta
from pathlib import Path

from formats.files.document_files import UnreadableFile
from formats.recordings.sidecar import UNSTATED_START, read_sidecar

APART = timedelta(days=1)
"""Time between the starts of two recordings."""


def next_start(folder: Path, machine: str) -> datetime:
    """Return the day after the newest recording of a machine in a folder starts, of those that say when.

    The same commands in the same order give the same times. Where there is none, it is the time that recordings without a
    stated one have.
    """
    starts = [start for table in sorted(folder.glob("*.csv")) if (start := _stated_start(table, machine)) is not None]
    return max(starts) + APART if starts else UNSTATED_START


def _stated_start(table: Path, machine: str) -> datetime | None:
    try:
        sidecar = read_sidecar(table.with_suffix(".yaml"))
    except (UnreadableFile, OSError):
        return None
    if sidecar.machine != machine or "start" not in sidecar.model_fields_set:
        return None
    return sidecar.start if sidecar.start.tzinfo else sidecar.start.replace(tzinfo=UNSTATED_START.tzinfo)
