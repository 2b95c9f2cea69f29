"""Writes CSV in which spreadsheets take text for text: stored texts must not become formulas."""

import csv
import re
from collections.abc import Iterable
from typing import IO, Any

_SIGNS = "=+\\-@＝＋－＠"
"""Characters that begin a formula; those of full width count as the others in Chinese, Japanese and Korean editions."""
FORMULA = re.compile(rf"'*[{_SIGNS}\t\r\n]")
"""Beginning of a cell that a spreadsheet may evaluate, also behind apostrophes, so that one can be taken off again."""
INNER_FORMULA = re.compile(rf"(?<=[;\t\r\n])(?=['\"]*[{_SIGNS}])")
"""Place within a cell where one begins for a spreadsheet that takes `;` or a tab for the separator: it obeys the quotes of a
cell only behind a separator that it knows."""
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")


def cell(value: Any) -> Any:
    """Return a value for CSV: what could be a formula in a text gets an apostrophe in front, a number stays as it is.

    Source: OWASP, CSV Injection.
    """
    if not isinstance(value, str) or NUMBER.fullmatch(value):
        return value
    found = INNER_FORMULA.sub("'", value)
    return f"'{found}" if FORMULA.match(value) else found


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
