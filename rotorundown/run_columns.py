"""Columns of a table as people have them: data frames with times as their index, missing values, numbers as text."""

import re
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from datetime import datetime
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.errors import Invalid
from formats.recordings.exported_table import is_number, number_hint
from formats.recordings.plain_table import separator_of
from formats.recordings.run_times import EXAMPLE, moment_of, seconds_since_first

SPEED_COLUMNS = ("speed", "speed_rpm", "rpm")
TIME_COLUMNS = ("time", "time_s")
TIME_IN_SECONDS = re.compile(r"time(_s)?\s*[\[(]\s*(s|sec|secs|second|seconds)\s*[\])]")
"""Names of a column of times with their unit, such as `time [s]`."""
AMPLITUDE_ENDS = ("_amplitude", "_um_pp")
PHASE_ENDS = ("_phase", "_lag_deg")
GAP_END = "_gap_um"
"""End of the names of columns of mean gaps [µm], as the probes' `gap_grows` of the document says that they grow."""
UNNAMED = "Unnamed: "
"""Beginning of the name that pandas gives to a column without one."""
MOST_NAMED = 5
"""Most columns that an error names of those that are too long or too short."""
TIME_KINDS = {"M": "datetime64[ns]", "m": "timedelta64[ns]"}
"""Kinds of columns and of a frame's index that hold dates or durations, and how numpy has them."""

NUMBERS = ("f", "i", "u")
"""Kinds of columns of numbers."""


class WrongRun(Invalid):
    """Raised for a file, a table or numbers that cannot be a run of the machine."""


class ReadColumns(NamedTuple):
    """Columns of a table by name.

    Attributes:
        numbers: Their values (S,).
        unread: What is wrong with those that hold no numbers.
        dated: Whether its times are dates or durations, whose unit is certain.
    """

    numbers: dict[str, Floats]
    unread: dict[str, str]
    dated: bool


def columns_of(source: Any) -> ReadColumns:
    """Return the columns of a data frame, a mapping or a structured array.

    A frame's index is among them where it is the time or speed. Raises WrongRun.
    """
    if hasattr(source, "read") and not hasattr(source, "keys"):
        raise WrongRun(f"a run is a file's path, not an opened file ({type(source).__name__}): give its path")
    if of_array := getattr(getattr(source, "dtype", None), "names", None):
        source = {name: source[name] for name in of_array}
    if not hasattr(source, "keys") or not hasattr(source, "__getitem__") or getattr(source, "ndim", 2) == 1:
        right = ": give its columns by name, {'speed_rpm': …}" if hasattr(source, "ndim") else ""
        raise WrongRun(f"a run is a file's path, a data frame or a mapping of columns, not {type(source).__name__}{right}")
    given = list(source.keys())
    names = [known_name(str(name)) for name in given]
    if len(names) == 1 and (sign := separator_of(names[0])) != ",":
        raise WrongRun(f"the table has a single column, whose cells {sign!r} separates: read it with sep={sign!r}")
    require_different(names)
    columns: dict[str, Floats] = {}
    unread: dict[str, str] = {}
    values = dict(zip(names, map(source.__getitem__, given), strict=True))
    values |= _of_index(getattr(source, "index", None), names)
    unnamed = next((one for one in values if one.startswith(UNNAMED) and _are_dates(values[one])), None)
    if unnamed is not None and not {*TIME_COLUMNS} & {*values}:
        values[TIME_COLUMNS[0]] = values.pop(unnamed)
    for name, one in values.items():
        try:
            numbers = _numbers(name, one)
        except WrongRun as error:  # raised where it is a column of the run
            unread[name] = str(error)
            continue
        if not (name.startswith(UNNAMED) and (np.isnan(numbers).all() or _are_row_numbers(numbers))):
            columns[name] = numbers
    if not columns and unread:
        raise WrongRun(next(iter(unread.values())))
    if not columns or not all(column.ndim == 1 and column.size for column in columns.values()):
        raise WrongRun("the run has no samples: each column must hold at least one number")
    require_equal_length(columns)
    return ReadColumns(columns, unread, any(_are_dates(values[one]) for one in TIME_COLUMNS if one in values))


def require_equal_length(columns: Mapping[str, Floats]) -> None:
    """Raise WrongRun where columns differ in length, with those that are not as long as most are."""
    lengths = Counter(column.size for column in columns.values())
    usual = lengths.most_common(1)[0][0]
    odd = [f"{name} has {one.size}" for name, one in columns.items() if one.size != usual]
    if odd:
        more = f" and {len(odd) - MOST_NAMED} more" if len(odd) > MOST_NAMED else ""
        raise WrongRun(f"columns differ in length: {', '.join(odd[:MOST_NAMED])}{more}; the others have {usual}")


def known_name(name: str) -> str:
    """Return a column's name without spaces around it, its known part in small letters: `B1L_um_pp` for `B1L_UM_PP`."""
    plain = name.strip()
    small = plain.lower()
    if small in (*SPEED_COLUMNS, *TIME_COLUMNS):
        return small
    if TIME_IN_SECONDS.fullmatch(small):
        return TIME_COLUMNS[1]
    end = next((one for one in (*AMPLITUDE_ENDS, *PHASE_ENDS, GAP_END) if small.endswith(one)), "")
    return plain[: len(plain) - len(end)] + end


