"""Languages in which findings are described: their sentences, names and numbers. What one lacks is said in English."""

import itertools
import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from service.wording.english import ENGLISH_SENTENCES
from service.wording.german import GERMAN_SENTENCES

Locale = Literal["en", "de"]
"""Languages that there are, as RFC 5646 writes them."""
LengthUnit = Literal["µm", "mil"]
"""Units of small lengths."""
MIL_UM = 25.4
"""Micrometres in a mil, a thousandth of an inch."""
MILS_ASKED = ("ms", "ussystem")
"""Subtags of a language tag that ask for units of the US (Unicode Technical Standard 35, key `ms`): `en-u-ms-ussystem`."""
SENTENCES: Mapping[Locale, Mapping[str, str]] = {"en": ENGLISH_SENTENCES, "de": GERMAN_SENTENCES}


class _Filling(string.Formatter):
    """Fills places; fractions get the language's decimal mark."""

    def __init__(self, mark: str) -> None:
        self._mark = mark

    def format_field(self, value: Any, format_spec: str) -> str:
        text = str(super().format_field(value, format_spec))
        return text.replace(".", self._mark) if isinstance(value, float) else text


@dataclass(frozen=True)
class Language:
    """A language by its code, and the unit in which its readers want small lengths."""

    code: Locale = "en"
    length_unit: LengthUnit = "µm"

    def translate(self, key: str, /, **values: Any) -> str:
        """Return a sentence with values in its places. Raises KeyError for an unknown key, or one without its value."""
        mark = self.decimal_mark()
        if mark == ".":
            return self._sentence(key).format_map(values)  # the same, at a tenth of the time
        return _Filling(mark).vformat(self._sentence(key), (), values)

    def in_length_unit(self, micrometres: float) -> float:
        """Return a small length [µm] in the readers' unit."""
        return micrometres if self.length_unit == "µm" else micrometres / MIL_UM

    def length(self, micrometres: float) -> str:
        """Return a small length [µm] with its unit, to 1 µm or 0.01 mil."""
        decimals = 0 if self.length_unit == "µm" else 2
        return f"{self.digits(f'{self.in_length_unit(micrometres):.{decimals}f}')} {self.length_unit}"

    def decimal_mark(self) -> str:
        """Return the decimal mark."""
        return self._sentence("decimal_mark")

    def digits(self, number: str) -> str:
        """Return a written number with the language's decimal mark."""
        return number.replace(".", self.decimal_mark())

    def named(self, identifier: str) -> str:
        """Return the word for an identifier of the API; the identifier with spaces where there is none."""
        own = SENTENCES[self.code].get(f"name.{identifier}") or ENGLISH_SENTENCES.get(f"name.{identifier}")
        return own or identifier.replace("_", " ")

    def element(self, name: str) -> str:
        """Return an element's name, such as `coupling C1` of `coupling.C1`."""
        kind, _, own = name.partition(".")
        return f"{self.named(kind)} {own}" if own else self.named(kind)

    def _sentence(self, key: str) -> str:
        return SENTENCES[self.code].get(key) or ENGLISH_SENTENCES[key]


ENGLISH = Language("en")
GERMAN = Language("de")
LANGUAGES = tuple(Language(code) for code in SENTENCES)


def require_every_language(what: str, texts: Mapping[Locale, object]) -> None:
    """Raise ValueError if a text is missing in a language, or is given in an unknown language."""
    missing = [code for code in SENTENCES if not texts.get(code)]
    unknown = sorted(set(texts) - set(SENTENCES))
    if missing:
        raise ValueError(f"{what} is missing in: {', '.join(missing)}")
    if unknown:
        raise ValueError(f"{what} is said in {', '.join(unknown)}, and the languages are {', '.join(SENTENCES)}")


LONGEST_HEADER = 1_000
"""Number of characters of an Accept-Language header that are read."""


def asked_language(accepted: str, default: Language) -> Language:
    """Return the language that an Accept-Language header asks for (RFC 9110 §12.5.4); the default without one of ours.

    A tag with the units of the US, `en-u-ms-ussystem`, asks for mils. Of a very long header only the beginning counts: reading
    all of it would hold up everybody else's requests.
    """
    best, wished = default, 0.0
    for part in accepted[:LONGEST_HEADER].split(","):
        tag, _, quality = part.strip().partition(";")
        weight = _quality(quality)
        code, *subtags = tag.strip().lower().split("-")
        for one in LANGUAGES:
            if code == one.code and weight > wished:
                best, wished = Language(one.code, _length_unit(subtags)), weight
    return best


def _length_unit(subtags: Sequence[str]) -> LengthUnit:
    return "mil" if MILS_ASKED in itertools.pairwise(subtags) else "µm"


def _quality(said: str) -> float:
    try:
        return float(said.strip().removeprefix("q=")) if said.strip() else 1.0
    except ValueError:
        return 0.0
