"""Chapter 4 of the thesis: flexible shafts, measured at the bearings only, by dynamic and high-frequency condensation.

python -m benchmarks.thesis chapter-4 [--method I|II] [--case A|B|C_fb1|C_fb2|C_fb3] [--noise 1] [--data full|own]
                                      [--sharing none] [--seed 0]
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from benchmarks.thesis.chapter_3 import FORCES, curve_errors, transmitted
from benchmarks.thesis.flexible import (
    LIKELIHOOD_SEEDS,
    NOISE,
    SEEDS,
    Case,
    Complexes,
    Document,
    Floats,
    Placement,
    Subject,
    bearings_only,
    both_ways,
    bound,
    bound_text,
    estimated,
    experiment,
    likelihood,
    likelihood_errors,
    load,
    median_and_range,
    one_way,
    regression,
    regression_errors,
)
from benchmarks.thesis.flexible_misprints import with_printed_rotary_inertia
from benchmarks.thesis.flexible_printed import TABLE_4_2, TABLE_4_3
from benchmarks.thesis.plots import Series, chart, save
from benchmarks.thesis.tables import median_and_worst, percent, power, table, worst_of_seeds
from estimator.thesis.flexible_train import Indices, parts
from estimator.thesis.noise import Sharing, complex_noise, multiplicative_noise, multiplicative_rms
from estimator.thesis.reduced_model import ReducedModel, reduced_response, response_equations
from estimator.thesis.reduction import (
    dynamic_masters,
    dynamically_condensed,
    eliminated,
    high_frequency_condensed,
    high_frequency_transformation,
)
from estimator.thesis.regression import solve
from estimator.thesis.response_regression import speed_dependent_regression, with_trial_unbalances

LOWER, UPPER = np.arange(150.0, 175.1, 0.5), np.arange(275.0, 300.1, 0.5)
"""The frequency bands of Case C [rad/s]."""
CASES = (
    one_way("A", [99, 109, 121, 136]),
    one_way("B", [54, 79, 159, 171]),
    one_way("C_fb3", np.concatenate([LOWER, UPPER])),
    both_ways("A", [121, 136]),
    both_ways("B", [159, 171]),
    both_ways("C_fb3", np.concatenate([LOWER[::2], UPPER[::2]])),
)
"""§4.5.1-4.5.2."""
BANDS = (one_way("C_fb1", LOWER), one_way("C_fb2", UPPER))
RUN_DOWN = one_way("2 to 300 rad/s", np.arange(2.0, 301.0, 2.0))
"""Not one of the thesis's cases: what a run-down gives."""
BIAS = 0.05
"""Relative bias of E and of the density (§4.5)."""
Data = Literal["own", "full"]
DATA: tuple[Data, Data] = ("own", "full")
"""Phasors from the same reduced model that the regression uses, or from the full model."""


