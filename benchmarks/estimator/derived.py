"""Derived quantities: how often their 95 % intervals hold the truth, and what they cost beside the fit.

`python -m benchmarks.estimator.derived --runs 40`. Each run draws a machine near its example's document and a noisy run-down,
identifies it as the service does, and compares what is derived with what follows from the true parameters. The seeds
count from 0.
"""

import argparse
import time
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law
from estimator.updated_model.derived_quantities import Derived, derived_quantities, model_quantities, running_speed
from estimator.updated_model.model import UpdatedModel, expected_model
from formats.files.document_files import read_machine

EXAMPLES = Path(__file__).parents[2] / "examples"
MACHINES = ("thesis-chapter-3", "motor-pump", "turbine-compressor-generator")
SAMPLES = 200


def main(arguments: Sequence[str] | None = None) -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=20, help="identifications of each machine")
    runs = parser.parse_args(arguments).runs
    with threadpool_limits(limits=1):
        for name in MACHINES:
            print(report(read_machine(EXAMPLES / f"{name}.yaml"), runs))


def report(machine: Machine, runs: int) -> str:
    """Return coverage by kind of quantity, and the ratio of costs, of one machine."""
    inside: dict[str, list[bool]] = defaultdict(list)
    missing: dict[str, int] = defaultdict(int)
    ratios, accepted = [], 0
    for seed in range(runs):
        truth, found, fit_s = identified(machine, seed)
        began = time.process_time()
        quantities = derived_quantities(machine, found)
        ratios.append((time.process_time() - began) / fit_s)
        accepted += found.accepted
        true = {one.name: one for one in model_quantities(true_model(machine, truth), speed=running_speed(machine, found))}
        for one in quantities:
            expected = true.get(one.name)
            if one.value is None or expected is None or expected.value is None:
                missing[kind(one)] += 1
            else:
                inside[kind(one)].append((one.lower or 0.0) <= expected.value <= (one.upper or 0.0))
    lines = [
        f"{machine.id}: {runs} identifications, {accepted} accepted; inside the 95 % interval (95 % asked), not comparable"
    ]
    for name, hits in inside.items():
        lines.append(f"  {name:<24}{100 * np.mean(hits):6.1f} % of {len(hits):<6}{missing[name]:>6}")
    usual, first = float(np.median(ratios[1:] or ratios)), ratios[0]
    lines.append(f"  cost in parts of the fit: median {usual:.2f} (1 asked), {first:.2f} the first time in a process")
    return "\n".join(lines)


def identified(machine: Machine, seed: int) -> tuple[Truth, Identification, float]:
    """Return a drawn machine, its identification, and the time that took [s of processor]. E and density are as documented."""
    rng = np.random.default_rng(seed)
    drawn = draw_truth(machine, rng)
    truth = replace(drawn, factors=dict.fromkeys(drawn.factors, 1.0))
    _, speed = speed_law(machine, "run-down", duration=300.0, samples=SAMPLES)
    phasor = measured_phasors(machine, truth, speed, rng)
    measurement = Measurement.of(speed=speed, phasor=phasor, direction=machine.direction)
    began = time.process_time()
    return truth, identify(machine, measurement), time.process_time() - began


def true_model(machine: Machine, truth: Truth) -> UpdatedModel:
    """Return the model of the true parameters, exactly known."""
    none = np.zeros_like(expected_model(machine).covariance)
    return UpdatedModel.of(machine, coefficients=truth.coefficients, unbalances=truth.unbalances, covariance=none)


def kind(one: Derived) -> str:
    """Return the kind of a quantity, such as `amplification_factor`."""
    said = describe(one.name)
    return said.quantity or said.element_kind


if __name__ == "__main__":
    main()
