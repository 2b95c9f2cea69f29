"""Identification from coast-downs that are integrated in time, with and without the quality gate.

The train of Chapter 3 of the thesis with all damping coefficients halved, which gives the modes that a run-down from 5900
crosses damping ratios of 1 to 10 % (printed). It coasts down at a constant rate, slow, medium and fast; nothing is in a
steady state. The waveforms at its bearings, 1 kHz, go through keyphasor and order tracking in blocks of half a second; each
run adds 1 % of circular complex noise to the phasors and starts from a document whose coefficients are wrong by 10 % and
whose unbalances by 20 %, rms. Then the motor-pump of the examples, whose modulus and density are unknowns too: a model that is
free to take in some of what the sweep adds.

    python -m benchmarks.estimator.coast_down [--runs N]
"""

import argparse
import copy
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import yaml
from threadpoolctl import threadpool_limits

from benchmarks.documents import Document
from benchmarks.estimator.trains import EXAMPLES
from estimator.arrays import Complexes, Floats
from estimator.bearings.terms import TERMS
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.identification.quality_gate import GatedIdentification, identify_gated
from estimator.identification.sweep_correction import predicted_transient
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import describe
from estimator.modes.eigenmodes import modes
from estimator.phasors.beating import find_beats
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import Measurement
from estimator.phasors.quality import assess
from estimator.phasors.recorded_run import RecordedRun
from estimator.phasors.speed_law import SpeedLaw
from estimator.rotor.system_matrices import system_matrices
from estimator.runs.segmentation import RunKind
from estimator.signal.keyphasor import shaft_angle
from estimator.signal.order_tracking import track_orders
from estimator.simulation.coast_down import coast_down
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.model import updated_model

RUNS = 20
DAMPING = 0.5
"""Factor on the thesis's damping coefficients."""
FROM_RPM, TO_RPM = 5900.0, 400.0
RATES_RPM_PER_S = (2.0, 20.0, 80.0)
OTHER, OTHER_FROM_RPM, OTHER_RATE = "motor-pump", 3550.0, 40.0
SAMPLING_HZ = 1000.0
BLOCK_S = 0.5
SAMPLES = 300
"""Phasors that a run keeps, evenly over its time: as many as there are blocks at most."""
STEP_S = 0.002
"""Time step of the integration at 20 r/min per s; it scales with the root of the rate."""
TIMED_SAMPLES = 150
NOISE = 0.01
COEFFICIENT_SPREAD, UNBALANCE_SPREAD = 0.1, 0.2
STARTS = 3
"""Starts at most: a fit that ringing spoils is refused sooner."""

STEADY = ("thesis-chapter-3", "motor-pump", "turbine-compressor-generator", "sealed-pump", "thesis-chapter-5-rig")
"""Examples that beats are looked for in, in vain."""


@dataclass(frozen=True)
class Swept:
    """Phasors (S, m) [m] of one coast-down without noise, at instants (S,) [s] and speeds (S,) [rad/s]."""

    time: Floats
    speed: Floats
    phasor: Complexes


@dataclass(frozen=True)
class Score:
    """Quality of one identification: median relative error of estimates, true values that intervals hold, acceptance."""

    error: float
    held: int
    intervals: int
    accepted: bool


def true_document(example: str = "thesis-chapter-3", damping: float = DAMPING) -> Document:
    """Return an example with its damping scaled."""
    document: Document = yaml.safe_load((EXAMPLES / f"{example}.yaml").read_text(encoding="utf-8"))
    for part in (*document["bearings"], *document["couplings"]):
        for name in ("cxx", "cxy", "cyx", "cyy"):
            if name in part:
                part[name] *= damping
    return document | {"noise": {"relative": NOISE, "floor": 0.0}}


def nominal_document(true: Document, rng: np.random.Generator) -> Document:
    """Return the document with wrong nominal values that the fit starts from."""
    document = copy.deepcopy(true)
    for part in (*document["bearings"], *document["couplings"]):
        for name in part:
            if name in TERMS and isinstance(part[name], float | int):
                part[name] *= math.exp(COEFFICIENT_SPREAD * rng.standard_normal())
    for disc in document["discs"]:
        disc["unbalance"]["magnitude"] *= math.exp(UNBALANCE_SPREAD * rng.standard_normal())
    return document


