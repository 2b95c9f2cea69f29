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
    least = SHORT_LIKENESS if len(name) <= SHORT else LIKENESS
    matches = difflib.get_close_matches(name, list(known), n=MOST_MATCHES, cutoff=least)
    return f"; did you mean {' or '.join(repr(one) for one in matches)}?" if matches else ""
