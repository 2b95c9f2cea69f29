"""Diagnosis of a calibrated machine: a coupling that goes out of alignment is told, and healthy runs fit the calibration."""

import re

import numpy as np
import pytest
from msgspec.structs import replace

import rotorundown as rd
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.unbalance_since import unbalance_since
from estimator.machine.document import Machine
from tests.paths import EXAMPLES

HEALTHY, MISALIGNED = 5, 3
FAR = 4.0
"""Standard errors that no parameter of a healthy run is away from its calibration: coefficients vary from run to run [-]."""
CHANGED = "bearings or couplings have changed since the calibration"


@pytest.fixture(scope="module")
def machine() -> Machine:
    return rd.read_machine(EXAMPLES / "motor-pump.yaml")


@pytest.fixture(scope="module")
def calibrated(machine: Machine) -> Machine:
    """The motor-pump, calibrated by a run without weights and one with a weight on each disc."""
    weights = [{}, *({disc.id: (2000.0 if number < 2 else 600.0, 90.0 * number)} for number, disc in enumerate(machine.discs))]
    runs = []
    for number, on in enumerate(weights):
        measured = rd.simulate(machine, seed=3, run_seed=100 + number, weights=on).measurement
        added = np.zeros((measured.speed.size, len(machine.discs)), complex) if measured.added is None else measured.added
        runs.append(
            CalibrationRun(f"run {number}", replace(measured, added=added), (f"{number}",) * measured.speed.size, steady=False)
        )
    found = calibrate(machine, runs)
    assert found.accepted, found.verdict
    return found.machine


@pytest.fixture(scope="module")
def healthy(machine: Machine, calibrated: Machine) -> list[rd.Result]:
    return [rd.identify(calibrated, rd.simulate(machine, seed=3, run_seed=number)) for number in range(1, HEALTHY + 1)]


@pytest.fixture(scope="module")
def misaligned(machine: Machine, calibrated: Machine) -> list[rd.Result]:
    runs = [rd.simulate(machine, scenario="misalignment", seed=3, run_seed=number) for number in range(20, 20 + MISALIGNED)]
    return [rd.identify(calibrated, run) for run in runs]


def test_healthy_runs_fit_the_calibration(healthy: list[rd.Result]) -> None:
    assert all(one.accepted and CHANGED not in one.verdict for one in healthy), [one.verdict for one in healthy]
    away = [float(one) for result in healthy for one in re.findall(r"furthest from it, by ([\d.]+)", result.verdict)]
    assert max(away, default=0.0) < FAR, away


@pytest.mark.long
def test_a_coupling_that_goes_out_of_alignment_is_told(healthy: list[rd.Result], misaligned: list[rd.Result]) -> None:
    assert all(one.accepted and CHANGED in one.verdict for one in misaligned), [one.verdict for one in misaligned]
    found = rd.diagnose(healthy, misaligned, runs_that_agree=MISALIGNED)
    print(found)
    assert [(one.kind, one.element) for one in found.causes] == [("misalignment", "coupling.C1")]


@pytest.mark.long
def test_unbalances_are_not_told_as_gained_where_a_coupling_has_changed(
    calibrated: Machine, misaligned: list[rd.Result]
) -> None:
    for one in misaligned:
        gained = unbalance_since(calibrated, one.identification)
        assert gained is not None
        parts = np.stack([gained.value.real, gained.value.imag], axis=1).reshape(-1)
        away = np.abs(parts) / np.sqrt(np.diag(gained.covariance))
        assert np.all(away < 3.0), away
