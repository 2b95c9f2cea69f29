"""Columns of an ASAM MDF file (MF4): channels of numbers by name, or GROUP/CHANNEL where groups share a name.

Channels of one group share their times; the sampling rate is that of the first. asammdf is an optional dependency.
"""

from pathlib import Path
from typing import Any, cast

import numpy as np

from formats.recordings.measured_columns import BrokenFile, MeasuredColumns, named_once
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
    try:
        # From an open file: of a broken one the library would close what it has not opened.
        with path.open("rb") as opened, MDF(opened) as file:
            groups = [
                (number, channel.name, file.get(group=number, index=place))
                for number, group in enumerate(cast("list[Any]", file.groups))
                for place, channel in enumerate(group.channels)
            ]
            start = file.header.start_time
    except OSError:
        raise
    except Exception as error:
        raise BrokenFile("truncated_file", f"not a whole MDF file: {error}") from error
    numbers = [(number, name, signal) for number, name, signal in groups if signal.samples.dtype.kind in "fiu"]
    values, twice = named_once([(name, f"{number}/{name}", signal.samples.astype(float)) for number, name, signal in numbers])
    times = numbers[0][2].timestamps if numbers else np.empty(0)
    steps = np.diff(times)
    even = steps.size > 0 and float(np.ptp(steps)) <= EVEN * float(np.mean(steps))
    return MeasuredColumns(values, 1.0 / float(np.mean(steps)) if even else None, from_datetime(start), twice=twice)
