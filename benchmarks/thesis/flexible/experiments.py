"""The flexible train of the thesis's Chapters 3 and 4 for the evidence: its cases, its data, and how an estimate is judged."""

import copy
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import yaml
from msgspec.structs import replace

from benchmarks.documents import Document
from benchmarks.thesis.tables import percent, short_name, table, worst_of_seeds
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.fit.identify import identify, identify_train
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import sensitivity
from estimator.thesis.flexible_train import FlexibleTrain, flexible_train, full_response, parts
from estimator.thesis.noise import Sharing, multiplicative_noise
from estimator.thesis.reduced_model import ReducedModel, ResponseEquations, response_equations
from estimator.thesis.regression import RegressionMethod, Scaling, Solution, solve
from estimator.thesis.response_regression import real_names, speed_independent_regression

Placement = Literal["everywhere", "matrix only"]
"""Place of the noise in a regression: matrix and right-hand side, as with measured phasors, or the matrix alone."""

ROOT = Path(__file__).parents[3]
NOISE = (1, 5)
"""Noise levels of the thesis's tables [%]."""
SEEDS = range(10)
LIKELIHOOD_SEEDS = range(5)
START_SPAN = 0.5
"""The maximum-likelihood fits start from documents whose coefficients are off by a factor uniform in 1 ± this."""
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "k_phix", "k_phiy")
SINGULAR = 1e-13
"""A scaled matrix whose smallest singular value is below this part of the largest determines nothing in floating point."""


@dataclass(frozen=True)
class FlexibleCase:
    """One of the thesis's cases: at which speeds (S,) [rad/s] and in which directions (S,) the train is measured."""

    method: Literal["I", "II"]
    name: str
    speed: Floats
    direction: Floats

    @property
    def title(self) -> str:
        """Return the case's name in the tables."""
        return f"{self.method}, {self.name}"


@dataclass(frozen=True)
class Subject:
    """The train, the true coefficients (K,) and unbalances (P,), and the document it was made from."""

    document: Document
    machine: Machine
    train: FlexibleTrain
    coefficients: Floats
    unbalances: Complexes

    @property
    def truth(self) -> Floats:
        """Return the true K + 2P real unknowns."""
        return np.concatenate([self.coefficients, parts(self.unbalances)])

    @property
    def names(self) -> tuple[str, ...]:
        """Return the short names of the real unknowns: `B1 cxy`, `D2 U real`."""
        return tuple(short_name(name) for name in real_names(self.train.unknowns))

    def response(self, case: FlexibleCase) -> Complexes:
        """Return phasors (S, N) of the full model without noise."""
        return full_response(
            self.train,
            coefficients=self.coefficients,
            unbalances=self.unbalances,
            speed=case.speed,
            direction=case.direction,
        )


def load(change: Callable[[Document], None] | None = None) -> Subject:
    """Load the train of `examples/thesis-chapter-3.yaml`, its document changed first where asked."""
    document = yaml.safe_load((ROOT / "examples" / "thesis-chapter-3.yaml").read_text(encoding="utf-8"))
    if change is not None:
        change(document)
    machine = parse_machine(document)
    train = flexible_train(machine)
    return Subject(
        document=document,
        machine=machine,
        train=train,
        coefficients=np.array([one.nominal for one in train.unknowns.coefficients], dtype=float),
        unbalances=np.array([one.nominal for one in train.unknowns.unbalances], dtype=complex),
    )


def one_way(name: str, speed: Sequence[float] | Floats) -> FlexibleCase:
    """Return the case of Method I."""
    return FlexibleCase("I", name, np.asarray(speed, dtype=float), np.ones(len(speed)))


def both_ways(name: str, speed: Sequence[float] | Floats) -> FlexibleCase:
    """Return the case of Method II."""
    count = len(speed)
    return FlexibleCase("II", name, np.tile(np.asarray(speed, dtype=float), 2), np.repeat([1.0, -1.0], count))


