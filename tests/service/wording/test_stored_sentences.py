"""Sentences that are stored in English: each language knows all of them, with their places, and none that nobody stores."""

import re
from collections import Counter
from itertools import chain
from pathlib import Path

import pytest

from estimator.fit.validation.goodness_of_fit import Verdict
from estimator.phasors.quality import Flag
from service.alerts import transitions
from service.wording.english import ENGLISH_SENTENCES
from service.wording.german_stored import TOPICS
from service.wording.language import ENGLISH, GERMAN, LANGUAGES
from service.wording.stored_sentences import STORED_SENTENCES, comment_in_language, in_language

ROOT = Path(__file__).parents[3]
PLACE = re.compile(r"\{(\w+)\}")
FRAGMENT = re.compile(r"\{\w+\}|, | r/min ")
FIGURE_OF_SPEED = re.compile(r"(?<=\d) r/min\b")
PACKAGES = ("estimator", "service/runs", "service/monitoring", "service/api", "service/delivery", "service/security")
ENGLISH_WORDS = re.compile(r"\b(?:the|of|is|are|with|from|not|and|this|has|which|since|by|or|at|it)\b")
"""Words that no German sentence has."""
STORED = Path(__file__).with_name("stored-sentences.txt").read_text(encoding="utf-8").splitlines()
"""Sentences as the service stores them, rare ones first of all."""
MOST_PIECES = 3
"""Pieces of source that a fragment of a sentence is put together of at most."""


@pytest.mark.parametrize("sentence", STORED)
def test_no_english_is_left_of_a_stored_sentence(sentence: str) -> None:
    said = in_language(sentence, GERMAN)
    assert ENGLISH_WORDS.findall(said) == [], said
    # What is told in numbers and names is told in every language.
    assert set(re.findall(r"[A-Z]\d\w*", sentence)) <= set(re.findall(r"[A-Z]\d\w*", said))
    assert in_language(sentence, ENGLISH) == sentence


@pytest.mark.parametrize("sentence", [one for one in STORED if FIGURE_OF_SPEED.search(one)])
def test_sentences_that_earlier_releases_stored_with_rpm_are_told_as_those_of_today(sentence: str) -> None:
    for language in LANGUAGES:
        assert in_language(FIGURE_OF_SPEED.sub(" rpm", sentence), language) == in_language(sentence, language)


def test_no_sentence_belongs_to_two_topics() -> None:
    assert [one for one, times in Counter(chain.from_iterable(TOPICS)).items() if times > 1] == []


def test_what_nobody_knows_stays_as_it_is_and_numbers_get_their_mark() -> None:
    assert in_language("a sentence of another release", GERMAN) == "a sentence of another release"
    assert (
        in_language("accepted: χ²/dof 1.02, expected 1 ± 0.08", GERMAN)
        == "angenommen: χ²/Freiheitsgrad 1,02, erwartet 1 ± 0,08"
    )
    for unknown in (
        "the values and the file",
        "bearing B1 of it and coupling renewed",
        "no more, the end",
        "this or with that part",
    ):
        assert in_language(unknown, GERMAN) == unknown
    assert in_language("D1, D2 and bearing B1", GERMAN) == "D1, D2 und Lager B1"
    endless = ", ".join(f"this {n} and that {n} or a {n}" for n in range(60))
    assert in_language(endless, GERMAN) == endless
    refused = Verdict(True, "accepted: χ²/dof 1.02, expected 1 ± 0.08", 3).refused("it is left out")
    assert in_language(refused.words, GERMAN) == "er ist ausgelassen; χ²/Freiheitsgrad 1,02, erwartet 1 ± 0,08"


def test_languages_know_the_same_sentences_with_the_same_places() -> None:
    assert sorted(STORED_SENTENCES) == sorted(one.code for one in LANGUAGES if one != ENGLISH)
    known = STORED_SENTENCES["de"]
    for code, sentences in STORED_SENTENCES.items():
        assert sorted(sentences) == sorted(known), code
        wrong = [one for one, said in sentences.items() if sorted(PLACE.findall(one)) != sorted(PLACE.findall(said))]
        assert wrong == [], code


def test_sentences_are_those_that_the_service_stores() -> None:
    sources = [path.read_text(encoding="utf-8") for one in PACKAGES for path in sorted((ROOT / one).rglob("*.py"))]
    text = re.sub(r'"\s*\n\s*f?"', "", "\n".join([*sources, *(one.label for one in Flag)]))
    parts = {part.strip() for sentence in STORED_SENTENCES["de"] for part in FRAGMENT.split(sentence)}
    unknown = [part for part in sorted(parts) if len(part.strip(" .,:;()?")) > 3 and pieces(part, text) > MOST_PIECES]
    assert unknown == []
    assert pieces("which no source has ever written at any of its places", text) > MOST_PIECES


def pieces(fragment: str, text: str) -> int:
    """Count the pieces of a text that make up a fragment, each as long as can be: one where it stands there whole."""
    words, count = fragment.split(), 0
    while words:
        length = next((one for one in range(len(words), 0, -1) if " ".join(words[:one]) in text), 1)
        words, count = words[length:], count + 1
    return count


def test_comments_of_the_service_are_reported_in_a_language_and_reasons_of_people_as_they_were_given() -> None:
    assert comment_in_language("its cause is gone", GERMAN) == "die Ursache ist entfallen"
    assert comment_in_language("its time is over", GERMAN) == "die Zeit ist abgelaufen"
    said = comment_in_language("a new baseline begins: bearing B1 and coupling renewed; aligned", GERMAN)
    assert said == "ein neuer Referenzzustand beginnt: bearing B1 and coupling renewed; aligned"
    revised = "a new baseline begins: revision 3 describes the machine otherwise"
    assert (
        comment_in_language(revised, GERMAN) == "ein neuer Referenzzustand beginnt: Revision 3 beschreibt die Maschine anders"
    )
    assert comment_in_language("looked at it", GERMAN) == "looked at it"
    assert comment_in_language(revised, ENGLISH) == revised


def test_comments_of_the_service_are_those_that_it_writes() -> None:
    written = [Path(transitions.__file__), ROOT / "service" / "monitoring" / "baseline_changes.py"]
    text = "\n".join(path.read_text(encoding="utf-8") for path in written)
    comments = {key: said for key, said in ENGLISH_SENTENCES.items() if key.startswith("comment.")}
    assert len(comments) == 4
    assert [key for key, said in comments.items() if not all(part in text for part in PLACE.sub("{}", said).split("{}"))] == []
