"""Sizes of causes: in words, and as the columns of a data frame."""

from collections.abc import Iterator
from typing import Any

from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart
from estimator.machine.parameter_description import describe

COLUMNS = ("kind", "element", "evidence", "per_cent", "figure", "value", "lower", "upper", "before", "allowed", "unit")
"""Columns of a data frame of causes."""


def size_words(size: ChangeSize) -> str:
    """Return a size in words: per cent of the baseline, else the figure that takes most of what is allowed, and loads."""
    if size.per_cent is not None:
        return f"{size.per_cent:.0f} %, "
    loads = [one for one in size.parts[1:] if describe(one.name).element_kind == "bearing"]
    return "".join(f"{_figure(one)}{_part_of_load(one, size)}, " for one in (*size.parts[:1], *loads))


def size_rows(cause: Cause, size: ChangeSize) -> Iterator[list[Any]]:
    """Yield the columns of each figure of a cause's size, at least one row.

    Args:
        cause: The cause.
        size: Its size.

    Yields:
        Values of `COLUMNS`.
    """
    common = [cause.kind, cause.element, cause.evidence, size.per_cent]
    for one in size.parts:
        yield [*common, one.name, one.value, one.lower, one.upper, one.before, one.allowed, one.unit]
    if not size.parts:
        yield [*common, None, None, None, None, None, None, None]


def _figure(one: SizePart) -> str:
    return f"{one.name} {one.value:.3g} ± {(one.upper - one.lower) / 2:.2g} {one.unit}"


def _part_of_load(one: SizePart, size: ChangeSize) -> str:
    """Return by how much more or less a bearing carries, where the figure is a load and that is known; nothing else."""
    part = size.quantities.get(f"{one.name.removesuffix('_vertical')}_per_cent")
    return "" if part is None else f" ({part:+.0f} %)"