def scaled_matrix(subject: Subject, model: ReducedModel, phasor: Complexes) -> Floats:
    """Return the regression matrix with columns of unit length."""
    problem = speed_independent_regression(
        response_equations(model, phasor), subject.train.unknowns, mean_speed=1.0, damping_scaled=False
    )
    return np.asarray(problem.matrix / np.linalg.norm(problem.matrix, axis=0))


def rank(matrix: Floats) -> int:
    """Return the number of unknowns that a matrix with columns of unit length determines in floating point."""
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.count_nonzero(values > SINGULAR * values[0]))


def regression(
    subject: Subject,
    model: ReducedModel,
    measured: Complexes,
    *,
    exact: Complexes | None = None,
    scaling: Scaling = "norm",
    method: RegressionMethod = "orthogonal",
    damping_scaled: bool = True,
) -> Solution:
    """Return the thesis's regression on measured phasors (S, n); the right-hand side from `exact` ones where these are
    given."""
    equations = response_equations(model, measured)
    if exact is not None:
        equations = ResponseEquations(equations.coefficient, equations.unbalance, response_equations(model, exact).target)
    problem = speed_independent_regression(
        equations, subject.train.unknowns, mean_speed=float(model.speed.mean()), damping_scaled=damping_scaled
    )
    return solve(problem, scaling=scaling, method=method)


def regression_errors(
    subject: Subject,
    model: ReducedModel,
    clean: Complexes,
    *,
    percent: float,
    seeds: Sequence[int] = SEEDS,
    sharing: Sharing = "none",
    placement: Placement = "everywhere",
    scaling: Scaling = "norm",
    method: RegressionMethod = "orthogonal",
    damping_scaled: bool = True,
) -> Floats:
    """Return the relative errors (seeds, K + 2P) of the regression under the thesis's noise."""
    found = []
    for seed in seeds:
        noisy = multiplicative_noise(clean, percent=percent, rng=np.random.default_rng(seed), sharing=sharing)
        exact = clean if placement == "matrix only" else None
        solution = regression(
            subject, model, noisy, exact=exact, scaling=scaling, method=method, damping_scaled=damping_scaled
        )
        found.append(np.abs(solution.values / subject.truth - 1.0))
    return np.array(found)


def bound(train: CondensedTrain, subject: Subject, *, rms: float) -> Floats | None:
    """Return the Cramér-Rao bound (K + 2P,), relative to the truth, for circular complex noise; None where it is infinite."""
    found = sensitivity(train, coefficients=subject.coefficients, excitations=subject.unbalances)
    phasor, slope = found.phasor, found.by_parameter
    weighted = (slope / (rms / math.sqrt(2) * np.abs(phasor))[..., None]).reshape(-1, slope.shape[-1])
    rows = np.concatenate([weighted.real, weighted.imag])
    size = np.linalg.norm(rows, axis=0)
    _, values, right = np.linalg.svd(rows / size, full_matrices=False)
    if rows.shape[0] < rows.shape[1] or values[-1] < SINGULAR * values[0]:
        return None
    error = np.sqrt(np.sum((right / values[:, None]) ** 2, axis=0)) / size
    return np.asarray(error / np.abs(subject.truth))


def bearings_only(subject: Subject, case: FlexibleCase) -> CondensedTrain:
    """Return the train as measured at the bearings' translations, exactly condensed."""
    return condense(subject.machine, speed=case.speed, direction=case.direction)


def all_interfaces(subject: Subject, case: FlexibleCase) -> CondensedTrain:
    """Return the train as measured at every degree of freedom of bearings and couplings, rotations included."""
    return _measured_everywhere(bearings_only(subject, case))


def _measured_everywhere(train: CondensedTrain) -> CondensedTrain:
    count = train.known.shape[1]
    channels = tuple(f"interface-{k}" for k in range(count))
    exact = np.zeros(count)
    return replace(train, output=np.eye(count), channels=channels, gain_spread=exact, run_out_spread=exact)


