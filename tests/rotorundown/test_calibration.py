"""Calibration from Python: what runs must say, and that one that is not accepted writes nothing."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

import rotorundown as rd
from rotorundown.calibration import NotCalibrated
from tests.paths import EXAMPLES

KIT = EXAMPLES / "rk4-rotor-kit-four-probes.yaml"


@pytest.fixture(scope="module")
def calibrated() -> rd.CalibratedMachine:
    return rd.calibrate(rd.read_machine(KIT), [EXAMPLES / "recordings" / "rk4_unbalance_1x.csv"])


def without_stated_weights(folder: Path, condition: str) -> rd.MachineRun:
    """The kit's records of one condition, whose weights nobody states."""
    header, *rows = (EXAMPLES / "recordings" / "rk4_unbalance_1x.csv").read_text().splitlines()
    file = folder / "later.csv"
    file.write_text("\n".join([header, *(row for row in rows if row.startswith(f"{condition},"))]))
    said = yaml.safe_load((EXAMPLES / "recordings" / "rk4_unbalance_1x.yaml").read_text())
    del said["added_unbalance"]
    file.with_suffix(".yaml").write_text(yaml.safe_dump(said))
    return rd.read_run(file, machine=rd.read_machine(KIT))


def test_the_measured_kit_is_calibrated_and_written(calibrated: rd.CalibratedMachine, tmp_path: Path) -> None:
    assert calibrated.accepted
    assert str(calibrated).startswith(calibrated.verdict)
    assert calibrated._repr_html_().startswith("<pre>")
    calibrated.write(tmp_path / "kit.yaml")
    calibrated.write(tmp_path / "kit.yaml")
    (tmp_path / "own.yaml").write_text("id: kit  # mine\n")
    with pytest.raises(NotCalibrated, match=r"own\.yaml is there already"):
        calibrated.write(tmp_path / "own.yaml")
    assert rd.read_machine(tmp_path / "kit.yaml") == calibrated.machine


def test_where_it_cannot_be_written_is_told_in_a_line(calibrated: rd.CalibratedMachine, tmp_path: Path) -> None:
    wrong: dict[Any, str] = {
        tmp_path / "none/kit.yaml": f"cannot be written: there is no folder {tmp_path / 'none'}, make it first",
        tmp_path: "cannot be written: Is a directory",
        7: "file is a int: give the path of the document to write",
    }
    for file, words in wrong.items():
        with pytest.raises(NotCalibrated, match=re.escape(words)) as raised:
            calibrated.write(file)
        assert "\n" not in str(raised.value)


def test_what_was_calibrated_is_a_table(calibrated: rd.CalibratedMachine) -> None:
    frame, calibration = calibrated.to_frame(), calibrated.machine.calibration
    assert calibration is not None
    assert len(frame) == len({one.removesuffix(".real").removesuffix(".imaginary") for one in calibration.parameters})
    gain = frame.loc["probe.P2X.gain"]
    assert abs(complex(gain["value"], gain["imaginary"])) == pytest.approx(0.539, abs=0.001), "as the text says"
    assert gain["lower"] < 0.539 < gain["upper"]
    stiffness, row = frame.loc["bearing.B1.kxx"], calibration.parameters.index("bearing.B1.kxx")
    assert math.log(stiffness["value"]) == pytest.approx(calibration.values[row])
    assert stiffness["standard_error"] == pytest.approx(stiffness["value"] * calibration.covariance[row][row] ** 0.5)
    assert list(frame.loc[["bearing.B1.kxx", "disc.D1.unbalance", "probe.P1X.run_out"], "unit"]) == ["N/m", "kg m", "m"]
    assert list(frame["quantity"].unique()) == ["stiffness", "damping", "unbalance", "scale factor", "gain", "run-out"]


def test_the_model_of_a_calibrated_machine_moves_as_the_kit_did(calibrated: rd.CalibratedMachine) -> None:
    # With 3 g mm beside its own 30 the second probe showed 0.365 mil peak at 1004 r/min, by a chain that shows 0.540 of it.
    predicted = rd.model(calibrated.machine).response([1004.0])
    assert predicted.amplitude_um_pp[0, 2] == pytest.approx(2 * 0.365 * 25.4 / 0.540, rel=0.15)
    assert 0.01 < predicted.lower_um_pp[0, 2] / predicted.upper_um_pp[0, 2] < 0.99


def test_what_a_later_run_has_gained_is_reported_for_a_calibrated_machine_only(
    calibrated: rd.CalibratedMachine, tmp_path: Path
) -> None:
    pump = rd.read_machine(EXAMPLES / "motor-pump.yaml")
    assert rd.identify(pump, rd.simulate(pump)).unbalance_gained is None
    gained = rd.identify(calibrated.machine, without_stated_weights(tmp_path, "A005")).unbalance_gained
    assert gained is not None
    assert abs(gained.value[0] - 30e-6) < 2.5 * gained.standard_error(0), "30 g mm were on disc 1, at 0°"
    assert 5e-6 < gained.standard_error(0) * 1.96 < 20e-6


def test_gains_that_may_have_drifted_widen_what_a_later_run_has_gained(
    calibrated: rd.CalibratedMachine, tmp_path: Path
) -> None:
    file = EXAMPLES / "recordings" / "rk4_unbalance_1x.csv"
    drifting = rd.calibrate(rd.read_machine(KIT), [file], gain_drift=0.05)
    drifting.write(tmp_path / "kit.yaml")
    machine, later = rd.read_machine(tmp_path / "kit.yaml"), without_stated_weights(tmp_path, "A005")
    assert machine.calibration is not None
    assert machine.calibration.gain_drift == 0.05
    wide, narrow = (rd.identify(one, later).unbalance_gained for one in (machine, calibrated.machine))
    assert wide is not None
    assert narrow is not None
    assert wide.standard_error(0) > 1.1 * narrow.standard_error(0)
    with pytest.raises(NotCalibrated, match=r"gain_drift is 5: it lies between 0 and 0\.5, such as 0\.02 for 2 %"):
        rd.calibrate(rd.read_machine(KIT), ["said before anything is read.csv"], gain_drift=5.0)


def test_one_that_is_not_accepted_is_not_written(calibrated: rd.CalibratedMachine, tmp_path: Path) -> None:
    refused = replace(calibrated, found=replace(calibrated.found, accepted=False))
    assert str(refused).startswith("NOT ACCEPTED, not to be used")
    with pytest.raises(NotCalibrated, match="nothing is written"):
        refused.write(tmp_path / "kit.yaml")
    assert not (tmp_path / "kit.yaml").exists()


def test_runs_without_stated_weights_are_refused(tmp_path: Path) -> None:
    pump = rd.read_machine(EXAMPLES / "motor-pump.yaml")
    with pytest.raises(NotCalibrated, match="no such file"):
        rd.calibrate(pump, [tmp_path / "missing.csv"])
    with pytest.raises(NotCalibrated, match="a calibration needs runs"):
        rd.calibrate(pump, [])