def is_known_name(name: str) -> bool:
    """Return whether a column's name says what it holds."""
    return name in (*SPEED_COLUMNS, *TIME_COLUMNS) or name.endswith((*AMPLITUDE_ENDS, *PHASE_ENDS, GAP_END))


def require_different(names: Sequence[str]) -> None:
    """Raise WrongRun where a name stands twice."""
    twice = next((name for i, name in enumerate(names) if name in names[:i]), None)
    if twice is not None:
        raise WrongRun(f"column '{twice}' stands twice: which one counts?")


def _of_index(index: Any, names: Sequence[str]) -> dict[str, Any]:
    """Return the column that a frame's index is, by its name; of one without a name whole numbers are those of rows."""
    if not hasattr(index, "dtype") or getattr(index, "nlevels", 1) > 1:
        return {}
    if index.dtype.kind in TIME_KINDS and not {*TIME_COLUMNS} & {*names}:
        return {TIME_COLUMNS[0]: index}
    whole = index.dtype.kind in "iu"
    if index.name is None:
        return {} if whole else {f"{UNNAMED}index": index}
    name = known_name(str(index.name))
    numbers_rows = whole and not is_known_name(name) and _are_row_numbers(np.asarray(index))
    return {} if name in names or numbers_rows else {name: index}


def _are_row_numbers(values: NDArray[Any]) -> bool:
    """Return whether values number the rows, from 0 or 1."""
    return bool(values.size and values[0] in (0, 1) and np.all(np.diff(values) == 1))


def _are_dates(values: Any) -> bool:
    """Return whether a column holds dates or durations, as its kind or its first value says."""
    kind = getattr(getattr(values, "dtype", None), "kind", "")
    if kind in (*TIME_KINDS, *NUMBERS) or not isinstance(values, Collection):
        return kind in TIME_KINDS
    first = next((one for one in values if not _is_blank(one)), None)
    return moment_of(first) is not None and not (isinstance(first, str) and is_number(first))


def _numbers(name: str, values: Any) -> Floats:
    """Return a column's numbers, NaN for blanks, and times in seconds since the first. Raises WrongRun."""
    kind = getattr(getattr(values, "dtype", None), "kind", "")
    if name in TIME_COLUMNS and kind in TIME_KINDS:
        moments = np.asarray(values, dtype=TIME_KINDS[kind])
        return np.asarray((moments - moments[:1]) / np.timedelta64(1, "s"), dtype=float)
    if kind == "c":
        raise WrongRun(f"column '{name}' is complex: give its amplitude and its phase as two columns")
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Collection):
        raise WrongRun(f"column '{name}' is a {type(values).__name__}: give a list of numbers, one a sample")
    plain = _plain_numbers(values)
    if plain is not None:
        return plain
    blank = values.isna() if hasattr(values, "isna") else [None] * len(values)
    found = np.full(len(values), np.nan)
    for number, (value, missing) in enumerate(zip(values, blank, strict=True)):
        if missing or _is_blank(value):
            continue
        try:
            if isinstance(value, bool | np.bool_):
                raise TypeError
            found[number] = float(value)
        except (TypeError, ValueError):
            if name in TIME_COLUMNS and not np.isfinite(found).any() and moment_of(value) is not None:
                return _seconds_of_dates(name, values, blank)
            right = number_hint(str(value))
            if name in TIME_COLUMNS and not right:
                right = f": write seconds since the start, or dates and times such as {EXAMPLE}"
            raise WrongRun(f"column '{name}', row {number + 1}: '{value!s:.40}' is not a number{right}") from None
    return found


def _plain_numbers(values: Any) -> Floats | None:
    """Return the numbers of an array of them, or of a list of texts, all at once; None where each has to be looked at."""
    of_texts = isinstance(values, list) and set(map(type, values)) == {str}
    of_numbers = getattr(getattr(values, "dtype", None), "kind", "") in NUMBERS and getattr(values, "ndim", 0) == 1
    try:
        return np.array(values, dtype=float) if of_texts or of_numbers else None
    except (TypeError, ValueError):
        return None


def _is_blank(value: Any) -> bool:
    return value is None or (isinstance(value, str) and not value.strip())


def _seconds_of_dates(name: str, values: Any, blank: Sequence[bool | None]) -> Floats:
    """Return the seconds since the first of dates and times, NaN for blanks. Raises WrongRun."""
    moments: list[datetime | None] = []
    for number, (value, missing) in enumerate(zip(values, blank, strict=True)):
        moments.append(None if missing or _is_blank(value) else moment_of(value))
        if moments[-1] is None and not (missing or _is_blank(value)):
            raise WrongRun(f"column '{name}', row {number + 1}: '{value!s:.40}' is no date and time such as {EXAMPLE}")
    try:
        return np.array(seconds_since_first(moments), dtype=float)
    except ValueError as error:
        raise WrongRun(f"column '{name}': {error}") from None
