"""Vectors in files of measuring systems, their columns mapped once for a folder."""

import math
from pathlib import Path

import numpy as np
import pytest
import pyuff
import scipy.io
from nptdms import ChannelObject, TdmsWriter

from formats.files.document_files import UnreadableFile
from formats.recordings.recording import read_recording
from tests.formats.recordings.mapped_columns import AMPLITUDE, PHASE, RPM, assert_read, mapped


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
