"""Exports of other programs, their columns mapped once for a folder."""

from pathlib import Path

import numpy as np
import pytest
import scipy.io

from formats.files.document_files import UnreadableFile
from formats.recordings.recording import read_recording
from tests.formats.recordings.mapped_columns import AMPLITUDE, PHASE, RPM, assert_read, mapped

SYSTEM_1 = """Machine Name:,Pump
Point Name,B1X,,,B1Y
Date Range,"from 2024-03-01, to 2024-03-01"

Timestamp,Speed,Amplitude,Phase,Amplitude,Phase
,rpm,um pp,deg,um pp,deg
"""


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_an_export_with_lines_about_it_a_line_of_units_and_names_that_repeat(tmp_path: Path, separator: str) -> None:
    mapped(tmp_path, channels=[{"channel": "B1X", "amplitude": "Amplitude#2", "phase": "Phase#2"}])
    rows = [
        f"3/1/2024 10:00:{k:02d},{speed:.6f},1.0,2.0,{one:.6f},{phase:.6f}"
        for k, (speed, one, phase) in enumerate(zip(RPM, AMPLITUDE, PHASE, strict=True))
    ]
    text = (SYSTEM_1 + "\n".join(rows)).replace(",", separator)
    if separator != ",":
        text = text.replace(".", ",")
    (tmp_path / "a.csv").write_text(text + "\n")
    assert_read(tmp_path / "a.csv")
    mapped(tmp_path, channels=[{"channel": "B1X", "amplitude": "Amplitude", "phase": "Phase#2"}])
    with pytest.raises(UnreadableFile, match="'Amplitude' is there more than once: name 'Amplitude#1', 'Amplitude#2'"):
        read_recording(tmp_path / "a.csv")


ENCODED = [("cp1252", "\r\n"), ("utf-16", "\r\n"), ("utf-8-sig", "\r\n"), ("utf-8", "\r")]


@pytest.mark.parametrize(("encoding", "ends"), ENCODED)
def test_exports_are_read_in_the_encodings_that_are_written(tmp_path: Path, encoding: str, ends: str) -> None:
    lines = ["Export;Prüfstand", "", "Speed (rpm);B1X Amp (µm);B1X Phase (°)"]
    lines += [f"{n:.2f};{a:.6f};{p:.6f}".replace(".", ",") for n, a, p in zip(RPM, AMPLITUDE, PHASE, strict=True)]
    (tmp_path / "a.csv").write_bytes(ends.join(lines).encode(encoding))
    mapped(tmp_path, speed="Speed (rpm)", channels=[{"channel": "B1X", "amplitude": "B1X Amp (µm)", "phase": "B1X Phase (°)"}])
    assert_read(tmp_path / "a.csv")


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    mapped(tmp_path)
    (tmp_path / "a.csv").write_bytes(b"PK\x03\x04\xff\x00\x00\xfe")
    with pytest.raises(UnreadableFile, match=r"a\.csv"):
        read_recording(tmp_path / "a.csv")


def test_what_is_wrong_with_an_export_is_reported_by_the_line_of_the_file(tmp_path: Path) -> None:
    mapped(tmp_path, channels=[{"channel": "B1X", "amplitude": "Amplitude#1", "phase": "Phase#1"}])
    rows = ["3/1/2024 10:00:00,600,1.0,2.0,3.0,4.0", "3/1/2024 10:00:01,700,Bad,2.0,3.0,4.0", "3/1/2024 10:00:02,800,1."]
    (tmp_path / "a.csv").write_text(SYSTEM_1 + "\n".join(rows[:2]) + "\n")
    with pytest.raises(UnreadableFile, match="line 8: 'Bad' in column 'Amplitude#1' is not a number"):
        read_recording(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text(SYSTEM_1 + "\n".join(rows[::2]))
    with pytest.raises(UnreadableFile, match=r"line 8 is too short: it has no column 'Phase#1': was the file cut short\?"):
        read_recording(tmp_path / "a.csv")
    mapped(tmp_path)
    scipy.io.savemat(tmp_path / "a.mat", {"Speed": np.r_[np.nan, RPM[1:]], "A": AMPLITUDE, "P": PHASE})
    with pytest.raises(UnreadableFile, match="value 1: column 'Speed' has no value"):
        read_recording(tmp_path / "a.mat")
