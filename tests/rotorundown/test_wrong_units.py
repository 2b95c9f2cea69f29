"""Values in other units than those stated are named in one line that says what would be right."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.run_columns import WrongRun
from service.commands.app import app
from tests.rotorundown.wrong_input import PUMP, in_radians, one_line

UNITS: dict[str, tuple[Callable[[Any, Path], Any], dict[str, Any], str]] = {
    "degrees said to be radians": (
        lambda frame, _: frame.rename(columns=lambda name: name.replace("_lag_deg", "_phase")),
        {"phase_unit": "rad"},
        "degrees and not radians: say phase_unit='deg'",
    ),
    "mil in a column of micrometres": (
        lambda frame, _: frame,
        {"amplitude_unit": "mil"},
        "column 'B1L_um_pp' is in um, but amplitude_unit says mil: where that is right, name it B1L_amplitude",
    ),
    "0-to-peak in a column of peak-to-peak": (
        lambda frame, _: frame,
        {"amplitude_kind": "pk"},
        "column 'B1L_um_pp' is in peak-to-peak, but amplitude_kind says peak",
    ),
    "lead in a column of lag": (
        lambda frame, _: frame,
        {"phase_convention": "lead"},
        "column 'B1L_lag_deg' is in lag, but phase_convention says lead: where that is right, name it B1L_phase",
    ),
    "radians in a column of degrees": (
        lambda frame, _: frame,
        {"phase_unit": "rad"},
        "column 'B1L_lag_deg' is in deg, but phase_unit says rad",
    ),
    "hertz in a column of revolutions": (
        lambda frame, _: frame,
        {"speed_unit": "Hz"},
        "column 'speed_rpm' is in rpm, but speed_unit says Hz: where that is right, name it speed",
    ),
    "a unit that there is not": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "speed"}),
        {"speed_unit": "herz"},
        "speed_unit 'herz' is not one of rpm, rad/s, Hz; did you mean 'Hz'?",
    ),
    "a kind that there is not": (lambda frame, _: frame, {"amplitude_kind": "rms"}, "amplitude_kind 'rms' is not one of peak"),
    "no text for a unit": (lambda frame, _: frame, {"phase_unit": 360}, "phase_unit 360 is not one of deg, rad"),
    "revolutions a minute said to be radians": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "speed"}),
        {"speed_unit": "rad/s"},
        "most speeds lie far beyond the range of 'motor-pump' when read in rad/s: are these in rpm? Say so with speed_unit",
    ),
    "speeds of a shaft that turns the other way": (
        lambda frame, _: frame.assign(speed_rpm=-frame["speed_rpm"]),
        {},
        "all speeds are below zero: write them positive, the document says which way it turns (rotation: positive)",
    ),
    "decibels": (
        lambda frame, _: frame.assign(B1R_um_pp=20 * np.log10(frame["B1R_um_pp"] / 1e3)),
        {},
        "the amplitudes of B1R are below zero, such as -",
    ),
    "one component of vectors": (
        lambda frame, _: frame.assign(B2L_um_pp=frame["B2L_um_pp"] * np.cos(np.radians(frame["B2L_lag_deg"]))),
        {},
        "write amplitudes with phases, not decibels or one component of the vector",
    ),
    "metres": (
        lambda frame, _: frame.apply(lambda one: one * 1e-6 if one.name.endswith("_um_pp") else one),
        {},
        "less than any probe resolves: are these in m? Say so with amplitude_unit",
    ),
}


@pytest.mark.parametrize("name", UNITS)
def test_values_in_another_unit_are_told_theirs(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    make, options, words = UNITS[name]
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(make(run.to_frame(), tmp_path / "run.csv"), machine=pump, **options)
    one_line(raised)


def test_small_phases_of_a_single_channel_are_degrees_where_somebody_says_so(run: rd.MachineRun, pump: Machine) -> None:
    """A stiff place may turn by a few degrees only; four of them that do are rather in radians."""
    frame = in_radians(run.to_frame())
    one = frame[["speed_rpm", "B2L_um_pp", "B2L_lag_deg"]]
    with pytest.raises(WrongRun, match="looks like radians: say phase_unit='rad', or phase_unit='deg' where they are"):
        rd.read_run(one, machine=pump)
    (line,) = rd.read_run(one, machine=pump, phase_unit="deg").left_out
    assert line.endswith("which looks like radians: taken as degrees, as phase_unit says")
    with pytest.raises(WrongRun, match="which looks like radians: say phase_unit='rad'"):
        rd.read_run(frame, machine=pump, phase_unit="deg")


def test_one_channel_in_radians_among_others_in_degrees_is_named(run: rd.MachineRun, pump: Machine) -> None:
    frame = run.to_frame()
    assert rd.read_run(frame, machine=pump).left_out == ()
    (line,) = rd.read_run(frame.assign(B2L_lag_deg=np.radians(frame["B2L_lag_deg"])), machine=pump).left_out
    assert line.startswith("run, B2L: its phases lie within 4.89, those of others do not")
    assert line.endswith("are they in radians? Write degrees")


@pytest.mark.parametrize(
    ("said", "instead", "words"),
    [
        ("phase_unit: deg", "phase_unit: rad", "are degrees and not radians: its sidecar should say phase_unit: deg"),
        ("speed_unit: rpm", "speed_unit: herz", "speed_unit: 'herz' is not one of rpm, rad/s, Hz; did you mean 'Hz'?"),
        (
            "amplitude_unit: um",
            "amplitude_unit: µn",
            "amplitude_unit: 'µn' is not one of m, mm, um, mil, V; did you mean 'um'?",
        ),
    ],
)
def test_a_wrong_unit_of_a_sidecar_is_named_with_its_file(
    pump: Machine, tmp_path: Path, said: str, instead: str, words: str
) -> None:
    run = tmp_path / "run.csv"
    assert CliRunner().invoke(app, ["sample", str(PUMP), str(run)]).exit_code == 0
    sidecar = run.with_suffix(".yaml")
    sidecar.write_text(sidecar.read_text().replace(said, instead))
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(run, machine=pump)
    one_line(raised)
    told = CliRunner().invoke(app, ["identify", str(PUMP), str(run)])
    assert told.exit_code == 1
    (line,) = told.output.splitlines()
    assert words in line


def test_units_have_the_names_that_people_and_the_tool_give_them(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    frame = run.to_frame().rename(columns={"speed_rpm": "speed"})
    read = rd.read_run(
        frame,
        machine=pump,
        speed_unit="r/min",  # type: ignore[arg-type]  # as people write it
        amplitude_unit="µm",  # type: ignore[arg-type]
        amplitude_kind="pk-pk",  # type: ignore[arg-type]
        phase_convention="Lag",  # type: ignore[arg-type]
        phase_unit="°",  # type: ignore[arg-type]
    )
    np.testing.assert_allclose(read.recorded.phasor, run.recorded.phasor, rtol=1e-6, atol=2e-11)
    assert read.units == "as r/min, µm peak-to-peak, phase lag in degrees"
    file = tmp_path / "run.csv"
    assert CliRunner().invoke(app, ["sample", str(PUMP), str(file)]).exit_code == 0
    right = rd.read_run(file, machine=pump).recorded.phasor
    sidecar = file.with_suffix(".yaml")
    named = {"rpm\n": "r/min\n", "um\n": "μm\n", "peak-to-peak": "p-p", "deg\n": "°\n"}
    text = sidecar.read_text().replace("speed: speed_rpm\n", "speed: speed_rpm \n")
    for unit, name in named.items():
        assert unit in text
        text = text.replace(f": {unit}", f": {name}")
    sidecar.write_text(text, encoding="utf-8")
    np.testing.assert_array_equal(rd.read_run(file, machine=pump).recorded.phasor, right)


@pytest.mark.parametrize(
    ("column", "unit", "in_header", "words"),
    [
        (
            "B1L_um_pp",
            "mil pp",
            False,
            "is in mil by its header, but its sidecar says amplitude_unit: um: correct one of them",
        ),
        ("B1L_um_pp", "µm pk", True, "is in peak by its header, but its sidecar says amplitude_kind: peak-to-peak"),
        ("B1L_lag_deg", "rad", False, "is in rad by its header, but its sidecar says phase_unit: deg"),
        ("speed_rpm", "[Hz]", False, "is in Hz by its header, but its sidecar says speed_unit: rpm"),
        ("speed_rpm", "Hz", True, "column 'speed_rpm [Hz]' is in Hz by its header, but its sidecar says speed_unit: rpm"),
        ("speed_rpm", "r/min", True, ""),
        ("speed_rpm", "x", False, ""),
    ],
)
def test_units_of_a_table_that_contradict_its_sidecar_are_named(
    pump: Machine, tmp_path: Path, column: str, unit: str, in_header: bool, words: str
) -> None:
    file = tmp_path / "run.csv"
    assert CliRunner().invoke(app, ["sample", str(PUMP), str(file)]).exit_code == 0
    header, *rows = file.read_text().splitlines()
    if in_header:
        named = f"{column} [{unit}]"
        header = header.replace(column, named, 1)
        sidecar = file.with_suffix(".yaml")
        sidecar.write_text(sidecar.read_text().replace(f": {column}\n", f": '{named}'\n"), encoding="utf-8")
    else:
        rows = [",".join(unit if name == column else "" for name in header.split(",")), *rows]
        if column != header.split(",")[0]:
            rows[0] = "rpm" + rows[0]
    file.write_text("\n".join([header, *rows]), encoding="utf-8")
    if not words:
        assert rd.read_run(file, machine=pump).left_out == ()
        return
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(file, machine=pump)
    one_line(raised)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"speed_unit": "Hz"}, "speed_unit says Hz, but its sidecar rpm: leave speed_unit out"),
        ({"amplitude_unit": "mil"}, "amplitude_unit says mil, but its sidecar um: leave amplitude_unit out"),
        ({"phase_unit": "rad"}, "phase_unit says rad, but its sidecar deg: leave phase_unit out"),
    ],
)
def test_units_that_are_given_beside_a_sidecar_are_those_it_says(pump: Machine, given: dict[str, Any], words: str) -> None:
    recording = PUMP.parent / "recordings" / "motor-pump.csv"
    with pytest.raises(WrongRun, match=words) as raised:
        rd.read_run(recording, machine=pump, **given)
    one_line(raised)
    assert len(rd.read_run(recording, machine=pump, phase_unit="deg", speed_unit="rpm")) == 200
