"""Calibrations whose coefficients are hardly known, so that the fit goes along a flat and curved valley, come to an end."""

from dataclasses import replace

import numpy as np

from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import draw_truth, measured_phasors
from estimator.units import rpm_to_rad_per_s
from tests.plant import document

GAIN, RUN_OUT = 1.3 * np.exp(0.4j), 2e-6 - 1e-6j
WEIGHT = 1e-3
"""Trial weight [kg m]."""
POINTS = 60


def runs_of(machine: Machine, seed: int) -> list[CalibrationRun]:
    """Return a run without weight and one with a weight on each disc, of probes that read too much and see a run-out."""
    rng = np.random.default_rng(seed)
    truth = draw_truth(machine, rng)
    speed = np.linspace(rpm_to_rad_per_s(2900.0), rpm_to_rad_per_s(400.0), POINTS)
    found = []
    for number, unit in enumerate(np.vstack([np.zeros(len(machine.discs)), np.eye(len(machine.discs))])):
        added = WEIGHT * unit * 1j ** (number - 1)
        loaded = replace(truth, unbalances=truth.unbalances + added)
        phasor = GAIN * measured_phasors(machine, loaded, speed, rng) + RUN_OUT
        usable, scatter = np.ones(phasor.shape, dtype=bool), np.full(phasor.shape, np.nan)
        measurement = Measurement(speed, np.ones(POINTS), phasor, usable, scatter, np.tile(added, (POINTS, 1)))
        found.append(CalibrationRun(f"run-{number}", measurement, (f"run-{number}",) * POINTS, steady=False))
    return found


def test_a_calibration_in_a_flat_and_curved_valley_converges() -> None:
    machine = parse_machine(document(operation={}))
    found = calibrate(machine, runs_of(machine, 9))
    assert found.accepted, found.verdict
    assert found.machine.calibration is not None
    place = found.machine.calibration.parameters.index("probe.B3X.gain.real")
    error = found.machine.calibration.covariance[place][place] ** 0.5
    assert abs(found.machine.calibration.values[place] - (GAIN.real - 1.0)) < 4.0 * error
