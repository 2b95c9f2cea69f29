"""The page's words and enums of findings and channels are those of the declarations."""

import re
from pathlib import Path
from typing import get_args

import pytest

from estimator.diagnosis.finding_kind import ELEMENT_LISTS, ElementKind
from estimator.machine.document import LISTS
from service.commands.page_declarations import documents, write
from tests.paths import ROOT

SOURCES = ROOT / "dashboard" / "src"
PAGE = SOURCES / "declarations"
SLICED = re.compile(r"""(starts|ends)With\(["'][a-z]["']\)|\b(xy\|yx|yx\|xy)\b""")
"""Ways in which the page once read physics from the letters of a name."""


@pytest.mark.parametrize("name", list(documents()))
def test_the_page_has_what_is_declared(name: str) -> None:
    assert (PAGE / name).read_text(encoding="utf-8") == documents()[name], (
        "stale: run `make dashboard` and commit what it writes"
    )


def test_all_files_are_written(tmp_path: Path) -> None:
    write(tmp_path)
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == documents()


def test_the_page_reads_no_physics_from_letters_of_names() -> None:
    files = [path for path in SOURCES.rglob("*.ts*") if PAGE not in path.parents]
    found = [f"{path.relative_to(SOURCES)}: {one[0]}" for path in files for one in SLICED.finditer(path.read_text("utf-8"))]
    assert found == [], "quantity, axes and order of a term stand in declarations/terms.ts"


@pytest.mark.parametrize("text", ['one.term.startsWith("k")', 'field.endsWith("x")', "/(xy|yx)(@|$)/.test(parameter)"])
def test_such_a_reading_is_seen(text: str) -> None:
    assert SLICED.search(text)


def test_every_element_but_the_machine_has_its_list_of_the_document() -> None:
    assert set(ELEMENT_LISTS) == set(get_args(ElementKind)) - {"machine"}
    assert set(ELEMENT_LISTS.values()) <= set(LISTS)
