"""Field balancing: printed cases of the literature against their published corrections.

Printed inputs are rounded, and so are the corrections: where a correction lies farther than 2 % from the published one, it
must be what the printed inputs give (solved here once more by other means), and leave no more than the published one does.
"""

import numpy as np
from scipy.optimize import NonlinearConstraint, minimize

from benchmarks.calibration.measured_kit import HeldOutUnbalances, held_out, runs_with_scatter, simulated_runs
from benchmarks.calibration.printed_balancing import PrintedCase, printed_cases
from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Complexes, Floats
from estimator.balancing.plane_separation import separate_planes

SIMULATED_SPLITS, SEEDS = 3, 8
NOISES = (0.1, 0.5, 1.0)
"""Noise of single points in simulated kits, in units of the measured kit's scatter [-]."""
ALLOWED = 0.02
"""Largest relative difference of a correction [-]."""


def printed_balancing() -> list[ReportLine]:
    """Return a line for each printed case."""
    return [_line(case) for case in printed_cases()]


def measured_kit(splits: int = 20) -> list[ReportLine]:
    """Return the lines of influence coefficients on the measured rotor kit, conditions held out in five folds."""
    found = held_out(splits)
    chi_square = float(np.mean(found.standardised**2))
    what = "measured kit, influence coefficients, five folds: "
    return [
        ReportLine(
            f"{what}rms magnitude, median phase",
            "≤ 4 g mm, 4°",
            f"{found.rms_magnitude:.1f} g mm, {found.median_phase:.1f}°",
            found.rms_magnitude <= 4.0 and found.median_phase <= 4.0,
        ),
        ReportLine(f"{what}95 % intervals", "90–100 %", f"{100 * found.coverage:.0f} %", found.coverage >= 0.9),
        ReportLine(f"{what}χ² of errors", "0.7–1.3", f"{chi_square:.2f}", 0.7 <= chi_square <= 1.3),
        *_simulated_kits(),
    ]


def _simulated_kits() -> list[ReportLine]:
    """Return the lines of kits that settle anew, with more or less noise of points, and of kits that scatter as it does."""
    settling = [held_out(SIMULATED_SPLITS, simulated_runs(seed, noise=noise)) for noise in NOISES for seed in range(SEEDS)]
    alike = [held_out(SIMULATED_SPLITS, runs_with_scatter(seed)) for seed in range(len(NOISES) * SEEDS)]
    return [*_interval_lines("that settle anew", settling), *_interval_lines("with the measured kit's scatter", alike)]


def _interval_lines(kind: str, found: list[HeldOutUnbalances]) -> list[ReportLine]:
    chi_square = float(np.mean(np.concatenate([one.standardised for one in found]) ** 2))
    covered = float(np.mean([one.coverage for one in found]))
    what = f"{len(found)} simulated kits {kind}, influence coefficients: "
    return [
        ReportLine(f"{what}χ² of errors", "0.7–1.3", f"{chi_square:.2f}", 0.7 <= chi_square <= 1.3),
        ReportLine(f"{what}95 % intervals", "90–100 %", f"{100 * covered:.0f} %", covered >= 0.9),
    ]


def _line(case: PrintedCase) -> ReportLine:
    what = f"printed case {case.name}, {case.criterion}: difference"
    separation = separate_planes(case.influence)
    if separation.left_out:
        told = f"{', '.join(separation.left_out)} told inseparable"
        return ReportLine(f"printed case {case.name}: planes that cannot be told apart", "named", told, True)
    published = _difference(case.correction, case.published)
    if published <= ALLOWED:
        return ReportLine(what, "≤ 2 %", f"{100 * published:.1f} %", True)
    own = _difference(case.correction, solved_otherwise(case))
    no_worse = case.objective(case.correction) <= case.objective(case.published)
    shown = f"{100 * published:.1f} %, inputs {100 * own:.2f} %"
    return ReportLine(what, "≤ 2 %", shown, own <= ALLOWED and no_worse)


def _difference(correction: Complexes, published: Complexes) -> float:
    return float(np.max(np.abs(correction - published) / np.abs(published)))


def solved_otherwise(case: PrintedCase) -> Complexes:
    """Return the correction that the printed inputs give, by normal equations or sequential quadratic programming."""
    matrix, offset = case.influence.influence, case.influence.offset
    if case.criterion == "least-squares":
        normal = np.conj(matrix).T @ matrix
        return np.asarray(np.linalg.solve(normal, -np.conj(matrix).T @ offset))
    planes = matrix.shape[1]

    def paired(x: Floats) -> Complexes:
        return np.asarray(x[:planes] + 1j * x[planes : 2 * planes])

    limits = np.full(planes, np.inf) if case.limit is None else case.limit
    room = [NonlinearConstraint(lambda x: x[-1] ** 2 - np.abs(offset + matrix @ paired(x)) ** 2, 0.0, np.inf)]
    if case.limit is not None:
        room.append(NonlinearConstraint(lambda x: limits**2 - np.abs(paired(x)) ** 2, 0.0, np.inf))
    begin = np.concatenate([case.published.real, case.published.imag, np.array([case.objective(case.published)])])

    def largest(x: Floats) -> float:
        return float(x[-1])

    found = minimize(
        largest, np.asarray(begin, dtype=float), constraints=room, method="SLSQP", options={"ftol": 1e-12, "maxiter": 500}
    )
    return paired(found.x)
