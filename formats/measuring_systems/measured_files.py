"""Files of measuring systems, known by the endings of their names: MAT, TDMS, UFF58 and MDF4, each read as a whole."""

from collections.abc import Callable
from pathlib import Path

from formats.measuring_systems.mat_columns import mat_columns
from formats.measuring_systems.mdf4_columns import mdf4_columns
from formats.measuring_systems.measured_columns import MeasuredColumns
from formats.measuring_systems.tdms_columns import tdms_columns
from formats.measuring_systems.uff58_columns import uff58_columns

READERS: dict[str, Callable[[Path], MeasuredColumns]] = {
    ".mat": mat_columns,
    ".tdms": tdms_columns,
    ".uff": uff58_columns,
    ".unv": uff58_columns,
    ".uf": uff58_columns,
    ".mf4": mdf4_columns,
}


def is_measured_file(path: Path) -> bool:
    """Return whether a file's name says that a measuring system wrote it."""
    return path.suffix.lower() in READERS


def read_measured_file(path: Path) -> MeasuredColumns:
    """Return the columns of such a file. Raises BrokenFile, OSError."""
    return READERS[path.suffix.lower()](path)
