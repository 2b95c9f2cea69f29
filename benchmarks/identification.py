"""Time, convergence and accuracy of the identification on the Chapter 3 train, measured at the bearings only.

Data: the reference response of tests/data (computed with ROSS) at 150 speeds, 2 to 300 rad/s, with 1 % complex noise: the
real and the imaginary part each have standard deviation 0.01 |X| / √2. Everything runs on one BLAS thread.

    python -m benchmarks.identification [--trials N]
"""

import argparse
import math
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from estimator.condensation import condense
from estimator.identification import Identification, identify
from estimator.machine import Machine, parse_machine
from estimator.measurement import Measurement
from estimator.response import response
from estimator.sensitivity import sensitivity

Floats = NDArray[np.float64]

ROOT = Path(__file__).parents[1]
RELATIVE_NOISE = 0.01
NOISE_SEEDS = 20
TRIALS = 100
DOCUMENT_SEED = 2024
"""Seed of the random documents; trial t draws its noise with seed 1000 + t."""
SPAN = 0.5
"""A nominal coefficient is off by a factor uniform between 1 - SPAN and 1 + SPAN."""
MEDIAN_ASKED = 0.5
CHI_SQUARE_ASKED = 5.0
"""Standard deviations √(2/dof) by which χ²/dof may differ from 1."""
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "k_phix", "k_phiy")


@dataclass(frozen=True)
class Train:
    """The document, its machine, the noiseless response (S, m) [m] at the speeds (S,) [rad/s], the true real unknowns [SI]."""

    document: dict[str, Any]
    machine: Machine
    speed: Floats
    clean: NDArray[np.complex128]
    truth: Floats

    def measured(self, seed: int) -> Measurement:
        """The response with noise."""
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal(self.clean.shape) + 1j * rng.standard_normal(self.clean.shape)
        return Measurement.of(speed=self.speed, phasor=self.clean + RELATIVE_NOISE / math.sqrt(2) * np.abs(self.clean) * noise)


@dataclass(frozen=True)
class Run:
    """One identification and how long it took [s]."""

    outcome: Identification
    seconds: float

    @property
    def converged(self) -> bool:
        """Whether χ²/dof is as near to 1 as asked."""
        one = self.outcome
        spread = math.sqrt(2 / one.degrees_of_freedom)
        return abs(one.chi_square / one.degrees_of_freedom - 1) <= CHI_SQUARE_ASKED * spread

    def real_values(self) -> Floats:
        """Estimates as one real vector, NaN where not estimable."""
        values: list[float] = []
        for one in self.outcome.estimates:
            values.append(math.nan if one.value is None else one.value)
            if one.quantity == "unbalance":
                values.append(math.nan if one.imaginary is None else one.imaginary)
        return np.array(values)


def load() -> Train:
    """The Chapter 3 train."""
    document = yaml.safe_load((ROOT / "examples" / "thesis-chapter-3.yaml").read_text(encoding="utf-8"))
    machine = parse_machine(document)
    with np.load(ROOT / "tests" / "data" / "thesis-chapter-3.npz") as data:
        speed, clean = data["speed"][1::2], data["response"][1::2]
    coefficients, unbalances = _nominal(machine)
    truth = np.concatenate([coefficients, np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(-1)])
    return Train(document, machine, speed, clean, truth)


def perturbed(document: dict[str, Any], rng: np.random.Generator) -> Machine:
    """The machine with every nominal coefficient off by a random factor, and no nominal unbalance."""

    def off(part: dict[str, Any]) -> dict[str, Any]:
        changed = {name: part[name] * (1 + rng.uniform(-SPAN, SPAN)) for name in COEFFICIENTS if name in part}
        return {**part, **changed}

    discs = [{key: value for key, value in disc.items() if key != "unbalance"} for disc in document["discs"]]
    bearings, couplings = ([off(part) for part in document[name]] for name in ("bearings", "couplings"))
    return parse_machine({**document, "discs": discs, "bearings": bearings, "couplings": couplings})


def without_nominal(document: dict[str, Any], parts: Sequence[str]) -> Machine:
    """The machine whose document says nothing about the coefficients of its bearings, or couplings, or its unbalances."""
    left_out = {*COEFFICIENTS, "unbalance"}
    silent = {part: [{k: v for k, v in item.items() if k not in left_out} for item in document[part]] for part in parts}
    return parse_machine({**document, **silent})


def model_deviation(train: Train) -> float:
    """Largest relative deviation of the model's response from the reference, on the same mesh."""
    condensed = condense(train.machine, speed=train.speed, direction=np.ones_like(train.speed))
    coefficients, unbalances = _nominal(train.machine)
    modelled = response(condensed, coefficients=coefficients, excitations=unbalances)
    return float(np.max(np.abs(modelled - train.clean) / np.abs(train.clean)))


