"""Tables of coefficients in CSV files beside a machine document."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from formats.files.document_files import UnreadableFile, read_machine
from tests.estimator.trains import chapter_3_document

GOOD = (
    "speed_rpm,kxx_n_per_m,cyy\n# a maker's figures\n90,2e5,300\n500, 2.5e5 ,290\n\n1000,3e5,280\n2000,3e5,270\n6000,4e5,250\n"
)


def document_with(folder: Path, table: dict[str, Any], text: str | None = None) -> Path:
    """A document in a folder whose second bearing has a table, and the table's file one folder below."""
    document = chapter_3_document()
    for name in ("kxx", "cyy"):
        del document["bearings"][1][name]
    document["bearings"][1]["speed_dependence"] = table
    (folder / "tables").mkdir()
    if text is not None:
        (folder / "tables" / "B2.csv").write_text(text, encoding="utf-8")
    path = folder / "machine.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    return path


def test_columns_are_those_of_the_file_beside_the_document(tmp_path: Path) -> None:
    named = {"form": "table", "csv": "tables/B2.csv", "scale_spread": 0.05}
    machine = read_machine(document_with(tmp_path, named, "\ufeff" + GOOD.replace("\n", "\r\n")))
    found = machine.model_dump(mode="json", exclude_none=True)["bearings"][1]["speed_dependence"]
    assert found == {
        "form": "table",
        "speed_rpm": [90, 500, 1000, 2000, 6000],
        "kxx": [2e5, 2.5e5, 3e5, 3e5, 4e5],
        "cyy": [300, 290, 280, 270, 250],
        "scale_spread": 0.05,
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "B2.csv: No such file"),
        ("", "B2.csv is empty: its first line names the columns: speed_rpm"),
        (GOOD.replace("speed_rpm", "speed"), "column 'speed' is none of a table"),
        (
            GOOD.replace("kxx_n_per_m", "kxx_n_per_um"),
            "column 'kxx_n_per_um' is none of a table, with commas between: speed_rpm",
        ),
        (GOOD.replace("cyy", "kxx"), "two columns are kxx"),
        (GOOD.replace("speed_rpm", "kyy"), "column speed_rpm is missing"),
        (
            GOOD.replace("2.5e5", "2,5e5"),
            "B2.csv, line 4: 4 cells; the first line names 3 columns; was a decimal comma meant?",
        ),
        (GOOD.replace("2.5e5", '"2,5e5"'), "B2.csv, line 4, column kxx_n_per_m: '2,5e5' is no number, such as 1.5e8"),
        (GOOD.replace(",", ";").replace(".", ","), "B2.csv: semicolons stand between its cells: save it with commas"),
        (GOOD.replace("290", ""), "B2.csv, line 4, column cyy: the cell is empty: each line needs a number in each"),
        (GOOD.replace(",290", ""), "B2.csv, line 4: 2 cells; the first line names 3 columns"),
        (GOOD.replace("290", "nan"), "B2.csv, line 4, column cyy: 'nan' is no number"),
        (GOOD.replace("1000,", "400,"), "bearings[1].speed_dependence.speed_rpm: speeds [r/min] must ascend: 400 at place 3"),
        (GOOD.replace("290", "-290"), "bearings[1].speed_dependence.cyy[1]"),
        (GOOD.replace("290", "n.a."), "B2.csv, line 4, column cyy: 'n.a.' is no number, such as 1.5e8"),
        (GOOD.replace("290", "inf"), "line 4, column cyy: 'inf' is no number"),
        ("speed_rpm,kxx\n" + "".join(f"{1 + n},1e5\n" for n in range(501)), "line 502: at most 500 speeds"),
        ("speed_rpm,kxx\n90,2e5\n", "bearings[1].speed_dependence.speed_rpm: a table has at least 5 speeds"),
    ],
)
def test_a_wrong_file_is_reported_by_file_line_and_column(tmp_path: Path, text: str | None, message: str) -> None:
    path = document_with(tmp_path, {"form": "table", "csv": "tables/B2.csv"}, text)
    with pytest.raises(UnreadableFile) as raised:
        read_machine(path)
    assert message in str(raised.value)
    assert str(raised.value).startswith(str(path))
    assert "bearings[1].speed_dependence" in str(raised.value)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"form": "piecewise", "knots_rpm": [500, 900], "csv": "tables/B2.csv"}, "of the form 'table' only"),
        ({"form": "table", "csv": 7}, "names a file, such as bearing-B1.csv"),
        ({"form": "table", "csv": "tables/B2.csv", "kxx": [1e5] * 5}, "kxx beside csv: give the columns in one of them only"),
    ],
)
def test_a_file_goes_with_a_table_and_no_columns(tmp_path: Path, table: dict[str, Any], message: str) -> None:
    with pytest.raises(UnreadableFile, match=r"bearings\[1\].speed_dependence") as raised:
        read_machine(document_with(tmp_path, table, GOOD))
    assert message in str(raised.value)


def test_what_is_no_document_is_refused_as_before(tmp_path: Path) -> None:
    path = tmp_path / "machine.yaml"
    path.write_text("bearings: [1, {speed_dependence: 3}]\n", encoding="utf-8")
    with pytest.raises(UnreadableFile, match="is not a machine document"):
        read_machine(path)
    path.write_text("[1, 2]\n", encoding="utf-8")
    with pytest.raises(UnreadableFile, match="is not a machine document"):
        read_machine(path)
