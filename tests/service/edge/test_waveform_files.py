"""Files of waveforms as other programs write them: read in pieces, from any sample on, and as far as they are whole."""

import csv
import gc
import math
import wave
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io.wavfile
from asammdf import MDF, Signal
from nptdms import ChannelObject, TdmsWriter
from pydantic import ValidationError

from estimator.arrays import Floats
from service.edge.condition import Conditions
from service.edge.configuration import EdgeConfiguration
from service.edge.files import read_chunks
from service.edge.sample_window import Chunk
from service.edge.waveform_message import BadMessage, decode_waveforms, encode_waveforms
from tests.waveforms import RATE, START_NS, edge_document

SAMPLES = 40_000
VALUES = np.round(np.random.default_rng(3).uniform(-0.9, 0.9, (3, SAMPLES)), 6)
NAMES = ("K", "A", "B")


def write_csv(path: Path) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["other", *NAMES])
        writer.writerows([0.0, *row] for row in VALUES.T.tolist())


def write_npz(path: Path) -> None:
    np.savez(path, **dict(zip(NAMES, VALUES, strict=True)), sampling_rate=RATE, start_ns=START_NS)


def write_npz_compressed(path: Path) -> None:
    np.savez_compressed(path, K=VALUES[0], A=VALUES[1], B=VALUES[2], sampling_rate=RATE, start_ns=START_NS)


def write_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        file.attrs["sampling_rate"], file.attrs["start_ns"] = RATE, START_NS
        for name, values in zip(NAMES, VALUES, strict=True):
            file.create_dataset(name, data=values, chunks=(1000,))


def write_wav(path: Path, kind: str = "f8") -> None:
    scale = 1.0 if kind.startswith("f") else 2.0 ** (8 * int(kind[1]) - 1)
    scipy.io.wavfile.write(path, int(RATE), (VALUES.T * scale).astype(kind))


def write_mat(path: Path) -> None:
    named = dict(zip(NAMES, VALUES, strict=True))
    scipy.io.savemat(path, named | {"sampling_rate": RATE, "start_ns": np.int64(START_NS), "note": "a text"})


def write_tdms(path: Path) -> None:
    said = {"wf_increment": 1.0 / RATE, "wf_start_time": np.datetime64(START_NS, "ns")}
    with TdmsWriter(path) as file:
        for part in np.split(VALUES, 4, axis=1):
            file.write_segment([ChannelObject("scope", name, one, said) for name, one in zip(NAMES, part, strict=True)])


