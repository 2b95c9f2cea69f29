"""Writes CSV in which spreadsheets take text for text: stored texts must not become formulas."""

import csv
import re
from collections.abc import Iterable
from typing import IO, Any

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""First characters of cells that a spreadsheet may evaluate."""
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def cell(value: Any) -> Any:
    """Return a value for CSV: a text that could be a formula gets an apostrophe in front, a number stays as it is.

    Source: OWASP, CSV Injection.
    """
    if isinstance(value, str) and value.startswith(FORMULA) and not NUMBER.fullmatch(value):
        return f"'{value}"
    return value


class CsvWriter:
    """Writer of CSV (RFC 4180) to a file that was opened with newline=''."""

    def __init__(self, file: IO[str]) -> None:
        self._writer = csv.writer(file)

    def row(self, values: Iterable[Any]) -> None:
        """Write a row, or the header."""
        self._writer.writerow(map(cell, values))

    def rows(self, rows: Iterable[Iterable[Any]]) -> None:
        """Write many rows."""
        self._writer.writerows(map(cell, values) for values in rows)
