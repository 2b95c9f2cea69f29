"""Columns of numbers that a measuring system has written, and what can be wrong with its file."""

from collections import Counter
from collections.abc import Sequence
from typing import Literal

from msgspec import Struct

from estimator.arrays import Floats

FileFault = Literal["unreadable_file", "truncated_file", "damaged_file", "missing_column"]


class BrokenFile(ValueError):
    """A file of a measuring system cannot be read. fault: what kind of trouble it is."""

    def __init__(self, fault: FileFault, detail: str) -> None:
        super().__init__(detail)
        self.fault = fault


class MeasuredColumns(Struct, frozen=True, eq=False):
    """Columns (N,) of a file by name.

    values: values of each column. sampling_rate [Hz], start_ns [UTC, since 1970]: None where the file does not say them. cut:
    what is missing at its end, in words; empty for a whole file. twice: names that several columns have, which are in `values`
    under other names. unusable: why columns that are in the file are not in `values`, by name.
    """

    values: dict[str, Floats]
    sampling_rate: float | None = None
    start_ns: int | None = None
    cut: str = ""
    twice: tuple[str, ...] = ()
    unusable: dict[str, str] = {}

    def require(self, wanted: Sequence[str]) -> None:
        """Raise BrokenFile unless all columns are there once."""
        there = ", ".join(list(self.values)[:50]) or "none"
        for column in wanted:
            if column in self.unusable:
                raise BrokenFile("missing_column", f"'{column}' {self.unusable[column]}")
            if column in self.twice:
                raise BrokenFile("missing_column", f"'{column}' is there more than once: name one of {there}")
        missing = [column for column in wanted if column not in self.values]
        if missing:
            raise BrokenFile("missing_column", f"no {', '.join(missing)}; there are {there}")


def named_once(columns: Sequence[tuple[str, str, Floats]]) -> tuple[dict[str, Floats], tuple[str, ...]]:
    """Return columns by their short names, by the long ones where several share a short one, and the names of the latter.

    columns: short name, long name and values of each.
    """
    count = Counter(short for short, _, _ in columns)
    values: dict[str, Floats] = {}
    for short, long, column in columns:
        name = short if count[short] == 1 else long
        copy = 2
        while name in values:
            name, copy = f"{long}#{copy}", copy + 1
        values[name] = column
    return values, tuple(short for short, times in count.items() if times > 1)
