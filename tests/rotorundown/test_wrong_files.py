"""Files that hold no run are named in one line that says what would be right."""

import re
import shutil
from collections.abc import Callable
from datetime import UTC, datetime
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from formats.recordings.written_recording import write_recording
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

LINES: dict[str, tuple[Callable[[list[str]], list[str]], str]] = {
    "no header": (
        lambda lines: lines[1:],
        "run.csv, line 1 is no header: it holds numbers; the line above the first",
    ),
    "a title of two cells": (
        lambda lines: ["Export, pump 12", *lines],
        "run.csv, line 1 is no header: 'Export pump 12' has 2 cells, the lines below have 18; the first line names the "
        "columns, begin lines above it with #",
    ),
    "a row that is cut short": (
        lambda lines: [*lines[:4], lines[4][:20], *lines[5:]],
        "run.csv, line 5 has 2 cells, its header 18: the row is cut short; complete it or leave it out",
    ),
    "a last row that is cut short": (
        lambda lines: [*lines[:4], lines[4][:20]],
        "run.csv, line 5 has 2 cells, its header 18: the row is cut short, as an export that broke off; complete it",
    ),
    "a first sample without numbers": (
        lambda lines: [lines[0], "1969-12-31T23:59:59+00:00" + "," * lines[0].count(","), *dated(lines[1:])],
        "the speed has no number in row 1: leave such rows out",
    ),
    "a first sample that is not available": (
        lambda lines: [lines[0], ",".join(["n/a"] * (lines[0].count(",") + 1)), *lines[1:]],
        "column 'time_s', row 1: 'n/a' is not a number",
    ),
    "a word below lines about the export": (
        lambda lines: ["# pump 12", "", lines[0], units(lines[0]), lines[1], lines[2].replace(",", ",low", 1), *lines[3:]],
        "is not a number (row 1 is line 5)",
    ),
    "units that are not known": (
        lambda lines: [lines[0], units(lines[0]).replace("µm pp", "mm/s", 1), *lines[1:]],
        "column 'B1L_um_pp [mm/s]': its unit 'mm/s' is not known: write one of m, mm, um, mil and one of peak",
    ),
    "units that are others": (
        lambda lines: [lines[0], units(lines[0], speed="Hz"), *lines[1:]],
        "column 'speed_rpm [Hz]' is in Hz, but speed_unit says rpm (or in a sidecar, run.yaml)",
    ),
}


def units(header: str, *, speed: str = "rpm") -> str:
    """Return a line of units below a header."""
    known = {"time_s": "s", "speed_rpm": speed}
    return ",".join(known.get(name, "µm pp" if name.endswith("_um_pp") else "deg") for name in header.split(","))


def dated(rows: list[str]) -> list[str]:
    """Return rows whose seconds are dates."""
    cells = [row.partition(",") for row in rows]
    return [f"{datetime.fromtimestamp(float(time), UTC).isoformat()},{rest}" for time, _, rest in cells]


