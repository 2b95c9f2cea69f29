"""Tables as System 1, ADRE and other programs export them: lines about the export, a header, perhaps a line of units, numbers.

The separator is a comma, a semicolon or a tab; behind the latter two a comma in a number is a decimal one. A name that is in
the header more than once is known as NAME#1, NAME#2 and so on, from left to right.
"""

import codecs
import csv
import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from estimator.arrays import Floats

SEPARATORS = (",", ";", "\t")
LONGEST_HEAD = 200
"""Most lines before the first numbers."""
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")
THOUSANDS = re.compile(r"[-+]?\d{1,3}((,\d{3})+\.\d*|(\.\d{3})+,\d*|([ '’\u00a0\u202f]\d{3})+([.,]\d*)?|([,.]\d{3}){2,})")
"""A number with signs between its thousands: 3,596.40 or 3.596,40, 3 596 or 1,234,567; 3,596 may be either."""

ExportedRow = dict[str, str | None]


def decoded(content: bytes) -> str:
    """Return the text of a table: UTF-8, UTF-16 behind a byte order mark, or else as Windows writes it in the west.

    Its lines end as on any system. Raises UnicodeDecodeError.
    """
    return _text(content).replace("\r\n", "\n").replace("\r", "\n")


def no_text(path: Path) -> str:
    """Return what is wrong with a file that cannot be decoded, and what would be right."""
    return f"{path} is no text in UTF-8: save it as CSV in UTF-8"


def _text(content: bytes) -> str:
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16")
    try:
        # Spreadsheets put a byte order mark in front.
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Of a file that is no text, the first error says more than that of a second attempt.
        if b"\0" in content:
            raise
    return content.decode("cp1252")


def exported_rows(text: str) -> tuple[list[tuple[int, ExportedRow]], dict[str, str]]:
    """Return the rows below the header by their columns' names, each with the number of its line, and the line of units.

    There are none where no header stands above numbers.
    """
    lines = text.splitlines()
    for separator in SEPARATORS:
        reader = csv.reader(lines, delimiter=separator)
        numbered = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
        table = [cells for _, cells in numbered]
        first = next((place for place, cells in enumerate(table[:LONGEST_HEAD]) if _has_numbers(cells, separator)), None)
        if not first:
            continue
        head = first
        while head > 0 and len(table[head - 1]) == len(table[first]) and any(table[head - 1]):
            head -= 1
        if head == first:
            continue
        # Above a line of units some cells of which are blank.
        header = next((cells for cells in table[head:first] if all(cells)), table[head])
        names, above = _named(header), table[first - 1]
        units = {} if above is header else dict(zip(names, above, strict=False))
        decimal, gap = decimal_points(separator), [None] * len(names)
        rows = [
            (line, dict(zip(names, [*map(decimal, cells), *gap], strict=False)))
            for line, cells in numbered[first:]
            if any(cells)
        ]
        return rows, units
    return [], {}


def is_plain(text: str) -> bool:
    """Return whether a text is a header line of different names, separated by commas, with a number in the line below."""
    lines = text.split("\n", 2)[:2]
    header, first = (next(csv.reader([line]), []) for line in [*lines, ""][:2])
    names = [name.strip() for name in header]
    alone = len(names) > 1 and len(set(names)) == len(names) and not any(map(is_number, names))
    return alone and (not first or any(map(is_number, first)))


def _has_numbers(cells: Sequence[str], separator: str) -> bool:
    """Return whether most of a line's cells are numbers, two at least."""
    turned = decimal_points(separator)
    count = sum(is_number(turned(cell)) for cell in cells)
    return count >= 2 and 2 * count >= len([cell for cell in cells if cell])


def is_number(text: str) -> bool:
    """Return whether a text is a number with a decimal point."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def number_hint(text: str) -> str:
    """Return what would be right for a text that should be a number; empty where it does not look like one."""
    if THOUSANDS.fullmatch(text.strip()):
        return ": write numbers without signs between thousands"
    return ": write numbers with a decimal point" if "," in text else ""


def lost_thousands(speed: Floats) -> str:
    """Return that a sign between thousands was read as a decimal one in speeds (S,), and what would be right; else nothing.

    Such speeds jump by a thousand from 1.002 to 998; the larger is whole then, and the smaller has three decimals at most.
    """
    if np.array_equal(speed, np.round(speed)):
        return ""
    pairs = np.sort(np.column_stack([speed[:-1], speed[1:]]))
    small, large = pairs.T
    jumps = (small > 0.0) & (large >= 800.0 * small) & (large <= 1250.0 * small) & (large == np.round(large))
    jumps &= np.abs(1e3 * small - np.round(1e3 * small)) < 1e-6
    if not np.any(jumps):
        return ""
    row = int(np.argmax(jumps))
    one, other = f"{small[row]:.3f}", f"{large[row]:g}"
    return (
        f"the speed jumps between {one} and {other} from row {row + 1} to row {row + 2}: is the sign in {one} one between "
        f"thousands? Write {1e3 * small[row]:.0f}"
    )


def asks_for_thousands(speed: Floats) -> str:
    """Return the question whether speeds (S,) that are far too low have a sign between thousands; nothing where none can."""
    if not np.allclose(1e3 * speed, np.round(1e3 * speed), rtol=0.0, atol=1e-6):
        return ""
    return f"is {speed[0]:.3f} one with a sign between thousands? Write {1e3 * speed[0]:.0f}"


def decimal_points(separator: str) -> Callable[[str], str]:
    """Return the function that replaces decimal commas by points; it changes nothing where commas separate columns."""

    def turned(cell: str) -> str:
        return cell.replace(",", ".") if separator != "," and DECIMAL_COMMA.fullmatch(cell) else cell

    return turned


def _named(header: Sequence[str]) -> list[str]:
    """Return the names of a header, numbered where several are the same."""
    count, seen = Counter(header), Counter[str]()
    names = []
    for name in header:
        seen[name] += 1
        names.append(f"{name}#{seen[name]}" if count[name] > 1 else name)
    return names
