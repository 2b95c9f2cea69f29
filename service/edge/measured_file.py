"""Waveforms in a file of a measuring system: MAT, TDMS, UFF58 or MDF4, which is read as a whole and must fit into memory."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from estimator.arrays import Floats
from formats.measuring_systems.measured_columns import BrokenFile
from formats.measuring_systems.measured_files import read_measured_file
from service.edge.file_error import InputFileError


class MeasuredFile:
    """A file of a measuring system. Raises InputFileError."""

    def __init__(self, path: Path, columns: list[str]) -> None:
        try:
            read = read_measured_file(path)
            read.require(columns)
        except BrokenFile as error:
            raise InputFileError(error.fault, str(error)) from error
        self._columns = [read.values[column] for column in columns]
        self._cut = read.cut
        self.sampling_rate = read.sampling_rate
        self.start_ns = read.start_ns

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from sample `first` on, `size` samples at a time. Raises InputFileError when it ends early."""
        lengths = [column.size for column in self._columns]
        for place in range(first, min(lengths), size):
            yield np.array([column[place : min(place + size, min(lengths))] for column in self._columns])
        if self._cut or min(lengths) < max(lengths):
            shortest = f"some columns end after {min(lengths)} samples, others do not"
            raise InputFileError("truncated_file", self._cut or shortest)