def cramer_rao(train: Train) -> Floats:
    """Smallest standard error that an unbiased estimate of each real unknown can have."""
    condensed = condense(train.machine, speed=train.speed, direction=np.ones_like(train.speed))
    coefficients, unbalances = _nominal(train.machine)
    slope = sensitivity(condensed, coefficients=coefficients, excitations=unbalances).by_parameter
    weighted = (slope / (RELATIVE_NOISE / math.sqrt(2) * np.abs(train.clean))[..., None]).reshape(-1, slope.shape[-1])
    size = np.linalg.norm(weighted, axis=0)
    information = ((weighted / size).conj().T @ (weighted / size)).real
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information))) / size)


def timed(machine: Machine, measurement: Measurement) -> Run:
    """One identification with its time."""
    begin = time.perf_counter()
    outcome = identify(machine, measurement)
    return Run(outcome, time.perf_counter() - begin)


def report(train: Train, nominal: list[Run], trials: list[Run], silent: dict[str, list[Run]]) -> str:
    """The figures, measured beside asked."""
    bound = cramer_rao(train)
    lines = [
        "Identification of the Chapter 3 train, bearings only",
        f"{train.speed.size} speeds {train.speed[0]:g} to {train.speed[-1]:g} rad/s, {train.clean.shape[1]} channels, "
        f"{train.truth.size} real unknowns, {100 * RELATIVE_NOISE:g} % complex noise, one BLAS thread",
        "",
        _row("", "asked", "measured"),
        _row("model against ROSS, same mesh, relative", "<= 1e-9", f"{model_deviation(train):.1e}"),
        f"nominal values as true, noise seeds 0 to {len(nominal) - 1}",
        *_rows(nominal, bound, train.truth, time_asked=f"<= {MEDIAN_ASKED:g}", converged_asked=""),
        f"nominal coefficients off by uniform ±{100 * SPAN:.0f} %, {len(trials)} documents (seed {DOCUMENT_SEED})",
        *_rows(trials, bound, train.truth, time_asked="", converged_asked=f"{len(trials)} of {len(trials)}"),
        _row("starts used: documents", "", _histogram(run.outcome.starts for run in trials)),
    ]
    for what, runs in silent.items():
        lines.append(f"no nominal values of {what}, noise seeds 0 to {len(runs) - 1}")
        lines += _rows(runs, bound, train.truth, time_asked="", converged_asked="")
        lines.append(_row("starts used: documents", "", _histogram(run.outcome.starts for run in runs)))
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.identification", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--trials", type=int, default=TRIALS, help=f"random documents, default {TRIALS}")
    trial_count = parser.parse_args(arguments).trials
    if trial_count < 1:
        parser.error("--trials must be at least 1")
    train = load()
    rng = np.random.default_rng(DOCUMENT_SEED)
    with threadpool_limits(limits=1):
        timed(train.machine, train.measured(0))  # the first call pays for loading
        nominal = [timed(train.machine, train.measured(seed)) for seed in range(NOISE_SEEDS)]
        trials = [timed(perturbed(train.document, rng), train.measured(1000 + trial)) for trial in range(trial_count)]
        silent = {
            " and ".join(parts): [timed(without_nominal(train.document, parts), train.measured(seed)) for seed in range(3)]
            for parts in (["discs", "bearings"], ["discs", "bearings", "couplings"])
        }
    print(report(train, nominal, trials, silent))


def _nominal(machine: Machine) -> tuple[Floats, NDArray[np.complex128]]:
    unknown = condense(machine, speed=np.array([1.0]), direction=np.array([1.0])).unknowns
    return (
        np.array([one.nominal for one in unknown.coefficients], dtype=float),
        np.array([one.nominal for one in unknown.unbalances], dtype=complex),
    )


def _rows(runs: list[Run], bound: Floats, truth: Floats, *, time_asked: str, converged_asked: str) -> list[str]:
    seconds = np.array([run.seconds for run in runs])
    good = [run for run in runs if run.converged]
    rows = [
        _row("time, median [s]", time_asked, f"{np.median(seconds):.3f}"),
        _row("time, shortest to longest [s]", "", f"{seconds.min():.3f} to {seconds.max():.3f}"),
        _row("converged: |χ²/dof - 1| <= 5 √(2/dof)", converged_asked, f"{len(good)} of {len(runs)}"),
    ]
    if good:
        ratio = (np.array([run.real_values() for run in good]) - truth) / bound
        missing = int(np.count_nonzero(np.isnan(ratio)))
        overall = math.sqrt(float(np.nanmean(ratio**2)))
        rows.append(_row("rms error over Cramér-Rao bound (ideal 1)", "", f"{overall:.3f}"))
        rows.append(_row("largest error over its bound", "", f"{np.nanmax(np.abs(ratio)):.2f}"))
        rows.append(_row("values reported as not estimable", "", f"{missing} of {ratio.size}"))
    return rows


def _row(what: str, asked: str, measured: str) -> str:
    return f"  {what:<44}{asked:>12}  {measured:>16}".rstrip()


def _histogram(counts: Iterable[int]) -> str:
    return ", ".join(f"{value}: {number}" for value, number in sorted(Counter(counts).items()))


if __name__ == "__main__":
    main()
