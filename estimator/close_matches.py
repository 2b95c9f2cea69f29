"""Suggestions: which known names a misspelt one is close to."""

import difflib
from collections.abc import Iterable

MOST_MATCHES = 3
"""Most names that are suggested."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a clause that suggests names like the one given.

    Args:
        name: The name that is not known.
        known: The known names.

    Returns:
        The clause, beginning with a semicolon; empty where no name is close.
    """
    matches = difflib.get_close_matches(name, list(known), n=MOST_MATCHES, cutoff=0.6)
    return f"; did you mean {' or '.join(repr(one) for one in matches)}?" if matches else ""
