"""Texts of a finding: templates with places for its numbers, as they are declared with the finding or written by a site.

A place is a name in braces, such as {id}; a brace itself is doubled. Nothing else is taken: neither formats nor attributes.
"""

import string
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields

PLACES = ("id", "element", "machine", "size", "compared", "since", "sigma", "runs")
"""Places that the texts of every finding may have.

id: id of its element, such as C1; element: such as coupling C1; machine: its id; size: how far, in words; compared: number of
runs that were compared with the baseline; since: day of the first run that shows it; sigma: how certain; runs: number of runs
that were looked at together.
"""
LONGEST_TEXT = 600
"""Most characters of a text."""
MOST_TEXTS = 12
"""Most texts of a list."""


class TextsWrong(ValueError):
    """Texts are unusable; the message names each wrong text and what would be right."""


@dataclass(frozen=True)
class FindingTexts:
    """Texts of one kind of finding.

    what: one sentence that says what has happened. check: what to look at, to know more. in_operation: what to do while the
    machine runs. at_next_stop: what to do when it stands next. if_danger: what to do now where it is a danger. confirm: what
    would confirm it. not_determined: what the finding leaves open.
    """

    what: str
    check: tuple[str, ...] = ()
    in_operation: tuple[str, ...] = ()
    at_next_stop: tuple[str, ...] = ()
    if_danger: tuple[str, ...] = ()
    confirm: tuple[str, ...] = ()
    not_determined: tuple[str, ...] = ()

    def problems(self, places: Iterable[str], needed: Iterable[str]) -> Iterator[tuple[str, str]]:
        """Yield each wrong text with what is wrong. places: that there are; needed: those that `what` must have."""
        known = (*PLACES, *places)
        for field, text in self._texts():
            yield from ((field, message) for message in _problems(text, known))
        missing = [one for one in needed if one not in set(_places(self.what))]
        if missing:
            yield "what", f"needs {', '.join(f'{{{one}}}' for one in missing)}: without it nobody knows what is meant"

    def filled(self, values: Mapping[str, str]) -> "FindingTexts":
        """Return the texts with values in their places."""
        return FindingTexts(
            self.what.format_map(values),
            *(tuple(one.format_map(values) for one in getattr(self, name)) for name in LISTS),
        )

    def _texts(self) -> Iterator[tuple[str, str]]:
        yield "what", self.what
        for name in LISTS:
            for number, one in enumerate(getattr(self, name)):
                yield f"{name}[{number}]", one


LISTS = tuple(one.name for one in fields(FindingTexts) if one.name != "what")
"""Names of the texts that are lists."""


def _problems(text: str, known: Iterable[str]) -> Iterator[str]:
    if not text.strip() or len(text) > LONGEST_TEXT:
        yield f"must have 1 to {LONGEST_TEXT} characters"
        return
    try:
        parts = list(string.Formatter().parse(text))
    except ValueError as error:
        yield f"is no text with places: {error}; a brace itself is doubled"
        return
    for _, name, form, conversion in parts:
        if name is None:
            continue
        if form or conversion or name not in known:
            yield (
                f"{{{name}{'!' + conversion if conversion else ''}{':' + form if form else ''}}} is no place: it has "
                + ", ".join(f"{{{one}}}" for one in known)
            )


def _places(text: str) -> Iterator[str]:
    try:
        yield from (name for _, name, _, _ in string.Formatter().parse(text) if name)
    except ValueError:
        return
