"""Long trains: what a machine of 50, 120 and 300 shaft sections costs wherever its model is computed.

Each is a row of rotors of 2.6 m with some 33 sections, two wheels, two or three sleeve bearings with two probes each, and a
flexible coupling between neighbours; dimensions and coefficients are drawn. The 300 sections have 20 bearings, 40 probes and 8
couplings. The identification starts from a document that is off by up to 10 %. Processor time on one BLAS thread, with the
first use of everything in it; the last column is the bound at 300 sections.
"""

import argparse
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks.documents import Document
from estimator.bearings.terms import TERMS
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.checks.document_size import accepted_machine, document_size
from estimator.machine.document import Machine
from estimator.modes.campbell import campbell
from estimator.modes.nominal_critical_speeds import nominal_critical_speeds
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.derived_quantities import derived_quantities
from estimator.updated_model.model import updated_model

SECTIONS = (50, 120, 300)
SECTIONS_PER_SHAFT = 33
SHAFT_LENGTH, SHAFT_DIAMETER = 2.6, 0.14
SAMPLES = 500
NOISE = 0.01
OFF = 0.1
"""Part by which the coefficients of the document are off at most."""
CAMPBELL_POINTS = 40
NOMINAL_S, IDENTIFICATION_S, CAMPBELL_S = 0.5, 30.0, 5.0
"""Bounds at 300 sections, processor time [s]."""

T = TypeVar("T")


def large_train(sections: int, *, seed: int) -> Document:
    """Return the document of a train with so many shaft sections."""
    rng = np.random.default_rng(seed)
    shafts = max(1, round(sections / SECTIONS_PER_SHAFT))
    whole: Document = {
        "schema_version": 1,
        "id": f"train-{sections}",
        "plant": "benchmarks",
        "name": f"A train of {sections} sections",
        "speed_range": {"minimum_rpm": 300, "maximum_rpm": 3960},
        "materials": {"steel": {"young_modulus": 2.06e11, "density": 7850.0, "poisson_ratio": 0.3}},
        "noise": {"relative": NOISE, "floor": 0.0},
        "shafts": [],
        "discs": [],
        "bearings": [],
        "couplings": [],
        "probes": [],
    }
    for number in range(shafts):
        _add_rotor(whole, number, sections // shafts + (number < sections % shafts), rng, bearings=3 if number % 4 == 3 else 2)
    for number in range(1, shafts):
        whole["couplings"].append(
            {"id": f"C{number}", "driver": f"S{number}", "driven": f"S{number + 1}"}
            | {"kxx": 4.5e6, "kxy": 0.0, "kyx": 0.0, "kyy": 4.72e6, "k_phix": 55000.0, "k_phiy": 57800.0}
            | {"cxx": 800.0, "cxy": 0.0, "cyx": 0.0, "cyy": 840.0}
        )
    return whole


def _add_rotor(whole: Document, number: int, sections: int, rng: np.random.Generator, *, bearings: int) -> None:
    name = f"S{number + 1}"
    lengths = np.round(SHAFT_LENGTH * rng.dirichlet(np.full(sections, 5.0)), 5)
    belly = 1.0 + 0.15 * np.sin(np.pi * np.arange(sections) / sections)
    diameters = np.round(SHAFT_DIAMETER * belly * rng.uniform(0.95, 1.05, sections), 4)
    steps = [
        {"length": length, "outer_diameter": diameter, "material": "steel"}
        for length, diameter in zip(lengths.tolist(), diameters.tolist(), strict=True)
    ]
    whole["shafts"].append({"id": name, "sections": steps})
    end = math.fsum(lengths.tolist())
    for part in (0.35, 0.62):
        mass = round(float(rng.uniform(150.0, 300.0)), 1)
        whole["discs"].append(
            {"id": f"D{len(whole['discs']) + 1}", "shaft": name, "station": round(part * end, 4), "mass": mass}
            | {"diametral_inertia": round(0.03 * mass, 3), "polar_inertia": round(0.055 * mass, 3)}
            | {"unbalance": {"magnitude": round(1.2e-5 * mass, 6), "angle_deg": round(float(rng.uniform(0.0, 360.0)), 1)}}
        )
    for part in (0.08, 0.9, 0.5)[:bearings]:
        k, station = float(rng.uniform(2e7, 5e7)), round(part * end, 4)
        c = k * float(rng.uniform(1.2e-3, 1.8e-3))
        bearing = f"B{len(whole['bearings']) + 1}"
        whole["bearings"].append(
            {"id": bearing, "shaft": name, "station": station}
            | {"kxx": k, "kxy": 0.2 * k, "kyx": -0.28 * k, "kyy": 1.4 * k}
            | {"cxx": c, "cxy": -0.12 * c, "cyx": -0.12 * c, "cyy": 1.4 * c}
        )
        whole["probes"] += [
            {"id": f"{bearing}{side}", "shaft": name, "station": station, "angle_deg": angle}
            for side, angle in (("L", 135), ("R", 45))
        ]


def off(document: Document, *, seed: int) -> Document:
    """Return the document with every coefficient wrong and no nominal unbalance."""
    rng = np.random.default_rng(seed)

    def changed(part: Document) -> Document:
        wrong = {name: value * (1 + rng.uniform(-OFF, OFF)) for name, value in part.items() if name in TERMS}
        return part | wrong

    discs = [{name: value for name, value in disc.items() if name != "unbalance"} for disc in document["discs"]]
    parts = {kind: [changed(part) for part in document[kind]] for kind in ("bearings", "couplings")}
    return document | parts | {"discs": discs}


def measured(machine: Machine, *, samples: int, seed: int) -> Measurement:
    """Return a run over the speed range of a machine as its document has it, with noise."""
    limits = machine.speed_range
    speed = np.linspace(rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm), samples)
    train = condense(machine, speed=speed, direction=np.ones(samples))
    coefficients = np.array([one.nominal for one in train.unknowns.coefficients], dtype=float)
    excitations = np.array([one.nominal for one in train.unknowns.excitations], dtype=complex)
    clean = response(train, coefficients=coefficients, excitations=excitations)
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)
    return Measurement.of(speed=speed, phasor=clean + NOISE / math.sqrt(2) * np.abs(clean) * noise)


