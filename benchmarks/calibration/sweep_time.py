"""Time that the calibration of many sweeps takes on one core."""

import time

import numpy as np

from benchmarks.calibration.rotor_kit import ROOT
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors
from estimator.units import rpm_to_rad_per_s
from service.configuration.document_files import read_machine

RUNS, SPEEDS = 20, 150
SECONDS_ASKED = 10.0
GAIN_ERROR, RUN_OUT = 0.7, 3e-6
"""Rms of the logarithm of the channels' gains [-], whose phases are any, and rms parts of their run-outs [m]."""
MOUNTING_ECCENTRICITY = 1e-6
"""Rms parts of what the discs' eccentricity differs by from run to run [m]."""
WEIGHT_ECCENTRICITY = 1e-5
"""Trial weight over the disc's mass [m]."""


def seconds_of_sweeps() -> float:
    """Return the processor time of a calibration of the motor-pump train, which has eight channels [s]."""
    machine = read_machine(ROOT / "examples" / "motor-pump.yaml")
    rng = np.random.default_rng(0)
    truth = draw_truth(machine, rng)
    limits = machine.speed_range
    speed = np.linspace(rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm), SPEEDS)
    channels = len(machine.probes)
    gain = np.exp(GAIN_ERROR * rng.standard_normal(channels) + 1j * rng.uniform(-np.pi, np.pi, channels))
    run_out = RUN_OUT * (rng.standard_normal(channels) + 1j * rng.standard_normal(channels))
    mass = np.array([disc.mass for disc in machine.discs])
    runs = []
    for number in range(RUNS):
        added = np.zeros(len(machine.discs), dtype=complex)
        if number:
            disc = number % added.size
            added[disc] = machine.discs[disc].mass * WEIGHT_ECCENTRICITY * np.exp(2j * np.pi * rng.random())
        moved = MOUNTING_ECCENTRICITY * mass * (rng.standard_normal(mass.size) + 1j * rng.standard_normal(mass.size))
        loaded = Truth(truth.unknowns, truth.coefficients, truth.unbalances + added + moved, truth.factors)
        phasor = measured_phasors(machine, loaded, speed, rng) * gain + run_out
        measurement = Measurement.of(speed=speed, phasor=phasor).with_trial_weight(added)
        runs.append(CalibrationRun(f"run-{number}", measurement, (f"run-{number}",) * SPEEDS, steady=False))
    began = time.process_time()
    found = calibrate(machine, runs)
    if not found.accepted:
        raise RuntimeError(found.verdict)
    return time.process_time() - began
