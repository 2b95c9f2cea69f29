"""§6.5 of the thesis, its future work: what a document may hold beyond the thesis's model, identified in simulated runs."""

import argparse
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.thesis.future_work.trains import FEATURES, INTERNAL_DAMPING, NOMINAL_ERROR, RMS, Feature, plain, true_point
from benchmarks.thesis.tables import paragraphs, percent, prose, table
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe, is_direct
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response, sensitivity

SPEED: Floats = np.arange(20.0, 500.0, 3.0)
"""[rad/s]"""
SEED = 0
SEEDS = range(5)
"""Seeds of the summary."""
PROFILE = (0.5, 1.0, 1.5)
"""Internal damping that documents state, over the true one."""
STEP = 1e-3
"""Relative step in internal damping for its derivative."""


@dataclass(frozen=True)
class SimulatedRun:
    """A simulated run, and what the smallest standard errors of any unbiased estimate from it are.

    phasor: (S, m) without noise [m]. names, truth, bound: (n,) fit coordinates, their true values, Cramér-Rao bounds;
    of direct terms as logarithms, internal damping known. internal_damping_bound: of β [s] with all else unknown; NaN for
    trains without.
    """

    phasor: Complexes
    names: tuple[str, ...]
    truth: Floats
    bound: Floats
    internal_damping_bound: float

    def measured(self, *, seed: int) -> Measurement:
        """Return the phasors with circular noise."""
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal(self.phasor.shape) + 1j * rng.standard_normal(self.phasor.shape)
        return Measurement.of(speed=SPEED, phasor=self.phasor * (1.0 + RMS / math.sqrt(2.0) * noise), direction=1)


def simulated(feature: Feature) -> SimulatedRun:
    """Return the train with a feature, at its true parameters, with the bound of the information matrix there."""
    machine = feature.machine()
    clean, slope, names, truth = _response(machine, feature.truth)
    if machine.materials["steel"].internal_damping > 0.0:
        low, high = (_response(feature.machine(factor=1.0 + step), feature.truth)[0] for step in (-STEP, STEP))
        slope = np.concatenate([slope, ((high - low) / (2.0 * STEP * INTERNAL_DAMPING))[None]])
    # The information that the size of the noise carries by itself is left out, as the fit leaves it out.
    rows = (slope / (RMS * np.abs(clean))).reshape(len(slope), -1)
    information = 2.0 * (rows @ rows.conj().T).real
    free = len(names)
    damping = float(_bounds(information)[-1]) if len(information) > free else math.nan
    return SimulatedRun(clean, names, truth, _bounds(information[:free, :free]), damping)


def _bounds(information: Floats) -> Floats:
    """Return the Cramér-Rao bounds (n,) of an information matrix (n, n)."""
    size = np.sqrt(np.diag(information))
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information / np.outer(size, size)))) / size)


def _response(machine: Machine, truth: Mapping[str, complex]) -> tuple[Complexes, Complexes, tuple[str, ...], Floats]:
    """Return the phasors (S, m), their derivatives (n, S, m) by the fit coordinates, names and true values (n,) of these."""
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    by_name = true_point(machine, coordinates.names, truth)
    point = np.array([by_name[name] for name in coordinates.names])
    theta = coordinates.theta(point)
    coefficients, excitations = coordinates.coefficients(theta), coordinates.excitations(theta)
    found = sensitivity(train, coefficients=coefficients, excitations=excitations)
    slope = phasor_jacobian(
        coordinates, theta, found, coefficients=coefficients, direction=train.direction, block=slice(0, SPEED.size)
    )
    clean = response(train, coefficients=coefficients, excitations=excitations)
    return clean, slope / coordinates.unit[:, None, None], coordinates.names, point


def identified(feature: Feature, measurement: Measurement) -> Identification:
    """Identify with a document that has the feature, and states its own coefficients wrongly."""
    factor = 1.0 if feature is FEATURES["internal-damping"] else NOMINAL_ERROR
    return identify(feature.machine(factor=factor), measurement)


