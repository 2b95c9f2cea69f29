"""Recorded runs: a CSV file and its sidecar become one batch, and whatever is wrong with either is said with its place."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from formats.files.document_files import UnreadableFile
from formats.recordings.recorded_runs import read_measurement
from formats.recordings.recording import read_recording, split
from formats.recordings.sidecar import EXAMPLES, Sidecar, read_sidecar
from formats.recordings.written_recording import write_recording
from formats.wire import Key, decode_batch, encode_batch, to_samples
from tests.paths import DATA
from tests.plant import SECOND, START, batch, document, machine, sweep_rpm

HEADER = "seconds,rpm,size,phase,size_2,phase_2"
ROWS = ("0.0,2990,100,30,50,-20", "0.5,2980,101,31,51,-21", "1.25,2970,102,32,52,-22")


def sidecar(**changes: Any) -> dict[str, Any]:
    """Return what the columns of `HEADER` mean; a change to None takes a field away."""
    fields = {
        "plant": "plant-1",
        "machine": "pump-7",
        "start": "2023-11-14T22:13:20Z",
        "time": "seconds",
        "speed": "rpm",
        "speed_unit": "rpm",
        "channels": [
            {"channel": "B2X", "amplitude": "size", "phase": "phase"},
            {"channel": "B3Y", "amplitude": "size_2", "phase": "phase_2"},
        ],
        "amplitude_unit": "um",
        "amplitude_kind": "peak-to-peak",
        "phase_convention": "lag",
        "phase_unit": "deg",
    }
    return {name: value for name, value in (fields | changes).items() if value is not None}


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """A recording of three rows with its sidecar beside it."""
    write(tmp_path)
    return tmp_path / "run.csv"


def write(folder: Path, *, rows: tuple[str, ...] = ROWS, header: str = HEADER, **changes: Any) -> Path:
    (folder / "run.yaml").write_text(yaml.safe_dump(sidecar(**changes)), encoding="utf-8")
    (folder / "run.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return folder / "run.csv"


def refused(path: Path) -> str:
    with pytest.raises(UnreadableFile) as caught:
        read_recording(path)
    return str(caught.value)


def test_a_recording_is_a_batch(recording: Path) -> None:
    one = read_recording(recording)
    assert (one.plant, one.machine, one.source, one.epoch, one.sequence) == ("plant-1", "pump-7", "recording", 0, 0)
    assert one.channels == ["B2X", "B3Y"]
    assert one.time_ns == [START, START + SECOND // 2, START + SECOND + SECOND // 4]
    assert one.speed == [2990.0, 2980.0, 2970.0]
    assert one.amplitude == [[100.0, 50.0], [101.0, 51.0], [102.0, 52.0]]
    assert one.phase == [[30.0, -20.0], [31.0, -21.0], [32.0, -22.0]]
    assert decode_batch(Key("plant-1", "pump-7"), encode_batch(one), "") == one
    found, taken, faults = to_samples(one, machine(), received_at=START + 10 * SECOND)
    assert taken.all()
    assert faults == []
    assert np.abs(found.phasor[0, 0]) == pytest.approx(5e-5)


def test_rows_may_come_at_an_interval(tmp_path: Path) -> None:
    one = read_recording(write(tmp_path, time=None, interval_s=0.1, direction="negative", source="old-log"))
    assert one.time_ns == [START, START + SECOND // 10, START + SECOND // 5]
    assert (one.direction, one.source) == ("negative", "old-log")


def test_another_sidecar_may_be_given(recording: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(yaml.safe_dump(sidecar(machine="pump-8")))
    assert read_recording(recording, other).machine == "pump-8"


@pytest.mark.parametrize("start", ["2023-11-14T22:13:20", "2023-11-14T23:13:20+01:00"])
def test_a_start_without_a_zone_counts_as_utc(tmp_path: Path, start: str) -> None:
    assert read_recording(write(tmp_path, start=start)).time_ns[0] == START


def test_an_empty_value_may_be_written_as_nan(tmp_path: Path) -> None:
    one = read_recording(write(tmp_path, rows=(ROWS[0], "0.5,2980,nan,31,51,-21")))
    found, _, _ = to_samples(one, machine(), received_at=START + 10 * SECOND)
    assert found.usable[1].tolist() == [False, False, False, True]


def test_a_file_from_a_spreadsheet_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    path = write(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert len(read_recording(path).time_ns) == 3


def test_a_column_that_no_one_asks_for_may_hold_anything(tmp_path: Path) -> None:
    path = write(tmp_path, header=f"{HEADER},remark", rows=(f"{ROWS[0]},start", f"{ROWS[1]},"))
    assert read_recording(path).speed == [2990.0, 2980.0]


def test_a_measured_run_up_can_be_read(tmp_path: Path) -> None:
    changes = {
        "channels": [{"channel": "B3X", "amplitude": "amp_1x_V", "phase": "phase_1x_deg"}],
        "amplitude_unit": "V",
        "time": None,
        "interval_s": 1.0,
    }
    path = tmp_path / "run.yaml"
    path.write_text(yaml.safe_dump(sidecar(**changes)))
    one = read_recording(DATA / "rk4_runup_1x.csv", path)
    assert len(one.speed) == len(one.amplitude) > 100
    assert one.speed[0] == 1037.1
    assert one.amplitude[0] == [0.0658]


# --- what is wrong with the file ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ((), "no rows below a header line"),
        ((ROWS[0], "0.5,fast,101,31,51,-21"), "line 3: 'fast' in column 'rpm' is not a number"),
        ((ROWS[0], "0.5,,101,31,51,-21"), "line 3: column 'rpm' has no value"),
        ((ROWS[0], ROWS[1], "1.25,2970,102"), "line 4 is too short: it has no column 'size_2'"),
        (('0.0,"2990',), "run.csv"),
    ],
)
def test_a_row_that_cannot_be_read_is_said(tmp_path: Path, rows: tuple[str, ...], said: str) -> None:
    assert said in refused(write(tmp_path, rows=rows))


@pytest.mark.parametrize("seconds", ["nan", "inf", "-inf", "1e300"])
def test_a_time_that_is_none_is_said(tmp_path: Path, seconds: str) -> None:
    assert "seconds" in refused(write(tmp_path, rows=(ROWS[0], f"{seconds},2980,101,31,51,-21")))


def test_a_column_that_is_not_there_is_said_with_those_that_are(tmp_path: Path) -> None:
    said = refused(write(tmp_path, speed="speed"))
    assert "no column 'speed'; it has seconds, rpm, size, phase, size_2, phase_2" in said


def test_a_file_that_is_not_there_or_not_text_is_said(tmp_path: Path, recording: Path) -> None:
    recording.write_bytes(b"\xff\xfe\x00")
    assert "run.csv" in refused(recording)
    (tmp_path / "run.yaml").unlink()
    assert "needs a sidecar" in refused(recording)
    assert "run.yaml" in refused(recording)
    recording.unlink()
    assert "run.csv: no such file" in refused(recording)


# --- what is wrong with the sidecar ---------------------------------------------------------------------------------


@pytest.mark.parametrize("changes", [{"time": None}, {"interval_s": 1.0}])
def test_times_come_from_a_column_or_an_interval(tmp_path: Path, changes: dict[str, Any]) -> None:
    assert "either the column `time` or `interval_s`" in refused(write(tmp_path, **changes))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"speed": None}, "speed: "),
        ({"machine": "pump 7"}, "machine: "),
        ({"direction": "clockwise"}, "direction: "),
        ({"time": None, "interval_s": 0}, "interval_s: "),
        ({"time": None, "interval_s": float("inf")}, "interval_s: "),
        ({"start": "yesterday"}, "start: "),
        ({"channels": []}, "channels: "),
        ({"channels": [{"channel": "B2X", "amplitude": "size"}]}, "channels[0]: "),
        ({"colour": "red"}, "colour: "),
    ],
)
def test_wrong_fields_of_a_sidecar_are_named(tmp_path: Path, changes: dict[str, Any], field: str) -> None:
    said = refused(write(tmp_path, **changes))
    assert "run.yaml is not a recording's sidecar" in said
    assert f"sidecar: {field}" in said or f"\n  {field}" in said


def test_a_sidecar_that_is_no_yaml_or_no_mapping_is_said(recording: Path) -> None:
    for text in ("[", "a: b: c", "", "just text"):
        recording.with_suffix(".yaml").write_text(text)
        assert "run.yaml" in refused(recording)


def test_a_sidecar_knows_its_defaults(recording: Path) -> None:
    found = read_sidecar(recording.with_suffix(".yaml"))
    assert isinstance(found, Sidecar)
    assert (found.source, found.direction) == ("recording", "positive")


@pytest.mark.parametrize("field", EXAMPLES)
def test_a_field_that_a_sidecar_must_have_is_named_with_an_example(recording: Path, field: str) -> None:
    described = sidecar()
    del described[field]
    recording.with_suffix(".yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
    assert f"{field}: it is missing; one is `{field}: " in refused(recording)
    Sidecar.model_validate(described | {field: yaml.safe_load(EXAMPLES[field])})


def test_columns_may_be_operating_conditions(tmp_path: Path) -> None:
    rows = [f"{row},{value}" for row, value in zip(ROWS, ("61.5", "", "61.0"), strict=True)]
    path = write(tmp_path, rows=tuple(rows), header=f"{HEADER},warm", conditions={"oil": "warm"})
    one = read_recording(path)
    assert one.conditions == {"oil": [61.5, None, 61.0]}
    found, _, _ = to_samples(one, machine(conditions=[{"name": "oil", "unit": "degC"}]), received_at=START + 10 * SECOND)
    assert found.conditions[::2].tolist() == [[61.5], [61.0]]
    (tmp_path / "run.yaml").write_text(yaml.safe_dump(sidecar(conditions={"oil": "cold"})), encoding="utf-8")
    assert "has no column 'cold'" in refused(path)


def test_columns_may_be_gaps(tmp_path: Path) -> None:
    rows = [f"{row},{value}" for row, value in zip(ROWS, ("-9.5", "", "-9.6"), strict=True)]
    channels = [{**sidecar()["channels"][0]}, {**sidecar()["channels"][1], "gap": "dc"}]
    path = write(tmp_path, rows=tuple(rows), header=f"{HEADER},dc", channels=channels, gap_unit="V")
    one = read_recording(path)
    assert one.gap == [[None, -9.5], [None, None], [None, -9.6]]
    probes = [{**probe, "gap_grows": "towards"} for probe in document()["probes"]]
    found, _, faults = to_samples(one, machine(probes=probes), received_at=START + 10 * SECOND)
    assert faults == []
    assert found.gap[:, 3] == pytest.approx([-9.5 / 4000.0, np.nan, -9.6 / 4000.0], nan_ok=True, abs=1e-10)
    for wrong in ({"channels": channels}, {"gap_unit": "V"}):
        assert "come together" in refused(write(tmp_path, **wrong))


def test_a_gap_that_no_probe_sees_is_named_with_its_row_of_which_the_vibration_stays(tmp_path: Path) -> None:
    """1200 µm, said to be mm."""
    rows = [f"{row},{value}" for row, value in zip(ROWS, ("1.2", "1200", "1.2"), strict=True)]
    channels = [{**sidecar()["channels"][0]}, {**sidecar()["channels"][1], "gap": "dc"}]
    path = write(tmp_path, rows=tuple(rows), header=f"{HEADER},dc", channels=channels, gap_unit="mm")
    pump = machine(probes=[{**probe, "gap_grows": "towards"} for probe in document()["probes"]])
    measurement, left_out = read_measurement(pump, [path])
    assert measurement.speed.size == 3
    (said,) = left_out
    assert said.startswith(f"{path}, row 2 left out in part: channel B3Y: a gap of 1200 mm is 1.2 m, at most 0.02 m")


def test_columns_may_be_overall_levels(tmp_path: Path) -> None:
    rows = [f"{row},{value}" for row, value in zip(ROWS, ("120", "", "130"), strict=True)]
    channels = [{**sidecar()["channels"][0]}, {**sidecar()["channels"][1], "overall": "direct"}]
    path = write(tmp_path, rows=tuple(rows), header=f"{HEADER},direct", channels=channels)
    assert read_recording(path).overall == [[None, 120.0], [None, None], [None, 130.0]]
    channels[1]["overall"] = channels[1]["amplitude"]
    assert "mapped twice" in refused(write(tmp_path, channels=channels))


def test_a_written_recording_with_gaps_is_read_again(tmp_path: Path) -> None:
    probes = [{**probe, "gap_grows": "away"} for probe in document()["probes"]]
    pump = machine(probes=probes)
    speed, phasor = np.array([1000.0, 990.0]), np.full((2, 4), 5e-6 + 1e-6j)
    gap = np.array([[1000.0, 1100.0, np.nan, 1200.0], [1001.0, 1102.0, np.nan, 1203.0]])
    path = tmp_path / "run.csv"
    write_recording(path, pump, speed_rpm=speed, phasor=phasor, interval_s=1.0, gap_um=gap)
    found, taken, faults = to_samples(read_recording(path), pump, received_at=START + 10 * SECOND)
    assert taken.all()
    assert faults == []
    assert found.gap == pytest.approx(-1e-6 * gap, abs=1e-10, nan_ok=True)
    assert found.phasor == pytest.approx(phasor, rel=1e-5)


# --- pieces ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1, 3, 10, 100])
def test_pieces_are_the_whole(size: int) -> None:
    tables: dict[str, Any] = {
        name: [[float(i)] * 4 for i in range(10)] for name in ("scatter", "amplitude_2x", "phase_2x", "gap", "overall")
    }
    whole = batch(
        sweep_rpm(2990.0, 2900.0, 10),
        sequence=5,
        status=[["good"] * 4] * 10,
        conditions={"oil": list(map(float, range(10)))},
        gap_unit="um",
        **tables,
    )
    pieces = list(split(whole, size))
    assert [len(piece.time_ns) for piece in pieces] == [min(size, 10 - first) for first in range(0, 10, size)]
    assert [piece.sequence for piece in pieces] == [5 + first for first in range(0, 10, size)]
    for name in ("time_ns", "speed", "amplitude", "phase", "status", *tables):
        assert [value for piece in pieces for value in getattr(piece, name)] == getattr(whole, name)
    assert [value for piece in pieces for value in (piece.conditions or {})["oil"]] == list(range(10))
    assert {piece.source for piece in pieces} == {"monitor"}


def test_a_recording_does_not_take_the_place_of_a_machine_document(tmp_path: Path) -> None:
    document = tmp_path / "pump.yaml"
    document.write_text("id: pump\nname: Pump\n", encoding="utf-8")
    pump = machine()
    speed, phasor = np.array([900.0, 800.0]), np.full((2, len(pump.channels)), 1e-5 + 0j)
    with pytest.raises(UnreadableFile, match=r"pump\.yaml is no sidecar of a recording.*give the CSV another name"):
        write_recording(tmp_path / "pump.csv", pump, speed_rpm=speed, phasor=phasor, interval_s=1.0)
    assert document.read_text(encoding="utf-8").startswith("id: pump")
    assert not (tmp_path / "pump.csv").exists()
    with pytest.raises(UnreadableFile, match="a recording is a CSV file"):
        write_recording(tmp_path / "run.yaml", pump, speed_rpm=speed, phasor=phasor, interval_s=1.0)
    for _ in range(2):  # its own sidecar may be written again
        write_recording(tmp_path / "run.csv", pump, speed_rpm=speed, phasor=phasor, interval_s=1.0)
