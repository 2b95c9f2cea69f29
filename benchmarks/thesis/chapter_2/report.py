"""Chapter 2 of the thesis: two rigid rotors, all eight degrees of freedom measured.

python -m benchmarks.thesis chapter-2 [--method I|II] [--case A|B|C] [--noise 1] [--scaling norm] [--solver orthogonal]
    [--tikhonov L-curve] [--sharing none] [--seed 0]
"""

import argparse
from typing import get_args

import numpy as np

from benchmarks.thesis.chapter_2.exact_data import conditioning_section, frequencies_section, misprints_section
from benchmarks.thesis.chapter_2.experiments import CASES, bound, case, experiment, likelihood, likelihood_values, regression
from benchmarks.thesis.chapter_2.noise import (
    against_the_bound_section,
    largest_errors_section,
    noise_hypotheses_section,
    responses_section,
)
from benchmarks.thesis.chapter_2.parameters import forces_section, parameters_section
from benchmarks.thesis.chapter_2.regularisation import SCALINGS, scaling_section, tikhonov_section
from benchmarks.thesis.chapter_2.unbalances import unbalances_section
from benchmarks.thesis.tables import paragraphs, percent, prose, table
from estimator.thesis.noise import Sharing, multiplicative_rms
from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.regression import RegressionMethod
from estimator.thesis.rigid_train import names


def section() -> str:
    """Return the chapter's part of the evidence page."""
    subjects = {one: experiment(one) for one in CASES}
    best = subjects[case("II", "C")]
    parts = [
        "## Chapter 2: rigid rotors",
        prose("""
        Train: two rigid rotors with two discs each, four bearings of eight coefficients, a coupling of ten, 8 degrees
        of freedom, all of them measured; 42 coefficients and 4 complex unbalances make 50 real unknowns
        (`estimator/thesis/rigid_train.py`, `estimator/thesis/rigid_regression.py`). Method I turns in one sense,
        Method II in both. Case A: four speeds near the first resonances, B: four speeds away from them, C: 200 speeds
        up to 2000 rad/s.
        """),
        frequencies_section(),
        conditioning_section(subjects),
        misprints_section(best),
        largest_errors_section(subjects),
        against_the_bound_section(subjects),
        responses_section(subjects),
        noise_hypotheses_section(subjects),
        parameters_section(best),
        unbalances_section(),
        scaling_section(subjects[case("I", "A")], subjects[case("II", "C")]),
        tikhonov_section(subjects),
        forces_section(best),
    ]
    return paragraphs(*parts) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `python -m benchmarks.thesis chapter-2`."""
    parser.add_argument("--method", choices=("I", "II"), default="II", help="one or both senses of rotation, default II")
    parser.add_argument("--case", choices=("A", "B", "C"), default="C", help="speeds of the thesis, default C")
    parser.add_argument("--noise", type=float, default=1.0, help="N of Eq. 2.20 [%%], default 1")
    parser.add_argument("--scaling", choices=SCALINGS, default="norm", help="of columns, default norm")
    parser.add_argument("--solver", choices=get_args(RegressionMethod), default="orthogonal", help="default orthogonal")
    parser.add_argument(
        "--tikhonov", choices=get_args(RegularisationRule), default=None, help="rule of a regularisation, default none"
    )
    parser.add_argument("--sharing", choices=get_args(Sharing), default="none", help="phasors that share a random number")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")


def run(arguments: argparse.Namespace) -> str:
    """Return one regression, parameter by parameter."""
    subject = experiment(case(arguments.method, arguments.case))
    phasor = subject.noisy(arguments.noise, arguments.seed, arguments.sharing)
    found = regression(subject, phasor, scaling=arguments.scaling, method=arguments.solver, tikhonov=arguments.tikhonov)
    columns = {"regression": found.values}
    rms = multiplicative_rms(arguments.noise)
    smallest = np.full(found.values.size, np.nan)
    if rms > 0.0:
        columns["maximum likelihood"] = likelihood_values(likelihood(subject, phasor, rms=rms, seed=arguments.seed))
        smallest = bound(subject, rms=rms)
    rows = []
    for k, (name, true) in enumerate(zip(names(), subject.rigid.values, strict=True)):
        cells = [(f"{values[k]:.5g}", percent(abs(values[k] / true - 1))) for values in columns.values()]
        rows.append([name, f"{true:.5g}", *(cell for pair in cells for cell in pair), percent(float(smallest[k]))])
    header = ["parameter [SI]", "assumed", *(title for name in columns for title in (name, "error"))]
    conditions = f"{found.condition_number_before:.2e} before, {found.condition_number_after:.2e} after column scaling"
    return (
        table([*header, "Cramér-Rao bound, circular noise"], rows)
        + f"\n\ncondition number: {conditions}; λ = {found.parameter:.3g}"
    )
