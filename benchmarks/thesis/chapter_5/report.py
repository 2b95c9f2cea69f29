"""Chapter 5 of the thesis: the laboratory rig, aligned and misaligned, with Appendices C and E.

python -m benchmarks.thesis chapter-5 [--speeds printed|resonances|run-up] [--case A1|A2|B1|B2|C1|C2] [--seed 0]
"""

import argparse

import numpy as np

from benchmarks.thesis.chapter_5 import mode_shapes
from benchmarks.thesis.chapter_5.geometry import geometry_section
from benchmarks.thesis.chapter_5.identification import directions_section, fits_section
from benchmarks.thesis.chapter_5.misalignment import misalignment_section, plain, printed_factors
from benchmarks.thesis.chapter_5.natural_frequencies import impact_tests_section, natural_frequencies_section
from benchmarks.thesis.chapter_5.response import half_power_section, printed_response_section
from benchmarks.thesis.chapter_5.rig import CAMPAIGNS, fitted, load
from benchmarks.thesis.chapter_5.signals import signals_section
from benchmarks.thesis.tables import table
from estimator.thesis.rig import CASES


def section() -> str:
    """Return the chapter's part of the evidence page."""
    rig = load()
    parts_of_page = [
        "## Chapter 5: the laboratory rig",
        "Two shafts, a disc in the middle of each, four ball bearings in soft padding, one coupling; proximity probes at the "
        "four bearings. The measured data are not printed, except one channel (Table 5.3), so the rig is simulated: "
        "`examples/thesis-chapter-5-rig.yaml` says which of its numbers are printed and which were chosen to meet the printed "
        "natural frequencies. Noise is circular, 1 % of the amplitude, with or without a floor of 50 nm. Everything below on "
        "identification holds for this rig; another choice with the same natural frequencies has the same difficulty, since "
        "it comes from where the speeds lie.",
        geometry_section(rig),
        half_power_section(rig),
        printed_response_section(rig),
        directions_section(rig),
        fits_section(rig),
        misalignment_section(rig),
        natural_frequencies_section(rig),
        mode_shapes.section(rig),
        impact_tests_section(rig),
        signals_section(),
    ]
    return "\n\n".join(parts_of_page) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `python -m benchmarks.thesis chapter-5`."""
    parser.add_argument("--speeds", choices=sorted(CAMPAIGNS), default="run-up", help="where to measure, default run-up")
    cases = [plain(case) for case in CASES]
    parser.add_argument("--case", choices=cases, default=None, help="misalignment of Table 5.4, default none")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")


def run(arguments: argparse.Namespace) -> str:
    """Return one maximum-likelihood fit of the rig, parameter by parameter."""
    rig = load()
    campaign = CAMPAIGNS[arguments.speeds]
    chosen = [case for case in CASES if plain(case) == arguments.case]
    factors = printed_factors(rig, chosen[0]) if chosen else np.ones_like(rig.coefficients)
    outcome = fitted(rig, campaign, seed=arguments.seed, factors=factors)
    truth = [*(rig.coefficients * factors), *rig.unbalances]
    rows = []
    for one, true in zip(outcome.estimates, truth, strict=True):
        shown = f"{true.real:.4g}" if one.imaginary is None and one.quantity != "unbalance" else f"{true:.4g}"
        if one.value is None or one.standard_error is None:
            rows.append([one.name, shown, "-", one.reason or "-"])
        else:
            value = f"{one.value:.4g}" if one.imaginary is None else f"{complex(one.value, one.imaginary):.4g}"
            rows.append([one.name, shown, value, f"{one.standard_error:.2g}"])
    return table(["parameter [SI]", "true", "estimated", "standard error"], rows) + f"\n\n{outcome.verdict}"