def without_feature(measurement: Measurement) -> Identification:
    """Identify with the document that has no such feature; channels that it does not have are left out."""
    machine = plain()
    phasor = measurement.phasor[:, : len(machine.probes)]
    return identify(machine, Measurement.of(speed=SPEED, phasor=phasor, direction=1), Options(starts=1))


def bearing_errors(found: Identification, simulation: SimulatedRun, feature: Feature) -> tuple[float, float]:
    """Return the largest relative error of kxx and kyy, and largest error of any coefficient over its Cramér-Rao bound, of
    bearings.

    Those of the feature's own element are left out.
    """
    place = {name: k for k, name in enumerate(simulation.names)}
    others = [
        (name, k, place[name])
        for k, name in enumerate(found.coordinates)
        if describe(name).element_kind == "bearing" and describe(name).element != feature.element
    ]
    errors = {name: found.point[k] - simulation.truth[i] for name, k, i in others}
    stiffness = [abs(math.expm1(error)) for name, error in errors.items() if describe(name).quantity in ("kxx", "kyy")]
    return max(stiffness), max(abs(errors[name]) / simulation.bound[i] for name, _, i in others)


def internal_damping(measurement: Measurement) -> tuple[float, float]:
    """Estimate and standard error [s] from the profile of χ²: a parabola through fits by three documents."""
    feature = FEATURES["internal-damping"]
    chi_square = [identify(feature.machine(factor=one), measurement).chi_square for one in PROFILE]
    curvature, slope, _ = np.polyfit(PROFILE, chi_square, 2)
    # χ² rises by 1 at one standard error.
    return float(-slope / (2.0 * curvature)) * INTERNAL_DAMPING, float(1.0 / math.sqrt(curvature)) * INTERNAL_DAMPING


def section() -> str:
    """Return the last part of the evidence page."""
    return (
        paragraphs(
            "## §6.5: what the thesis leaves to future work",
            prose(f"""
                The thesis ends with what its model lacks. A machine document may hold it, and an identification finds it.
                Tikhonov's regularisation is compared in Chapter 2 above, the regression's own form of speed-dependent
                coefficients (Eq. 4.66-4.70) in Chapter 4. Here is the rest, each on the same small train: two shafts of
                0.8 m, four bearings, a coupling that is soft in bending and has heavy halves, probes x and y at the bearings
                and at both halves (and at the seal), {SPEED.size} speeds from {SPEED[0]:g} to {SPEED[-1]:g} rad/s in one
                sense of rotation, 1 % circular noise, seed {SEED}. The data come from this project's model at the true values;
                that it is right is asked in the tests, against dense solves of the equations of motion written down
                independently. The document states the coefficients of seals and of the coupling's further terms
                {percent(NOMINAL_ERROR - 1)} too large; of bows and loads it only says how large they may be. All coefficients
                and unbalances of the train are unknown beside those shown.

                The bound is that of the information matrix at the true values, all unknowns free, without any prior. Below
                it stand the fit's own verdict, and that of the document without the feature on the same data, from one start;
                and what each makes of the bearings (those that the feature itself changes left out).

                Of the thesis's list these are not in the model: terms between translation and rotation in bearings,
                coupling parameters that vary within a turn, cracks, and particular kinds of coupling.
                """),
            summary(),
            *(part(name, seed=SEED) for name in FEATURES),
        )
        + "\n"
    )


def summary() -> str:
    """Return all unknowns of each train over some seeds: χ²/dof and errors over their bounds."""
    rows = []
    for feature in FEATURES.values():
        simulation = simulated(feature)
        found = [identified(feature, simulation.measured(seed=seed)) for seed in SEEDS]
        fit = np.mean([one.chi_square / one.degrees_of_freedom for one in found])
        errors = np.array([one.point - simulation.truth for one in found]) / simulation.bound
        accepted = sum(one.accepted for one in found)
        size, largest = np.sqrt(np.mean(errors**2)), np.abs(errors).max()
        rows.append(
            [
                feature.title,
                str(len(simulation.names)),
                f"{accepted} of {len(found)}",
                f"{fit:.3f}",
                f"{size:.2f}",
                f"{largest:.1f}",
            ]
        )
    header = ["train with", "unknowns", "accepted", "mean χ²/dof", "rms error over the bound", "largest"]
    return paragraphs(
        f"All unknowns of each train together, bearings and unbalances too, seeds {SEEDS[0]} to {SEEDS[-1]}:",
        table(header, rows),
    )


