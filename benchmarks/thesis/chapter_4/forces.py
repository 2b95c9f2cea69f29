"""Chapter 4: forces and moments that the coupling transmits."""

import numpy as np

from benchmarks.thesis.chapter_3.forces import FORCES, curve_errors, transmitted
from benchmarks.thesis.chapter_4.cases import CASES, high_frequency_model
from benchmarks.thesis.flexible.experiments import Subject, estimated, likelihood, one_way, regression
from benchmarks.thesis.plots import PlottedCurve, chart, save
from benchmarks.thesis.tables import percent, table
from estimator.thesis.noise import multiplicative_noise, multiplicative_rms


def forces_section(subject: Subject) -> str:
    """Write the section on misalignment forces."""
    case, best = one_way("curve", np.arange(2.0, 301.0, 2.0)), CASES[5]
    clean = subject.response(best)[:, subject.train.bearing]
    noisy = multiplicative_noise(clean, percent=5, rng=np.random.default_rng(0))
    regressed = regression(subject, high_frequency_model(subject, best), noisy).values
    outcome = likelihood(subject, best, noisy, rms=multiplicative_rms(5), seed=0)
    curves = {
        "true": transmitted(subject, case, subject.truth),
        "high-frequency regression": transmitted(subject, case, regressed),
        "maximum likelihood": transmitted(subject, case, np.nan_to_num(estimated(subject, outcome))),
    }
    rows = [[name, *[percent(one) for one in curve_errors(curves, k)]] for k, name in enumerate(FORCES)]
    series = [PlottedCurve(name, case.speed.tolist(), np.abs(curve[:, 0]).tolist()) for name, curve in curves.items()]
    svg = chart(
        title="Force along x that the coupling transmits, found from the bearings alone",
        x_label="speed [rad/s]",
        y_label="|F_x| [N]",
        series=series,
        logarithmic=True,
    )
    return (
        "### Misalignment forces and moments over speed (Fig. 4.21)\n\n"
        "Rms error over 2 to 300 rad/s of what the coupling transmits, from parameters estimated on the full model's data "
        "at the "
        "bearings, Case C_fb3 of Method II, 5 % noise, seed 0; displacements at the coupling from the model with these "
        "parameters.\n\n"
        + table(["", *list(curves)[1:]], rows)
        + f"\n\n![Force along x over speed]({save('chapter-4-coupling-force', svg)})"
    )
