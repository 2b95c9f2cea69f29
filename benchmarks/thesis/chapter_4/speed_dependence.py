"""Chapter 4: coefficients that depend on the speed, from runs with trial unbalances."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.thesis.flexible.experiments import SEEDS, Subject
from benchmarks.thesis.tables import median_and_worst, percent, table
from estimator.arrays import Complexes, Floats, Indices
from estimator.thesis.flexible_train import parts
from estimator.thesis.noise import complex_noise
from estimator.thesis.reduced_model import reduced_response, response_equations
from estimator.thesis.reduction import eliminated, high_frequency_condensed
from estimator.thesis.regression import solve
from estimator.thesis.response_regression import speed_dependent_regression, with_trial_unbalances

SPEED_STEPS = (60.0, 160.0, 240.0)
"""Speeds [rad/s] at which the coefficients are found one by one."""

TRIAL = 4e-3
"""Known trial unbalance [kg m]."""

GROWTH = 0.002
"""Relative growth of every coefficient per rad/s above the first of these speeds."""


def speed_dependent_section(subject: Subject) -> str:
    """Write the section on coefficients that depend on the speed."""
    rows = []
    for title, senses, planes in (
        ("one way, 1 trial mass", (1,), 1),
        ("one way, 2 trial masses", (1,), 2),
        ("one way, 4 trial masses", (1,), 4),
        ("both ways, no trial mass", (1, -1), 0),
        ("both ways, 1 trial mass", (1, -1), 1),
        ("both ways, 4 trial masses", (1, -1), 4),
    ):
        runs = _runs(senses, planes)
        rows.append([title, *[_speed_dependent_row(subject, runs, which) for which in ("interface", "bearings")]])
    speeds = ", ".join(f"{speed:g}" for speed in SPEED_STEPS)
    return (
        "### Speed-dependent coefficients (Eq. 4.66-4.70)\n\n"
        f"Coefficients that grow with speed, found at {speeds} rad/s from "
        "runs with and without a known trial mass on one disc after the other; 134 unknowns. Largest error without noise, "
        "then "
        f"median / largest at 0.1 % complex noise, {len(SEEDS)} seeds.\n\n"
        + table(
            ["runs", "interface measured (16 channels), exact elimination", "bearings only, high-frequency, own data"], rows
        )
        + "\n\nWithout noise the form works where runs enough are at hand: one way, it needs a trial mass with the "
        "interface "
        "measured and two with the bearings alone; both ways, none and one. With noise it has too few equations for each "
        "value: a "
        "tenth of a per cent leaves the median error near one per cent at best, and the high-frequency form useless even "
        "on its own "
        "data. The thesis gives no numbers for it."
    )


@dataclass(frozen=True)
class TrialMassRuns:
    """Samples with trial masses: group (S,) number of the speed, speed and direction (S,), trial (S, 4) [kg m]."""

    group: Indices
    speed: Floats
    direction: Floats
    trial: Complexes


def _runs(senses: Sequence[int], planes: int) -> TrialMassRuns:
    trials = np.vstack([np.zeros((1, 4)), TRIAL * np.eye(4)[[0, 3, 1, 2][:planes]]]).astype(complex)
    samples = [(k, omega, sense, t) for k, omega in enumerate(SPEED_STEPS) for sense in senses for t in trials]
    return TrialMassRuns(
        group=np.array([one[0] for one in samples], dtype=np.intp),
        speed=np.array([one[1] for one in samples]),
        direction=np.array([float(one[2]) for one in samples]),
        trial=np.array([one[3] for one in samples]),
    )


def _speed_dependent_row(subject: Subject, runs: TrialMassRuns, which: str) -> str:
    reduction = eliminated if which == "interface" else high_frequency_condensed
    model = reduction(subject.train, speed=runs.speed, direction=runs.direction)
    changing = subject.coefficients * (1.0 + GROWTH * (runs.speed[:, None] - SPEED_STEPS[0]))
    clean = reduced_response(model, coefficients=changing, unbalances=subject.unbalances + runs.trial)
    firsts = [int(np.flatnonzero(runs.group == k)[0]) for k in range(len(SPEED_STEPS))]
    truth = np.concatenate([changing[firsts].reshape(-1), parts(subject.unbalances)])

    def errors(phasor: Complexes) -> Floats:
        equations = with_trial_unbalances(response_equations(model, phasor), runs.trial)
        problem = speed_dependent_regression(
            equations, subject.train.unknowns, group=runs.group, mean_speed=float(runs.speed.mean())
        )
        return np.asarray(np.abs(solve(problem).values / truth - 1))

    if 2 * clean.size < truth.size:
        return f"{2 * clean.size} equations for {truth.size} unknowns"
    exact = float(errors(clean).max())
    if exact > 1e-3:
        return "undetermined"
    noisy = np.array([errors(complex_noise(clean, rms=1e-3, rng=np.random.default_rng(seed))) for seed in SEEDS])
    return f"{percent(exact)}; {median_and_worst(noisy)}"
