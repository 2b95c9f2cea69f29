"""The page's catalogues of messages: every language says everything that English says, with the same places."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from service.wording.language import SENTENCES, Locale

ROOT = Path(__file__).parents[2]
MESSAGES = ROOT / "dashboard" / "src" / "messages"
MESSAGE = re.compile(r'^  "?([\w.]+)"?: ("(?:[^"\\]|\\.)*"),$', re.MULTILINE)
PLACE = re.compile(r"\{(\w+)\}")
LOCALES = sorted(path.stem for path in MESSAGES.glob("*.ts") if len(path.stem) == 2 and path.stem != "en")


def catalogue(locale: str) -> dict[str, str]:
    """The messages of a language by their keys."""
    text = (MESSAGES / f"{locale}.ts").read_text(encoding="utf-8")
    found = MESSAGE.findall(text)
    assert len(found) == len(dict(found)), f"{locale}: a key stands twice"
    return {key: words[1:-1] for key, words in found}


@pytest.mark.parametrize("locale", LOCALES)
def test_a_language_lacks_no_message(locale: str) -> None:
    english, other = catalogue("en"), catalogue(locale)
    assert sorted(set(english) - set(other)) == []
    assert sorted(set(other) - set(english)) == []


@pytest.mark.parametrize("locale", LOCALES)
def test_messages_have_the_same_places(locale: str) -> None:
    other = catalogue(locale)
    english = {key: sorted(PLACE.findall(text)) for key, text in catalogue("en").items()}
    assert {key: places for key, places in english.items() if sorted(PLACE.findall(other[key])) != places} == {}


def test_there_is_a_message_for_every_key_and_each_is_said() -> None:
    sources = [path for path in MESSAGES.parent.rglob("*.ts*") if path.parent != MESSAGES]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources)
    unsaid = [key for key in catalogue("en") if not key.startswith("term.") and f'"{key}"' not in text]
    assert unsaid == []


def test_every_language_can_be_chosen() -> None:
    locales = (MESSAGES / "locale.ts").read_text(encoding="utf-8")
    assert re.findall(r"(\w\w): \"", locales.split("LOCALES = {")[1].split("}")[0]) == ["en", *LOCALES]


@pytest.mark.parametrize("locale", ["en", *LOCALES])
def test_what_the_service_declares_has_its_name_from_there(locale: str) -> None:
    """Also in the catalogue, where an element has the same name: `term` looks there first."""
    names = {**declared("findings.ts", "FINDING_NAMES")[locale], **declared("channels.ts", "CHANNEL_NAMES")[locale]}
    assert len(names) > 20
    messages = catalogue(locale)
    assert {kind: messages[f"term.{kind}"] for kind, said in names.items() if messages.get(f"term.{kind}", said) != said} == {}


def test_what_is_declared_is_there_in_every_language() -> None:
    for file, constant in (
        ("findings.ts", "FINDING_NAMES"),
        ("channels.ts", "CHANNEL_NAMES"),
        ("channels.ts", "ADDRESS_FORMS"),
    ):
        assert sorted(declared(file, constant)) == sorted(["en", *LOCALES])


def declared(file: str, constant: str) -> dict[str, Any]:
    """Return what a constant of the declarations holds, by language."""
    text = (MESSAGES.parent / "declarations" / file).read_text(encoding="utf-8")
    lines = text.split(f"export const {constant} = {{\n")[1].split("\n};")[0].splitlines()
    return {locale: json.loads(said.removesuffix(",")) for locale, said in (line.strip().split(": ", 1) for line in lines)}


NOT_SHOWN = {"parallel", "angular", "combined", "splitting", "rpm", "real", "imaginary", "times", "test"}
"""Words of the service's own sentences, which the page says otherwise or not at all."""


@pytest.mark.parametrize("locale", ["en", *LOCALES])
def test_page_and_service_call_a_thing_by_one_name(locale: Locale) -> None:
    declared_names = declared("findings.ts", "FINDING_NAMES")[locale]
    page = catalogue(locale)
    said = {key.removeprefix("name."): words for key, words in SENTENCES[locale].items() if key.startswith("name.")}
    shown = {name: page.get(f"term.{name}", declared_names.get(name)) for name in said.keys() - NOT_SHOWN}
    assert {name: words for name, words in shown.items() if words != said[name]} == {}
