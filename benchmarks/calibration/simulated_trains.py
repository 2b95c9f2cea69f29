"""Simulated calibrations of the example trains from sweeps: intervals of later changes of their unbalance.

Trial weights are those that somebody beside the machine would choose: three tenths of the unbalance that the document states
for the disc, which changes its vibration by about as much, or where that is more (or none is stated) a force of a tenth of the
disc's weight at service speed. Later changes are of that size, too.

`python -m benchmarks.calibration.simulated_trains [--count 6] [--train NAME …] [--keep FILE]` prints them alone, of all
examples; with a file it goes on where it was stopped.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
import threadpoolctl
from msgspec import structs

from benchmarks.calibration.rotor_kit import ROOT, HeldOut
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import KEEPING, KeptOutcomes, kept_or_computed
from estimator.arrays import Complexes, Floats
from estimator.calibration.calibrate import Calibrated, calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.unbalance_since import unbalance_since
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import draw_truth, measured_phasors
from estimator.units import GRAVITY, rpm_to_rad_per_s
from formats.files.document_files import read_machine

TRAINS = {"motor-pump": 40, "thesis-chapter-3": 12, "motor-compressor": 20, "turbine-on-tilting-pads": 6}
"""Examples, and how many trains like each are simulated."""
EVERY = (*TRAINS, "sealed-pump", "thesis-chapter-5-rig")
"""All examples with bearings whose coefficients or films a sweep determines."""
ASKED = (0.93, 0.97)
FEWEST = 20
"""Trains from which on coverage is judged."""
GAIN_ERROR, RUN_OUT = 0.7, 3e-6
"""Rms of the logarithm of the channels' gains [-], whose phases are any, and rms parts of their run-outs [m]."""
MOUNTING_ECCENTRICITY = 1e-6
"""Rms parts of what the discs' eccentricity differs by from run to run, at most [m]."""
MOUNTING_PART = 0.1
"""Most of the discs' own eccentricity, as the document states it, that these parts are [-]: fast trains repeat better."""
WEIGHT_PART, WEIGHT_FORCE = 0.3, 0.1
"""Trial weight over the disc's unbalance as the document states it, its force at service speed over the disc's weight [-]."""
RUNS, SPEEDS, LATER = 8, 60, 3


@cache
def _document(name: str) -> Machine:
    return read_machine(ROOT / "examples" / f"{name}.yaml")


class MountedTrain:
    """A train near its document, whose probes read anything; its runs are sweeps, after each of which it is mounted anew."""

    def __init__(self, name: str, seed: int) -> None:
        self.machine = _document(name)
        self.rng = np.random.default_rng(seed)
        self.truth = draw_truth(self.machine, self.rng)
        channels = len(self.machine.probes)
        self.gain = np.exp(GAIN_ERROR * self.rng.standard_normal(channels) + 1j * self.rng.uniform(-np.pi, np.pi, channels))
        self.run_out = RUN_OUT * self._complex(channels)
        self.mass: Floats = np.array([disc.mass for disc in self.machine.discs])
        self.trial_weight = _trial_weights(self.machine)
        own = [disc.unbalance.magnitude / disc.mass for disc in self.machine.discs if disc.unbalance]
        self.mounting_eccentricity = min([MOUNTING_ECCENTRICITY, *([MOUNTING_PART * float(np.mean(own))] if own else [])])

    def _complex(self, count: int) -> Complexes:
        return np.asarray(self.rng.standard_normal(count) + 1j * self.rng.standard_normal(count))

    def weight(self, number: int) -> Complexes:
        """Return the trial weights of a run (P,) [kg m]: none in the first, then one disc after the other."""
        added = np.zeros(self.mass.size, dtype=complex)
        if number:
            disc = number % added.size
            added[disc] = self.trial_weight[disc] * np.exp(2j * np.pi * self.rng.random())
        return added

    def sweep(self, added: Complexes, speeds: int) -> Measurement:
        """Measure a new mounting over the speed range with a known unbalance (P,) [kg m]."""
        limits = self.machine.speed_range
        speed = np.linspace(rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm), speeds)
        moved = self.mounting_eccentricity * self.mass * self._complex(self.mass.size)
        loaded = replace(self.truth, unbalances=self.truth.unbalances + added + moved)
        phasor = measured_phasors(self.machine, loaded, speed, self.rng) * self.gain + self.run_out
        return Measurement.of(speed=speed, phasor=phasor).with_trial_weight(added)

    def runs(self, count: int, speeds: int) -> list[CalibrationRun]:
        """Return the runs of a calibration."""
        measured = [self.sweep(self.weight(number), speeds) for number in range(count)]
        return [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * speeds, steady=False) for k, one in enumerate(measured)]


