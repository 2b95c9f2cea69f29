"""The picture of the house in docs/developers.md and the table of its rooms in docs/rooms.md, drawn from `tests.rooms`.

`python -m tests.rooms_picture` draws both.
"""

import ast
import re
import textwrap
from pathlib import Path

from tests.paths import ROOT
from tests.rooms import ROOMS

PICTURE, TABLE = ROOT / "docs" / "developers.md", ROOT / "docs" / "rooms.md"
LABEL = 13
"""Width of the column of packages: the longest name and two blanks."""
BEGIN, END = "<!-- rooms: drawn by `python -m tests.rooms_picture` -->\n", "<!-- end of rooms -->"


def first_sentence(package: Path) -> str:
    """Return what the docstring of a room says lives there, up to the first full stop."""
    text = ast.get_docstring(ast.parse((package / "__init__.py").read_text())) or ""
    return re.split(r"[.;](?=\s)", " ".join(text.split()) + " ", maxsplit=1)[0]


def table() -> str:
    """Return the table of docs/rooms.md: what lives in each room, and the rooms that it imports."""
    lines = ["| room | what lives there | imports |", "|---|---|---|"]
    for room, others in ROOMS.items():
        package = room.split("/")[0]
        own = [one.removeprefix(f"{package}/") for one in others if one.startswith(f"{package}/")]
        floor = [
            f"ground floor of `{one}`" if one == package else f"`{one}`"
            for one in dict.fromkeys(one.split("/")[0] for one in others if not one.startswith(f"{package}/"))
        ]
        named = [f"`{one}`" for one in own] + floor
        lines.append(f"| `{room}/` | {first_sentence(ROOT / room)} | {', '.join(named) or '—'} |")
    return "\n".join(lines) + "\n"


def height(room: str) -> int:
    """Return how many rooms of its package stand below a room, one on the other."""
    below = [one for one in ROOMS.get(room, ()) if one.split("/")[0] == room.split("/")[0] and one in ROOMS]
    return 1 + max(map(height, below), default=-1)


def drawing() -> str:
    """Return the packages with their rooms as storeys: each imports from lower ones only."""
    lines = ["```"]
    for package in ("service", "rotorundown", "formats", "storage", "estimator"):
        storeys: dict[int, list[str]] = {}
        for room in ROOMS:
            if room.startswith(f"{package}/"):
                storeys.setdefault(height(room), []).append(room.removeprefix(f"{package}/"))
        for number, storey in enumerate(sorted(storeys, reverse=True)):
            lines += textwrap.wrap(
                "  ".join(storeys[storey]),
                110,
                initial_indent=f"{'' if number else package:{LABEL}}",
                subsequent_indent=" " * LABEL,
            )
        lines.append("")
    return "\n".join([*lines[:-1], "```"]) + "\n"


def drawn(page: Path) -> str:
    """Return a page with what stands between its marks drawn anew."""
    head, rest = page.read_text().split(BEGIN, 1)
    return head + BEGIN + (drawing() if page == PICTURE else table()) + END + rest.split(END, 1)[1]


if __name__ == "__main__":
    for one in (PICTURE, TABLE):
        one.write_text(drawn(one))