def section() -> str:
    """The chapter's part of the evidence page."""
    subject = load()
    parts_of_page = [
        "## Chapter 4: measured at the bearings only",
        "The train of Chapter 3, measured in both translations at the four bearings (8 channels). The thesis condenses "
        "twice: "
        "dynamically to bearings, coupling and discs (24 degrees of freedom, Eq. 4.53), then by high-frequency "
        "condensation to "
        "the bearings (Eq. 4.57), and says that its data come from the full model (Eq. 4.42). E is read as 2.1×10¹¹ N/m², "
        "the "
        "printed 2.1×10⁹ being a slip. Critical speeds: as printed for Chapter 3, and as little reproduced.",
        _reductions(subject),
        _without_noise(subject),
        _worst(subject),
        _conditions(subject),
        _misprinted(with_printed_rotary_inertia(subject)),
        _likelihood(subject),
        _bias(subject),
        _speed_dependent(subject),
        _forces(subject),
    ]
    return "\n\n".join(parts_of_page) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of `python -m benchmarks.thesis chapter-4`."""
    parser.add_argument("--method", choices=("I", "II"), default="II", help="one or both senses of rotation, default II")
    parser.add_argument("--case", choices=("A", "B", "C_fb1", "C_fb2", "C_fb3"), default="C_fb3", help="default C_fb3")
    parser.add_argument("--noise", type=float, default=1.0, help="N of Eq. 2.20 [%%], default 1")
    parser.add_argument("--data", choices=DATA, default="full", help="of the reduced or the full model, default full")
    parser.add_argument("--scaling", choices=("none", "thesis", "norm"), default="norm", help="of columns, default norm")
    parser.add_argument("--sharing", choices=get_args(Sharing), default="none", help="phasors that share a random number")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")
    parser.add_argument(
        "--part",
        choices=sorted(PARTS),
        default=None,
        help="a part of the page instead of one experiment; other options are then unused",
    )


def run(arguments: argparse.Namespace) -> str:
    """One experiment, parameter by parameter, or a part of the page. Raises SystemExit for a case that is not there."""
    subject = load()
    if arguments.part is not None:
        return PARTS[arguments.part](subject)
    wanted = (arguments.method, arguments.case)
    cases = [case for case in (*CASES, *BANDS) if (case.method, case.name) == wanted]
    if not cases:
        raise SystemExit(f"the thesis has no Case {arguments.case} under Method {arguments.method}")
    model = high_frequency_condensed(subject.train, speed=cases[0].speed, direction=cases[0].direction)
    clean = _phasors(subject, cases[0], model, arguments.data)
    noisy = multiplicative_noise(
        clean, percent=arguments.noise, rng=np.random.default_rng(arguments.seed), sharing=arguments.sharing
    )
    solution = regression(subject, model, noisy, scaling=arguments.scaling)
    fit = None
    if arguments.data == "full" and arguments.noise > 0.0:
        fit = likelihood(subject, cases[0], noisy, rms=multiplicative_rms(arguments.noise), seed=arguments.seed)
    return experiment(subject, solution, fit)


def _phasors(subject: Subject, case: Case, model: ReducedModel, data: Data) -> Complexes:
    """Noiseless phasors (S, 8) at the bearings."""
    if data == "own":
        return reduced_response(model, coefficients=subject.coefficients, unbalances=subject.unbalances)
    return subject.response(case)[:, subject.train.bearing]


def _high_frequency(subject: Subject, case: Case) -> ReducedModel:
    return high_frequency_condensed(subject.train, speed=case.speed, direction=case.direction)


def _reductions(subject: Subject) -> str:
    rows = []
    for speed in (99.0, 150.0, 300.0, 1e4, 1e5, 1e6):
        case = one_way("one", [speed])
        full = subject.response(case)
        dynamic = dynamically_condensed(subject.train, speed=case.speed, direction=case.direction)
        deviations = [
            _deviation(subject, dynamic, full[:, dynamic_masters(subject.train)]),
            _deviation(subject, _high_frequency(subject, case), full[:, subject.train.bearing]),
        ]
        rows.append([f"{speed:g}", *[percent(one) for one in deviations], f"{_lowest_frequency(subject, speed):.0f}"])
    header = ["speed [rad/s]", "dynamic condensation", "high-frequency condensation", "its lowest natural frequency [rad/s]"]
    return (
        "### What the condensations do to the response\n\n"
        "Largest deviation from the full model over its largest displacement, at the same parameters.\n\n"
        + table(header, rows)
        + "\n\nThe dynamic condensation leaves out the gyroscopic effect in its transformation only and is good. The "
        "high-frequency "
        "condensation is no approximation at the thesis's speeds: -Mₛₛ⁻¹Mₛₘ ties coupling and discs to the bearings as if "
        "no "
        "stiffness held them, which strains the shafts so much that the lowest natural frequency rises from 122 to over "
        "1100 rad/s "
        "and the response all but vanishes. It becomes right only far above the natural frequencies of what it "
        "eliminates, beyond 10⁵ rad/s."
    )


def _deviation(subject: Subject, model: ReducedModel, full: Complexes) -> float:
    found = reduced_response(model, coefficients=subject.coefficients, unbalances=subject.unbalances)
    return float(np.abs(found - full).max() / np.abs(full).max())


def _lowest_frequency(subject: Subject, speed: float) -> float:
    """Lowest natural frequency [rad/s] of the train condensed at one speed, undamped and without gyroscopic effect."""
    train = subject.train
    transformation = high_frequency_transformation(train, speed=np.array([speed]))[0]
    elastic = ~train.viscous
    unknown = (train.left[:, elastic] * subject.coefficients[elastic]) @ train.right[:, elastic].T
    mass = transformation.T @ train.mass @ transformation
    stiffness = transformation.T @ (train.stiffness + unknown) @ transformation
    return float(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real.min()))


def _without_noise(subject: Subject) -> str:
    rows = []
    for case in (*CASES, *BANDS):
        model = _high_frequency(subject, case)
        row = [case.title]
        for data in DATA:
            clean = _phasors(subject, case, model, data)
            errors = np.abs(regression(subject, model, clean).values / subject.truth - 1)
            row.append(median_and_worst(errors[None]))
        rows.append(row)
    return (
        "### Without noise\n\nMedian / largest error of the regression of Eq. 4.71.\n\n"
        + table(["method, case", "data of the reduced model itself", "data of the full model, as a plant has"], rows)
        + "\n\nThe regression is exact on data of its own reduced model and useless on the full model's."
    )


def _worst(subject: Subject) -> str:
    rows = []
    for case in (*CASES, *BANDS):
        printed = TABLE_4_3.get(case.title)
        row = [case.title, "-" if printed is None else f"{printed[2]:.1f} %, {printed[3]:.1f} %"]
        model = _high_frequency(subject, case)
        for data in DATA:
            clean = _phasors(subject, case, model, data)
            row.append(_both_noises(subject, model, clean, "everywhere"))
        dynamic = dynamically_condensed(subject.train, speed=case.speed, direction=case.direction)
        whole = reduced_response(dynamic, coefficients=subject.coefficients, unbalances=subject.unbalances)
        row += [_both_noises(subject, dynamic, whole, "everywhere"), _both_noises(subject, dynamic, whole, "matrix only")]
        rows.append(row)
    header = [
        "method, case",
        "printed: 1 %, 5 %",
        "own data",
        "full model's data",
        "24 channels, no high-frequency step",
        "the same, noise in the matrix only",
    ]
    return (
        "### Largest error after column scaling (Table 4.3, Fig. 4.6)\n\n"
        f"Noise of Eq. 2.19-2.20, one number per phasor; median over {len(SEEDS)} seeds (smallest to largest).\n\n"
        + table(header, rows)
        + f"\n\n{_needed_noise(subject)}"
    )


def _both_noises(subject: Subject, model: ReducedModel, clean: Complexes, placement: Placement) -> str:
    found = [regression_errors(subject, model, clean, percent=n, placement=placement) for n in NOISE]
    return ", ".join(worst_of_seeds(one) for one in found)


def _needed_noise(subject: Subject) -> str:
    """Which noise would give the printed error on the reduced model's own data."""
    found = []
    for case in (CASES[2], CASES[5]):
        model = _high_frequency(subject, case)
        clean = _phasors(subject, case, model, "own")
        wanted = TABLE_4_3[case.title][2] / 100
        low, high = -8.0, 0.0
        for _ in range(12):
            middle = (low + high) / 2
            errors = regression_errors(subject, model, clean, percent=10**middle, seeds=range(5))
            low, high = (middle, high) if np.median(errors.max(axis=1)) < wanted else (low, middle)
        found.append(f"{10**low:.1g} % in Case C_fb3 of Method {case.method}")
    shared = []
    sharings: tuple[Sharing, Sharing] = ("channel", "speed")
    for sharing in sharings:
        model = _high_frequency(subject, CASES[5])
        clean = _phasors(subject, CASES[5], model, "own")
        errors = regression_errors(subject, model, clean, percent=1, sharing=sharing)
        shared.append(f"{percent(float(np.median(errors.max(axis=1))))} with one number per {sharing}")
    return (
        "Even data of the reduced model itself do not give the printed errors: to leave the printed one at 1 %, the noise "
        "would "
        f"have to be {' and '.join(found)}. Noise shared between phasors does not help either (C_fb3 of Method II at 1 %: "
        f"{', '.join(shared)}); one number for the whole data set would leave nothing but the unbalances off, by half the "
        f"noise. Of "
        "the readings tried, one meets the print at 1 % within a third in four cases of six: the regression without its "
        "high-frequency step, with coupling and discs measured too, noise entering the matrix but not the right-hand "
        "side. That "
        "is not what the chapter promises, and at 5 % it lies between half and four times the print; it may be a "
        "coincidence."
    )


