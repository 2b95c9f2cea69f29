"""Chapter 2, §2.3.2 and §6.5: column scaling, and Tikhonov regularisation of the regression."""

from typing import get_args

import numpy as np

from benchmarks.thesis.chapter_2.experiments import Experiment, RigidCase, case, regression
from benchmarks.thesis.tables import decade, median_and_worst, paragraphs, percent, prose, table
from estimator.arrays import Floats
from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.regression import RegressionMethod, Scaling
from estimator.thesis.rigid_train import names

SCALINGS: tuple[Scaling, ...] = get_args(Scaling)

EXPECTED_SPAN = 0.2
"""Values that a regularisation draws towards are off by a factor uniform between 1 - and 1 + this."""

TIKHONOV_SEEDS = 10

ROUNDING = 1e-4
"""Without noise, errors below this are rounding and differ from one machine to the next."""


def scaling_section(near: Experiment, best: Experiment) -> str:
    """Write the section on column scaling."""
    rows = []
    for title, subject in (("I, A", near), ("II, C", best)):
        for percentage in (0.0, 1.0):
            phasor = subject.noisy(percentage, 0)
            for method in get_args(RegressionMethod):
                errors = [
                    subject.error(regression(subject, phasor, scaling=scaling, method=method).values) for scaling in SCALINGS
                ]
                shown = [float(one.max()) for one in errors]
                cells = [percent(one) if one > ROUNDING else decade(one) for one in shown]
                rows.append([title, f"{percentage:g} %", method, *cells])
    return paragraphs(
        "### What column scaling does (Figure 2.5)",
        prose("""
        Largest error, seed 0. *Inverse* is Eq. 2.16 literally, *orthogonal* uses the singular values of A,
        *pseudo-inverse* is that of AᵀA with the usual cut-off at its size times the machine's precision.
        """),
        table(["method, case", "noise", "solver", "unscaled", "thesis scaling", "norm scaling"], rows),
        prose("""
        Scaling does not change a least-squares solution, and the inverse of Eq. 2.16 does not even mind the rounding,
        condition number 1e20 or not: Gaussian elimination is insensitive to the scale of the columns. With noise,
        inverse and orthogonal solution agree in every digit shown, scaled or not. Only a pseudo-inverse, which cuts
        off what it takes for zero, needs scaling, and more than the thesis's. An improvement such as the 20 % of
        Figure 2.5 says that the solver cut something off, not that the data held more information.
        """),
    )


def tikhonov_section(subjects: dict[RigidCase, Experiment]) -> str:
    """Write the section on Tikhonov regularisation."""
    rules: tuple[RegularisationRule | None, ...] = (None, *get_args(RegularisationRule))
    factor = 1.0 + np.random.default_rng(99).uniform(-EXPECTED_SPAN, EXPECTED_SPAN, len(names()))
    rows = []
    for method, name, noise in (("I", "A", 1.0), ("I", "A", 5.0), ("II", "A", 1.0), ("II", "A", 5.0), ("II", "C", 5.0)):
        subject = subjects[case(method, name)]
        for scaling in SCALINGS:
            expected = subject.rigid.values * factor
            choices = [*((rule, None) for rule in rules), *((rule, expected) for rule in rules[1:])]
            cells = [median_and_worst(_tikhonov_errors(subject, noise, scaling, rule, towards)) for rule, towards in choices]
            rows.append([f"{method}, {name}", f"{noise:g} %", scaling, *cells])
    guess = percent(float(np.median(np.abs(factor - 1)))), percent(float(np.max(np.abs(factor - 1))))
    return paragraphs(
        "### Tikhonov regularisation (§6.5)",
        prose(f"""
        The thesis leaves it to the future. λ is chosen by generalised cross-validation (GCV) or at the corner of the
        L-curve, on the scaled columns; the unknowns are drawn towards zero, or towards expected values that are wrong
        by up to ± {100 * EXPECTED_SPAN:.0f} % (seed 99; median {guess[0]}, largest {guess[1]}). Median over
        parameters / median over seeds 0 to {TIKHONOV_SEEDS - 1} of the largest error.
        """),
        table(
            ["method, case", "noise", "scaling", "none", "GCV", "L-curve", "GCV, expected values", "L-curve, expected values"],
            rows,
        ),
        prose("""
        It does not rescue the ill-conditioned cases. Drawn towards zero, both rules take up to two fifths off the
        median error and leave the largest at hundreds or thousands of per cent. Expected values help more, but what
        comes out is hardly better than what went in: at best a median of 7 to 9 % where the expected values
        themselves have 7.6 %, with a largest error of 130 to 260 % where they have 19 %. Believing them without any
        measurement would have served better. In the well-conditioned Case C cross-validation rightly changes nothing;
        the L-curve can do harm there, most where the columns are not scaled by their norm. Regularisation hides a
        lack of information and does not replace it; this project's fit uses a weak prior and says which parameters
        the data leave open.
        """),
    )


def _tikhonov_errors(
    subject: Experiment, noise: float, scaling: Scaling, rule: RegularisationRule | None, expected: Floats | None
) -> Floats:
    return np.array(
        [
            subject.error(
                regression(subject, subject.noisy(noise, seed), scaling=scaling, tikhonov=rule, expected=expected).values
            )
            for seed in range(TIKHONOV_SEEDS)
        ]
    )
