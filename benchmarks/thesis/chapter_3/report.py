"""Chapter 3 of the thesis: flexible shafts, every degree of freedom at bearings and coupling measured.

python -m benchmarks.thesis chapter-3 [--method I|II] [--case A|B|C] [--noise 1] [--scaling norm] [--sharing none] [--seed 0]
                                      [--damping 0.01]
"""

import argparse
from typing import get_args

import numpy as np

from benchmarks.thesis.chapter_3.cases import CASES, damped, measured
from benchmarks.thesis.chapter_3.forces import forces_section
from benchmarks.thesis.chapter_3.models import critical_speeds_section, damping_section
from benchmarks.thesis.chapter_3.noise import clean_section, likelihood_section, scaling_section, worst_section
from benchmarks.thesis.chapter_3.parameters import parameters_section, unbalances_section
from benchmarks.thesis.flexible.experiments import experiment, likelihood, load, regression
from estimator.thesis.noise import Sharing, multiplicative_noise, multiplicative_rms


def section() -> str:
    """Return the chapter's part of the evidence page."""
    subject = load()
    parts = [
        "## Chapter 3: flexible shafts, all interface degrees of freedom measured",
        "Train: `examples/thesis-chapter-3.yaml`, 10 Timoshenko elements of 0.25 m, 48 degrees of freedom. Measured: both "
        "translations at the four bearings, translations and rotations of both coupling halves (16); the other 32 are "
        "eliminated exactly (Eq. 3.27). 50 real unknowns. Errors are relative to the true value of each real unknown, as in "
        "the thesis. Method II assumes with the thesis that a bearing has the same coefficients in both senses of "
        "rotation, which no fluid-film bearing has.",
        critical_speeds_section(subject),
        clean_section(subject),
        worst_section(subject),
        scaling_section(subject),
        likelihood_section(subject),
        parameters_section(subject),
        unbalances_section(),
        damping_section(subject),
        forces_section(subject),
    ]
    return "\n\n".join(parts) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `python -m benchmarks.thesis chapter-3`."""
    parser.add_argument("--method", choices=("I", "II"), default="II", help="one or both senses of rotation, default II")
    parser.add_argument("--case", choices=("A", "B", "C"), default="C", help="speeds of the thesis, default C")
    parser.add_argument("--noise", type=float, default=1.0, help="N of Eq. 2.20 [%%], default 1")
    parser.add_argument("--scaling", choices=("none", "thesis", "norm"), default="norm", help="of columns, default norm")
    parser.add_argument("--sharing", choices=get_args(Sharing), default="none", help="phasors that share a random number")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")
    parser.add_argument("--damping", type=float, default=0.0, help="shaft damping ratio (Appendix B) [-], default 0")


def run(arguments: argparse.Namespace) -> str:
    """Return one experiment, parameter by parameter."""
    subject = damped(load(), arguments.damping)
    case = next(c for c in CASES if (c.method, c.name) == (arguments.method, arguments.case))
    model, clean = measured(subject, case)
    noisy = multiplicative_noise(
        clean, percent=arguments.noise, rng=np.random.default_rng(arguments.seed), sharing=arguments.sharing
    )
    solution = regression(subject, model, noisy, scaling=arguments.scaling, damping_scaled=False)
    fit = None
    # The fit knows no shaft damping, and a fit needs noise of a stated size.
    if (
        arguments.noise > 0.0
        and arguments.damping == 0.0
        and 2 * case.speed.size * subject.train.bearing.size > len(subject.names)
    ):
        rms = multiplicative_rms(arguments.noise)
        fit = likelihood(subject, case, noisy[:, : subject.train.bearing.size], rms=rms, seed=arguments.seed)
    return experiment(subject, solution, fit)
