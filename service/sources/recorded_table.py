"""The table of a recording: a CSV file with a header line, its cells as numbers or words, and what is wrong with its place."""

import csv
from dataclasses import dataclass
from pathlib import Path

from service.configuration.document_files import UnreadableFile


@dataclass(frozen=True)
class RecordedTable:
    """Rows of a CSV file by the names in its header line.

    Attributes:
        path: The file.
        rows: One mapping per row below the header.
    """

    path: Path
    rows: list[dict[str, str | None]]

    @classmethod
    def read(cls, path: Path) -> "RecordedTable":
        """Return the table of a file. Raises UnreadableFile."""
        try:
            # Spreadsheets put a byte order mark in front.
            with path.open(encoding="utf-8-sig", newline="") as file:
                rows = list(csv.DictReader(file, strict=True))
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise UnreadableFile(f"{path}: {error}") from error
        if not rows:
            raise UnreadableFile(f"{path} has no rows below its header")
        return cls(path, rows)

    def gappy(self, name: str) -> list[float | None]:
        """Return the numbers of a column, None where a cell is blank. Raises UnreadableFile."""
        return [self._number(line, name, text) for line, text in enumerate(self._cells(name), start=2)]

    def column(self, name: str) -> list[float]:
        """Return the numbers of a column that has no gaps. Raises UnreadableFile."""
        values = self.gappy(name)
        if None in values:
            raise UnreadableFile(f"{self.path}, line {values.index(None) + 2}: column '{name}' has no value")
        return [value for value in values if value is not None]

    def words(self, name: str) -> list[str]:
        """Return the texts of a column that has no gaps. Raises UnreadableFile."""
        found = [(text or "").strip() for text in self._cells(name)]
        if "" in found:
            raise UnreadableFile(f"{self.path}, line {found.index('') + 2}: column '{name}' has no value")
        return found

    def _cells(self, name: str) -> list[str | None]:
        if name not in self.rows[0]:
            raise UnreadableFile(f"{self.path} has no column '{name}'; it has {', '.join(self.rows[0])}")
        return [row[name] for row in self.rows]

    def _number(self, line: int, name: str, text: str | None) -> float | None:
        if text is None:
            raise UnreadableFile(f"{self.path}, line {line} is too short: it has no column '{name}'")
        if not text.strip():
            return None
        try:
            return float(text)
        except ValueError:
            raise UnreadableFile(f"{self.path}, line {line}: '{text}' in column '{name}' is not a number") from None