def _conditions(subject: Subject) -> str:
    rows = []
    for case in CASES:
        printed = TABLE_4_2[case.title]
        row = [case.title, f"{power(printed[0])} → {power(printed[2])}"]
        model = _high_frequency(subject, case)
        for data in DATA:
            clean = _phasors(subject, case, model, data)
            noisy = multiplicative_noise(clean, percent=1, rng=np.random.default_rng(0))
            scaled = regression(subject, model, noisy)
            literal = regression(subject, model, noisy, scaling="thesis")
            steps = (scaled.condition_number_before, literal.condition_number_after, scaled.condition_number_after)
            row.append(" → ".join(power(one**2) for one in steps))
        rows.append(row)
    return (
        "### Condition numbers of AᵀA (Table 4.2)\n\n"
        "At 1 % noise, seed 0: unscaled → damping and unbalances by 1/ω_a (§4.5) → columns of unit length.\n\n"
        + table(["method, case", "printed, before → after", "own data", "full model's data"], rows)
    )


def _misprinted(subject: Subject) -> str:
    rows = []
    for case in CASES:
        printed, conditions = TABLE_4_3[case.title], TABLE_4_2[case.title]
        model = _high_frequency(subject, case)
        own = _phasors(subject, case, model, "own")
        clean = subject.response(case)[:, subject.train.bearing]
        noisy = multiplicative_noise(own, percent=1, rng=np.random.default_rng(0))
        rows.append(
            [
                case.title,
                f"{printed[2]:.1f} %, {printed[3]:.1f} %",
                ", ".join(worst_of_seeds(regression_errors(subject, model, own, percent=n)) for n in NOISE),
                ", ".join(worst_of_seeds(regression_errors(subject, model, own, percent=n, sharing="speed")) for n in NOISE),
                median_and_worst(np.abs(regression(subject, model, clean).values / subject.truth - 1)[None]),
                f"{power(conditions[2])}",
                power(regression(subject, model, noisy).condition_number_after ** 2),
            ]
        )
    header = ["method, case", "printed: 1 %, 5 %", "own data, one number per phasor", "own data, one per speed"]
    header += ["full model's data, no noise", "condition of AᵀA, printed", "unit columns, own data, 1 %"]
    deviations = []
    for speed in (150.0, 300.0, 1000.0):
        case = one_way("one", [speed])
        full = subject.response(case)[:, subject.train.bearing]
        deviations.append(f"{percent(_deviation(subject, _high_frequency(subject, case), full))} at {speed:g} rad/s")
    return (
        "### With the rotary inertia of Appendix A as printed\n\n"
        "The printed critical speeds suggest that the thesis's mass matrix has ρAl where ρI belongs (Chapter 3 above). In "
        "such a "
        "train, in data and model, rotation is so heavy that the high-frequency condensation looks better than it is: "
        "largest "
        "errors as above, median / largest error without noise on the full model's data.\n\n"
        + table(header, rows)
        + "\n\nWith data of the reduced model, Case C_fb3 of Method II then comes within a factor of 4 of the printed 7 % "
        "at 1 %, with "
        "noise common to the channels of a speed within 1.4, and its condition number within 3. The other cases stay 16 "
        "to 75 "
        "times above the print (one number per phasor, 1 %), and the full model's data remain out of reach: the condensed "
        "response "
        f"is off by {', '.join(deviations)}. The printed success of the best case is thus most likely that of a slip in "
        f"the mass "
        "matrix and of data from the method's own model; a real train offers neither."
    )


