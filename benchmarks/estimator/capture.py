"""A long run thinned for the fit: samples picked against samples averaged, and what more of them would bring.

`python -m benchmarks.estimator.capture [--samples N] [--seeds N]`: the coast-down of the thesis's Chapter 3 train, as dense
as a monitor that sends many samples a second would tell it.
"""

import argparse
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from estimator.arrays import Floats
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.machine.parameter_description import is_direct
from estimator.phasors.measurement import Measurement
from estimator.runs.sample_selection import thinned
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law
from formats.files.document_files import read_machine

EXAMPLE = Path(__file__).parents[2] / "examples" / "thesis-chapter-3.yaml"
COUNTS = (150, 300, 600, 1000, 2000)


@dataclass(frozen=True)
class JudgedFit:
    """One fit: seconds, whether accepted, χ² over its degrees of freedom, errors of direct terms, and those in 1 σ."""

    seconds: float
    accepted: bool
    reduced: float
    errors: list[float]
    sizes: list[float]


def picked(run: Measurement, times: Floats, count: int) -> Measurement:
    """Return some samples unchanged."""
    which = np.zeros(run.speed.size, dtype=bool)
    which[thinned(time=(1e9 * times).astype(np.int64), speed=run.speed, count=count)] = True
    return run.pick(which)


def averaged(machine: Machine, run: Measurement, count: int) -> Measurement:
    """Return means over bands of speed of equal width; the error of a mean is the document's over the root of the number."""
    edges = np.linspace(run.speed.min(), run.speed.max(), count + 1)
    band = np.clip(np.searchsorted(edges, run.speed, side="right") - 1, 0, count - 1)
    inside = [np.flatnonzero(band == i) for i in range(count)]
    inside = [which for which in inside if which.size]
    speed = np.array([run.speed[which].mean() for which in inside])
    phasor = np.array([run.phasor[which].mean(axis=0) for which in inside])
    number = np.array([which.size for which in inside])[:, None]
    noise = machine.noise
    scatter = np.sqrt(((noise.relative * np.abs(phasor)) ** 2 + noise.floor**2) / number)
    return Measurement(speed, np.ones(speed.size), phasor, np.ones(phasor.shape, dtype=bool), scatter)


def outcome(machine: Machine, truth: Truth, run: Measurement) -> JudgedFit:
    """Identify a run; return time, verdict and errors of the direct terms."""
    began = time.perf_counter()
    result = identify(machine, run)
    seconds = time.perf_counter() - began
    true = dict(zip([c.name for c in truth.unknowns.coefficients], truth.coefficients.tolist(), strict=True))
    errors, sizes = [], []
    for one in result.estimates:
        if one.value is not None and one.standard_error is not None and one.name in true and is_direct(one.name):
            error = math.log(one.value / true[one.name])
            errors.append(abs(error))
            sizes.append(error / (one.standard_error / one.value))
    return JudgedFit(seconds, result.accepted, result.chi_square / result.degrees_of_freedom, errors, sizes)


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=12_000)
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args(given)
    machine = read_machine(EXAMPLE)
    print(f"{machine.id}: a run-down of {arguments.samples} samples, seeds 0 to {arguments.seeds - 1}; medians\n")
    print("samples for the fit    seconds  accepted  chi2/dof  error of direct terms  rms error/SE")
    table: dict[str, list[JudgedFit]] = {}
    for seed in range(arguments.seeds):
        rng = np.random.default_rng(seed)
        truth = draw_truth(machine, rng)
        times, speed = speed_law(machine, "run-down", duration=300.0, samples=arguments.samples)
        run = Measurement.of(speed=speed, phasor=measured_phasors(machine, truth, speed, rng))
        for count in COUNTS:
            table.setdefault(f"{count} picked", []).append(outcome(machine, truth, picked(run, times, count)))
            table.setdefault(f"{count} averaged", []).append(outcome(machine, truth, averaged(machine, run, count)))
    for name, outcomes in table.items():
        errors = 100 * float(np.median([error for one in outcomes for error in one.errors]))
        sizes = math.sqrt(float(np.mean(np.square([size for one in outcomes for size in one.sizes]))))
        print(
            f"{name:<22} {np.median([one.seconds for one in outcomes]):7.1f}  "
            f"{sum(one.accepted for one in outcomes)} of {len(outcomes)}    "
            f"{np.median([one.reduced for one in outcomes]):8.2f}  {errors:19.2f} %  {sizes:12.2f}"
        )


if __name__ == "__main__":
    main()
