"""Calibration from Python: what runs must say, and that one that is not accepted writes nothing."""

from dataclasses import replace
from pathlib import Path

import pytest

import rotorundown as rd
from rotorundown.calibration import NotCalibrated
from tests.paths import DATA, EXAMPLES

KIT = EXAMPLES / "rk4-rotor-kit-four-probes.yaml"


@pytest.fixture(scope="module")
def calibrated() -> rd.CalibratedMachine:
    return rd.calibrate(rd.read_machine(KIT), [DATA / "rk4_unbalance_1x.csv"])


def test_the_measured_kit_is_calibrated_and_written(calibrated: rd.CalibratedMachine, tmp_path: Path) -> None:
    assert calibrated.accepted
    assert str(calibrated).startswith(calibrated.verdict)
    assert calibrated._repr_html_().startswith("<pre>")
    calibrated.write(tmp_path / "kit.yaml")
    assert rd.read_machine(tmp_path / "kit.yaml") == calibrated.machine


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