def _likelihood(subject: Subject) -> str:
    rows = []
    for case in (*CASES, RUN_DOWN):
        clean = subject.response(case)[:, subject.train.bearing]
        row = [case.title]
        for column, n in zip((2, 3), NOISE, strict=True):
            rms = multiplicative_rms(n)
            row.append(f"{TABLE_4_3[case.title][column]:.1f} %" if case.title in TABLE_4_3 else "-")
            row.append(bound_text(bound(bearings_only(subject, case), subject, rms=rms)))
            row.append(_fits(subject, case, clean, n))
        rows.append(row)
    header = ["method, case"]
    for n in NOISE:
        header += [f"printed, {n} %", f"bound, {n} %", f"maximum likelihood, {n} %"]
    return (
        "### Maximum likelihood on the full model's data, bearings only\n\n"
        "Exact condensation and output-error fit of the same phasors at the bearings, with the thesis's noise, started from "
        f"coefficients off by ± 50 %: median / largest error over parameters, {len(LIKELIHOOD_SEEDS)} seeds. Bound: "
        f"Cramér-Rao, for "
        "circular complex noise of the same rms (the thesis's noise leaves phases exact, which the fit does not use).\n\n"
        + table(header, rows)
        + f"\n\n![Error of every parameter]({save('chapter-4-errors', _errors_chart(subject))})"
        + "\n\nThe chapter's promise holds for this fit: with bearings alone, 100 speeds determine every parameter to a "
        "fraction of "
        "a per cent in the median, and the errors are those of the bound. The largest is that of the coupling's c_xy or "
        "k_φ. No "
        "unbiased method does better on data with such noise in amplitude and phase, so the printed 11.5 % at 5 % is out of "
        "reach. Where four speeds cannot determine a parameter (Cases A and B), the fit says so instead of giving a number."
    )


