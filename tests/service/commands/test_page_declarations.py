"""The page's words and enums of findings and channels are those of the declarations."""

from pathlib import Path

import pytest

from service.commands.page_declarations import documents, write
from tests.paths import ROOT

PAGE = ROOT / "dashboard" / "src" / "declarations"


@pytest.mark.parametrize("name", list(documents()))
def test_the_page_has_what_is_declared(name: str) -> None:
    assert (PAGE / name).read_text(encoding="utf-8") == documents()[name], (
        "stale: run `make dashboard` and commit what it writes"
    )


def test_all_files_are_written(tmp_path: Path) -> None:
    write(tmp_path)
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == documents()
