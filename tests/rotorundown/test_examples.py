"""The examples of docs/python.md, run as printed; each public name is in one of them."""

import re
from inspect import signature
from pathlib import Path
from typing import Any

import matplotlib
import pytest

import rotorundown as rd
from benchmarks.serving import served
from storage.database.engine import Database
from tests.paths import ROOT
from tests.rotorundown.test_notebooks import NOTEBOOKS
from tests.rotorundown.test_public_names import parts

PAGE = (ROOT / "docs" / "python.md").read_text()
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[1:]
"""All but the five lines, which tests/end_to_end/test_by_hand.py runs."""
ADDRESS = "http://localhost:8080"


def test_each_public_name_has_an_example() -> None:
    code = "\n".join(BLOCKS)
    assert [name for name in rd.__all__ if name != "read_run" and f"rd.{name}" not in code] == []
    assert "rd.read_run" in PAGE


NOT_SHOWN = {
    "Machine": "its parts and properties are the document's, of which integrators.md tells",
    "Rows.columns": "to_frame() has them",
}
"""Public names without an example, and why."""


def test_each_method_and_option_has_an_example() -> None:
    """Examples are those of the page and of the notebooks: the tests run both."""
    code = "\n".join([*BLOCKS, *(one.read_text() for one in NOTEBOOKS)])
    methods = [title for name in rd.__all__ for title, _ in parts(name) if name not in NOT_SHOWN]
    unshown = [one for one in methods if "." in one and not re.search(rf"\.{one.rpartition('.')[2]}\b", code)]
    assert set(unshown) <= NOT_SHOWN.keys()
    for name in ("read_run", "identify", "calibrate", "compare", "diagnose", "read_ross_model", "plot_trend"):
        options = [one.name for one in signature(getattr(rd, name)).parameters.values() if one.kind is one.KEYWORD_ONLY]
        assert [one for one in options if not re.search(rf"\b{one}=|\"{one}\":", code)] == [], name


def test_the_examples_run_as_printed(
    plant: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    matplotlib.use("Agg")
    for folder in ("examples", "tests"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    with served(plant) as url:
        for block in BLOCKS:
            exec(block.replace(ADDRESS, url.removesuffix("/api/v1")), names)
    printed = capsys.readouterr().out
    assert "changed coefficients" in printed
    assert "misalignment at coupling.C1" in printed
    assert "no AlertEntry" in printed
    assert "does not answer" not in printed