def _errors_chart(subject: Subject) -> str:
    """Errors of the 50 unknowns in the best case, as the thesis's Figures 4.13-4.19 show them."""
    best, rms = CASES[5], multiplicative_rms(1)
    clean = subject.response(best)[:, subject.train.bearing]
    noisy = multiplicative_noise(clean, percent=1, rng=np.random.default_rng(0))
    regressed = np.abs(regression(subject, _high_frequency(subject, best), noisy).values / subject.truth - 1)
    fitted = likelihood_errors(subject, likelihood(subject, best, noisy, rms=rms, seed=0))
    smallest = bound(bearings_only(subject, best), subject, rms=rms)
    number = np.arange(1.0, subject.truth.size + 1).tolist()
    series = [
        Series("high-frequency regression", number, (100 * regressed).tolist(), points=True),
        Series("maximum likelihood", number, (100 * fitted).tolist(), points=True),
    ]
    if smallest is not None:
        series.append(Series("Cramér-Rao bound", number, (100 * smallest).tolist()))
    return chart(
        title="Error of every parameter, bearings only, Case C_fb3 of Method II, 1 % noise",
        x_label="number of the unknown: bearings, coupling, unbalances",
        y_label="error [%]",
        series=series,
        logarithmic=True,
    )


def _fits(subject: Subject, case: Case, clean: Complexes, n: int) -> str:
    found, missing = [], 0
    for seed in LIKELIHOOD_SEEDS:
        noisy = multiplicative_noise(clean, percent=n, rng=np.random.default_rng(seed))
        errors = likelihood_errors(subject, likelihood(subject, case, noisy, rms=multiplicative_rms(n), seed=seed))
        missing += int(np.count_nonzero(np.isnan(errors)))
        found.append(errors)
    text = median_and_range(np.array(found))
    return text if missing == 0 else f"{text}; {missing / len(found):.1f} of 50 not estimable"


@dataclass(frozen=True)
class Biased:
    """A model whose E and density are off by factors, and what is said of it."""

    title: str
    modulus: float
    density: float

    def apply(self, document: Document) -> None:
        """Change a document."""
        steel = document["materials"]["steel"]
        steel["young_modulus"] *= self.modulus
        steel["density"] *= self.density


BIASES = (
    Biased("E +5 %", 1 + BIAS, 1.0),
    Biased("ρ +5 %", 1.0, 1 + BIAS),
    Biased("E +5 %, ρ +5 %", 1 + BIAS, 1 + BIAS),
    Biased("E -5 %, ρ +5 %", 1 - BIAS, 1 + BIAS),
)


def _bias(subject: Subject) -> str:
    rows = []
    for biased in BIASES:
        wrong = load(biased.apply)
        for case in (CASES[2], CASES[5]):
            model = high_frequency_condensed(wrong.train, speed=case.speed, direction=case.direction)
            own = _phasors(subject, case, _high_frequency(subject, case), "own")
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


def _biased_fit(subject: Subject, wrong: Subject, case: Case, clean: Complexes) -> list[str]:
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


SPEED_STEPS = (60.0, 160.0, 240.0)
"""Speeds [rad/s] at which the coefficients are found one by one."""
TRIAL = 4e-3
"""Known trial unbalance [kg m]."""
GROWTH = 0.002
"""Relative growth of every coefficient per rad/s above the first of these speeds."""


