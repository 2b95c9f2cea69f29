"""Reads tables of coefficients over speed from CSV files beside a machine document, into the document's own columns.

The first line names the columns: `speed_rpm`, and terms such as `kxx` or, with their unit, `kxx_n_per_m` and `cxx_n_s_per_m`.
A column `load_n` makes it a table over the load as well: lines of one load stand together, all loads at the same speeds.
Lines that are empty or begin with # do not count.
"""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from estimator.bearings.table_columns import COLUMNS, MOST_LOADS, MOST_SPEEDS
from estimator.bearings.terms import TERMS
from estimator.machine.part_coefficients import ELEMENTS

SPEED, LOAD = "speed_rpm", "load_n"
UNIT = {"stiffness": "n_per_m", "damping": "n_s_per_m"}
"""End of a column's name by the term's quantity."""
NAMES = (
    {SPEED: SPEED, LOAD: LOAD}
    | {name: name for name in COLUMNS}
    | {f"{name}_{UNIT[TERMS[name].quantity]}": name for name in COLUMNS}
)
"""Field of the table by the name of a column."""
WORDS = (
    f"{SPEED}, {LOAD} where there are several loads, and terms with or without their unit, such as kxx or kxx_n_per_m, cxx or "
    "cxx_n_s_per_m"
)


class WrongTableFile(ValueError):
    """A table's file cannot be read or has the wrong content; the message names file, line and column."""


def with_table_columns(document: Any, folder: Path) -> Any:
    """Return a decoded document with the columns of its tables' files in place of their names.

    folder: where relative names begin. Raises WrongTableFile. What is no document is returned as it is, for others to refuse.
    """
    if not isinstance(document, Mapping):
        return document
    found = dict(document)
    for place in ELEMENTS:
        if isinstance(found.get(place), Sequence) and not isinstance(found[place], str):
            found[place] = [_resolved(part, f"{place}[{number}]", folder) for number, part in enumerate(found[place])]
    return found


def _resolved(part: Any, place: str, folder: Path) -> Any:
    form = part.get("speed_dependence") if isinstance(part, Mapping) else None
    if not isinstance(form, Mapping) or "csv" not in form:
        return part
    where, rest, name = f"{place}.speed_dependence", {key: form[key] for key in form if key != "csv"}, form["csv"]
    if form.get("form") != "table" or not isinstance(name, str) or not name:
        raise WrongTableFile(f"{where}.csv: names a file, such as bearing-B1.csv, of the form 'table' only")
    double = [key for key in (SPEED, *COLUMNS, "over_load") if rest.get(key) is not None]
    if double:
        raise WrongTableFile(f"{where}: {', '.join(double)} beside csv: give the columns in one of them only")
    try:
        return {**part, "speed_dependence": {**rest, **_by_load(read_table(folder / name))}}
    except WrongTableFile as error:
        raise WrongTableFile(f"{where}.csv: {error}") from error


def _by_load(columns: dict[str, list[float]]) -> dict[str, Any]:
    """Return the fields of a table: columns as they are, or those of each load. Raises WrongTableFile."""
    if LOAD not in columns:
        return dict(columns)
    loads, terms = columns[LOAD], [name for name in columns if name not in (SPEED, LOAD)]
    places: dict[float, list[int]] = {}
    for place, load in enumerate(loads):
        places.setdefault(load, []).append(place)
    speeds = [[columns[SPEED][one] for one in lines] for lines in places.values()]
    for load, found in zip(places, speeds, strict=True):
        if found != speeds[0]:
            raise WrongTableFile(
                f"lines of {load:g} N have other speeds than those of {loads[0]:g} N: all loads need the same"
            )
    tables = [
        {"load": load, **{name: [columns[name][one] for one in lines] for name in terms}} for load, lines in places.items()
    ]
    return {SPEED: speeds[0], "over_load": tables}


def read_table(path: Path) -> dict[str, list[float]]:
    """Read the columns of a table: `speed_rpm`, `load_n` where it has one, and terms; values are in the file's order.

    Raises WrongTableFile.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = _lines(file)
            try:
                _, header = next(lines)
            except StopIteration:
                raise WrongTableFile(f"{path} is empty: its first line names the columns: {WORDS}") from None
            fields = _fields(path, header)
            columns: dict[str, list[float]] = {field: [] for field in fields}
            over_load = LOAD in fields
            most = MOST_SPEEDS * (MOST_LOADS if over_load else 1)
            for count, (number, cells) in enumerate(lines, start=1):
                if count > most:
                    raise WrongTableFile(f"{path}, line {number}: at most {MOST_SPEEDS} speeds{' of each load' * over_load}")
                _append(columns, cells, header, f"{path}, line {number}")
    except OSError as error:
        raise WrongTableFile(f"{path}: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise WrongTableFile(f"{path} is not CSV: {error}") from error
    return columns


def _lines(file: Any) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line that counts."""
    reader = csv.reader(file, skipinitialspace=True)
    for row in reader:
        cells = [cell.strip() for cell in row]
        if any(cells) and not cells[0].startswith("#"):
            yield reader.line_num, cells


def _fields(path: Path, header: list[str]) -> list[str]:
    """Return the table's field of each column."""
    fields: list[str] = []
    for name in header:
        field = NAMES.get(name.lower())
        if field is None and ";" in name:
            raise WrongTableFile(
                f"{path}: semicolons stand between its cells: save it with commas between cells and points in numbers"
            )
        if field is None:
            raise WrongTableFile(f"{path}: column '{name}' is none of a table, with commas between: {WORDS}")
        if field in fields:
            raise WrongTableFile(f"{path}: two columns are {field}")
        fields.append(field)
    if SPEED not in fields:
        raise WrongTableFile(f"{path}: column {SPEED} is missing")
    return fields


def _append(columns: dict[str, list[float]], cells: list[str], header: list[str], where: str) -> None:
    """Append a line's numbers to the columns."""
    if len(cells) != len(header):
        comma = "; was a decimal comma meant? Numbers have points, such as 1.5e8" if len(cells) > len(header) else ""
        raise WrongTableFile(f"{where}: {len(cells)} cells; the first line names {len(header)} columns{comma}")
    for column, name, cell in zip(columns.values(), header, cells, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            told = f"'{cell}' is no number, such as 1.5e8" if cell else "the cell is empty: each line needs a number in each"
            raise WrongTableFile(f"{where}, column {name}: {told}")
        column.append(value)
