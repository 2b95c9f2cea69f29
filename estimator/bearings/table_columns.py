"""Columns of a table of coefficients over speed, for one load on the bearing or for several."""

import itertools
from collections.abc import Iterator, Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from estimator.bearings.monotone_cubic import MonotoneCubic
from estimator.bearings.terms import LATERAL
from estimator.field_types import Direct, Part, Positive, Real, Stiffness
from estimator.usual_values import declarations, with_unit

MOST_SPEEDS = 500
"""Largest number of speeds of a table."""
MOST_LOADS = 20
"""Largest number of loads of a table."""
SMALLEST_STIFFNESS = 1e3
"""Smallest direct stiffness of a bearing or pedestal [N/m]: one that sinks by a millimetre under 0.1 kg."""
SPIKE, SPIKE_AT_END = 10.0, 100.0
"""Ratio of a value to both beside it above which it is doubted, and of one at an end of the table to the next two [-]."""
STEEP = 10.0
"""Largest ratio of the values beside one that may be doubted [-]."""
COLUMNS = tuple(term.name for term in LATERAL)
"""Terms that a table can give."""
DIRECT = frozenset(term.name for term in LATERAL if term.direct)
"""Those of them that are positive by nature."""
StiffnessColumn = Annotated[tuple[Stiffness, ...], Field(max_length=MOST_SPEEDS, fail_fast=True)] | None
DirectColumn = Annotated[tuple[Direct, ...], Field(max_length=MOST_SPEEDS, fail_fast=True)] | None
CrossColumn = Annotated[tuple[Real, ...], Field(max_length=MOST_SPEEDS, fail_fast=True)] | None


class TableColumns(Part):
    """Columns of a table over speed; those that are not given are no columns."""

    kxx: StiffnessColumn = Field(default=None, description="at each speed [N/m]; usual is 1e+5 to 1e+9 N/m")
    kxy: CrossColumn = Field(default=None, description="at each speed [N/m]")
    kyx: CrossColumn = Field(default=None, description="at each speed [N/m]")
    kyy: StiffnessColumn = Field(default=None, description="at each speed [N/m]; usual is 1e+5 to 1e+9 N/m")
    cxx: DirectColumn = Field(default=None, description="at each speed [N s/m]")
    cxy: CrossColumn = Field(default=None, description="at each speed [N s/m]")
    cyx: CrossColumn = Field(default=None, description="at each speed [N s/m]")
    cyy: DirectColumn = Field(default=None, description="at each speed [N s/m]")

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the terms that have a column."""
        return tuple(name for name in COLUMNS if getattr(self, name) is not None)

    def too_soft(self) -> Iterator[tuple[str, str]]:
        """Find stiffnesses that are too small for a bearing: their unit must be another.

        Yields:
            Name of a column, and its smallest value with what is usual.
        """
        for name in ("kxx", "kyy"):
            column = getattr(self, name)
            if column and min(column) < SMALLEST_STIFFNESS:
                yield name, declarations(type(self))[name].words(min(column))

    def spikes(self, speed_rpm: Sequence[float]) -> Iterator[tuple[str, str]]:
        """Find values that are far from those at the speeds beside them: a digit or an exponent of theirs is probably wrong.

        Args:
            speed_rpm: The table's speeds (n,) [r/min].

        Yields:
            Name of a column, and such a value with what stands beside it.
        """
        for name in COLUMNS:
            column, told = getattr(self, name) or (), declarations(type(self))[name]
            for place in _spikes([abs(value) for value in column], direct=name in DIRECT):
                beside = column[place - 1 if place else 1]
                words = f"{with_unit(column[place], told.unit)} at {speed_rpm[place]:g} r/min stands beside"
                yield name, f"{words} {with_unit(beside, told.unit)}: is its exponent right?"

    def require_values(self, count: int) -> None:
        """Check that each column has one value at each speed.

        Args:
            count: Number of speeds [-].

        Raises:
            ValueError: A column has more or fewer.
        """
        for name in self.coefficients:
            given = len(getattr(self, name))
            if given != count:
                raise ValueError(f"{name} needs one value at each of the {count} speeds of speed_rpm, not {given}")


class ColumnsAtLoad(TableColumns):
    """Columns of a table for one load on the bearing."""

    load: Positive = Field(description="static load on the bearing [N]")


def _spikes(sizes: Sequence[float], *, direct: bool) -> Iterator[int]:
    """Yield the places of values that are far above all beside them, or, of a direct term, far below."""
    last = len(sizes) - 1
    for place, size in enumerate(sizes):
        if 0 < place < last:
            beside, far = (sizes[place - 1], sizes[place + 1]), SPIKE
        else:  # at an end the next two tell whether the course is as steep there as beside
            beside, far = (sizes[1], sizes[2]) if place == 0 else (sizes[-3], sizes[-2]), SPIKE_AT_END
        if min(beside) == 0.0 or max(beside) > STEEP * min(beside):
            continue
        if size > far * max(beside) or (direct and size * far < min(beside)):
            yield place


def require_alike(tables: Sequence[ColumnsAtLoad]) -> None:
    """Check that tables are of ascending loads and have the same columns.

    Args:
        tables: Columns for each load.

    Raises:
        ValueError: They do not.
    """
    for before, one in itertools.pairwise(tables):
        if one.load <= before.load:
            raise ValueError(f"loads [N] must ascend: {one.load:g} follows {before.load:g}")
        if one.coefficients != before.coefficients:
            raise ValueError(
                f"each load needs the same columns: at {one.load:g} N they are {', '.join(one.coefficients) or 'none'}, "
                f"at {before.load:g} N {', '.join(before.coefficients) or 'none'}"
            )


def at_load(tables: Sequence[ColumnsAtLoad], load: float, term: str) -> tuple[float, ...]:
    """Interpolate a term to a load: shape-preserving cubics over its logarithm (doi:10.1137/0717021), level beyond the ends.

    Args:
        tables: Columns for each of two loads or more, ascending.
        load: Static load on the bearing [N].
        term: The term, such as `kxx`.

    Returns:
        Values (n,) over the table's speeds [SI].
    """
    place = np.log([one.load for one in tables])
    values = np.array([getattr(one, term) for one in tables])
    at = float(np.clip(np.log(load), place[0], place[-1]))
    if len(tables) == 2:  # a cubic needs three
        share = (at - place[0]) / (place[1] - place[0])
        return tuple(((1.0 - share) * values[0] + share * values[1]).tolist())
    return tuple(MonotoneCubic(place, values)(np.array([at]))[0].tolist())
