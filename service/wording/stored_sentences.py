"""Sentences that are stored in English, such as verdicts and what the service itself wrote into histories, in a language."""

import functools
import re
from collections.abc import Mapping

from service.wording.german_stored import GERMAN_STORED
from service.wording.language import SENTENCES, Language, Locale

STORED_SENTENCES: Mapping[Locale, Mapping[str, str]] = {"de": GERMAN_STORED}
"""By language what each English sentence is; a place stands for a part, which is looked for again."""
_COMMENTS = ("comment.revised", "comment.new_baseline", "comment.cause_gone", "comment.time_over")
"""Keys of what the service writes into histories, the more particular ones first."""
_PLACE = re.compile(r"\{(\w+)\}")
_LIST = re.compile(r"\{\w+\}(?:,| and| or| or with) \{\w+\}")
"""Form of a list, which any sentence may have by chance: it is one only of parts that are known, or names."""
_ONE_WORD = frozenset({"id", "meant", "sent"})
"""Placeholders filled by a single word, so that a list of sentences is not mistaken for one sentence."""
_WORD = r"\S+"
_NAME = re.compile(rf"{_WORD}(?: %)?")
"""Part of a list that every language says alike: a name or a number."""
_FRACTION = re.compile(r"[−+-]?\d+\.\d+(e[+-]?\d+)?(?: %)?")
_FORMER_UNIT = re.compile(r"(?<=\d) rpm\b")
"""Unit of speeds in sentences that earlier releases stored."""


def in_language(sentence: str, language: Language) -> str:
    """Return a stored sentence in a language, as far as there are words for its parts."""
    sentence = _FORMER_UNIT.sub(" r/min", sentence)
    if language.code not in STORED_SENTENCES:
        return sentence
    return "; ".join(_part(one, language) for one in sentence.split("; "))


def comment_in_language(comment: str, language: Language) -> str:
    """Return a comment that the service wrote in a language; a reason that a person gave stays as it was written."""
    for key in _COMMENTS:
        found = _form(SENTENCES["en"][key]).fullmatch(comment)
        if found:
            return language.translate(key, **found.groupdict())
    return comment


def _part(part: str, language: Language) -> str:
    return _known(part, language) or part


@functools.lru_cache(maxsize=4096)  # parts of a list are looked for again at each of its separators
def _known(part: str, language: Language) -> str | None:
    """Return a part in a language; None where there are no words for it."""
    if _FRACTION.fullmatch(part):
        return language.digits(part)
    for form, said, is_list in _forms(language.code):
        if found := form.fullmatch(part):
            values = found.groupdict()
            known = {name: _known(value, language) for name, value in values.items()}
            if not is_list or all(known[name] or _NAME.fullmatch(value) for name, value in values.items()):
                told = {name: known[name] or value for name, value in values.items()}
                return _PLACE.sub(lambda place, told=told: told[place[1]], said)  # type: ignore[misc]
    return None


@functools.cache
def _forms(code: Locale) -> tuple[tuple[re.Pattern[str], str, bool], ...]:
    """Return the forms of sentences and whether each is a list, the longest first: the most of a sentence is known by them."""
    known = STORED_SENTENCES[code]
    return tuple((_form(one), known[one], bool(_LIST.fullmatch(one))) for one in sorted(known, key=len, reverse=True))


@functools.cache
def _form(sentence: str) -> re.Pattern[str]:
    parts = _PLACE.split(sentence)
    return re.compile("".join(_filled(one) if at % 2 else re.escape(one) for at, one in enumerate(parts)), re.DOTALL)


def _filled(place: str) -> str:
    return rf"(?P<{place}>{_WORD if place in _ONE_WORD else '.+'})"