@dataclass(frozen=True)
class Costs:
    """Processor time [s] that one train takes. accepted: whether its identification was."""

    nominal: float
    identification: float
    campbell: float
    accepted: bool


def costs(sections: int, *, seed: int) -> Costs:
    """Return the costs of a train of so many sections."""
    document = large_train(sections, seed=seed)
    machine = accepted_machine(off(document, seed=seed))
    run = measured(accepted_machine(document), samples=SAMPLES, seed=seed)
    nominal, _ = timed(lambda: nominal_critical_speeds(machine))
    identification, found = timed(lambda: _identified(machine, run))
    model = updated_model(machine, found)
    highest = 1.25 * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    diagram, _ = timed(
        lambda: campbell(
            model.scaled_machine,
            speed=np.linspace(0.0, highest, CAMPBELL_POINTS),
            highest_frequency=2.0 * highest,
            coefficients=model.coefficients,
        )
    )
    return Costs(nominal, identification, diagram, found.accepted)


def _identified(machine: Machine, run: Measurement) -> Identification:
    found = identify(machine, run)
    derived_quantities(machine, found)
    return found


def timed(work: Callable[[], T]) -> tuple[float, T]:
    """Return the processor time [s] of some work, and its result."""
    began = time.process_time()
    found = work()
    return time.process_time() - began, found


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 when a bound is not kept, else 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1, help="trains of each size")
    seeds = parser.parse_args(arguments).seeds
    kept = True
    with threadpool_limits(limits=1):
        print(f"processor time [s], one BLAS thread, {SAMPLES} samples, medians over seeds 0 to {seeds - 1}")
        print(f"{'sections':<10}{'elements':>9}{'unknowns':>9}{'nominal':>10}{'identified':>12}{'Campbell':>10}   accepted")
        for sections in SECTIONS:
            size = document_size(accepted_machine(large_train(sections, seed=0)))
            found = [costs(sections, seed=seed) for seed in range(seeds)]
            middle = [
                float(np.median([getattr(one, name) for one in found])) for name in ("nominal", "identification", "campbell")
            ]
            accepted = sum(one.accepted for one in found)
            figures = f"{middle[0]:>10.2f}{middle[1]:>12.1f}{middle[2]:>10.2f}"
            print(f"{sections:<10}{size.elements:>9}{size.unknowns:>9}{figures}   {accepted} of {seeds}", flush=True)
            kept = kept and accepted == seeds
    bounds = (NOMINAL_S, IDENTIFICATION_S, CAMPBELL_S)
    within = all(one <= bound for one, bound in zip(middle, bounds, strict=True))
    print(f"{'bound':<28}{bounds[0]:>10.2f}{bounds[1]:>12.1f}{bounds[2]:>10.2f}   {'kept' if kept and within else 'NOT KEPT'}")
    return 0 if kept and within else 1


if __name__ == "__main__":
    sys.exit(main())
