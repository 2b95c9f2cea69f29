"""Waveforms in a CSV file with a header line, read piece by piece."""

import csv
import itertools
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from estimator.arrays import Floats
from service.edge.file_error import InputFileError, require_columns


class CsvFile:
    """A CSV file; blank and non-numeric cells read as NaN. Raises InputFileError."""

    start_ns: int | None = None
    sampling_rate: float | None = None

    def __init__(self, path: Path, columns: list[str]) -> None:
        self._path = path
        with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
            header = next(csv.reader([file.readline()]), [])
        names = [name.strip() for name in header]
        require_columns(columns, names)
        self._width = len(names)
        self._columns = [names.index(column) for column in columns]

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from row `first` on, `size` rows at a time. Raises InputFileError for a truncated last row."""
        with self._path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
            rows = itertools.islice(file, first + 1, None)
            while lines := list(itertools.islice(rows, size)):
                # A last line without a line end may lack digits, even when it has all its cells.
                cut = lines.pop() if not lines[-1].endswith(("\n", "\r")) else None
                if lines:
                    yield self._values(lines)
                if cut is not None:
                    raise InputFileError("truncated_file", f"its last line '{cut[:60]}' is cut short")

    def _values(self, lines: list[str]) -> Floats:
        try:
            table = np.loadtxt(lines, delimiter=",", usecols=self._columns, ndmin=2, comments=None)
            if len(table) == len(lines):
                return np.asarray(table.T, dtype=float)
        except ValueError:
            pass  # a cell is not a number: parsed cell by cell below
        # Line by line: an unclosed quote must not swallow the rows after it.
        return np.array([self._row(line) for line in lines], dtype=float).T

    def _row(self, line: str) -> list[float]:
        try:
            cells = next(csv.reader([line]), [])
        except csv.Error:
            cells = []
        if len(cells) != self._width:
            return [math.nan] * len(self._columns)
        return [_number(cells[column]) for column in self._columns]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