@pytest.mark.parametrize("name", LINES)
def test_a_wrong_line_of_a_table_is_named(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    change, words = LINES[name]
    file = tmp_path / "run.csv"
    file.write_text("\n".join(change(run.to_frame().to_csv(index=False).splitlines())) + "\n", encoding="utf-8")
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(file, machine=pump)
    one_line(raised)


@pytest.mark.parametrize("number", ["3,596.40", "3.596,40", "3 596.4", "1,003,596"])
def test_signs_between_thousands_are_named(pump: Machine, run: rd.MachineRun, tmp_path: Path, number: str) -> None:
    frame = run.to_frame().astype({"speed_rpm": str})
    frame.loc[2, "speed_rpm"] = number
    words = re.escape(f"row 3: '{number}' is not a number: write numbers without signs between thousands")
    with pytest.raises(WrongRun, match=words):
        rd.read_run(written(tmp_path / "run.csv", frame), machine=pump)


@pytest.mark.parametrize("sidecar", [True, False])
@pytest.mark.parametrize("sign", [".", ","])
def test_signs_between_thousands_without_decimals_are_named(
    pump: Machine, run: rd.MachineRun, tmp_path: Path, sign: str, sidecar: bool
) -> None:
    """Speeds such as 3,596 and 988, which are numbers with a decimal sign, too."""
    file = tmp_path / "run.csv"
    write_recording(file, pump, speed_rpm=run.speed_rpm, phasor=run.recorded.phasor, interval_s=run.interval_s)
    header, *rows = file.read_text().splitlines()
    if not sidecar:
        file.with_suffix(".yaml").unlink()

    def saved(taken: Callable[[float], bool]) -> None:
        cells = [(float(speed), rest.replace(",", ";")) for speed, _, rest in (row.partition(",") for row in rows)]
        lines = [f"{speed:,.0f};{rest}".replace(",", sign) for speed, rest in cells if taken(speed)]
        file.write_text("\n".join([header.replace(",", ";"), *lines]))

    saved(bool)
    with pytest.raises(WrongRun, match=r"the speed jumps between 1\.\d\d\d and 9\d\d from row .*thousands\? Write 1\d\d\d"):
        rd.read_run(file, machine=pump)
    saved(lambda speed: speed > 1000.0)
    with pytest.raises(WrongRun, match=r"is 3\.596 one with a sign between thousands\? Write 3596"):
        rd.read_run(file, machine=pump)


HEADS: dict[str, Callable[[list[str]], list[str]]] = {
    "a separator": lambda lines: ["sep=;", *(one.replace(",", ";") for one in lines)],
    "comments": lambda lines: ["# export of pump 12, 2026-11-27", "#", "", *lines],
    "a title": lambda lines: ["Run-down of pump 12", "", *lines],
    "a header behind a comment sign, as of numpy": lambda lines: [f"# {lines[0]}", *lines[1:]],
    "a line of units": lambda lines: [lines[0], units(lines[0]), *lines[1:]],
    "a line of units in brackets": lambda lines: [lines[0], f"[{units(lines[0]).replace(',', '],[')}]", *lines[1:]],
    "a line of units with dashes": lambda lines: [lines[0], units(lines[0], speed="-"), *lines[1:]],
    "a form of dates for a unit": lambda lines: [lines[0], units(lines[0]).replace("s,", "hh:mm:ss,", 1), *dated(lines[1:])],
    "units in the header and below": lambda lines: [
        lines[0].replace("speed_rpm", "Speed [rpm]").replace("B1L_um_pp", "B1L Amplitude (µm)").replace("time_s", "time (s)"),
        units(lines[0]),
        *lines[1:],
    ],
    "a tab said to be the separator": lambda lines: ["sep=\t", *(one.replace(",", "\t") for one in lines)],
    "a comma in a name, between semicolons": lambda lines: [
        lines[0].replace(",", ";").replace("B1L_um_pp", "B1L Amplitude (µm, pp)"),
        *(one.replace(",", ";").replace(".", ",") for one in lines[1:]),
    ],
    "a separator behind each row": lambda lines: [lines[0], *(f"{one}," for one in lines[1:])],
    "rows of blank cells at the end": lambda lines: [*lines, "," * lines[0].count(",")],
}


@pytest.mark.parametrize("name", HEADS)
def test_lines_around_a_table_are_no_part_of_it(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    file = tmp_path / "run.csv"
    file.write_text("\n".join(HEADS[name](run.to_frame().to_csv(index=False).splitlines())) + "\n", encoding="utf-8")
    read = rd.read_run(file, machine=pump)
    np.testing.assert_allclose(read.recorded.phasor, run.recorded.phasor, rtol=1e-6, atol=2e-11)
    assert read.interval_s == pytest.approx(run.interval_s)
    assert read.left_out == ()


@pytest.mark.parametrize("name", MISREAD)
def test_what_holds_no_run_is_one_line(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    make, options, words = MISREAD[name]
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(make(run.to_frame(), tmp_path / "run.csv"), machine=pump, **options)
    one_line(raised)


def test_a_file_that_ends_in_capitals_is_a_table(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    assert len(rd.read_run(written(tmp_path / "RUN.CSV", run.to_frame()), machine=pump)) == len(run)
