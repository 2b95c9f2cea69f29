"""Rows that a running service answers with, as the library gives them: read by name, what is new in them is left out."""

from collections.abc import Iterator, Sequence
from datetime import datetime
from typing import Any, Generic, TypeVar, overload

import msgspec

from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package

R = TypeVar("R", bound=msgspec.Struct)
MOST_PRINTED = 20
"""Most rows that are printed."""


class MachineEntry(msgspec.Struct, frozen=True):
    """A machine that the service monitors."""

    id: str
    plant: str
    name: str
    revision: int
    created_at: datetime


class RunEntry(msgspec.Struct, frozen=True):
    """A run that the service recorded; speeds in r/min."""

    id: int
    machine: str
    kind: str
    direction: str
    state: str
    started_at: datetime
    ended_at: datetime | None
    samples: int | None
    speed_minimum_rpm: float | None
    speed_maximum_rpm: float | None


class IdentificationEntry(msgspec.Struct, frozen=True):
    """An identification that the service made; speeds in r/min."""

    id: int
    machine: str
    scope: str
    run_kind: str
    runs: list[int]
    measured_at: datetime
    computed_at: datetime
    accepted: bool
    verdict: str
    chi_square: float
    degrees_of_freedom: int
    samples: int
    speed_minimum_rpm: float
    speed_maximum_rpm: float


class EstimateEntry(msgspec.Struct, frozen=True):
    """An estimate of an identification, in SI units; of an unbalance `value` and `imaginary` are its two parts."""

    parameter: str
    element: str
    quantity: str
    unit: str
    value: float | None
    standard_error: float | None
    lower: float | None
    upper: float | None
    imaginary: float | None = None
    reason: str | None = None


class AlertEntry(msgspec.Struct, frozen=True):
    """An alert."""

    id: int
    machine: str
    rule: str
    element: str
    state: str
    severity: str
    message: str
    identification: int
    measured_at: datetime
    first_measured_at: datetime
    opened_at: datetime
    updated_at: datetime
    closed_at: datetime | None


class TrendPoint(msgspec.Struct, frozen=True):
    """A point of a parameter's history, in SI units; of an unbalance `value` is its magnitude."""

    parameter: str
    unit: str
    measured_at: datetime
    value: float | None
    lower: float | None
    upper: float | None
    quality: str
    run_kind: str
    identification: int


class Rows(Sequence[R], Generic[R]):
    """Rows of one kind, in the order in which the service gives them."""

    def __init__(self, kind: type[R], rows: Sequence[R]) -> None:
        self.kind = kind
        self._rows = tuple(rows)

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, place: int) -> R: ...

    @overload
    def __getitem__(self, place: slice) -> "Rows[R]": ...

    def __getitem__(self, place: int | slice) -> "R | Rows[R]":
        if isinstance(place, slice):
            return Rows(self.kind, self._rows[place])
        return self._rows[place]

    def __iter__(self) -> Iterator[R]:
        return iter(self._rows)

    @property
    def columns(self) -> tuple[str, ...]:
        """Return the names of the columns."""
        return self.kind.__struct_fields__

    def to_frame(self) -> Any:
        """Return a pandas DataFrame with a row each. Raises PackageMissing without pandas."""
        pandas = optional_package("pandas", needed_for="data frames")
        return pandas.DataFrame(
            [[getattr(one, column) for column in self.columns] for one in self._rows], columns=list(self.columns)
        )

    def __repr__(self) -> str:
        lines = [repr(one) for one in self._rows[:MOST_PRINTED]]
        left = len(self) - MOST_PRINTED
        return "\n".join([*lines, *([f"and {left} more: to_frame()"] if left > 0 else [])] or [f"no {self.kind.__name__}"])

    def _repr_html_(self) -> str:
        """Return the text for a notebook; names come from documents, so everything is escaped."""
        return notebook_text(self)


def rows_of(kind: type[R], answers: Sequence[Any]) -> Rows[R]:
    """Return rows of decoded answers. Raises ValueError where one is not of the kind."""
    return Rows(kind, msgspec.convert(list(answers), list[kind]))  # type: ignore[valid-type]
