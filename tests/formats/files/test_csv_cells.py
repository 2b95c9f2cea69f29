"""Texts that a spreadsheet would compute, in every CSV that is written."""

import csv
import io
import re
from pathlib import Path

import pytest

from formats.files.csv_cells import cell
from service.api.conventions.formats import csv_bytes
from service.export.column_writer import Column, write
from tests.end_to_end.processes import ROOT

FORMULAS = [
    "=cmd|'/C calc'!A0",
    "@SUM(1)",
    "+1+1",
    "-2+3+cmd|' /C calc'!D2",
    "\tx",
    "\rx",
    "\nx",
    "-",
    "+",
    "-inf",
    "-1_0",
    "=\n",
    "＝1+1",
    "＋1+1",
    "－1+1",
    "＠SUM(1)",
    "'=1",
    "''＝1",
    "'-1",
]
INSIDE = {
    "moved;=cmd|'/C calc'!A0;": "moved;'=cmd|'/C calc'!A0;",
    'moved;"=1+1;': "moved;'\"=1+1;",
    "moved;-1": "moved;'-1",
    "moved;'@SUM(1)": "moved;''@SUM(1)",
    "moved\n=1+1": "moved\n'=1+1",
    "moved\t＝1+1": "moved\t'＝1+1",
    "=1;=1;=1": "'=1;'=1;'=1",
    "\t=1+1": "'\t'=1+1",
    "\r=1+1": "'\r'=1+1",
}
PLAIN = ["-1", "+1.5", "-.5e-3", "1=1", "", "it moves", " x", "{}", "a;b", "a; =b", "a;'\tb", "'x", None, -1.5, True, 7]


@pytest.mark.parametrize("value", FORMULAS)
def test_a_formula_is_written_as_a_text(value: str) -> None:
    assert cell(value) == f"'{value}"
    ((header,), (row,)) = csv.reader(io.StringIO(csv_bytes({value: [value]}).decode(), newline=""))
    assert header == row == f"'{value}"


@pytest.mark.parametrize("value", INSIDE)
def test_no_cell_that_begins_at_another_separator_is_a_formula(value: str) -> None:
    """Such as for a spreadsheet in a country whose decimals have a comma."""
    assert cell(value) == INSIDE[value]
    written = csv_bytes({"comment": [value], "other": ["x"]}).decode()
    for separator in (";", "\t", ","):
        for row in csv.reader(io.StringIO(written, newline=""), delimiter=separator):
            assert not any(re.match("[=+@＝＋－＠-]", one) for one in row), (separator, row)


@pytest.mark.parametrize("value", [*FORMULAS, *INSIDE, *(one for one in PLAIN if isinstance(one, str))])
def test_a_program_takes_the_apostrophes_off(value: str) -> None:
    """By the rule that docs/integrators.md tells."""
    (rule,) = re.findall(r'`re\.sub\(r"""(.*)""", "", text\)`', (ROOT / "docs" / "integrators.md").read_text())
    assert re.sub(rule, "", cell(value)) == value


@pytest.mark.parametrize("value", PLAIN)
def test_all_else_is_written_as_it_is(value: object) -> None:
    assert cell(value) is value


def test_an_export_holds_no_formula(tmp_path: Path) -> None:
    columns = (Column("comment", "text", "what they said"), Column("value", "number", "a number"))
    write(tmp_path, "timeline", columns, [[[one, -1.5] for one in FORMULAS]])
    with (tmp_path / "timeline.csv").open(newline="") as file:
        assert [(row["comment"], row["value"]) for row in csv.DictReader(file)] == [(f"'{one}", "-1.5") for one in FORMULAS]


def test_no_other_module_writes_csv() -> None:
    writing = [
        file.name
        for package in ("formats", "rotorundown", "service")
        for file in (ROOT / package).rglob("*.py")
        if re.search(r"csv\.(writer|DictWriter)", file.read_text())
    ]
    assert writing == ["csv_cells.py"]