def swept(machine: Machine, rate_rpm_per_s: float, from_rpm: float = FROM_RPM) -> Swept:
    """Return a coast-down through the whole chain: integrated, sampled, keyphasor, order tracking."""
    duration = (from_rpm - TO_RPM) / rate_rpm_per_s
    law = SpeedLaw.through(np.array([0.0, duration]), np.array([rpm_to_rad_per_s(from_rpm), rpm_to_rad_per_s(TO_RPM)]))
    moved = coast_down(machine, law, step=STEP_S * math.sqrt(20.0 / rate_rpm_per_s))
    instants = np.arange(0.0, duration, 1.0 / SAMPLING_HZ)
    turned = law.angle(np.linspace(0.0, duration, int(duration * 1e4)))
    edges = np.interp(np.arange(0.0, turned[-1], 2.0 * np.pi), turned, np.linspace(0.0, duration, turned.size))
    tracked = track_orders(
        moved.waveforms(instants), sampling_rate=SAMPLING_HZ, angle=shaft_angle(edges), seconds=BLOCK_S
    ).blocks
    every = max(1, len(tracked) // SAMPLES)
    blocks = tracked[::every]
    return Swept(
        np.array([one.time for one in blocks]),
        np.array([one.speed for one in blocks]),
        np.array([one.phasors[:, 0] for one in blocks]),
    )


def recorded(machine: Machine, run: Swept, rng: np.random.Generator) -> tuple[RecordedRun, Measurement]:
    """Return the run with its noise."""
    noise = rng.standard_normal(run.phasor.shape) + 1j * rng.standard_normal(run.phasor.shape)
    phasor = run.phasor + NOISE / math.sqrt(2) * np.abs(run.phasor) * noise
    status = np.full(phasor.shape, ChannelStatus.GOOD, np.uint8)
    measurement = Measurement.of(speed=run.speed, phasor=phasor)
    return RecordedRun(run.time, run.speed, phasor, status, measurement.scatter, machine.channels), measurement


def score(found: Identification, true: Document) -> Score:
    """Return the estimates compared with the truth."""
    errors: list[float] = []
    held: list[bool] = []
    for one in found.estimates:
        if one.value is None or one.lower is None or one.upper is None:
            continue
        described = describe(one.name)
        kind, element, name = described.element_kind, described.element_id, described.quantity
        if kind == "material":
            continue
        part = next(part for part in true[f"{kind}s"] if part["id"] == element)
        if kind == "disc" and one.imaginary is not None and one.imaginary_standard_error and one.standard_error:
            value = part["unbalance"]["magnitude"] * np.exp(1j * math.radians(part["unbalance"]["angle_deg"]))
            errors.append(abs(complex(one.value, one.imaginary) - value) / abs(value))
            held.append(abs(one.value - value.real) <= 1.96 * one.standard_error)
            held.append(abs(one.imaginary - value.imag) <= 1.96 * one.imaginary_standard_error)
        else:
            value = part.get(name, 0.0)
            if value:
                errors.append(abs(one.value / value - 1.0))
            held.append(one.lower <= value <= one.upper)
    return Score(float(np.median(errors)), sum(held), len(held), found.accepted)


def compared(true: Document, rate: float, runs: int, from_rpm: float = FROM_RPM) -> None:
    """Print one rate's figures."""
    run = swept(parse_machine(true), rate, from_rpm)
    rows: dict[str, list[Score]] = {"no gate": [], "gate": []}
    left, lost = [], 0
    for seed in range(runs):
        rng = np.random.default_rng([seed, round(rate)])
        machine = parse_machine(nominal_document(true, rng))
        noisy, measurement = recorded(machine, run, rng)
        options = Options(starts=STARTS)
        rows["no gate"].append(score(identify(machine, measurement, options), true))
        gated: GatedIdentification = identify_gated(machine, [noisy], [measurement], options=options)
        left.append(float(np.mean(gated.qualities[0].usable)))
        if gated.identification is None:
            lost += 1
        else:
            rows["gate"].append(score(gated.identification, true))
    print(f"\n{true['id']}, {rate:g} r/min per s, {run.time.size} samples of {run.phasor.shape[1]} channels, {runs} runs:")
    for name, scores in rows.items():
        covered = 100.0 * sum(one.held for one in scores) / max(1, sum(one.intervals for one in scores))
        asked = "  (asked: 90 or more)" if name == "gate" else ""
        print(
            f"  {name:<8} median error {100 * float(np.median([one.error for one in scores])):6.2f} %"
            f"   accepted {sum(one.accepted for one in scores):3d} of {len(scores)}"
            f"   95 % intervals hold the truth {covered:5.1f} %{asked}"
        )
    print(f"  points left by the gate: median {100 * float(np.median(left)):.0f} %; too few for a fit in {lost} runs")


def false_alarms(runs: int) -> None:
    """Print how often a steady-state run is said to beat."""
    print(f"\nchannels of steady-state runs that are said to beat, {runs} runs of each machine, a third of them 5 % noisier:")
    for name in STEADY:
        machine = parse_machine(yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8")))
        found, channels = 0, 0
        for seed in range(runs):
            rng = np.random.default_rng(seed)
            kind: RunKind = "run-up" if seed % 2 else "run-down"
            _, speed = speed_law(machine, kind, duration=600.0, samples=int(rng.choice([60, 150, 300])))
            phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
            if seed % 3 == 2:
                phasor = phasor * (1 + 0.05 * (rng.standard_normal(phasor.shape) + 1j * rng.standard_normal(phasor.shape)))
            beats = find_beats(speed, phasor, np.isfinite(phasor))
            found, channels = found + sum(one is not None for one in beats), channels + len(beats)
        print(f"  {name:<32}{found:4d} of {channels}")


def timed(true: Document, rate: float) -> None:
    """Print what quality costs beside a fit: some 150 samples, 8 channels."""
    machine = parse_machine(nominal_document(true, np.random.default_rng(0)))
    run = swept(parse_machine(true), rate)
    every = max(1, run.time.size // TIMED_SAMPLES)
    some = slice(0, every * TIMED_SAMPLES, every)
    run = Swept(run.time[some], run.speed[some], run.phasor[some])
    noisy, measurement = recorded(machine, run, np.random.default_rng(0))
    options = Options(starts=1)
    model = updated_model(machine, identify(machine, measurement, options))
    parts: dict[str, Callable[[], object]] = {
        "one fit": lambda: identify(machine, measurement, options),
        "points judged without a model": lambda: assess(noisy, noise=machine.noise),
        "sweep predicted by a model": lambda: predicted_transient(model, time=run.time, speed=run.speed),
        "all, with its fits": lambda: identify_gated(machine, [noisy], [measurement], options=options),
    }
    print(f"\ntimes at {rate:g} r/min per s, {run.time.size} samples of 8 channels, median of 7, CPU [ms]:")
    for name, work in parts.items():
        taken = []
        for _ in range(7):
            began = time.process_time()
            work()
            taken.append(time.process_time() - began)
        print(f"  {name:<32}{1e3 * float(np.median(taken)):8.0f}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print everything."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimator.coast_down", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--steady", type=int, default=60, help="steady-state runs of each machine")
    parser.add_argument("--rates", type=float, nargs="*", default=list(RATES_RPM_PER_S), help="[r/min per s]")
    asked = parser.parse_args(arguments)
    with threadpool_limits(1):
        true = true_document()
        middle = rpm_to_rad_per_s((FROM_RPM + TO_RPM) / 2)
        found = modes(system_matrices(parse_machine(true)), spin=middle)
        crossed = found.eigenvalue.imag < rpm_to_rad_per_s(FROM_RPM)
        print("modes crossed [rpm: damping ratio in %]:", end=" ")
        pairs = zip(found.eigenvalue.imag[crossed], found.damping_ratio[crossed], strict=True)
        print(", ".join(f"{rad_per_s_to_rpm(float(f)):.0f}: {100 * z:.1f}" for f, z in pairs))
        for rate in asked.rates:
            compared(true, rate, asked.runs)
        compared(true_document(OTHER, 1.0), OTHER_RATE, asked.runs, OTHER_FROM_RPM)
        false_alarms(asked.steady)
        for rate in asked.rates[:: max(1, len(asked.rates) - 1)]:
            timed(true, rate)


if __name__ == "__main__":
    main()
