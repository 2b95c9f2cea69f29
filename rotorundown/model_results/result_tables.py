"""Tables of results: printed to fit a screen, as data frames, and in notebooks."""

import textwrap
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar, overload

import msgspec

from estimator.arrays import Floats
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package

MOST_ROWS = 30
"""Most rows that are printed."""
SCREEN_COLUMNS = 100
"""Longest line."""
NUMBERS = "+-<0123456789"
"""Characters that the text of a number begins with."""
SMALLEST = 1e-3
"""Smallest number that is printed: less is rounding, or nothing to a plant."""

R = TypeVar("R", bound=msgspec.Struct)
Cells = Mapping[str, Sequence[str]]
"""Cells of a printed table by heading."""


class ResultTable(ABC):
    """A result that is printed as a table and given as a data frame."""

    title: str
    notes: tuple[str, ...] = ()

    @abstractmethod
    def _columns(self) -> Mapping[str, Sequence[Any] | Floats]:
        """Return the columns of the data frame by name, equally long."""

    @abstractmethod
    def _cells(self) -> Cells:
        """Return the cells of the printed table by heading, equally long."""

    def to_frame(self) -> Any:
        """Return a pandas DataFrame, with units in the names of its columns. Raises PackageMissing without pandas."""
        pandas = optional_package("pandas", needed_for="data frames")
        return pandas.DataFrame(dict(self._columns()))

    def __str__(self) -> str:
        told = [self.title, *self.notes]
        wrapped = [textwrap.fill(line, SCREEN_COLUMNS, subsequent_indent="  ", break_on_hyphens=False) for line in told]
        return "\n".join([*wrapped, *_table_lines(self._cells())])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


class RowTable(ResultTable, Sequence[R], Generic[R]):
    """A result that is a sequence of rows, whose fields are the columns of its data frame."""

    kind: type[R]
    rows: tuple[R, ...]

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, place: int) -> R: ...

    @overload
    def __getitem__(self, place: slice) -> tuple[R, ...]: ...

    def __getitem__(self, place: int | slice) -> R | tuple[R, ...]:
        return self.rows[place]

    def __iter__(self) -> Iterator[R]:
        return iter(self.rows)

    def _columns(self) -> Mapping[str, Sequence[Any]]:
        return {name: [getattr(one, name) for one in self.rows] for name in self.kind.__struct_fields__}


def figure(value: float, *, digits: int = 3) -> str:
    """Return a number that is not negative with some digits, never with a power of ten."""
    return f"<{SMALLEST:g}" if 0.0 < value < SMALLEST else f"{float(f'{value:.{digits}g}'):.12g}"


def error_figure(error: float) -> str:
    """Return a standard error with two digits, a dash for none."""
    return figure(error, digits=2) if error else "-"


def _table_lines(cells: Cells) -> list[str]:
    """Return headings and rows, numbers to the right, and how many rows are left out."""
    count = len(next(iter(cells.values()), ()))
    if not count:
        return ["  none"]
    columns = [[heading, *several[:MOST_ROWS]] for heading, several in cells.items()]
    widths = [max(map(len, column)) for column in columns]
    right = [all(cell[:1] in NUMBERS for cell in column[1:]) for column in columns]
    lines = []
    for row in zip(*columns, strict=True):
        placed = [
            f"{cell:>{width}}" if number else f"{cell:<{width}}"
            for cell, width, number in zip(row, widths, right, strict=True)
        ]
        lines.append(f"  {'  '.join(placed)}".rstrip())
    more = count - MOST_ROWS
    return [*lines, *([f"  and {more} more: to_frame()"] if more > 0 else [])]
