"""Names of the page: a component or a type stands for one thing, and variables have words of the trade."""

import re
from collections import defaultdict

import pytest

from tests.paths import ROOT
from tests.test_names import DIALECT

SOURCES = ROOT / "dashboard" / "src"
IDIOM = {"Props"}
"""Arguments of a file's one component, as the framework's users call them."""
TYPE = re.compile(r"^(?:export )?(?:default )?(?:function|interface|type|class|enum) ([A-Z]\w*)", re.MULTILINE)
VARIABLE = re.compile(r"\b(?:function|const|let|interface|type) (\w+)")
WORD = re.compile("[A-Z]?[a-z0-9]+")
PAGE_DIALECT = DIALECT - {"some", "holes"}
"""Words of no trade; `some` is a method of lists, and holes are drilled into balancing planes."""


def sources() -> dict[str, str]:
    """Return the texts of the page's sources but its messages and what is generated, by their paths."""
    paths = [path for path in sorted(SOURCES.rglob("*.ts*")) if path.parent.name not in ("messages", "declarations")]
    assert len(paths) > 100
    return {path.relative_to(SOURCES).as_posix(): path.read_text(encoding="utf-8") for path in paths}


def test_no_two_components_or_types_have_one_name() -> None:
    found = defaultdict[str, list[str]](list)
    for path, text in sources().items():
        for name in TYPE.findall(text):
            found[name].append(path)
    assert {name: paths for name, paths in found.items() if len(paths) > 1 and name not in IDIOM} == {}


def dialect(text: str) -> list[str]:
    """Return the variables, functions and types of a source whose names hold a word of no trade."""
    return [name for name in VARIABLE.findall(text) if PAGE_DIALECT & {word.lower() for word in WORD.findall(name)}]


def test_variables_are_called_by_words_of_the_trade() -> None:
    assert {path: names for path, text in sources().items() if (names := dialect(text))} == {}


@pytest.mark.parametrize("name", ["told", "spokenText", "PeopleList"])
def test_a_word_of_no_trade_is_seen(name: str) -> None:
    assert dialect(f"  const {name} = 3;") == [name]
    assert dialect("const amplitudeText = 3; // as told") == []


def test_components_and_types_are_seen() -> None:
    text = "export interface Point {}\nfunction Row() {}\nfunction rowText() {}\ntype Kind = string;\n"
    assert TYPE.findall(text) == ["Point", "Row", "Kind"]
