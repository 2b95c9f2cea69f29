"""Files that hold no run are named in one line that says what would be right."""

import re
import shutil
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.run_columns import WrongRun
from tests.rotorundown.wrong_input import PUMP, doubled, one_line, written

MISREAD: dict[str, tuple[Callable[[Any, Path], Any], dict[str, Any], str]] = {
    "a column twice in a file": (lambda frame, file: written(file, doubled(frame)), {}, "column 'B4R_um_pp' stands twice"),
    "a folder": (lambda _, file: file.parent, {}, "is a folder: name a file of it"),
    "no text": (
        lambda _, file: file.write_bytes(bytes(range(256))) and file,
        {},
        "is no text in UTF-8: save it as CSV in UTF-8",
    ),
    "an opened file": (lambda _f, _: StringIO(), {}, "a run is a file's path, not an opened file (StringIO): give its path"),
    "a document": (lambda _f, _: str(PUMP), {}, "is no recording: name the table of the run, such as a CSV file"),
    "a document of its name beside it": (
        lambda frame, file: shutil.copy(PUMP, file.with_suffix(".yaml")) and written(file, frame),
        {},
        "run.yaml is a machine document and not the recording's sidecar: give one of the two another name",
    ),
    "an empty sidecar": (
        lambda frame, file: file.with_suffix(".yaml").write_text("") or written(file, frame),
        {},
        "run.yaml is not a recording's sidecar: it should be fields by name, each with its value",
    ),
    "a spreadsheet": (
        lambda _f, file: file.with_suffix(".xlsx").write_bytes(b"PK") and file.with_suffix(".xlsx"),
        {},
        "run.xlsx is a spreadsheet: save its table as CSV",
    ),
}


@pytest.mark.parametrize("name", MISREAD)
def test_what_holds_no_run_is_one_line(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    make, options, words = MISREAD[name]
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(make(run.to_frame(), tmp_path / "run.csv"), machine=pump, **options)
    one_line(raised)


def test_a_file_that_ends_in_capitals_is_a_table(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    assert len(rd.read_run(written(tmp_path / "RUN.CSV", run.to_frame()), machine=pump)) == len(run)
