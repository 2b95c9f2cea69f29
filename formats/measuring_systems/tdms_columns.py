"""Columns of a TDMS file as LabVIEW and its relatives write it: channels by name, or GROUP/CHANNEL where groups share a name.

The sampling rate is one over `wf_increment`, the beginning `wf_start_time`. npTDMS is an optional dependency.
"""

import logging
from pathlib import Path

import numpy as np

from formats.measuring_systems.measured_columns import BrokenFile, MeasuredColumns, named_once


def tdms_columns(path: Path) -> MeasuredColumns:
    """Return the columns of a TDMS file. Raises BrokenFile."""
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise BrokenFile("unreadable_file", "TDMS needs npTDMS: pip install 'rotorundown[tdms]'") from error
    for name in ("nptdms.reader", "nptdms.tdms_segment"):
        logging.getLogger(name).setLevel(logging.ERROR)  # what it warns of is told as `cut`
    try:
        file = TdmsFile.read(path)
        channels = [channel for group in file.groups() for channel in group.channels() if channel.dtype.kind in "fiu"]
        listed = [(one.name, f"{one.group_name}/{one.name}", np.asarray(one[:], dtype=float)) for one in channels]
        cut = "its last segment is not complete" if file.file_status.incomplete_final_segment else ""
    except OSError:
        raise
    except Exception as error:
        raise BrokenFile("damaged_file", f"not a whole TDMS file: {error}") from error
    if not listed:
        raise BrokenFile("damaged_file", "not a whole TDMS file: it ends before its first channel of numbers, or has none")
    values, twice = named_once(listed)
    steps = [float(one.properties["wf_increment"]) for one in channels if one.properties.get("wf_increment")]
    starts = [one.properties["wf_start_time"] for one in channels if "wf_start_time" in one.properties]
    return MeasuredColumns(
        values,
        1.0 / steps[0] if steps else None,
        int(np.datetime64(starts[0], "ns").astype(np.int64)) if starts else None,
        cut,
        twice,
    )
