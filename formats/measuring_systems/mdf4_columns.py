"""Columns of an ASAM MDF file (MF4): channels of numbers by name, or GROUP/CHANNEL where groups share a name.

Channels of one group share their times; the sampling rate is that of the first. asammdf is an optional dependency.
"""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any, cast

import numpy as np

from formats.measuring_systems.measured_columns import BrokenFile, MeasuredColumns, named_once
from storage.clock import from_datetime

MAGIC = (b"MDF     ", b"UnFinMF ")
"""Beginning of every such file, finished or not."""
EVEN = 1e-3
"""Largest relative difference of the steps of evenly sampled times [-]."""


def mdf4_columns(path: Path) -> MeasuredColumns:
    """Return the columns of an MDF file. Raises BrokenFile."""
    try:
        from asammdf import MDF
    except ImportError as error:
        raise BrokenFile("unreadable_file", "MDF4 needs asammdf: pip install 'rotorundown[mdf4]'") from error
    with path.open("rb") as opened:
        if opened.read(8) not in MAGIC:
            raise BrokenFile("unreadable_file", "not an MDF file: it does not begin with MDF")
    with _without_complaints():
        read = _read(path, MDF)
        if isinstance(read, str):
            gc.collect()  # the library's object refers to itself: now it is let go of, not at any time later
    if isinstance(read, str):
        raise BrokenFile("truncated_file", f"not a whole MDF file, cut short or damaged: copy or export it anew ({read})")
    groups, start = read
    numbers = [(number, name, signal) for number, name, signal in groups if signal.samples.dtype.kind in "fiu"]
    values, twice = named_once([(name, f"{number}/{name}", signal.samples.astype(float)) for number, name, signal in numbers])
    times = numbers[0][2].timestamps if numbers else np.empty(0)
    steps = np.diff(times)
    even = steps.size > 0 and float(np.ptp(steps)) <= EVEN * float(np.mean(steps))
    return MeasuredColumns(values, 1.0 / float(np.mean(steps)) if even else None, from_datetime(start), twice=twice)


def _read(path: Path, library: Any) -> tuple[list[tuple[int, str, Any]], datetime] | str:
    """Return the channels of all groups and when they begin, or in words what is wrong with the file."""
    try:
        # From an open file: of a broken one the library would close what it has not opened.
        with path.open("rb") as opened, library(opened) as file:
            groups = [
                (number, channel.name, file.get(group=number, index=place))
                for number, group in enumerate(cast("list[Any]", file.groups))
                for place, channel in enumerate(group.channels)
            ]
            return groups, file.header.start_time
    except OSError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever a broken file makes the library raise is what is wrong with it
        return str(error)


@contextmanager
def _without_complaints() -> Iterator[None]:
    """Keep quiet about what the library cannot close a second time when it lets go of a broken file."""
    before = sys.unraisablehook

    def report(complaint: "sys.UnraisableHookArgs") -> None:
        if getattr(complaint.object, "__qualname__", "") != "MDF4.__del__":
            before(complaint)

    sys.unraisablehook = report
    try:
        yield
    finally:
        sys.unraisablehook = before
