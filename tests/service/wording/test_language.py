"""Languages: each says everything that English says, with the same places; numbers have its decimal mark."""

import string
from collections.abc import Iterable

import pytest

from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.wording.english import ENGLISH_SENTENCES
from service.wording.finding_texts import LISTS, FindingTexts
from service.wording.german import GERMAN_SENTENCES
from service.wording.language import ENGLISH, GERMAN, LANGUAGES, SENTENCES, Language, asked_language
from service.wording.stored_sentences import in_language

DECLARED = (*FINDING_RULES, RATE_RULE)


def places(text: str) -> set[tuple[str, str]]:
    """The places of a text, with their formats."""
    return {(name, form or "") for _, name, form, _ in string.Formatter().parse(text) if name is not None}


def missing(has: Iterable[str], needs: Iterable[str]) -> list[str]:
    """Return what is needed and not there; names of identifiers may be English words as they are."""
    return sorted(one for one in set(needs) - set(has) if not one.startswith("name."))


def test_german_lacks_no_sentence() -> None:
    assert missing(GERMAN_SENTENCES, ENGLISH_SENTENCES) == []
    assert missing(ENGLISH_SENTENCES, GERMAN_SENTENCES) == []
    wrong = [key for key, text in ENGLISH_SENTENCES.items() if places(text) != places(GERMAN_SENTENCES[key])]
    assert wrong == []


def test_every_language_says_as_much_of_each_finding() -> None:
    for one in DECLARED:
        for language in LANGUAGES:
            for element_kind in ("", *one.texts_of_elements):
                said, english = (_shape(one.texts_in(each, element_kind)) for each in (language, ENGLISH))
                assert said == english, (one.kind, element_kind, language)
    assert [one.kind for one in DECLARED if one.texts_in(GERMAN) == one.texts_in(ENGLISH)] == []


def _shape(texts: FindingTexts) -> list[tuple[str, int, set[tuple[str, str]]]]:
    """Return how many texts there are of each name, and the places of what has happened."""
    return [("what", 1, places(texts.what)), *((name, len(getattr(texts, name)), set()) for name in LISTS)]


def test_a_finding_called_as_an_element_or_quantity_has_its_name() -> None:
    """Pages and reports name both by one identifier."""
    for language in LANGUAGES:
        own = {one.kind: one.name_in(language) for one in DECLARED}
        named = {key.removeprefix("name."): said for key, said in SENTENCES[language.code].items() if key.startswith("name.")}
        assert [kind for kind in sorted(own.keys() & named.keys()) if own[kind] != named[kind]] == []


def test_what_a_language_lacks_is_said_in_english(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SENTENCES, "de", {"decimal_mark": ","})
    assert GERMAN.translate("compared.mean", runs=3) == "mean of the newest 3 runs against the baseline"
    assert GERMAN.translate("wear", grown="3", after="79 µm", before="69 µm") == "3 % larger, 79 µm in place of 69 µm"
    assert GERMAN.named("run_up") == "run-up"
    assert GERMAN.named("static_load") == "static force"


def test_fractions_have_the_decimal_mark_of_the_language() -> None:
    assert ENGLISH.translate("urgent.so_far", far=-1.25) == "it has changed by -1.2 % so far; "
    assert GERMAN.translate("urgent.so_far", far=-1.25) == "bisher hat er sich um -1,2 % geändert; "
    assert GERMAN.digits("12.35 ± 0.12") == "12,35 ± 0,12"
    assert GERMAN.element("coupling.C1") == "Kupplung C1"
    assert GERMAN.element("machine") == "Maschine"


def test_quantities_of_parameters_have_german_names() -> None:
    """Also those that are called as a finding is: sizes of findings and reports name them."""
    named = {quantity: GERMAN.named(quantity) for quantity in ("unbalance", "bow", "run_out", "gain", "clearance")}
    assert named == {
        "unbalance": "Unwucht",
        "bow": "Wellenkrümmung",
        "run_out": "Runout",
        "gain": "Verstärkung",
        "clearance": "Lagerspiel",
    }


@pytest.mark.parametrize(
    ("accepted", "default", "found"),
    [
        ("", ENGLISH, "en"),
        ("", GERMAN, "de"),
        ("de", ENGLISH, "de"),
        ("de-AT,de;q=0.9,en;q=0.5", ENGLISH, "de"),
        ("en-GB,en;q=0.9,de;q=0.8", GERMAN, "en"),
        ("fr, de;q=0.2", ENGLISH, "de"),
        ("fr", GERMAN, "de"),
        ("de;q=0", ENGLISH, "en"),
        ("de;q=much, *", ENGLISH, "en"),
        (";;,,=", ENGLISH, "en"),
    ],
)
def test_the_language_is_the_one_that_is_asked_for(accepted: str, default: Language, found: str) -> None:
    assert asked_language(accepted, default).code == found


@pytest.mark.parametrize(
    ("accepted", "found"),
    [
        ("en-u-ms-ussystem", "mil"),
        ("de-AT-u-ms-ussystem;q=0.9, fr", "mil"),
        ("en-US", "µm"),
        ("en-u-ms-metric", "µm"),
        ("en-u-ussystem-ms", "µm"),
        ("en, en-u-ms-ussystem;q=0.5", "µm"),
        ("fr-u-ms-ussystem", "µm"),
    ],
)
def test_a_language_tag_may_ask_for_mils(accepted: str, found: str) -> None:
    assert asked_language(accepted, ENGLISH).length_unit == found


def test_a_length_is_reported_in_the_readers_unit() -> None:
    assert (ENGLISH.length(79.0), Language("en", "mil").length(79.0), Language("de", "mil").length(79.0)) == (
        "79 µm",
        "3.11 mil",
        "3,11 mil",
    )


def test_every_language_is_one_that_can_be_set() -> None:
    assert {one.code for one in LANGUAGES} == set(SENTENCES)


@pytest.mark.parametrize(
    ("sentence", "german"),
    [
        ("influence coefficients taken", "Einflusszahlen verwendet"),
        ("influence coefficients taken as asked", "Einflusszahlen verwendet wie verlangt"),
        ("influence coefficients 3.2 %, model 4.5 %", "Einflusszahlen 3,2 %, Modell 4,5 %"),
    ],
)
def test_methods_of_influence_coefficients_are_said_in_german(sentence: str, german: str) -> None:
    assert in_language(sentence, GERMAN) == german
