"""Tables without samples: what is said of them, whoever reads them."""

from pathlib import Path


def is_blank(path: Path) -> bool:
    """Return whether a file holds nothing but white space. Raises OSError."""
    with path.open("rb") as file:
        return not any(line.strip() for line in file)


def empty_table_text(path: Path) -> str:
    """Return what is wrong with a table without samples, and what would be right. Raises OSError."""
    found = "is empty" if is_blank(path) else "has no rows below a header line"
    return f"{path} {found}: the first line names the columns, each line below holds one sample; was its export cut short?"
