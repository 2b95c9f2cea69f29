"""Chapter 2, §2.4: unbalances of Tables 2.9 and 2.10."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.thesis.chapter_2.experiments import SEEDS, bound, case, experiment, likelihood, likelihood_values, regression
from benchmarks.thesis.chapter_2.printed import TABLE_2_9, TABLE_2_10
from benchmarks.thesis.tables import PrintedUnbalance, paragraphs, percent, prose, table
from estimator.arrays import Complexes, Floats
from estimator.thesis.noise import multiplicative_rms
from estimator.thesis.rigid_train import RigidTrain, printed_train, unbalances_of

UNBALANCE = slice(42, 50)


def unbalances_section() -> str:
    """Write the section on unbalances."""
    rows = []
    for line, (assumed, estimated) in enumerate(TABLE_2_9, start=1):
        rigid = replace(printed_train(), unbalances=_unbalances_of(assumed))
        rows.append([f"Table 2.9, line {line}", *_unbalance_errors(rigid, assumed, estimated)])
    assumed = TABLE_2_9[0][0]
    for line, (masses, estimated) in enumerate(TABLE_2_10, start=1):
        rigid = replace(printed_train(), unbalances=_unbalances_of(assumed), disc_mass=masses)
        rows.append([f"Table 2.10, set {line}", *_unbalance_errors(rigid, assumed, estimated)])
    return paragraphs(
        "### Unbalances: Tables 2.9 and 2.10",
        f"Method II, Case C, 5 % noise; largest of the four planes, here the median over seeds 0 to {SEEDS - 1}.",
        table(
            [
                "",
                "printed: magnitude",
                "angle",
                "regression: magnitude",
                "angle",
                "maximum likelihood: magnitude",
                "angle",
                "Cramér-Rao bound: magnitude",
                "angle",
            ],
            rows,
        ),
        prose("""
        Here the print is *worse* than the regression, and one-sided: no printed magnitude and no printed angle is too
        small. That is a bias and not noise.
        """),
    )


def _unbalance_errors(
    rigid: RigidTrain, assumed: Sequence[PrintedUnbalance], estimated: Sequence[PrintedUnbalance]
) -> list[str]:
    subject = experiment(case("II", "C"), rigid)
    true = rigid.unbalances
    found = [complex_unbalances(regression(subject, subject.noisy(5.0, seed)).values[UNBALANCE]) for seed in range(SEEDS)]
    smallest = bound(subject, rms=multiplicative_rms(5.0))[UNBALANCE] * np.abs(rigid.values[UNBALANCE])
    # Real and imaginary part of an unbalance are equally uncertain under circular noise.
    spread = np.sqrt(np.mean(smallest.reshape(-1, 2) ** 2, axis=1)) / np.abs(true)
    printed = _unbalances_of(estimated) / _unbalances_of(assumed)
    rms = multiplicative_rms(5.0)
    fits = [likelihood(subject, subject.noisy(5.0, seed), rms=rms, seed=seed) for seed in range(SEEDS)]
    fitted = [complex_unbalances(likelihood_values(one)[UNBALANCE]) for one in fits]
    return [
        percent(float(np.max(np.abs(np.abs(printed) - 1)))),
        f"{np.max(np.abs(np.angle(printed, deg=True))):.1f}°",
        *_median_plane_errors(found, true),
        *_median_plane_errors(fitted, true),
        percent(float(spread.max())),
        f"{np.rad2deg(spread.max()):.2f}°",
    ]


def _median_plane_errors(found: Sequence[Complexes], true: Complexes) -> tuple[str, str]:
    """Return the largest error of the planes in magnitude and angle, median over the estimates."""
    magnitude = np.median([np.max(np.abs(np.abs(one / true) - 1)) for one in found])
    angle = np.median([np.max(np.abs(np.angle(one / true, deg=True))) for one in found])
    return percent(float(magnitude)), f"{angle:.2f}°"


def _unbalances_of(planes: Sequence[PrintedUnbalance]) -> Complexes:
    return unbalances_of(tuple(plane[0] for plane in planes), tuple(plane[1] for plane in planes))


def complex_unbalances(parts: Floats) -> Complexes:
    """Return unbalances as complex numbers, from their real and imaginary parts in turn."""
    return np.asarray(parts[::2] + 1j * parts[1::2])