def _speed_dependent(subject: Subject) -> str:
    rows = []
    for title, senses, planes in (
        ("one way, 1 trial mass", (1,), 1),
        ("one way, 2 trial masses", (1,), 2),
        ("one way, 4 trial masses", (1,), 4),
        ("both ways, no trial mass", (1, -1), 0),
        ("both ways, 1 trial mass", (1, -1), 1),
        ("both ways, 4 trial masses", (1, -1), 4),
    ):
        runs = _runs(senses, planes)
        rows.append([title, *[_speed_dependent_row(subject, runs, which) for which in ("interface", "bearings")]])
    speeds = ", ".join(f"{speed:g}" for speed in SPEED_STEPS)
    return (
        "### Speed-dependent coefficients (Eq. 4.66-4.70)\n\n"
        f"Coefficients that grow with speed, found at {speeds} rad/s from "
        "runs with and without a known trial mass on one disc after the other; 134 unknowns. Largest error without noise, "
        "then "
        f"median / largest at 0.1 % complex noise, {len(SEEDS)} seeds.\n\n"
        + table(
            ["runs", "interface measured (16 channels), exact elimination", "bearings only, high-frequency, own data"], rows
        )
        + "\n\nWithout noise the form works where runs enough are at hand: one way, it needs a trial mass with the "
        "interface "
        "measured and two with the bearings alone; both ways, none and one. With noise it has too few equations for each "
        "value: a "
        "tenth of a per cent leaves the median error near one per cent at best, and the high-frequency form useless even "
        "on its own "
        "data. The thesis gives no numbers for it."
    )


@dataclass(frozen=True)
class Runs:
    """Samples with trial masses: group (S,) number of the speed, speed and direction (S,), trial (S, 4) [kg m]."""

    group: Indices
    speed: Floats
    direction: Floats
    trial: Complexes


def _runs(senses: Sequence[int], planes: int) -> Runs:
    trials = np.vstack([np.zeros((1, 4)), TRIAL * np.eye(4)[[0, 3, 1, 2][:planes]]]).astype(complex)
    samples = [(k, omega, sense, t) for k, omega in enumerate(SPEED_STEPS) for sense in senses for t in trials]
    return Runs(
        group=np.array([one[0] for one in samples], dtype=np.intp),
        speed=np.array([one[1] for one in samples]),
        direction=np.array([float(one[2]) for one in samples]),
        trial=np.array([one[3] for one in samples]),
    )


def _speed_dependent_row(subject: Subject, runs: Runs, which: str) -> str:
    reduction = eliminated if which == "interface" else high_frequency_condensed
    model = reduction(subject.train, speed=runs.speed, direction=runs.direction)
    changing = subject.coefficients * (1.0 + GROWTH * (runs.speed[:, None] - SPEED_STEPS[0]))
    clean = reduced_response(model, coefficients=changing, unbalances=subject.unbalances + runs.trial)
    firsts = [int(np.flatnonzero(runs.group == k)[0]) for k in range(len(SPEED_STEPS))]
    truth = np.concatenate([changing[firsts].reshape(-1), parts(subject.unbalances)])

    def errors(phasor: Complexes) -> Floats:
        equations = with_trial_unbalances(response_equations(model, phasor), runs.trial)
        problem = speed_dependent_regression(
            equations, subject.train.unknowns, group=runs.group, mean_speed=float(runs.speed.mean())
        )
        return np.asarray(np.abs(solve(problem).values / truth - 1))

    if 2 * clean.size < truth.size:
        return f"{2 * clean.size} equations for {truth.size} unknowns"
    exact = float(errors(clean).max())
    if exact > 1e-3:
        return "undetermined"
    noisy = np.array([errors(complex_noise(clean, rms=1e-3, rng=np.random.default_rng(seed))) for seed in SEEDS])
    return f"{percent(exact)}; {median_and_worst(noisy)}"


def _forces(subject: Subject) -> str:
    case, best = one_way("curve", np.arange(2.0, 301.0, 2.0)), CASES[5]
    clean = subject.response(best)[:, subject.train.bearing]
    noisy = multiplicative_noise(clean, percent=5, rng=np.random.default_rng(0))
    regressed = regression(subject, _high_frequency(subject, best), noisy).values
    outcome = likelihood(subject, best, noisy, rms=multiplicative_rms(5), seed=0)
    curves = {
        "true": transmitted(subject, case, subject.truth),
        "high-frequency regression": transmitted(subject, case, regressed),
        "maximum likelihood": transmitted(subject, case, np.nan_to_num(estimated(subject, outcome))),
    }
    rows = [[name, *[percent(one) for one in curve_errors(curves, k)]] for k, name in enumerate(FORCES)]
    series = [Series(name, case.speed.tolist(), np.abs(curve[:, 0]).tolist()) for name, curve in curves.items()]
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


PARTS: dict[str, Callable[[Subject], str]] = {"bias": _bias, "speed-dependent": _speed_dependent}
"""Parts that a command can print alone: E and density 5 % off, and Eq. 4.66-4.70."""
