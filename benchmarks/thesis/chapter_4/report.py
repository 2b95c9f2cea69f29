"""Chapter 4 of the thesis: flexible shafts, measured at the bearings only, by dynamic and high-frequency condensation.

python -m benchmarks.thesis chapter-4 [--method I|II] [--case A|B|C_fb1|C_fb2|C_fb3] [--noise 1] [--data full|own]
                                      [--sharing none] [--seed 0]
"""

import argparse
from collections.abc import Callable
from typing import get_args

import numpy as np

from benchmarks.thesis.chapter_4.bias import bias_section
from benchmarks.thesis.chapter_4.cases import BANDS, CASES, DATA, clean_phasors
from benchmarks.thesis.chapter_4.forces import forces_section
from benchmarks.thesis.chapter_4.noise import likelihood_section, without_noise_section, worst_section
from benchmarks.thesis.chapter_4.reduction import conditions_section, misprinted_section, reductions_section
from benchmarks.thesis.chapter_4.speed_dependence import speed_dependent_section
from benchmarks.thesis.flexible.experiments import Subject, experiment, likelihood, load, regression
from benchmarks.thesis.flexible.misprints import with_printed_rotary_inertia
from estimator.thesis.noise import Sharing, multiplicative_noise, multiplicative_rms
from estimator.thesis.reduction import high_frequency_condensed


def section() -> str:
    """Return the chapter's part of the evidence page."""
    subject = load()
    parts_of_page = [
        "## Chapter 4: measured at the bearings only",
        "The train of Chapter 3, measured in both translations at the four bearings (8 channels). The thesis condenses "
        "twice: "
        "dynamically to bearings, coupling and discs (24 degrees of freedom, Eq. 4.53), then by high-frequency "
        "condensation to "
        "the bearings (Eq. 4.57), and says that its data come from the full model (Eq. 4.42). E is read as 2.1×10¹¹ N/m², "
        "the "
        "printed 2.1×10⁹ being a slip. Critical speeds: as printed for Chapter 3, and as little reproduced.",
        reductions_section(subject),
        without_noise_section(subject),
        worst_section(subject),
        conditions_section(subject),
        misprinted_section(with_printed_rotary_inertia(subject)),
        likelihood_section(subject),
        bias_section(subject),
        speed_dependent_section(subject),
        forces_section(subject),
    ]
    return "\n\n".join(parts_of_page) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `python -m benchmarks.thesis chapter-4`."""
    parser.add_argument("--method", choices=("I", "II"), default="II", help="one or both senses of rotation, default II")
    parser.add_argument("--case", choices=("A", "B", "C_fb1", "C_fb2", "C_fb3"), default="C_fb3", help="default C_fb3")
    parser.add_argument("--noise", type=float, default=1.0, help="N of Eq. 2.20 [%%], default 1")
    parser.add_argument("--data", choices=DATA, default="full", help="of the reduced or the full model, default full")
    parser.add_argument("--scaling", choices=("none", "thesis", "norm"), default="norm", help="of columns, default norm")
    parser.add_argument("--sharing", choices=get_args(Sharing), default="none", help="phasors that share a random number")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")
    parser.add_argument(
        "--part",
        choices=sorted(PARTS),
        default=None,
        help="a part of the page instead of one experiment; other options are then unused",
    )


def run(arguments: argparse.Namespace) -> str:
    """Return one experiment, parameter by parameter, or a part of the page. Raises SystemExit for an unknown case."""
    subject = load()
    if arguments.part is not None:
        return PARTS[arguments.part](subject)
    wanted = (arguments.method, arguments.case)
    cases = [case for case in (*CASES, *BANDS) if (case.method, case.name) == wanted]
    if not cases:
        raise SystemExit(f"the thesis has no Case {arguments.case} under Method {arguments.method}")
    model = high_frequency_condensed(subject.train, speed=cases[0].speed, direction=cases[0].direction)
    clean = clean_phasors(subject, cases[0], model, arguments.data)
    noisy = multiplicative_noise(
        clean, percent=arguments.noise, rng=np.random.default_rng(arguments.seed), sharing=arguments.sharing
    )
    solution = regression(subject, model, noisy, scaling=arguments.scaling)
    fit = None
    if arguments.data == "full" and arguments.noise > 0.0:
        fit = likelihood(subject, cases[0], noisy, rms=multiplicative_rms(arguments.noise), seed=arguments.seed)
    return experiment(subject, solution, fit)


PARTS: dict[str, Callable[[Subject], str]] = {"bias": bias_section, "speed-dependent": speed_dependent_section}
"""Parts that a command can print alone: E and density 5 % off, and Eq. 4.66-4.70."""
