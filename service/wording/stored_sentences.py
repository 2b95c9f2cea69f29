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
_FRACTION = re.compile(r"[−+-]?\d+\.\d+(e[+-]?\d+)?")


def in_language(sentence: str, language: Language) -> str:
    """Return a stored sentence in a language, as far as there are words for its parts."""
    if language.code not in STORED_SENTENCES:
        return sentence
    return "; ".join(_part(one, language) for one in sentence.split("; "))


def told_comment(comment: str, language: Language) -> str:
    """Return a comment that the service wrote in a language; a reason that a person gave stays as it was written."""
    for key in _COMMENTS:
        found = _form(SENTENCES["en"][key]).fullmatch(comment)
        if found:
            return language.say(key, **found.groupdict())
    return comment


def _part(part: str, language: Language) -> str:
    if _FRACTION.fullmatch(part):
        return language.digits(part)
    for form, said in _forms(language.code):
        found = form.fullmatch(part)
        if found:
            values = {name: _part(value, language) for name, value in found.groupdict().items()}
            return _PLACE.sub(lambda place, values=values: values[place[1]], said)  # type: ignore[misc]
    return part


@functools.cache
def _forms(code: Locale) -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return the forms of sentences, the longest first: the most of a sentence is known by them."""
    known = STORED_SENTENCES[code]
    return tuple((_form(sentence), known[sentence]) for sentence in sorted(known, key=len, reverse=True))


@functools.cache
def _form(sentence: str) -> re.Pattern[str]:
    parts = _PLACE.split(sentence)
    return re.compile("".join(f"(?P<{one}>.+)" if at % 2 else re.escape(one) for at, one in enumerate(parts)), re.DOTALL)
