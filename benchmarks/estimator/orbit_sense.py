"""Detection of swapped channels and of a wrong sense of rotation from orbits, on the example trains.

Run-downs of simulated machines near their documents (every coefficient off by some per cent, unbalances drawn), with the
document's noise and a run-out on each channel. Three kinds of unbalance: near the document's, drawn anew with a balance grade
that is equal on all discs, and in one disc only. Then nothing is wrong, each pair is swapped in turn, or the machine turns the
other way than declared.

    python -m benchmarks.estimator.orbit_sense [--runs N]
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml
from threadpoolctl import threadpool_limits

from benchmarks.estimator.arguments import runs_asked
from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.orbits import orbit_findings
from estimator.phasors.probe_axes import probe_stations
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law, truth_of_run

EXAMPLES = Path(__file__).parents[2] / "examples"
TRAINS = ("motor-pump", "sealed-pump", "thesis-chapter-3", "thesis-chapter-5-rig", "turbine-compressor-generator")
RUNS = 6
FIRST_SEED = 1000
"""The limits were chosen on smaller seeds."""
RUN_OUTS = (0.0, 1e-5, 5e-5)
"""Run-out of each channel, 0-to-peak [m], at random angles."""
UNBALANCES = ("near the document's", "drawn anew", "in one disc")
ASKED = 100.0
"""A statement about a machine must be true: right where it speaks [%]."""


def examined(name: str, rotation: str) -> Machine:
    """Return an example that turns in a sense of rotation."""
    document = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return parse_machine({**document, "rotation": rotation})


def with_unbalance(truth: Truth, machine: Machine, kind: str, rng: np.random.Generator) -> Truth:
    """Return a truth with another distribution of unbalance, of the same size."""
    size = float(np.sqrt(np.sum(np.abs(truth.unbalances) ** 2)))
    drawn = rng.standard_normal(truth.unbalances.size) + 1j * rng.standard_normal(truth.unbalances.size)
    drawn *= np.array([disc.mass for disc in machine.discs])
    if kind == "in one disc":
        drawn[np.arange(drawn.size) != rng.integers(drawn.size)] = 0.0
    elif kind != "drawn anew":
        return truth
    return replace(truth, unbalances=drawn * size / np.sqrt(np.sum(np.abs(drawn) ** 2)))


def run_down(machine: Machine, kind: str, run_out: float, seed: int) -> tuple[Floats, Complexes]:
    """Return the speeds and phasors of one run-down."""
    rng = np.random.default_rng(seed)
    truth = with_unbalance(truth_of_run(draw_truth(machine, rng), rng), machine, kind, rng)
    _, speed = speed_law(machine, "run-down", duration=600.0, samples=200)
    phasor = measured_phasors(machine, truth, speed, rng)
    return speed, phasor + run_out * np.exp(2j * np.pi * rng.random(phasor.shape[1]))


def judged(machine: Machine, speed: Floats, phasor: Complexes, guilty: tuple[tuple[str, ...], ...]) -> Counter[str]:
    """Return counts per pair of probes: found and guilty or silent and innocent (right), unseen, missed, or wrongly accused
    (wrong)."""
    findings = orbit_findings(machine, Measurement.of(speed=speed, phasor=phasor))
    blind = {one.channels for one in findings if one.code == "orbit_sense_undetectable"}
    accused = [one.channels for one in findings if one.code != "orbit_sense_undetectable"]
    counts: Counter[str] = Counter()
    for place in probe_stations(machine):
        named = any(set(place.channels) <= set(channels) for channels in accused)
        if place.channels in blind:
            counts["unseen"] += 1
        elif named == (place.channels in guilty):
            counts["right"] += 1
        else:
            counts["accused" if named else "missed"] += 1
    return counts


def tallied(name: str, kind: str, run_out: float, runs: int) -> dict[str, Counter[str]]:
    """Return outcomes per case, summed over pairs and seeds."""
    machine, other = examined(name, "positive"), examined(name, "negative")
    places = probe_stations(machine)
    found: dict[str, Counter[str]] = {"nothing wrong": Counter(), "a pair swapped": Counter(), "sense reversed": Counter()}
    for seed in range(FIRST_SEED, FIRST_SEED + runs):
        speed, phasor = run_down(machine, kind, run_out, seed)
        found["nothing wrong"] += judged(machine, speed, phasor, ())
        for place in places:
            swapped = phasor.copy()
            swapped[:, list(place.columns)] = phasor[:, list(place.columns)[::-1]]
            found["a pair swapped"] += judged(machine, speed, swapped, (place.channels,))
        speed, phasor = run_down(other, kind, run_out, seed)
        found["sense reversed"] += judged(machine, speed, phasor, tuple(place.channels for place in places))
    return found


def report(runs: int) -> str:
    """Return a line per train, unbalance and case; then the whole, and each kind of unbalance."""
    lines = [
        f"orbit sense on the example trains, {runs} run-downs of each, seeds from {FIRST_SEED}",
        "of all pairs of probes: judged at all; of those judged: right, wrongly accused, missed; asked: right 100 %",
        "",
    ]
    whole: dict[str, Counter[str]] = {name: Counter() for name in ("all", *UNBALANCES)}
    for run_out in RUN_OUTS:
        lines.append(f"run-out {1e6 * run_out:.0f} µm 0-to-peak on every channel")
        for name in TRAINS:
            for kind in UNBALANCES:
                for case, counts in tallied(name, kind, run_out, runs).items():
                    lines.append(f"  {name:<29} unbalance {kind:<20} {case:<15} {_shares(counts)}")
                    whole["all"] += counts
                    whole[kind] += counts
    summary = [f"{name:<20} {_shares(counts)}; asked {ASKED:.0f} %" for name, counts in whole.items()]
    return "\n".join([*lines, "", *summary])


def _shares(counts: Counter[str]) -> str:
    spoken = counts["right"] + counts["accused"] + counts["missed"]
    shares = " ".join(f"{what} {100 * counts[what] / max(1, spoken):6.2f} %" for what in ("right", "accused", "missed"))
    return f"judged {100 * spoken / counts.total():5.1f} %  {shares}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    name = "benchmarks.estimator.orbit_sense"
    runs = runs_asked(arguments, name=name, description=__doc__, default=RUNS, what="run-downs of each kind")
    with threadpool_limits(limits=1):
        print(report(runs))


if __name__ == "__main__":
    main()
