"""Runs from tables and files: what is read, in which units, and what is said of wrong ones."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest

import rotorundown as rd
from estimator.arrays import Floats
from estimator.machine.document import Machine
from formats.recordings.written_recording import write_recording
from rotorundown.run_columns import WrongRun


def table(run: rd.MachineRun) -> dict[str, Floats]:
    """Return a run as a table of columns in the default units."""
    columns = {"speed": run.speed_rpm}
    for number, channel in enumerate(run.channels):
        columns[f"{channel}_amplitude"] = run.amplitude_um_pp[:, number]
        columns[f"{channel}_phase"] = run.phase_lag_deg[:, number]
    return columns


def same(one: rd.MachineRun, other: rd.MachineRun) -> None:
    """Assert that two runs hold the same samples."""
    np.testing.assert_allclose(one.recorded.phasor, other.recorded.phasor, rtol=1e-6, atol=2e-11)
    np.testing.assert_allclose(one.recorded.speed, other.recorded.speed, rtol=1e-6)


def test_a_mapping_and_a_data_frame_hold_the_same_run(pump: Machine, run: rd.MachineRun) -> None:
    same(rd.read_run(table(run), machine=pump), run)
    same(rd.read_run(pandas.DataFrame(table(run)), machine=pump), run)
    again = rd.read_run(run.to_frame(), machine=pump)
    same(again, run)
    np.testing.assert_allclose(again.to_frame()["time_s"], run.to_frame()["time_s"], atol=1e-6)
    assert again.interval_s == pytest.approx(run.interval_s)


def test_gaps_of_a_data_frame_are_the_shafts_places(pump: Machine, run: rd.MachineRun) -> None:
    probes = tuple(one.model_copy(update={"gap_grows": "away"}) for one in pump.probes)
    machine = pump.model_copy(update={"probes": probes})
    first, second = run.channels[:2]
    gap = np.linspace(400.0, 430.0, len(run))
    frame = pandas.DataFrame(table(run) | {f"{first}_GAP_UM": gap, f"{second}_gap": gap})
    read = rd.read_run(frame, machine=machine)
    assert read.measurement.gaps is not None
    np.testing.assert_allclose(read.measurement.gaps.place[:, 0], -1e-6 * gap)
    assert not np.isfinite(read.measurement.gaps.place[:, 1:]).any()
    assert read.left_out == (f"run, column '{second}_gap' left out: give gaps in µm, in a column '{second}_gap_um'",)
    again = rd.read_run(read.to_frame(), machine=machine)
    assert list(read.to_frame().columns).count(f"{first}_gap_um") == 1
    assert f"{second}_gap_um" not in read.to_frame()
    assert again.measurement.gaps is not None
    np.testing.assert_array_equal(again.measurement.gaps.place, read.measurement.gaps.place)
    small = rd.read_run(table(run) | {f"{first.lower()}_gap_um": gap}, machine=machine)
    assert small.left_out == ()
    assert small.measurement.gaps is not None
    np.testing.assert_allclose(small.measurement.gaps.place[:, 0], -1e-6 * gap)
    undescribed = rd.read_run(frame, machine=pump)
    assert undescribed.measurement.gaps is None
    assert any("gaps need the document's `gap_grows`" in one for one in undescribed.left_out)
    elsewhere = rd.read_run(table(run) | {"P99_gap_um": gap}, machine=machine)
    assert any("'P99' is no channel" in one for one in elsewhere.left_out)


def test_units_are_converted(pump: Machine, run: rd.MachineRun) -> None:
    columns = table(run)
    columns["speed"] = columns["speed"] / 60
    for channel in run.channels:
        columns[f"{channel}_amplitude"] = columns[f"{channel}_amplitude"] / 25.4 / 2
        columns[f"{channel}_phase"] = np.radians(-columns[f"{channel}_phase"])
    read = rd.read_run(
        columns,
        machine=pump,
        speed_unit="Hz",
        amplitude_unit="mil",
        amplitude_kind="peak",
        phase_convention="lead",
        phase_unit="rad",
    )
    same(read, run)


def test_a_file_with_a_sidecar_and_one_without_hold_the_same_run(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    with_sidecar = tmp_path / "run.csv"
    write_recording(with_sidecar, pump, speed_rpm=run.speed_rpm, phasor=run.recorded.phasor, interval_s=run.interval_s)
    without = tmp_path / "plain.csv"
    run.to_frame().to_csv(without, index=False)
    np.testing.assert_allclose(
        rd.read_run(with_sidecar, machine=pump).recorded.phasor, run.recorded.phasor, rtol=1e-5, atol=1e-11
    )
    same(rd.read_run(str(without), machine=pump), run)


def test_a_table_without_times_has_none(pump: Machine, run: rd.MachineRun) -> None:
    assert rd.read_run(table(run), machine=pump).recorded.time is None
    timed = {**table(run), "time": np.arange(len(run)) * 3.0}
    assert rd.read_run(timed, machine=pump).interval_s == pytest.approx(3.0)


def test_a_run_says_in_which_units_it_was_read(pump: Machine, run: rd.MachineRun) -> None:
    assert "read as r/min, µm peak-to-peak, phase lag in degrees" in str(rd.read_run(table(run), machine=pump))


def without(name: str, columns: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in columns.items() if key != name}


WRONG: dict[str, tuple[Callable[[dict[str, Any]], dict[str, Any]], dict[str, Any], str]] = {
    "wrong columns": (
        lambda c: {**without("speed", c), "sped": c["speed"]},
        {},
        "no column holds the speed.*; does 'sped' hold it",
    ),
    "no channel": (lambda c: {"speed": c["speed"]}, {}, "no column holds an amplitude of a channel of 'motor-pump'"),
    "no phase": (lambda c: without("B2L_phase", c), {}, r"no column holds the phase of B2L: .*B3R_phase and 4 more$"),
    "a phase under another name": (
        lambda c: {**without("B2L_phase", c), "B2L_deg": c["B2L_phase"]},
        {},
        "no column holds the phase of B2L: name it B2L_phase or B2L_lag_deg; .*; does 'B2L_deg' hold it",
    ),
    "degrees given for radians": (lambda c: c, {"phase_unit": "rad"}, "say phase_unit='deg'"),
    "radians given for degrees": (
        lambda c: {name: np.radians(one) if name.endswith("_phase") else one for name, one in c.items()},
        {},
        "say phase_unit='rad'",
    ),
    "a speed in Hz": (lambda c: {**c, "speed": c["speed"] / 60}, {}, "in rad/s or Hz.*speed_unit|in Hz.*speed_unit"),
    "a name that contradicts": (
        lambda c: {**without("speed", c), "speed_rpm": c["speed"]},
        {"speed_unit": "Hz"},
        "'speed_rpm' is in rpm, but speed_unit says Hz",
    ),
    "no rows": (lambda c: {name: one[:0] for name, one in c.items()}, {}, "no samples"),
    "columns of different length": (
        lambda c: {**c, "speed": c["speed"][1:]},
        {},
        r"columns differ in length: speed has \d+; the others have \d+$",
    ),
    "decimal commas": (lambda c: {**c, "speed": ["1500,5"] * len(c["speed"])}, {}, "decimal point"),
    "words": (lambda c: {**c, "speed": ["fast"] * len(c["speed"])}, {}, "row 1: 'fast' is not a number"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_table_is_named_with_what_would_be_right(pump: Machine, run: rd.MachineRun, name: str) -> None:
    change, units, words = WRONG[name]
    with pytest.raises(WrongRun, match=words) as raised:
        rd.read_run(change(table(run)), machine=pump, **units)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty: the first line names the columns"),
        ("speed,B1L_amplitude,B1L_phase\n", "no rows"),
        ("speed,B1L_amplitude,B1L_phase\n1500,5,1,2\n", "decimal comma"),
    ],
)
def test_a_wrong_file_is_named_with_what_would_be_right(pump: Machine, tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "run.csv"
    file.write_text(text)
    with pytest.raises(WrongRun, match=words):
        rd.read_run(file, machine=pump)


@pytest.mark.parametrize(("separator", "decimal"), [(";", ","), (";", "."), ("\t", ",")])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_table_as_spreadsheets_elsewhere_write_it_is_read(
    pump: Machine, run: rd.MachineRun, tmp_path: Path, separator: str, decimal: str, encoding: str
) -> None:
    file = tmp_path / "run.csv"
    run.to_frame().to_csv(file, index=False, sep=separator, decimal=decimal, encoding=encoding)
    same(rd.read_run(file, machine=pump), run)


def test_a_structured_array_is_read(pump: Machine, run: rd.MachineRun) -> None:
    same(rd.read_run(run.to_frame().to_records(index=False), machine=pump), run)


def test_a_frame_of_a_single_column_says_how_it_is_read(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    run.to_frame().to_csv(file, index=False, sep=";")
    with pytest.raises(WrongRun, match="a single column, whose cells ';' separates: read it with sep=';'"):
        rd.read_run(pandas.read_csv(file), machine=pump)


def test_what_is_no_table_is_named(pump: Machine) -> None:
    with pytest.raises(WrongRun, match="not int"):
        rd.read_run(5, machine=pump)


def test_a_wrong_machine_is_named() -> None:
    with pytest.raises(ValueError, match="not a machine document"):
        rd.read_machine({"id": "pump"})
    with pytest.raises(ValueError, match="No such file"):
        rd.read_machine("nowhere.yaml")


def test_a_simulated_run_may_have_trial_weights_on(pump: Machine) -> None:
    alone = rd.simulate(pump, samples=20)
    weighted = rd.simulate(pump, samples=20, weights={"core-1": (3000.0, 90.0)})
    added = weighted.measurement.added
    assert alone.measurement.added is None
    assert added is not None
    assert np.allclose(added, [[3e-3j, 0, 0, 0]] * 20)
    assert weighted.truth == alone.truth  # a weight is no fault of the machine's
    assert np.abs(weighted.recorded.phasor - alone.recorded.phasor).max() > 1e-6