def _trial_weights(machine: Machine) -> Floats:
    """Return the trial weight of each disc (P,) [kg m]."""
    service = rpm_to_rad_per_s(machine.operation.running_rpm or machine.speed_range.maximum_rpm)
    usual = [WEIGHT_FORCE * disc.mass * GRAVITY / service**2 for disc in machine.discs]
    own = [disc.unbalance.magnitude if disc.unbalance else 0.0 for disc in machine.discs]
    return np.maximum(usual, WEIGHT_PART * np.array(own))


def calibrated_train(name: str, seed: int) -> tuple[MountedTrain, Calibrated]:
    """Return a simulated train and its calibration."""
    plant = MountedTrain(name, seed)
    return plant, calibrate(plant.machine, plant.runs(RUNS, SPEEDS))


def later_changes_of_train(name: str, seed: int) -> HeldOut | None:
    """Estimate, with a train calibrated, unbalances that it gains later; None where its calibration is refused."""
    plant, found = calibrated_train(name, seed)
    if not found.accepted:
        return None
    true, changes, covariance = [], [], []
    for number in range(1, LATER + 1):
        added = plant.weight(number)
        later = structs.replace(plant.sweep(added, SPEEDS), added=None)
        since = unbalance_since(found.machine, identify(found.machine, later))
        if since is not None:
            true.append(added)
            changes.append(since.value)
            covariance.append(since.covariance)
    return HeldOut(np.array(true), np.array(changes), np.array(covariance))


def train_lines(names: Sequence[str], count: int) -> Iterator[ReportLine]:
    """Yield how many intervals hold for some trains like each example."""
    for name in names:
        told = [
            kept_or_computed(f"trains, {name}, {seed}", tuple[int, int], partial(_outcome, name, seed))
            for seed in range(count)
        ]
        found = [one for one in told if one[1]]
        held, total = sum(one[0] for one in found), sum(one[1] for one in found)
        part = held / total if total else 0.0
        words = f"simulated {name}, {count} trains, {count - len(found)} refused: intervals hold"
        kept_up = len(found) < FEWEST or ASKED[0] <= part <= ASKED[1]
        yield ReportLine(words, "93-97 %", f"{part:.1%} of {total}" if total else "none accepted", kept_up)


def _outcome(name: str, seed: int) -> tuple[int, int]:
    """Return how many intervals of a train hold, and of how many; none where its calibration is refused."""
    found = later_changes_of_train(name, seed)
    if found is None:
        return 0, 0
    total = 2 * found.true.size
    return round(found.covered * total), total


def main() -> None:
    """Print a line for each example; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.calibration.simulated_trains", description="Simulated trains")
    parser.add_argument("--count", type=int, default=6, help="of trains like each example")
    parser.add_argument("--train", action="append", choices=EVERY, help="an example; by default all")
    parser.add_argument("--keep", type=Path, help="file that keeps outcomes, from which a run of this code goes on")
    asked = parser.parse_args()
    if asked.keep is not None:
        KEEPING.set(KeptOutcomes(asked.keep, benchmark="benchmarks.calibration.simulated_trains"))
    with threadpoolctl.threadpool_limits(1):
        lines = []
        for line in train_lines(asked.train or EVERY, asked.count):
            print(line, flush=True)
            lines.append(line)
    sys.exit(0 if all(line.kept for line in lines) else 1)


if __name__ == "__main__":
    main()
