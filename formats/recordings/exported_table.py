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


def exported_rows(text: str) -> list[tuple[int, ExportedRow]]:
    """Return the rows below the header by their columns' names, each with the number of its line.

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
        names = _named(next((cells for cells in table[head:first] if all(cells)), table[head]))
        decimal, gap = decimal_points(separator), [None] * len(names)
        return [
            (line, dict(zip(names, [*map(decimal, cells), *gap], strict=False)))
            for line, cells in numbered[first:]
            if any(cells)
        ]
    return []


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
