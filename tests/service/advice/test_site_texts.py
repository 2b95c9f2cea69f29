"""A site's own texts: read whole, or refused whole with every wrong text."""

from pathlib import Path

import pytest

from service.advice.site_texts import read_texts
from service.monitoring.rules.finding_catalogue import finding_rule
from service.wording.finding_texts import TextsWrong
from service.wording.language import ENGLISH, GERMAN


def written(folder: Path, text: str) -> str:
    (folder / "texts.yaml").write_text(text, encoding="utf-8")
    return str(folder / "texts.yaml")


def test_what_a_site_writes_stands_and_all_else_stays(tmp_path: Path) -> None:
    texts = read_texts(written(tmp_path, 'misalignment: {at_next_stop: ["Call the crew (417) for {id}"]}'))
    shipped = finding_rule("misalignment").texts_in(ENGLISH)
    assert texts.of("misalignment").at_next_stop == ("Call the crew (417) for {id}",)
    assert texts.of("misalignment").what == shipped.what
    assert texts.of("wear") is finding_rule("wear").texts_in(ENGLISH)
    assert read_texts("").of("misalignment") is shipped


def test_texts_may_be_for_readers_of_one_language(tmp_path: Path) -> None:
    file = written(tmp_path, 'wear: {check: ["Tel. 417"]}\nde: {wear: {confirm: ["Schablone 12"]}}')
    english, german = read_texts(file), read_texts(file, "de")
    assert english.of("wear").check == german.of("wear").check == ("Tel. 417",)
    assert german.of("wear").confirm == ("Schablone 12",)
    assert english.of("wear").confirm == finding_rule("wear").texts_in(ENGLISH).confirm
    assert german.of("wear").what == finding_rule("wear").texts_in(GERMAN).what
    assert english.in_language(GERMAN).of("wear") == german.of("wear")


def test_a_seal_has_texts_of_its_own(tmp_path: Path) -> None:
    texts = read_texts(written(tmp_path, 'bearing: {check: ["Oil of {id}"]}\nseal: {confirm: ["Gauge 12"]}'))
    shipped = finding_rule("bearing").texts_in(ENGLISH, "seal")
    assert texts.of("bearing", "seal").check == shipped.check
    assert texts.of("bearing", "seal").confirm == ("Gauge 12",)
    assert texts.of("bearing", "bearing").check == ("Oil of {id}",)
    assert texts.of("bearing", "bearing").confirm == finding_rule("bearing").texts_in(ENGLISH).confirm


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('misalignment: {what: "Kupplung {id}: {size}"}', r"misalignment\.what: needs \{judgement\}"),
        ('misalignment: {check: ["bei {sped}"]}', r"misalignment\.check\[0\]: \{sped\} is no place: it has \{id\}, "),
        ('misalignment: {check: ["bei {id.real}"]}', r"misalignment\.check\[0\]: \{id\.real\} is no place"),
        ('misalignment: {check: ["bei {id!r:>9}"]}', r"misalignment\.check\[0\]: \{id!r:>9\} is no place"),
        ('misalignment: {check: ["bei {id"]}', r"misalignment\.check\[0\]: is no text with places"),
        ('misalignement: {check: ["a"]}', r"misalignement: there is no such finding; did you mean 'misalignment' "),
        ('wear: {chek: ["a"]}', r"wear\.chek: there is no such text; did you mean 'check'\?"),
        ('fr: {wear: {check: ["a"]}}', r"fr: there is no such finding.*, and the languages en, de"),
        ("wear: {check: []}", r"wear\.check: must be a list of 1 to 12 texts"),
        ("wear: {check: look}", r"wear\.check: must be a list"),
        ("wear: {what: [a]}", r"wear\.what: must be one text"),
        ("wear: 7", "wear: must have texts by name"),
        ('de: {wear: {check: ["bei {sped}"]}}', r"de\.wear\.check\[0\]: \{sped\} is no place"),
        ("de: [wear]", "de: must have the kinds of findings below it"),
        ('de: {wear: {what: "Lager {id}"}}', r"de\.wear\.what: needs \{size\}"),
        ('seal: {what: "Seal {id}"}', r"seal\.what: needs \{size\}, \{judgement\}"),
        ("- wear", "must have the kinds of findings at its top"),
        ("wear: [", "is neither YAML nor JSON"),
    ],
)
def test_a_wrong_text_is_refused_in_words(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(TextsWrong, match=words):
        read_texts(written(tmp_path, text))


def test_every_wrong_text_is_named_at_once(tmp_path: Path) -> None:
    text = 'misalignment: {check: ["{a}", "{b}"]}\nwear: {what: "worn by {size}"}\nrubs: {}'
    with pytest.raises(TextsWrong) as raised:
        read_texts(written(tmp_path, text))
    assert all(one in str(raised.value) for one in ("check[0]", "check[1]", "wear.what: needs {id}", "rubs: there is no"))


def test_a_wrong_place_is_named_beside_a_misspelt_name_of_the_same_finding(tmp_path: Path) -> None:
    text = 'wear: {chek: ["a"], confirm: [], check: ["{sped}"], what: "worn"}'
    with pytest.raises(TextsWrong) as raised:
        read_texts(written(tmp_path, text))
    named = ("wear.chek: there is no", "wear.confirm: must be", "wear.check[0]: {sped}", "wear.what: needs {id}, {size}")
    assert [one for one in named if one not in str(raised.value)] == []


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(TextsWrong, match=r"none\.yaml: No such file"):
        read_texts(str(tmp_path / "none.yaml"))
