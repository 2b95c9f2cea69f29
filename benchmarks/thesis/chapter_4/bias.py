"""Chapter 4, §4.5: bias of the shaft's material."""

from dataclasses import dataclass

import numpy as np

from benchmarks.documents import Document
from benchmarks.thesis.chapter_4.cases import CASES, clean_phasors, high_frequency_model
from benchmarks.thesis.flexible.experiments import (
    LIKELIHOOD_SEEDS,
    FlexibleCase,
    Subject,
    likelihood,
    likelihood_errors,
    load,
    median_and_range,
    regression,
)
from benchmarks.thesis.flexible.printed import TABLE_4_3
from benchmarks.thesis.tables import median_and_worst, table
from estimator.arrays import Complexes
from estimator.thesis.noise import multiplicative_noise, multiplicative_rms
from estimator.thesis.reduction import high_frequency_condensed

BIAS = 0.05
"""Relative bias of E and of the density (§4.5)."""


@dataclass(frozen=True)
class Biased:
    """A model whose E and density are off by factors, and what is said of it."""

    title: str
    modulus: float
    density: float

    def apply(self, document: Document) -> None:
        """Multiply E and density of the steel in a document by the factors."""
        steel = document["materials"]["steel"]
        steel["young_modulus"] *= self.modulus
        steel["density"] *= self.density


BIASES = (
    Biased("E +5 %", 1 + BIAS, 1.0),
    Biased("ρ +5 %", 1.0, 1 + BIAS),
    Biased("E +5 %, ρ +5 %", 1 + BIAS, 1 + BIAS),
    Biased("E -5 %, ρ +5 %", 1 - BIAS, 1 + BIAS),
)


def bias_section(subject: Subject) -> str:
    """Write the section on a biased material."""
    rows = []
    for biased in BIASES:
        wrong = load(biased.apply)
        for case in (CASES[2], CASES[5]):
            model = high_frequency_condensed(wrong.train, speed=case.speed, direction=case.direction)
            own = clean_phasors(subject, case, high_frequency_model(subject, case), "own")
            regressed = np.abs(regression(subject, model, own).values / subject.truth - 1)
            clean = subject.response(case)[:, subject.train.bearing]
            fitted = _biased_fit(subject, wrong, case, clean)
            rows.append([biased.title, case.title, median_and_worst(regressed[None]), *fitted])
    header = ["model", "method, case", "regression, own data, no noise"]
    header += ["maximum likelihood, 1 %", "its χ²/dof", "the same, E and ρ estimated too", "its χ²/dof"]
    printed = [TABLE_4_3[case.title] for case in (CASES[2], CASES[5])]
    return (
        "### A model that is wrong by 5 % (Table 4.3, Fig. 4.20)\n\n"
        "Median / largest error. Printed, largest error in Case C_fb3 at 1 % and 5 % noise: "
        f"{printed[0][4]:.0f} % and {printed[0][5]:.0f} % (Method I), {printed[1][4]:.0f} % and {printed[1][5]:.0f} % "
        f"(Method II); "
        "whether E and density were off together, and which way, is not said. The last columns give the fit scale factors "
        "on E and ρ "
        "as further unknowns, believed to within 5 % rms.\n\n" + table(header, rows)
    )


def _biased_fit(subject: Subject, wrong: Subject, case: FlexibleCase, clean: Complexes) -> list[str]:
    rms = multiplicative_rms(1)
    cells = []
    for model_spread in (0.0, BIAS):
        found, misfit = [], []
        for seed in LIKELIHOOD_SEEDS:
            noisy = multiplicative_noise(clean, percent=1, rng=np.random.default_rng(seed))
            outcome = likelihood(wrong, case, noisy, rms=rms, seed=seed, model_spread=model_spread)
            found.append(likelihood_errors(subject, outcome))
            misfit.append(outcome.chi_square / outcome.degrees_of_freedom)
        cells += [median_and_range(np.array(found)), f"{np.median(misfit):.3g}"]
    return cells
