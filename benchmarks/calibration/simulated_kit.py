"""Simulated calibrations of the rotor kit: how often the intervals of later changes of its unbalance hold the truth."""

import numpy as np
from msgspec.structs import replace

from benchmarks.calibration.rotor_kit import DOCUMENT, HeldOut
from estimator.arrays import Complexes, Floats
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibrated_document import with_gain_drift
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.unbalance_since import unbalance_since
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.units import rpm_to_rad_per_s
from formats.files.document_files import read_machine

SPEEDS_RPM = (800.0, 1000.0, 1200.0)
RUNS, LATER = 16, 6
WEIGHT = 4e-5
"""Size of the trial weights [kg m]."""
MOUNTING_ECCENTRICITY, MOUNTING_RUN_OUT, NOISE = 3e-6, 2e-7, 1.5e-7
"""Rms differences between mountings, and rms error of a phasor [m]."""


class SimulatedKit:
    """A kit that differs from its document: modulus, bearings, chains, run-outs and its own unbalance."""

    def __init__(self, seed: int) -> None:
        self.machine: Machine = read_machine(DOCUMENT)
        self.rng = np.random.default_rng(seed)
        channels = len(self.machine.probes)
        self.gain = np.exp(0.3 * self.rng.standard_normal(channels) + 0.5j * self.rng.standard_normal(channels))
        self.run_out = 1e-6 * self._complex(channels)
        self.own = 3e-5 * self._complex(len(self.machine.discs))
        self.stiffer = np.exp(0.1 * self.rng.standard_normal(16))
        modulus = self.machine.materials["steel"].young_modulus * float(np.exp(0.05 * self.rng.standard_normal()))
        steel = self.machine.materials["steel"].model_copy(update={"young_modulus": modulus})
        self.true = self.machine.model_copy(update={"materials": {"steel": steel}})

    def _complex(self, count: int) -> Complexes:
        return np.asarray((self.rng.standard_normal(count) + 1j * self.rng.standard_normal(count)) / np.sqrt(2.0))

    def run(self, added: Complexes) -> Measurement:
        """Measure a new mounting at all speeds with a known unbalance (P,) [kg m]."""
        speed: Floats = np.array([rpm_to_rad_per_s(one) for one in SPEEDS_RPM])
        train = condense(self.true, speed=speed, direction=np.ones(speed.size))
        mass = np.array([disc.mass for disc in self.machine.discs])
        unbalance = self.own + added + MOUNTING_ECCENTRICITY * mass * self._complex(mass.size)
        coefficients = np.array([one.expected for one in train.unknowns.coefficients]) * self.stiffer
        phasor = response(train, coefficients=coefficients, excitations=unbalance) * self.gain
        phasor += self.run_out + MOUNTING_RUN_OUT * self._complex(self.gain.size)
        phasor += NOISE * self._complex(phasor.size).reshape(phasor.shape)
        return replace(Measurement.of(speed=speed, phasor=phasor), added=np.tile(added, (speed.size, 1)))

    def trial(self, number: int) -> Complexes:
        """Return the trial weights of a run (P,) [kg m]: none in the first, then one disc after the other."""
        added = np.zeros(len(self.machine.discs), dtype=complex)
        if number:
            added[number % added.size] = WEIGHT * np.exp(2j * np.pi * self.rng.random())
        return added


def calibrated_kit(seed: int, mountings: int = RUNS) -> tuple[SimulatedKit, Machine]:
    """Return a simulated kit and its document, calibrated from some mountings."""
    plant = SimulatedKit(seed)
    count = len(SPEEDS_RPM)
    runs = [
        CalibrationRun(f"run-{number}", plant.run(plant.trial(number)), (f"run-{number}",) * count, steady=True)
        for number in range(mountings)
    ]
    return plant, calibrate(plant.machine, runs).machine


def later_changes(seed: int, *, mountings: int = RUNS) -> HeldOut:
    """Estimate, with a simulated kit calibrated from some mountings, unbalances that it gains later."""
    plant, calibrated = calibrated_kit(seed, mountings)
    true, found, covariance = [], [], []
    for number in range(LATER):
        added = plant.trial(number)
        since = unbalance_since(calibrated, identify(calibrated, replace(plant.run(added), added=None)))
        if since is not None:
            true.append(added)
            found.append(since.value)
            covariance.append(since.covariance)
    return HeldOut(np.array(true), np.array(found), np.array(covariance))


def after_a_gain_changed(seed: int, factor: complex, gain_drift: float = 0.0) -> tuple[int, int, int]:
    """Estimate later unbalances of a calibrated kit while one channel's gain is not what it was, each in turn.

    gain_drift: what the calibration allows for [-]. Returns the number of fits, of accepted ones, and of intervals of these
    that hold; there are two to a disc.
    """
    plant, calibrated = calibrated_kit(seed)
    calibrated = with_gain_drift(calibrated, gain_drift)
    gain, accepted, held = plant.gain, 0, 0
    for channel in range(gain.size):
        plant.gain = np.where(np.arange(gain.size) == channel, factor, 1.0) * gain
        added = plant.trial(channel)
        found = identify(calibrated, replace(plant.run(added), added=None))
        since = unbalance_since(calibrated, found)
        if found.accepted and since is not None:
            accepted += 1
            error = np.stack([(since.value - added).real, (since.value - added).imag], axis=-1).ravel()
            held += int(np.count_nonzero(np.abs(error) <= CONFIDENCE_95 * np.sqrt(np.diag(since.covariance))))
    return gain.size, accepted, held
