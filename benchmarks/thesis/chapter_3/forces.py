"""Chapter 3: forces and moments that the coupling transmits."""

import numpy as np

from benchmarks.thesis.chapter_3.cases import BEST, measured
from benchmarks.thesis.flexible.experiments import FlexibleCase, Subject, estimated, likelihood, one_way, regression
from benchmarks.thesis.plots import PlottedCurve, chart, save
from benchmarks.thesis.tables import percent, table
from estimator.arrays import Complexes, Floats
from estimator.thesis.coupling_force import coupling_force
from estimator.thesis.flexible_train import full_response
from estimator.thesis.noise import multiplicative_noise, multiplicative_rms

FORCES = ("F_x [N]", "F_y [N]", "M_x [N m]", "M_y [N m]")


def forces_section(subject: Subject) -> str:
    """Write the section on misalignment forces."""
    case = one_way("curve", np.arange(2.0, 301.0, 2.0))
    model, clean = measured(subject, BEST)
    noisy = multiplicative_noise(clean, percent=5, rng=np.random.default_rng(0))
    regressed = regression(subject, model, noisy).values
    outcome = likelihood(subject, BEST, noisy[:, : subject.train.bearing.size], rms=multiplicative_rms(5), seed=0)
    curves = {
        "true": transmitted(subject, case, subject.truth),
        "regression": transmitted(subject, case, regressed),
        "maximum likelihood": transmitted(subject, case, np.nan_to_num(estimated(subject, outcome))),
    }
    rows = []
    for k, name in enumerate(FORCES):
        peaks = [np.abs(curve[:, k]) for curve in curves.values()]
        shown = [f"{size.max():.4g} at {case.speed[size.argmax()]:.0f}" for size in peaks]
        rows.append([name, *shown, *[percent(one) for one in curve_errors(curves, k)]])
    series = [PlottedCurve(name, case.speed.tolist(), np.abs(curve[:, 0]).tolist()) for name, curve in curves.items()]
    svg = chart(title="Force along x that the coupling transmits", x_label="speed [rad/s]", y_label="|F_x| [N]", series=series)
    return (
        "### Misalignment forces and moments over speed (Fig. 3.24)\n\n"
        "What the coupling transmits (Eq. 2.12), from parameters estimated at 5 % noise, Case C of Method II, seed 0 "
        "(regression: "
        "16 channels, maximum likelihood: 8), with the displacements of the model that has these parameters: largest "
        "value and its "
        "speed [rad/s], and the rms error of the curve over 2 to 300 rad/s.\n\n"
        + table(["", *curves, "rms error, regression", "rms error, maximum likelihood"], rows)
        + f"\n\n![Force along x over speed]({save('chapter-3-coupling-force', svg)})\n\n"
        "The thesis's figure is not in its text. As it says, the forces peak at the critical speeds: they are the elastic "
        "and "
        "viscous reaction to the unbalance response. They say nothing of a static misalignment, which is no unknown of this "
        "model."
    )


def curve_errors(curves: dict[str, Complexes], column: int) -> list[float]:
    """Return the rms error of each curve's column but the first's, over the rms of the first, which is the true one."""
    true, *others = [curve[:, column] for curve in curves.values()]
    return [float(np.linalg.norm(other - true) / np.linalg.norm(true)) for other in others]


def transmitted(subject: Subject, case: FlexibleCase, unknowns: Floats) -> Complexes:
    """Return forces and moments (S, 4) that the coupling transmits, for real unknowns (K + 2P,)."""
    count = subject.coefficients.size
    coefficients, planes = unknowns[:count], unknowns[count:]
    displacement = full_response(
        subject.train,
        coefficients=coefficients,
        unbalances=planes[::2] + 1j * planes[1::2],
        speed=case.speed,
        direction=case.direction,
    )
    return coupling_force(
        subject.train,
        coupling=0,
        coefficients=coefficients,
        displacement=displacement[:, subject.train.coupling],
        speed=case.speed,
    )