def part(name: str, *, seed: int) -> str:
    """Return the part on one feature: table, test of fit, and the results without it."""
    feature = FEATURES[name]
    simulation = simulated(feature)
    measurement = simulation.measured(seed=seed)
    found, lacking = identified(feature, measurement), without_feature(measurement)
    rows = _rows(feature, simulation, found) or [_internal_damping_row(simulation, measurement)]
    return paragraphs(
        f"### {feature.title}",
        table(["parameter", "true", "estimate", "standard error", "Cramér-Rao bound", "error / standard error"], rows),
        table(
            ["document", "verdict", "largest error of bearings' kxx, kyy", "of any bearing coefficient, over its bound"],
            [
                _judged("with it", found, simulation, feature),
                _judged("without it", lacking, simulation, feature),
            ],
        ),
        *([INTERNAL_DAMPING_REMARK] if name == "internal-damping" else []),
    )


INTERNAL_DAMPING_REMARK = prose("""
    Internal damping is a given of the document, not one of its unknowns. The estimate here is from the profile of χ² over
    three documents that state half, all and one and a half of it. In circular forward whirl a shaft keeps its bend and
    feels none of it; what is found comes from the backward part that unequal bearings add. Left out of the document, so
    little of it is hard to see in χ²: whether the fit is refused depends on the noise, while the damping and the cross-coupled
    terms of the bearings take it over, by many of their standard errors.
    """)


def _judged(document: str, found: Identification, simulation: SimulatedRun, feature: Feature) -> list[str]:
    stiffness, deviation = bearing_errors(found, simulation, feature)
    return [document, found.verdict, percent(stiffness), f"{deviation:.2g}"]


def _rows(feature: Feature, simulation: SimulatedRun, found: Identification) -> list[list[str]]:
    truth = dict(zip(simulation.names, simulation.truth.tolist(), strict=True))
    bound = dict(zip(simulation.names, simulation.bound.tolist(), strict=True))
    rows = []
    for name, value in feature.truth.items():
        one = found.estimate(name)
        if name in truth:
            scale = math.exp(truth[name]) if is_direct(name) else 1.0
            rows.append(_row(f"{name} [{one.unit}]", value.real, one.value, one.standard_error, scale * bound[name]))
        else:
            rows += [
                _row(f"{name} real [{one.unit}]", value.real, one.value, one.standard_error, bound[f"{name}.real"]),
                _row(
                    f"{name} imaginary [{one.unit}]",
                    value.imag,
                    one.imaginary,
                    one.imaginary_standard_error,
                    bound[f"{name}.imaginary"],
                ),
            ]
    return rows


def _row(label: str, true: float, estimate: float | None, error: float | None, bound: float) -> list[str]:
    if estimate is None or error is None:
        return [label, f"{true:.4g}", "not estimable", "-", f"{bound:.2g}", "-"]
    return [label, f"{true:.4g}", f"{estimate:.4g}", f"{error:.2g}", f"{bound:.2g}", f"{(estimate - true) / error:+.1f}"]


def _internal_damping_row(simulation: SimulatedRun, measurement: Measurement) -> list[str]:
    estimate, error = internal_damping(measurement)
    return _row("internal damping of steel [s]", INTERNAL_DAMPING, estimate, error, simulation.internal_damping_bound)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `python -m benchmarks.thesis future-work`."""
    parser.add_argument("--feature", choices=tuple(FEATURES), help="one of them, by default all")
    parser.add_argument("--seed", type=int, default=SEED, help=f"of the noise, default {SEED}")


def run(arguments: argparse.Namespace) -> str:
    """Return the part on one feature, or on all."""
    names = [arguments.feature] if arguments.feature else list(FEATURES)
    return paragraphs(*(part(name, seed=arguments.seed) for name in names))
