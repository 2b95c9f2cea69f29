"""Coarse fit: whether a run can be explained at all, for a small part of what an identification costs.

The first two stages of `maximum_likelihood` (Marquardt 1963, doi:10.1137/0111030) on a part of the samples. They allow five
per cent of misfit beside the noise: a right model leaves less than 1, and what lies beyond HOPELESS_MISFIT leads nowhere.
"""

import numpy as np

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import STAGE_MISFITS, descend
from estimator.fit.optimisation.multistart import chosen_start
from estimator.fit.optimisation.nuisance_parameters import counted_by_effect
from estimator.fit.optimisation.reweighting import without_outliers
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.fit.problem_setup import fit_problem
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement

COARSE_SAMPLES = 30
"""Fewest samples of a coarse fit, evenly spaced over those of the run."""
NUMBERS_PER_UNKNOWN = 4
"""Fewest measured numbers for each unknown: with few channels more samples are taken [-]."""
STEPS = (40, 12)
"""Most steps of the two stages: a right model needs hardly six in the second."""
GOOD = 1.5
"""χ²/dof of a coarse fit after which no other start is tried [-]."""


def coarse_problem(machine: Machine, measurement: Measurement) -> FitProblem:
    """Build the problem of a coarse fit.

    Args:
        machine: The machine.
        measurement: Its measured phasors.

    Returns:
        The problem, of a part of the samples.

    Raises:
        NotEnoughData: No phasor is usable, or every usable one is zero.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    measurement = measurement.pick(np.asarray(measurement.usable.any(axis=1)))
    count = measurement.speed.size
    unknown = len(machine.bearings) * 8 + len(machine.couplings) * 10 + len(machine.discs) * 2
    wanted = max(COARSE_SAMPLES, NUMBERS_PER_UNKNOWN * unknown // (2 * max(1, len(machine.probes))))
    if count > wanted:
        picked = np.zeros(count, dtype=bool)
        picked[np.linspace(0, count - 1, wanted).round().astype(int)] = True
        measurement = measurement.pick(picked)
    return fit_problem(machine, measurement, robust=True)


def coarse_misfit(problem: FitProblem, *, starts: int = 1, seed: int = 0) -> float:
    """Compute the smallest misfit of a coarse fit from some starts (Marquardt 1963, as `maximum_likelihood`).

    Args:
        problem: The problem, as `coarse_problem` gives it.
        starts: Most starts.
        seed: Seed of the random starts.

    Returns:
        χ²/dof with five per cent of misfit allowed beside the noise [-]; infinite where no start leads anywhere.
    """
    rng = np.random.default_rng(seed)
    best = np.inf
    for start in range(starts):
        best = min(best, _descended(problem, chosen_start(problem, rng, first=start == 0)))
        if best <= GOOD:
            break
    return float(best)


def _descended(problem: FitProblem, theta: Floats) -> float:
    """Return the misfit in which a start ends; infinite where it has no slope to follow."""
    reduced, told = np.inf, theta.size - int(np.count_nonzero(counted_by_effect(problem.coordinates)))
    for misfit, steps in zip(STAGE_MISFITS, STEPS, strict=False):
        weight = problem.weight(problem.first_amplitude, misfit)
        theta, _, _ = descend(problem, theta, weight, steps)
        freedom = max(1, 2 * int(np.count_nonzero(problem.used)) - told)
        reduced = problem.chi_square(theta, weight) / freedom
        problem = without_outliers(problem, theta, misfit)
    return reduced if np.isfinite(reduced) else np.inf


def linear_misfit(problem: FitProblem) -> float:
    """Compute the misfit of the document's values with the unbalances that fit best (weights of `maximum_likelihood`).

    Args:
        problem: The problem.

    Returns:
        χ² with fifty per cent of misfit allowed beside the noise [-].
    """
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    theta = best_excitations(problem, problem.coordinates.centre, weight)
    return problem.chi_square(theta, weight)
