"""Vectors in files of measuring systems and in exports of other programs, their columns mapped once for a folder."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyuff
import scipy.io
import yaml
from nptdms import ChannelObject, TdmsWriter

from formats.files.document_files import UnreadableFile
from formats.recordings.recording import read_recording

RPM = np.linspace(600.0, 3000.0, 25)
AMPLITUDE = 20.0 + 0.01 * RPM
PHASE = np.linspace(10.0, 170.0, 25)
SAID = {
    "plant": "examples",
    "machine": "pump",
    "interval_s": 1.0,
    "speed": "Speed",
    "speed_unit": "rpm",
    "amplitude_unit": "um",
    "amplitude_kind": "peak-to-peak",
    "phase_convention": "lag",
    "phase_unit": "deg",
    "channels": [{"channel": "B1X", "amplitude": "A", "phase": "P"}],
}
SYSTEM_1 = """Machine Name:,Pump
Point Name,B1X,,,B1Y
Date Range,"from 2024-03-01, to 2024-03-01"

Timestamp,Speed,Amplitude,Phase,Amplitude,Phase
,rpm,um pp,deg,um pp,deg
"""


def mapped(folder: Path, **changes: Any) -> None:
    """Save the mapping of the columns for all recordings of a folder."""
    (folder / "columns.yaml").write_text(yaml.safe_dump(SAID | changes))


def assert_read(path: Path) -> None:
    batch = read_recording(path)
    assert batch.speed == pytest.approx(list(RPM), rel=1e-5)
    assert [row[0] for row in batch.amplitude] == pytest.approx(list(AMPLITUDE), rel=1e-5)
    assert [row[0] for row in batch.phase] == pytest.approx(list(PHASE), rel=1e-5)


def test_vectors_of_mat_and_tdms_files(tmp_path: Path) -> None:
    mapped(tmp_path)
    scipy.io.savemat(tmp_path / "a.mat", {"Speed": RPM, "A": AMPLITUDE, "P": PHASE, "other": np.ones(3)})
    with TdmsWriter(tmp_path / "a.tdms") as file:
        file.write_segment([ChannelObject("run", n, v) for n, v in (("Speed", RPM), ("A", AMPLITUDE), ("P", PHASE))])
    assert_read(tmp_path / "a.mat")
    assert_read(tmp_path / "a.tdms")


def test_a_tdms_file_that_ends_before_its_first_channel_is_named(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    mapped(tmp_path)
    with TdmsWriter(tmp_path / "a.tdms") as file:
        file.write_segment([ChannelObject("run", n, v) for n, v in (("Speed", RPM), ("A", AMPLITUDE), ("P", PHASE))])
    (tmp_path / "a.tdms").write_bytes((tmp_path / "a.tdms").read_bytes()[:100])
    with pytest.raises(UnreadableFile, match="not a whole TDMS file: it ends before its first channel of numbers"):
        read_recording(tmp_path / "a.tdms")
    assert capfd.readouterr().err == ""


def test_an_order_over_speed_in_a_universal_file(tmp_path: Path) -> None:
    said = {"type": 58, "binary": 0, "func_type": 2, "id1": "B1X", "rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
    vector = AMPLITUDE * np.exp(1j * np.radians(PHASE))
    kinds = {"abscissa_spec_data_type": 19, "ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0}
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets(said | kinds | {"data": vector, "x": RPM}, mode="add")
    channel = {"channel": "B1X", "real": "B1X.real", "imaginary": "B1X.imag"}
    mapped(tmp_path, speed="x", channels=[channel], phase_convention="lead")
    assert_read(tmp_path / "a.uff")


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


def test_columns_that_map_twice_and_files_that_are_cut_are_named(tmp_path: Path) -> None:
    mapped(tmp_path, channels=[{"channel": "B1X", "amplitude": "A", "phase": "A"}])
    scipy.io.savemat(tmp_path / "a.mat", {"Speed": RPM, "A": AMPLITUDE, "P": PHASE})
    with pytest.raises(UnreadableFile, match="column A is mapped twice"):
        read_recording(tmp_path / "a.mat")
    mapped(tmp_path)
    whole = (tmp_path / "a.mat").read_bytes()
    (tmp_path / "a.mat").write_bytes(whole[: math.floor(0.7 * len(whole))])
    with pytest.raises(UnreadableFile, match="not a whole MAT file, cut short or damaged: copy or export it anew"):
        read_recording(tmp_path / "a.mat")
    scipy.io.savemat(tmp_path / "b.mat", {"Speed": RPM, "A": AMPLITUDE})
    with pytest.raises(UnreadableFile, match="has no column 'P'; it has Speed, A"):
        read_recording(tmp_path / "b.mat")


def test_a_file_without_the_keyphasors_speed_says_what_to_export(tmp_path: Path) -> None:
    mapped(tmp_path)
    scipy.io.savemat(tmp_path / "a.mat", {"A": AMPLITUDE, "P": PHASE})
    with pytest.raises(
        UnreadableFile, match="has no column 'Speed'; it has A, P: a run is nothing without the keyphasor's speed"
    ):
        read_recording(tmp_path / "a.mat")


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


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
def test_a_cut_mdf_file_is_reported_in_one_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    asammdf = pytest.importorskip("asammdf")
    mapped(tmp_path)
    file = asammdf.MDF(version="4.10")
    file.append([asammdf.Signal(AMPLITUDE, RPM, name="A")])
    file.save(tmp_path / "whole.mf4")
    (tmp_path / "a.mf4").write_bytes((tmp_path / "whole.mf4").read_bytes()[:1500])
    with pytest.raises(UnreadableFile, match="not a whole MDF file, cut short or damaged: copy or export it anew"):
        read_recording(tmp_path / "a.mf4")
    assert "Traceback" not in capfd.readouterr().err


def test_a_compressed_mat_file_is_read(tmp_path: Path) -> None:
    mapped(tmp_path)
    scipy.io.savemat(tmp_path / "a.mat", {"Speed": RPM, "A": AMPLITUDE, "P": PHASE}, do_compression=True)
    assert_read(tmp_path / "a.mat")


def test_a_mat_file_that_becomes_more_than_measured_values_would_is_refused_unread(tmp_path: Path) -> None:
    mapped(tmp_path)
    zeros = {name: np.zeros(5_000_000) for name in ("Speed", "A", "P")}
    scipy.io.savemat(tmp_path / "a.mat", zeros, do_compression=True)
    assert (tmp_path / "a.mat").stat().st_size < 300_000
    with pytest.raises(UnreadableFile, match=r"holds more than 64 MiB in 0\.1 MiB"):
        read_recording(tmp_path / "a.mat")


def test_orders_over_other_speeds_are_not_taken_for_orders_over_the_first(tmp_path: Path) -> None:
    said = {"type": 58, "binary": 0, "func_type": 2, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
    kinds = {"abscissa_spec_data_type": 19, "ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0}
    vector = AMPLITUDE * np.exp(1j * np.radians(PHASE))
    for name, node, speed in (("B1X", 1, RPM), ("B1Y", 2, RPM + 50.0), ("B2X", 3, RPM[:20])):
        one = {"id1": name, "rsp_node": node, "data": vector[: speed.size], "x": speed}
        pyuff.UFF(str(tmp_path / "a.uff")).write_sets(said | kinds | one, mode="add")
    mapped(
        tmp_path,
        speed="x",
        channels=[{"channel": "B1X", "real": "B1X.real", "imaginary": "B1X.imag"}],
        phase_convention="lead",
    )
    assert_read(tmp_path / "a.uff")
    for other in ("B1Y", "B2X"):
        channel = {"channel": "B1X", "real": f"{other}.real", "imaginary": f"{other}.imag"}
        mapped(tmp_path, speed="x", channels=[channel])
        with pytest.raises(UnreadableFile, match=f"'{other}.real' has another abscissa than B1X, whose is `x`"):
            read_recording(tmp_path / "a.uff")


def test_columns_of_other_lengths_and_of_several_groups_are_named(tmp_path: Path) -> None:
    mapped(tmp_path)
    scipy.io.savemat(tmp_path / "a.mat", {"Speed": RPM, "A": AMPLITUDE[:-2], "P": PHASE})
    with pytest.raises(
        UnreadableFile, match="column 'A' has 23 values where 2 columns have 25: export all at the same speeds"
    ):
        read_recording(tmp_path / "a.mat")
    with TdmsWriter(tmp_path / "a.tdms") as file:
        file.write_segment([ChannelObject("run", n, v) for n, v in (("Speed", RPM), ("A", AMPLITUDE), ("P", PHASE))])
        file.write_segment([ChannelObject("other", "Speed", RPM)])
    with pytest.raises(UnreadableFile, match="'Speed' is there more than once: name one of run/Speed, other/Speed"):
        read_recording(tmp_path / "a.tdms")


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
