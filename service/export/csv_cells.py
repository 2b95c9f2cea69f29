"""CSV that a spreadsheet takes for text where it is text: what somebody wrote must not become a formula that it computes."""

import csv
import re
from collections.abc import Iterable
from typing import IO, Any

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""How a cell begins that a spreadsheet may compute."""
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def cell(value: Any) -> Any:
    """Return a value as it is written: an apostrophe in front of a text that could be a formula, nothing in front of a number.

    Source: OWASP, CSV Injection.
    """
    if isinstance(value, str) and value.startswith(FORMULA) and not NUMBER.fullmatch(value):
        return f"'{value}"
    return value


class CsvWriter:
    """Writes CSV (RFC 4180) to a file that was opened with newline=''."""

    def __init__(self, file: IO[str]) -> None:
        self._writer = csv.writer(file)

    def row(self, values: Iterable[Any]) -> None:
        """Write a row, or the header."""
        self._writer.writerow(map(cell, values))

    def rows(self, rows: Iterable[Iterable[Any]]) -> None:
        """Write many rows."""
        self._writer.writerows(map(cell, values) for values in rows)