def likelihood(
    subject: Subject, case: FlexibleCase, phasor: Complexes, *, rms: float, seed: int, model_spread: float = 0.0
) -> Identification:
    """Fit phasors (S, 8) at the bearings by maximum likelihood, from a document whose coefficients are off by ± 50 %.

    model_spread: how far E and density may be off, relative rms; they are then estimated too.
    """
    document = wrong_document(subject.document, rms=rms, seed=seed)
    document["materials"]["steel"] |= {"young_modulus_spread": model_spread, "density_spread": model_spread}
    return identify(parse_machine(document), _measurement(case, phasor))


def likelihood_of_all(subject: Subject, case: FlexibleCase, phasor: Complexes, *, rms: float, seed: int) -> Identification:
    """Fit phasors (S, 16) of everything that `all_interfaces` measures by maximum likelihood."""
    machine = parse_machine(wrong_document(subject.document, rms=rms, seed=seed))
    train = _measured_everywhere(condense(machine, speed=case.speed, direction=case.direction))
    return identify_train(train, _measurement(case, phasor), noise=machine.noise)


def _measurement(case: FlexibleCase, phasor: Complexes) -> Measurement:
    return replace(Measurement.of(speed=case.speed, phasor=phasor), direction=case.direction)


def wrong_document(document: Document, *, rms: float, seed: int) -> Document:
    """Return the document with coefficients off by up to ± 50 %, without unbalances, with the noise's rms."""
    rng = np.random.default_rng(7000 + seed)
    changed = copy.deepcopy(document)
    for part in (*changed["bearings"], *changed["couplings"]):
        for name in COEFFICIENTS:
            if name in part:
                part[name] *= 1 + rng.uniform(-START_SPAN, START_SPAN)
    for disc in changed["discs"]:
        disc.pop("unbalance", None)
    changed["noise"] = {"relative": rms, "floor": 0.0}
    return changed


def estimated(subject: Subject, outcome: Identification) -> Floats:
    """Return the real unknowns (K + 2P,) of a fit, NaN where it says that the data do not determine a parameter."""
    by_name = {one.name: one for one in outcome.estimates}
    coefficients = [by_name[item.name].value for item in subject.train.unknowns.coefficients]
    planes = [by_name[plane.name] for plane in subject.train.unknowns.unbalances]
    parts_of_planes = [part for one in planes for part in (one.value, one.imaginary)]
    return np.array([math.nan if value is None else value for value in (*coefficients, *parts_of_planes)])


def likelihood_errors(subject: Subject, outcome: Identification) -> Floats:
    """Return the relative errors (K + 2P,), NaN where not estimable."""
    return np.abs(estimated(subject, outcome) / subject.truth - 1.0)


def experiment(subject: Subject, regressed: Solution, outcome: Identification | None) -> str:
    """Return one experiment parameter by parameter: the regression's estimates and, where there is a fit, the fit's."""
    header = ["parameter [SI]", "true", "regression", "error"]
    rows = [
        [name, f"{true:.5g}", f"{found:.5g}", percent(abs(found / true - 1))]
        for name, true, found in zip(subject.names, subject.truth, regressed.values, strict=True)
    ]
    if outcome is not None:
        header += ["maximum likelihood, bearings only", "error"]
        for row, value, error in zip(rows, estimated(subject, outcome), likelihood_errors(subject, outcome), strict=True):
            row += [f"{value:.5g}" if math.isfinite(value) else "not estimable", percent(float(error))]
    before, after = regressed.condition_number_before, regressed.condition_number_after
    lines = [table(header, rows), f"condition number: {before:.2e} before, {after:.2e} after column scaling"]
    if after > 1 / SINGULAR:
        lines.append("the equations do not determine the unknowns")
    return "\n\n".join(lines) + "\n"


def median_and_range(errors: Floats) -> str:
    """Return, of errors (seeds, parameters), the median over all, then each seed's largest error as `worst_of_seeds` shows
    it."""
    return f"{percent(float(np.nanmedian(errors)))} / {worst_of_seeds(errors)}"


def bound_text(found: Floats | None) -> str:
    """Return median and largest bound over parameters."""
    return "infinite" if found is None else f"{percent(float(np.median(found)))} / {percent(float(found.max()))}"