def write_uff(path: Path) -> None:
    file = pyuff.UFF(str(path))
    for name, values in zip(NAMES, VALUES, strict=True):
        said = {"type": 58, "binary": 0, "func_type": 1, "id1": name, "abscissa_spec_data_type": 17}
        places = {"rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1}
        kinds = {"ordinate_spec_data_type": 8, "orddenom_spec_data_type": 0}
        file.write_sets(said | places | kinds | {"data": values, "x": np.arange(SAMPLES) / RATE}, mode="add")


def write_mf4(path: Path) -> None:
    times = np.arange(SAMPLES) / RATE
    with MDF(version="4.10") as file:
        file.append([Signal(values, times, name=name) for name, values in zip(NAMES, VALUES, strict=True)])
        file.header.start_time = datetime.fromtimestamp(START_NS / 1e9, UTC)
        file.save(path, overwrite=True)


WRITERS: dict[str, Callable[[Path], None]] = {
    "a.csv": write_csv,
    "a.npz": write_npz,
    "b.npz": write_npz_compressed,
    "a.h5": write_hdf5,
    "a.wav": write_wav,
    "a.mat": write_mat,
    "a.tdms": write_tdms,
    "a.uff": write_uff,
    "a.mf4": write_mf4,
}


def configuration(path: Path, **waveforms: Any) -> EdgeConfiguration:
    said = {"files": [{"path": str(path), "start": "2023-11-14T22:13:20Z"}], "sampling_rate": RATE} | waveforms
    columns = {"K": "1", "A": "2", "B": "3"} if path.suffix == ".wav" else {name: name for name in NAMES}
    return EdgeConfiguration.model_validate(
        edge_document(
            waveforms=said,
            keyphasor={"column": columns["K"]},
            channels=[
                {"probe": "B2X", "column": columns["A"], "sensitivity": 8000.0},
                {"probe": "B2Y", "column": columns["B"], "sensitivity": 4000.0},
            ],
        )
    )


def read(path: Path, *, first: int = 0, **waveforms: Any) -> tuple[list[Chunk], dict[str, int]]:
    used = configuration(path, **waveforms)
    conditions = Conditions()
    chunks = list(read_chunks(used.waveforms.files[0], used.waveforms, used.columns, conditions, first=first))
    return chunks, conditions.counts()


def joined(chunks: list[Chunk]) -> Floats:
    return np.concatenate([chunk.values for chunk in chunks], axis=1)


def assert_close(found: Floats, expected: Floats, *, within: float) -> None:
    assert found.shape == expected.shape
    assert np.max(np.abs(found - expected)) <= within


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("first", [0, 1, 23_456])
def test_each_kind_is_read_in_pieces_from_any_sample_on(tmp_path: Path, name: str, first: int) -> None:
    WRITERS[name](tmp_path / name)
    chunks, counts = read(tmp_path / name, first=first)
    assert counts == {}
    assert_close(joined(chunks), VALUES[:, first:], within=1e-15)
    assert max(chunk.values.shape[1] for chunk in chunks) < 20_000
    places = [chunk.first for chunk in chunks]
    assert places == [first + 16_384 * k for k in range(len(chunks))]
    assert {(chunk.anchor, chunk.anchor_ns) for chunk in chunks} == {(0, START_NS)}
    # Six digits of time are what a universal file has.
    assert all(chunk.sampling_rate == pytest.approx(RATE, rel=1e-12) for chunk in chunks)


@pytest.mark.parametrize("kind", ["u1", "i2", "i4", "f4"])
def test_wav_of_other_types(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "a.wav"
    if kind == "u1":
        scipy.io.wavfile.write(path, int(RATE), np.rint(VALUES.T * 128.0 + 128.0).astype(np.uint8))
    else:
        write_wav(path, kind)
    chunks, _ = read(path, full_scale=10.0)
    step = {"u1": 10.0 / 128.0, "i2": 10.0 / 32768.0, "i4": 1e-8, "f4": 1e-6}[kind]
    assert_close(joined(chunks), 10.0 * VALUES, within=1.01 * step)


def test_wav_of_24_bits(tmp_path: Path) -> None:
    whole = np.rint(VALUES.T * 2.0**23).astype("<i4")
    with wave.open(str(tmp_path / "a.wav"), "wb") as file:
        file.setnchannels(3)
        file.setsampwidth(3)
        file.setframerate(int(RATE))
        file.writeframes(whole.reshape(-1, 1).view("u1")[:, :3].tobytes())
    chunks, counts = read(tmp_path / "a.wav")
    assert_close(joined(chunks), whole.T / 2.0**23, within=1e-15)
    assert counts == {}


# The reader of MDF4 cannot dispose of itself where a broken file has left it half made.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(
    ("name", "kept", "condition", "delivered"),
    [
        ("a.csv", 0.5, "truncated_file", (0.49, 0.51)),
        ("a.wav", 0.5, "truncated_file", (0.49, 0.51)),
        ("a.npz", 0.5, "damaged_file", (0.0, 0.0)),
        ("a.h5", 0.5, "truncated_file", (0.0, 0.0)),
        ("a.mat", 0.5, "damaged_file", (0.0, 0.0)),
        ("a.tdms", 0.6, "truncated_file", (0.5, 0.6)),
        ("a.uff", 0.9, "missing_column", (0.0, 0.0)),
        ("a.mf4", 0.5, "truncated_file", (0.0, 0.0)),
    ],
)
def test_a_file_cut_short_is_named_and_used_as_far_as_it_goes(
    tmp_path: Path, name: str, kept: float, condition: str, delivered: tuple[float, float]
) -> None:
    """NPZ and HDF5 keep their directory at the end or check their length: of them nothing is left, as of MAT and MDF4."""
    path = tmp_path / name
    WRITERS[name](path)
    content = path.read_bytes()
    path.write_bytes(content[: int(kept * len(content))])
    chunks, counts = read(path)
    gc.collect()
    count = sum(chunk.values.shape[1] for chunk in chunks)
    assert counts == {condition: 1}
    assert delivered[0] <= count / SAMPLES <= delivered[1]
    if count:
        assert_close(joined(chunks), VALUES[:, :count], within=1e-15)


@pytest.mark.parametrize("name", ["a.npz", "b.npz"])
def test_no_number_of_a_damaged_npz_is_used(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    content = bytearray(path.read_bytes())
    place = int(0.6 * len(content))
    content[place : place + 3] = b"???"
    path.write_bytes(content)
    assert read(path) == ([], {"damaged_file": 1})


@pytest.mark.parametrize("name", ["a.csv", "a.npz", "a.h5", "a.wav", "a.mat", "a.tdms", "a.uff", "a.mf4"])
def test_what_is_no_such_file_is_left_out(tmp_path: Path, name: str) -> None:
    assert read(tmp_path / name) == ([], {"unreadable_file": 1})
    (tmp_path / name).write_bytes(b"")
    kinds = ({"unreadable_file": 1}, {"missing_column": 1}, {"damaged_file": 1})
    assert read(tmp_path / name)[1] in kinds
    (tmp_path / name).write_bytes(b"\x00\xff nothing of the kind\n" * 50)
    assert read(tmp_path / name)[1] in kinds


@pytest.mark.parametrize("name", WRITERS)
def test_a_channel_that_is_not_there_is_named(tmp_path: Path, name: str) -> None:
    WRITERS[name](tmp_path / name)
    used = configuration(tmp_path / name)
    conditions = Conditions()
    assert list(read_chunks(used.waveforms.files[0], used.waveforms, ["K", "9"], conditions)) == []
    assert conditions.counts() == {"missing_column": 1}


@pytest.mark.parametrize("name", ["a.wav", "a.npz", "a.h5", "a.mat", "a.tdms", "a.uff", "a.mf4"])
def test_another_sampling_rate_than_configured_is_not_believed(tmp_path: Path, name: str) -> None:
    WRITERS[name](tmp_path / name)
    assert read(tmp_path / name, sampling_rate=2000.0) == ([], {"wrong_sampling_rate": 1})
    assert read(tmp_path / name, sampling_rate=None)[1] == {}


def test_somebody_must_say_when_it_began_and_how_fast_it_was_sampled(tmp_path: Path) -> None:
    write_csv(tmp_path / "a.csv")
    write_npz(tmp_path / "a.npz")
    bare = [{"path": str(tmp_path / "a.csv")}]
    assert read(tmp_path / "a.csv", files=bare) == ([], {"no_start_time": 1})
    assert read(tmp_path / "a.csv", sampling_rate=None) == ([], {"wrong_sampling_rate": 1})
    assert read(tmp_path / "a.npz", files=[{"path": str(tmp_path / "a.npz")}])[1] == {}


def write_timed(path: Path, seconds: Floats) -> None:
    rows = np.column_stack([seconds, VALUES[:, : seconds.size].T])
    np.savetxt(path, rows, delimiter=",", header="t,K,A,B", comments="", fmt="%.9f")


@pytest.mark.parametrize("said", [0.0, -RATE, math.nan, math.inf, "2048 Hz", [RATE, RATE]])
@pytest.mark.parametrize("name", ["a.npz", "a.h5"])
def test_what_is_no_sampling_rate_is_named(tmp_path: Path, name: str, said: Any) -> None:
    path = tmp_path / name
    if name == "a.npz":
        np.savez(path, **dict(zip(NAMES, VALUES, strict=True)), sampling_rate=said)
    else:
        write_hdf5(path)
        with h5py.File(path, "a") as file:
            file.attrs["sampling_rate"] = said
    assert read(path) == ([], {"unreadable_file": 1})


def test_an_array_of_objects_and_a_dataset_without_data_are_named(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", K=VALUES[0], A=VALUES[1], B=VALUES[2], start_ns=np.array(START_NS, dtype=object))
    assert read(tmp_path / "a.npz") == ([], {"unreadable_file": 1})
    write_hdf5(tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "a") as file:
        del file["B"]
        file["B"] = h5py.Empty("f8")
    assert read(tmp_path / "a.h5") == ([], {"missing_column": 1})


def test_a_file_without_samples_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("K,A,B\n")
    assert read(tmp_path / "a.csv") == ([], {"truncated_file": 1})


def test_a_wav_whose_writer_was_killed_is_used_as_far_as_it_goes(tmp_path: Path) -> None:
    """Its header still says that there are no samples."""
    path = tmp_path / "a.wav"
    write_wav(path)
    content = bytearray(path.read_bytes())
    size = content.index(b"data") + 4
    content[size : size + 4] = bytes(4)
    path.write_bytes(content)
    chunks, counts = read(path)
    assert counts == {"truncated_file": 1}
    assert_close(joined(chunks), VALUES, within=1e-15)


@pytest.mark.parametrize("wrong", ["1e12", "inf", "1e300", "7.5"])
def test_one_wrong_time_costs_its_row_and_not_those_behind_it(tmp_path: Path, wrong: str) -> None:
    times = [f"{row / RATE:.9f}" for row in range(SAMPLES)]
    times[5000] = wrong
    rows = [",".join([time, *map(str, row)]) for time, row in zip(times, VALUES.T.tolist(), strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["t,K,A,B", *rows, ""]))
    chunks, counts = read(tmp_path / "a.csv", time="t")
    assert counts == {"time_reversed": 1, "input_gap": 1}
    assert_close(joined(chunks), np.delete(VALUES, 5000, axis=1), within=1e-15)


def test_a_cell_beyond_all_bounds_or_a_quote_costs_its_row(tmp_path: Path) -> None:
    rows = [",".join(map(str, row)) for row in VALUES[:, :100].T.tolist()]
    rows[10], rows[20] = '"' + "1" * 200_000 + '",2,3', '"1,2,3'
    (tmp_path / "a.csv").write_text("\n".join(["K,A,B", *rows, ""]))
    ((chunk,), counts) = read(tmp_path / "a.csv")
    assert counts == {}
    assert np.flatnonzero(np.isnan(chunk.values).any(axis=0)).tolist() == [10, 20]


def test_a_column_of_time_gives_rate_and_holes(tmp_path: Path) -> None:
    seconds = 5.0 + np.arange(30_000) / RATE
    seconds[20_000:] += 3.0
    write_timed(tmp_path / "a.csv", seconds)
    chunks, counts = read(tmp_path / "a.csv", time="t", sampling_rate=None)
    assert counts == {"input_gap": 1}
    assert_close(joined(chunks), VALUES[:, :30_000], within=1e-9)
    assert [chunk.first for chunk in chunks if not chunk.follows] == [0, 20_000]
    assert {chunk.anchor_ns - START_NS for chunk in chunks} == {5_000_000_000, round(1e9 * round(seconds[20_000], 9))}
    assert chunks[0].sampling_rate == pytest.approx(RATE, rel=1e-5)
    assert read(tmp_path / "a.csv", time="t", sampling_rate=2000.0) == ([], {"wrong_sampling_rate": 1})


def test_time_that_runs_backwards_gives_nothing(tmp_path: Path) -> None:
    seconds = np.arange(30_000) / RATE
    write_timed(tmp_path / "a.csv", seconds[::-1])
    chunks, counts = read(tmp_path / "a.csv", time="t")
    assert counts == {"time_reversed": 1}
    assert sum(chunk.values.shape[1] for chunk in chunks) == 1  # the first row


def test_rows_that_step_back_are_left_out_and_the_rest_is_used(tmp_path: Path) -> None:
    seconds = np.arange(30_000) / RATE
    seconds[10_000:10_100] -= 2.0
    write_timed(tmp_path / "a.csv", seconds)
    chunks, counts = read(tmp_path / "a.csv", time="t")
    assert counts == {"time_reversed": 1, "input_gap": 1}
    assert_close(joined(chunks), np.delete(VALUES[:, :30_000], np.s_[10_000:10_100], axis=1), within=1e-9)


def test_cells_that_are_no_numbers_are_not_numbers(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("K,A,B\n1,2,3\n,x,6\n7,8\n10,11,12\n")
    chunks, counts = read(path)
    assert counts == {}
    values = joined(chunks)
    assert values[:, [0, 3]].T.tolist() == [[1, 2, 3], [10, 11, 12]]
    assert [math.isnan(value) for value in values[:, 1]] == [True, True, False]
    assert np.isnan(values[:, 2]).all()


# --- messages ---------------------------------------------------------------------------------------------------------


def message(**changes: Any) -> bytes:
    said: dict[str, Any] = {"channels": NAMES, "first": 7, "time_ns": START_NS, "sampling_rate": RATE, "kind": "<f8"}
    return encode_waveforms(VALUES[:, :100], **(said | changes))


@pytest.mark.parametrize(("kind", "step"), [("<f8", 0.0), ("<f4", 1e-7), ("<i2", 0.5 / 32000)])
def test_a_message_carries_waveforms(kind: str, step: float) -> None:
    got = decode_waveforms(message(kind=kind, unit=1.0 if kind != "<i2" else 1.0 / 32000))
    assert (got.first, got.time_ns, got.sampling_rate, got.channels) == (7, START_NS, RATE, NAMES)
    assert got.values == pytest.approx(VALUES[:, :100], abs=1.01 * step + 1e-15)


def test_the_layout_is_the_documented_one() -> None:
    one = message()
    assert one[:4] == b"RDWF"
    assert int.from_bytes(one[8:12], "little") == len(one) == 56 + 5 + 3 * 100 * 8
    assert one[56:61] == b"K\nA\nB"
    assert np.frombuffer(one, "<f8", 1, 61)[0] == VALUES[0, 0]


def test_any_flipped_bit_is_found() -> None:
    good = message()
    for place in range(0, len(good), 7):
        bad = good[:place] + bytes([good[place] ^ 4]) + good[place + 1 :]
        with pytest.raises(BadMessage):
            decode_waveforms(bad)
    for length in (0, 3, 55, len(good) - 1):
        with pytest.raises(BadMessage):
            decode_waveforms(good[:length])
    with pytest.raises(BadMessage, match="2 different names for 3"):
        decode_waveforms(message(channels=("K", "A", "A")))
    with pytest.raises(BadMessage, match="must be positive"):
        decode_waveforms(message(sampling_rate=0.0))


# --- configuration ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"block": {"seconds": 1, "turns": 10}}, "either seconds or turns"),
        ({"waveforms": {"sampling_rate": 100}}, "either files or a topic"),
        ({"waveforms": {"files": [{"path": "a.txt"}]}}, "none of the endings"),
        ({"waveforms": {"files": [{"path": "a.csv", "start": "2024-01-01T00:00:00"}]}}, "time zone"),
        ({"keyphasor": {"column": "K", "threshold": 1.0}}, "together or not at all"),
        ({"rails": [3.0, 1.0]}, "the lower one comes first"),
        ({"channels": [{"probe": "A", "column": "1"}] * 2}, "more than once"),
        ({"channels": [{"probe": "A", "column": "1", "sensitivity": 1}, {"probe": "B", "column": "2"}]}, "of every channel"),
        ({"speed_range": {"minimum_rpm": 9, "maximum_rpm": 3}}, "must be below"),
        ({"plant": "a b"}, "pattern"),
        ({"other": 1}, "Extra inputs"),
    ],
)
def test_a_wrong_configuration_says_what_is_wrong(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        EdgeConfiguration.model_validate(edge_document(**changes))


def test_a_channel_that_several_groups_have_is_named_by_its_group(tmp_path: Path) -> None:
    """Two channels of one name cannot be told apart; with the group before it each can."""
    path = tmp_path / "a.tdms"
    with TdmsWriter(path) as file:
        for group, part in (("left", VALUES[:2]), ("right", VALUES[1:])):
            pairs = zip(("K", "A"), part, strict=True)
            file.write_segment([ChannelObject(group, name, one, {"wf_increment": 1.0 / RATE}) for name, one in pairs])
    used, conditions = configuration(path), Conditions()
    assert list(read_chunks(used.waveforms.files[0], used.waveforms, ["left/K", "A"], conditions)) == []
    assert conditions.counts() == {"missing_column": 1}
    whole = list(read_chunks(used.waveforms.files[0], used.waveforms, ["left/K", "right/A"], Conditions()))
    assert_close(joined(whole), VALUES[[0, 2]], within=1e-15)


def test_a_column_is_mapped_once(tmp_path: Path) -> None:
    channels = [{"probe": "B2X", "column": "A", "sensitivity": 8000.0}, {"probe": "B2Y", "column": "A", "sensitivity": 8000.0}]
    said = {"files": [{"path": str(tmp_path / "a.mat")}]}
    with pytest.raises(ValidationError, match="column A is mapped twice"):
        EdgeConfiguration.model_validate(edge_document(waveforms=said, keyphasor={"column": "K"}, channels=channels))
    with pytest.raises(ValidationError, match="column A is mapped twice: the keyphasor and each probe"):
        EdgeConfiguration.model_validate(edge_document(waveforms=said, keyphasor={"column": "A"}, channels=channels[:1]))


def test_a_mat_file_of_the_newest_version_is_distinguished_from_a_broken_one(tmp_path: Path) -> None:
    write_hdf5(tmp_path / "a.h5")
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    (tmp_path / "a.mat").write_bytes(head.ljust(512, b"\x00") + (tmp_path / "a.h5").read_bytes())
    assert read(tmp_path / "a.mat") == ([], {"unreadable_file": 1})
