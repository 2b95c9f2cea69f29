"""A CSV table without a sidecar: lines about the export above its header, its header, a line of units below it, and its rows.

Where semicolons or tabs separate cells, decimals may have a comma. Lines about the export begin with # or have a single cell;
`sep=;` says what separates cells.
"""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from estimator.unit_names import UNIT_NAMES, stated_units
from formats.files.document_files import UnreadableFile
from formats.files.like_named_files import like_named
from formats.recordings.empty_table import empty_table_text
from formats.recordings.exported_table import SEPARATORS, decimal_points, decoded, is_number, no_text
from formats.recordings.run_times import moment_of

OTHER_SEPARATORS = (";", "\t")
STATED_SEPARATOR = re.compile(r"\"?sep=(.)\"?", re.IGNORECASE)
COMMENT = "#"
MOST_SHOWN = 40
"""Most signs of a line that are shown."""

NumberedRow = tuple[int, list[str]]
"""The number of a line in its file, and its cells."""


def separator_of(header: str, first: str = "") -> str:
    """Return what separates the names in a header line: what separates the cells below it as often, or else commas first."""
    alike = (sign for sign in OTHER_SEPARATORS if sign in header and header.count(sign) == first.count(sign))
    return next(alike, ",") if "," in header else next((sign for sign in OTHER_SEPARATORS if sign in header), ",")


def read_plain_table(path: Path) -> tuple[list[str], list[list[str]], int]:
    """Return the names in a table's header, with their units in brackets where a line below has them, and its rows.

    Last comes the number of the line in which the first row is. Raises UnreadableFile.
    """
    try:
        text = decoded(path.read_bytes())
        separator, lines = _lines(text)
        rows = list(_rows(lines, separator))
    except UnicodeDecodeError:
        raise UnreadableFile(no_text(path)) from None
    except (OSError, csv.Error) as error:
        raise UnreadableFile(f"{path}: {getattr(error, 'strerror', None) or error}{like_named(path)}") from None
    if len(rows) < 2:
        raise UnreadableFile(empty_table_text(path))
    (first, header), *body = rows
    if header and all(map(is_number, header)):
        raise UnreadableFile(
            f"{path}, line {first} is no header: it holds numbers; the line above the first sample names the columns, such as "
            "speed_rpm"
        )
    if _are_units(body, len(header)):
        header = list(map(_with_unit, header, body[0][1], body[1][1]))
        body = body[1:]
    if all(len(cells) == len(header) + 1 and not cells[-1] for _, cells in body):
        body = [(line, cells[:-1]) for line, cells in body]  # a separator behind each row, and none behind the header
    _require_whole(path, first, header, body)
    point = decimal_points(separator)
    plain = separator == ","
    return header, [cells if plain else [point(cell) for cell in cells] for _, cells in body], body[0][0]


def _lines(text: str) -> tuple[str, list[tuple[int, str]]]:
    """Return what separates cells, and the lines from the header on, each with its number."""
    lines, place = text.split("\n"), 0
    separators = [sign for sign in SEPARATORS if sign in text]
    separator, comment = "", ""
    while place < len(lines) - 1:
        line = lines[place]
        stated = STATED_SEPARATOR.fullmatch(line.strip(" "))
        if stated:
            separator = stated[1]
        elif line.startswith(COMMENT):
            comment = line.removeprefix(COMMENT)
        elif line.strip() and (not separators or any(sign in line for sign in (*separators, *separator))):
            break
        place += 1
    separator = separator or separator_of(lines[place], next(filter(str.strip, lines[place + 1 :]), ""))
    point, cells = decimal_points(separator), lines[place].split(separator)
    rest = list(enumerate(lines[place:], start=place + 1))
    if len(comment.split(separator)) == len(cells) > 1 and all(is_number(point(one.strip())) for one in cells):
        rest = [(place, comment), *rest]  # numpy writes its header behind a #
    return separator, rest


def _rows(lines: Sequence[tuple[int, str]], separator: str) -> Iterator[NumberedRow]:
    """Yield the cells of each line that is not blank. Raises csv.Error."""
    first = lines[0][0]
    reader = csv.reader(io.StringIO("\n".join(line for _, line in lines), newline=""), delimiter=separator, strict=True)
    for cells in reader:
        if any(cells):  # spreadsheets write rows of blank cells below a table
            yield first + reader.line_num - 1, [cell.strip() for cell in cells]


def _are_units(body: Sequence[NumberedRow], count: int) -> bool:
    """Return whether the first of the rows holds units: one at least, no number and no date, above a row with numbers."""
    if len(body) < 2:
        return False
    units, first = (cells for _, cells in body[:2])
    if len(units) != count or any(is_number(one) or moment_of(one) for one in units) or not any(map(is_number, first)):
        return False
    return any(stated_units(_unit(one), UNIT_NAMES) for one in units)


def _unit(cell: str) -> str:
    """Return the unit in a cell of a line of units, without brackets; nothing for a dash."""
    return cell.strip("[]() ").strip("-–")


def _with_unit(name: str, cell: str, first: str) -> str:
    """Return a name with the unit below it in brackets, unless that says nothing more. first: the cell below the unit."""
    unit = _unit(cell)
    if not unit or name.endswith((f"[{unit}]", f"({unit})")) or (moment_of(first) and not is_number(first)):
        return name
    return f"{name[:-1]} {unit}{name[-1]}" if name.endswith(("]", ")")) else f"{name} [{unit}]"


def _require_whole(path: Path, first: int, header: Sequence[str], body: Sequence[NumberedRow]) -> None:
    """Raise UnreadableFile where a row has not as many cells as the header."""
    wrong = next(((line, cells) for line, cells in body if len(cells) != len(header)), None)
    if wrong is None:
        return
    line, cells = wrong
    usual = Counter(len(one) for _, one in body).most_common(1)[0][0]
    told = f"{path}, line {line} has {len(cells)} cell{'' if len(cells) == 1 else 's'}, its header {len(header)}"
    if len(header) < 3 <= usual:
        raise UnreadableFile(
            f"{path}, line {first} is no header: '{' '.join(header):.{MOST_SHOWN}}' has {len(header)} cells, the lines below "
            f"have {usual}; the first line names the columns, begin lines above it with {COMMENT}"
        )
    if len(cells) > len(header):
        raise UnreadableFile(
            f"{told}; where numbers have a decimal comma or commas between thousands, write a point and none, or separate "
            "columns by semicolons"
        )
    last = line == body[-1][0]
    raise UnreadableFile(
        f"{told}: the row is cut short{', as an export that broke off' if last else ''}; complete it or leave it out"
    )
