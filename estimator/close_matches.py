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
    """Return the names that are like the one given, in capitals or not, the closest first; a name is like its own end, too.

    So `coupling.C1.kxx` is like `c1.kxx`.

    Args:
        name: The name.
        known: Names to choose from.

    Returns:
        At most `MOST_MATCHES` of them.
    """
    sought = name.casefold()
    forms: dict[str, list[str]] = {}
    for one in known:
        whole = one.casefold()
        end = ".".join(whole.split(".")[-1 - sought.count(".") :])
        for form in dict.fromkeys([end, whole]):
            forms.setdefault(form, []).append(one)
    least = SHORT_LIKENESS if len(name) <= SHORT else LIKENESS
    alike = difflib.get_close_matches(sought, forms, n=MOST_MATCHES, cutoff=least)
    return list(dict.fromkeys(one for form in alike for one in forms[form]))[:MOST_MATCHES]
