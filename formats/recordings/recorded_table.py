"""The table of a recording: a CSV file with a header line, its cells as numbers or words, and what is wrong with its place."""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path

import numpy as np
from msgspec import Struct

from estimator.close_matches import did_you_mean
from estimator.unit_names import stated_units
from formats.files.document_files import UnreadableFile
from formats.measuring_systems.measured_columns import BrokenFile
from formats.measuring_systems.measured_files import is_measured_file, read_measured_file
from formats.recordings.empty_table import empty_table_text
from formats.recordings.exported_table import ExportedRow, decoded, exported_rows, is_number, is_plain, no_text, number_hint
from formats.recordings.run_times import EXAMPLE, moment_of

IN_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]\s*$")
"""The unit behind a column's name."""


class MissingColumn(UnreadableFile):
    """Raised for a column that a recording does not have."""


class RecordedTable(Struct, frozen=True):
    """Rows of a CSV file by the names in its header line, or of a measuring system's file.

    Attributes:
        path: The file.
        rows: One mapping per row below the header.
        places: Where each row is in the file, in words.
        unusable: Why a column that is in the file cannot be used, by its name.
        units: What a line of units below the header says, by the columns' names.
    """

    path: Path
    rows: list[dict[str, str | None]]
    places: Sequence[str]
    unusable: Mapping[str, str] = {}
    units: Mapping[str, str] = {}

    @classmethod
    def read(cls, path: Path) -> "RecordedTable":
        """Return the table of a file, of a measuring system or CSV. Raises UnreadableFile."""
        if is_measured_file(path):
            return _measured_table(path)
        try:
            text = decoded(path.read_bytes())
            rows, units = _rows(text) if text.strip() else ([], {})
        except UnicodeDecodeError:
            raise UnreadableFile(no_text(path)) from None
        except (OSError, csv.Error) as error:
            raise UnreadableFile(f"{path}: {error}") from error
        if not rows:
            raise UnreadableFile(empty_table_text(path))
        return cls(path, [row for _, row in rows], [f"line {line}" for line, _ in rows], units=units)

    def stated_units(self, name: str, fields: Sequence[str]) -> dict[str, str]:
        """Return the units of some fields that a column's name in its brackets, or the line of units below, states."""
        in_name = IN_BRACKETS.search(name)
        texts = (in_name[1] if in_name else "", self.units.get(name, "").strip("[]()"))
        return {field: unit for text in texts for field, unit in (stated_units(text, fields) or {}).items()}

    def gappy(self, name: str) -> list[float | None]:
        """Return the numbers of a column, None where a cell is blank. Raises UnreadableFile."""
        return [self._number(row, name, text) for row, text in enumerate(self._cells(name))]

    def column(self, name: str) -> list[float]:
        """Return the numbers of a column that has no gaps. Raises UnreadableFile."""
        values = self.gappy(name)
        if None in values:
            raise UnreadableFile(f"{self.path}, {self.places[values.index(None)]}: column '{name}' has no value")
        return [value for value in values if value is not None]

    def words(self, name: str) -> list[str]:
        """Return the texts of a column that has no gaps. Raises UnreadableFile."""
        found = [(text or "").strip() for text in self._cells(name)]
        if "" in found:
            raise UnreadableFile(f"{self.path}, {self.places[found.index('')]}: column '{name}' has no value")
        return found

    def moments(self, name: str) -> list[datetime]:
        """Return the dates and times of a column in ISO 8601; none where it begins with a number. Raises UnreadableFile."""
        texts = self.words(name)
        if is_number(texts[0]):
            return []
        found = [moment_of(text) for text in texts]
        if None in found:
            row = found.index(None)
            raise UnreadableFile(
                f"{self.path}, {self.places[row]}: '{texts[row]}' in column '{name}' is no time: write seconds since the "
                f"start, or dates and times such as {EXAMPLE}"
            )
        return [one for one in found if one is not None]

    def columns_of_words(self) -> list[str]:
        """Return the columns whose first text is no number."""
        first = ((name, next((text for row in self.rows if (text := row[name])), "0")) for name in filter(None, self.rows[0]))
        return [name for name, text in first if not is_number(text)]

    def _cells(self, name: str) -> list[str | None]:
        if name in self.unusable:
            raise UnreadableFile(f"{self.path}: column '{name}' {self.unusable[name]}")
        if f"{name}#1" in self.rows[0]:
            raise UnreadableFile(f"{self.path}: column '{name}' is there more than once: name '{name}#1', '{name}#2', …")
        if name not in self.rows[0]:
            known = list(filter(None, self.rows[0]))
            raise MissingColumn(f"{self.path} has no column '{name}'; it has {', '.join(known)}{did_you_mean(name, known)}")
        return [row[name] for row in self.rows]

    def _number(self, row: int, name: str, text: str | None) -> float | None:
        if text is None:
            last = ": was the file cut short?" if row == len(self.rows) - 1 else ""
            raise UnreadableFile(f"{self.path}, {self.places[row]} is too short: it has no column '{name}'{last}")
        if not text.strip():
            return None
        try:
            return float(text)
        except ValueError:
            raise UnreadableFile(
                f"{self.path}, {self.places[row]}: '{text}' in column '{name}' is not a number{number_hint(text)}"
            ) from None


def _rows(text: str) -> tuple[list[tuple[int, ExportedRow]], dict[str, str]]:
    """Return the rows of a table, exported or plain, each with the number of its line, and its line of units."""
    rows, units = ([], {}) if is_plain(text) else exported_rows(text)
    return rows or _plain_rows(text.removeprefix("# ")), units  # behind which numpy writes its header


def _plain_rows(text: str) -> list[tuple[int, ExportedRow]]:
    """Return the rows below a header in the first line, each with the number of its line."""
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    return [(reader.line_num, row) for row in reader if any(row.values())]  # spreadsheets write blank ones below a table


def _is_of(column: str, short: str) -> bool:
    """Return whether a column's long name may stand for a short one: both begin or end alike."""
    return column.endswith(short) or column.startswith(short.removesuffix(".real").removesuffix(".imag"))


def _measured_table(path: Path) -> RecordedTable:
    """Return the table of a measuring system's file, of the columns that have the most usual length. Raises UnreadableFile."""
    try:
        read = read_measured_file(path)
    except (BrokenFile, OSError) as error:
        raise UnreadableFile(f"{path}: {error}") from error
    if read.cut:
        raise UnreadableFile(f"{path}: {read.cut}: it was cut short; copy or export it anew")
    sizes = [column.size for column in read.values.values()]
    length = max(set(sizes), key=sizes.count, default=0)
    columns = {name: column for name, column in read.values.items() if column.size == length}
    if not length:
        raise UnreadableFile(f"{path} holds no column of numbers")
    others = {
        name: f"has {column.size} values where {len(columns)} columns have {length}: export all at the same speeds"
        for name, column in read.values.items()
        if column.size != length
    }
    twice = {
        name: f"is there more than once: name one of {', '.join(one for one in read.values if _is_of(one, name))}"
        for name in read.twice
    }
    cells = {name: ["" if np.isnan(one) else repr(float(one)) for one in column] for name, column in columns.items()}
    rows: list[dict[str, str | None]] = [{name: column[row] for name, column in cells.items()} for row in range(length)]
    return RecordedTable(path, rows, [f"value {row + 1}" for row in range(length)], {**twice, **others, **read.unusable})
