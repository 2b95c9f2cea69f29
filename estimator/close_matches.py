"""Suggestions: which known names a misspelt one is close to."""

import difflib
from collections.abc import Iterable

MOST_MATCHES = 3
"""Most names that are suggested."""
LIKENESS, SHORT_LIKENESS = 0.6, 0.5
"""Least likeness of a suggested name, from 0 to 1, and that to a short one, in which a letter is half of it."""
SHORT = 3
"""Most letters of a short name."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a clause that suggests names like the one given.

    Args:
        name: The name that is not known.
        known: The known names.

    Returns:
        The clause, beginning with a semicolon; empty where no name is close.
    """
    matches = close_names(name, known)
    return f"; did you mean {' or '.join(repr(one) for one in matches)}?" if matches else ""


def close_names(name: str, known: Iterable[str]) -> list[str]:
    """Return the names that are like the one given, the closest first; `coupling.C1.kxx` is like `C1.kxx`, too.

    Args:
        name: The name.
        known: Names to choose from.

    Returns:
        At most `MOST_MATCHES` of them.
    """
    names = list(known)
    ends = [one for one in names if one.endswith(f".{name}")]
    least = SHORT_LIKENESS if len(name) <= SHORT else LIKENESS
    alike = difflib.get_close_matches(name, names, n=MOST_MATCHES, cutoff=least)
    return list(dict.fromkeys([*ends, *alike]))[:MOST_MATCHES]
