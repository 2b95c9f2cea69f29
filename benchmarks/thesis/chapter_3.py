"""Chapter 3 of the thesis: flexible shafts, every degree of freedom at bearings and coupling measured.

python -m benchmarks.thesis chapter-3 [--method I|II] [--case A|B|C] [--noise 1] [--scaling norm] [--sharing none] [--seed 0]
                                      [--damping 0.01]
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

import numpy as np

from benchmarks.thesis.flexible import (
    LIKELIHOOD_SEEDS,
    NOISE,
    SEEDS,
    Case,
    Complexes,
    Document,
    Floats,
    Subject,
    all_interfaces,
    bearings_only,
    both_ways,
    bound,
    bound_text,
    estimated,
    experiment,
    likelihood,
    likelihood_errors,
    likelihood_of_all,
    load,
    median_and_range,
    one_way,
    rank,
    regression,
    regression_errors,
    scaled_matrix,
)
from benchmarks.thesis.flexible_misprints import natural_frequencies, with_printed_rotary_inertia
from benchmarks.thesis.flexible_printed import (
    CRITICAL_SPEEDS,
    TABLE_3_7,
    TABLE_3_8,
    TABLE_3_9,
    TABLE_3_10,
    TABLES_3_3_TO_3_6,
    Plane,
)
from benchmarks.thesis.plots import Series, chart, save
from benchmarks.thesis.tables import percent, power, table, worst_of_seeds
from estimator.condensation import CondensedTrain
from estimator.critical_speed import critical_speeds
from estimator.rayleigh import rayleigh_damping
from estimator.response import response
from estimator.thesis.coupling_force import coupling_force
from estimator.thesis.flexible_train import flexible_train, full_response
from estimator.thesis.noise import Sharing, multiplicative_noise, multiplicative_rms
from estimator.thesis.reduced_model import ReducedModel
from estimator.thesis.reduction import eliminated

CASES = (
    one_way("A", [100, 110]),
    one_way("B", [60, 160]),
    one_way("C", np.arange(1.0, 301.0)),
    both_ways("A", [110]),
    both_ways("B", [160]),
    both_ways("C", np.arange(2.0, 301.0, 2.0)),
)
"""§3.4.1-3.4.2; at 0 rad/s nothing moves, so Case C starts at the first speed above it."""
BEST = CASES[-1]
"""Case C of Method II, of which the thesis prints Tables 3.3-3.6, 3.9 and 3.10."""
FORCES = ("F_x [N]", "F_y [N]", "M_x [N m]", "M_y [N m]")
DAMPING_FREQUENCIES = (122.0, 432.0)
"""Natural frequencies [rad/s] at which a stated shaft damping holds: the lowest and the eighth of the train."""


def section() -> str:
    """The chapter's part of the evidence page."""
    subject = load()
    parts = [
        "## Chapter 3: flexible shafts, all interface degrees of freedom measured",
        "Train: `examples/thesis-chapter-3.yaml`, 10 Timoshenko elements of 0.25 m, 48 degrees of freedom. Measured: both "
        "translations at the four bearings, translations and rotations of both coupling halves (16); the other 32 are "
        "eliminated exactly (Eq. 3.27). 50 real unknowns. Errors are relative to the true value of each real unknown, as in "
        "the thesis. Method II assumes with the thesis that a bearing has the same coefficients in both senses of "
        "rotation, which no fluid-film bearing has.",
        _critical_speeds(subject),
        _clean(subject),
        _worst(subject),
        _scaling(subject),
        _likelihood(subject),
        _parameters(subject),
        _unbalances(),
        _damping(subject),
        _forces(subject),
    ]
    return "\n\n".join(parts) + "\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of `python -m benchmarks.thesis chapter-3`."""
    parser.add_argument("--method", choices=("I", "II"), default="II", help="one or both senses of rotation, default II")
    parser.add_argument("--case", choices=("A", "B", "C"), default="C", help="speeds of the thesis, default C")
    parser.add_argument("--noise", type=float, default=1.0, help="N of Eq. 2.20 [%%], default 1")
    parser.add_argument("--scaling", choices=("none", "thesis", "norm"), default="norm", help="of columns, default norm")
    parser.add_argument("--sharing", choices=get_args(Sharing), default="none", help="phasors that share a random number")
    parser.add_argument("--seed", type=int, default=0, help="of the noise, default 0")
    parser.add_argument("--damping", type=float, default=0.0, help="shaft damping ratio (Appendix B) [-], default 0")


def run(arguments: argparse.Namespace) -> str:
    """One experiment, parameter by parameter."""
    subject = damped(load(), arguments.damping)
    case = next(c for c in CASES if (c.method, c.name) == (arguments.method, arguments.case))
    model, clean = _measured(subject, case)
    noisy = multiplicative_noise(
        clean, percent=arguments.noise, rng=np.random.default_rng(arguments.seed), sharing=arguments.sharing
    )
    solution = regression(subject, model, noisy, scaling=arguments.scaling, damping_scaled=False)
    fit = None
    # The fit knows no shaft damping, and a fit needs noise of a stated size.
    if (
        arguments.noise > 0.0
        and arguments.damping == 0.0
        and 2 * case.speed.size * subject.train.bearing.size > len(subject.names)
    ):
        rms = multiplicative_rms(arguments.noise)
        fit = likelihood(subject, case, noisy[:, : subject.train.bearing.size], rms=rms, seed=arguments.seed)
    return experiment(subject, solution, fit)


def damped(subject: Subject, ratio: float) -> Subject:
    """The same train with shafts damped by a ratio [-] at two natural frequencies (Appendix B)."""
    if ratio == 0.0:
        return subject
    lower, upper = DAMPING_FREQUENCIES
    damping = rayleigh_damping(lower_frequency=lower, lower_ratio=ratio, upper_frequency=upper, upper_ratio=ratio)
    return replace(subject, train=flexible_train(subject.machine, rayleigh=damping))


def _measured(subject: Subject, case: Case) -> tuple[ReducedModel, Complexes]:
    model = eliminated(subject.train, speed=case.speed, direction=case.direction)
    return model, subject.response(case)[:, subject.train.interface]


def _critical_speeds(subject: Subject) -> str:
    variants = {
        "critical speeds, data as printed": subject,
        "elements of 0.05 m": load(_finer),
        "no cross-coupled coefficients": load(_without_cross),
        "E halved": load(_halved),
        "shaft 15 mm": load(_thinner),
        "discs twice as heavy": load(_heavier),
    }
    rows = [["thesis §3.4", *[f"{one:.1f}" for one in CRITICAL_SPEEDS]]]
    misprinted = with_printed_rotary_inertia(subject)
    for name, one in (("rotary inertia ρI", subject), ("rotary inertia ρAl of Eq. A.5-A.8", misprinted)):
        rows.append([f"undamped, at rest, {name}", *[f"{value:.1f}" for value in natural_frequencies(one)[:8]]])
    for name, one in variants.items():
        found = critical_speeds(one.machine, highest=700.0)[:8]
        rows.append([name, *[f"{value:.1f}" for value in found], *["-"] * (8 - len(found))])
    return (
        "### Critical speeds\n\n"
        + table(["[rad/s]", *[str(k) for k in range(1, 9)]], rows)
        + "\n\nThe printed speeds do not follow from the printed data. The model's response agrees with that of ROSS "
        "(`python -m "
        "benchmarks.estimator`), and none of the slips of the pen tried in the data explains the difference. What "
        "does, with "
        "nothing adjusted, up to 6 % (3.4 % rms; without it 61 % and 41 %), is the rotary inertia of Appendix A taken as "
        "it is "
        "printed: its prefix ρAl where ρI belongs makes it 10⁴ times too large for these elements. Most likely the thesis's "
        "responses come from that mass matrix too; the tables below try it beside the right one."
    )


def _finer(document: Document) -> None:
    document["element_length"] = 0.05


def _without_cross(document: Document) -> None:
    for part in (*document["bearings"], *document["couplings"]):
        part.update(kxy=0.0, kyx=0.0, cxy=0.0, cyx=0.0)


def _halved(document: Document) -> None:
    document["materials"]["steel"]["young_modulus"] /= 2


def _thinner(document: Document) -> None:
    for shaft in document["shafts"]:
        shaft["sections"][0]["outer_diameter"] = 0.015


def _heavier(document: Document) -> None:
    for disc in document["discs"]:
        for name in ("mass", "diametral_inertia", "polar_inertia"):
            disc[name] *= 2


def _clean(subject: Subject) -> str:
    rows = []
    for case in CASES:
        model, clean = _measured(subject, case)
        found = rank(scaled_matrix(subject, model, clean))
        errors = np.abs(regression(subject, model, clean).values / subject.truth - 1)
        shown = [percent(float(np.median(errors))), percent(float(errors.max()))]
        rows.append([case.title, str(found), *(shown if found == subject.truth.size else ["undetermined"] * 2)])
    return (
        "### Without noise\n\n"
        + table(["method, case", "rank of 50", "median error", "largest error"], rows)
        + "\n\nThe regression of Eq. 3.41 is exact where the equations determine the unknowns. Cases A and B of Method II "
        "do "
        "not: one speed, both ways, gives 64 equations, but an isotropic shaft that turns the other way is its own mirror "
        "image, and what its second run says of the unbalances repeats the first. The errors that the thesis prints for "
        "these "
        "two cases cannot come from the data it describes."
    )


def _worst(subject: Subject) -> str:
    rows = []
    misprinted = with_printed_rotary_inertia(subject)
    for case in CASES:
        printed = TABLE_3_8[case.title]
        row = [case.title, f"{printed[2]:.1f} %, {printed[3]:.1f} %"]
        model, clean = _measured(subject, case)
        if rank(scaled_matrix(subject, model, clean)) < subject.truth.size:
            rows.append([*row, *["undetermined"] * 5])
            continue
        independent = [regression_errors(subject, model, clean, percent=n) for n in NOISE]
        shared = [regression_errors(subject, model, clean, percent=n, sharing="speed") for n in NOISE]
        one_sided = [regression_errors(subject, model, clean, percent=n, placement="matrix only") for n in NOISE]
        other, as_printed = _measured(misprinted, case)
        apart = [regression_errors(misprinted, other, as_printed, percent=n) for n in NOISE]
        common = [regression_errors(misprinted, other, as_printed, percent=n, sharing="speed") for n in NOISE]
        readings = (independent, shared, one_sided, apart, common)
        rows.append([*row, *[", ".join(worst_of_seeds(one) for one in both) for both in readings]])
    header = [
        "method, case",
        "printed: 1 %, 5 %",
        "one random number per phasor",
        "one per speed, common to all channels",
        "one per phasor, in the matrix only",
        "rotary inertia as printed, one per phasor",
        "rotary inertia as printed, one per speed",
    ]
    return (
        "### Largest error after column scaling (Table 3.8)\n\n"
        f"Noise of Eq. 2.19-2.20 at 1 % and 5 %; median over {len(SEEDS)} seeds (smallest to largest).\n\n"
        + table(header, rows)
        + "\n\nNoise that is drawn for each phasor, as a probe's is, makes the regression up to thirty times worse than "
        "printed. "
        "Other readings of the procedure come nearer, none meets all cases: one random number common to all channels of a "
        "speed "
        "(within a factor of 2 but for Case A), noise that enters the regression matrix but not the right-hand side "
        "(within 2.6), "
        "and the misprinted rotary inertia in data and model, which brings Case C of Method II to the printed size with "
        "either kind "
        "of noise. With one number for the whole data set nothing but the unbalances would be off, by 2.5 % at most."
    )


def _scaling(subject: Subject) -> str:
    rows = []
    for case in CASES:
        model, clean = _measured(subject, case)
        singular = rank(scaled_matrix(subject, model, clean)) < subject.truth.size
        noisy = multiplicative_noise(clean, percent=1, rng=np.random.default_rng(0))
        literal = regression(subject, model, noisy, scaling="thesis", damping_scaled=False)
        literal_inverse = regression(subject, model, noisy, scaling="none", method="inverse")
        pseudo_inverse = regression(subject, model, noisy, scaling="none", method="pseudo-inverse")
        scaled = regression(subject, model, noisy)
        conditions = (scaled.condition_number_before, literal.condition_number_after, scaled.condition_number_after)
        largest = [
            percent(float(np.abs(one.values / subject.truth - 1).max())) for one in (literal_inverse, pseudo_inverse, scaled)
        ]
        printed, error = TABLE_3_7[case.title], TABLE_3_8[case.title]
        rows.append(
            [
                case.title,
                f"{power(printed[0])} → {power(printed[2])}",
                *["singular" if singular else power(one**2) for one in conditions],
                f"{error[0]:.0f} % → {error[2]:.1f} %",
                *["undetermined" if singular else one for one in largest],
            ]
        )
    header = [
        "method, case",
        "condition of AᵀA, printed",
        "unscaled",
        "unbalances by 1/ω_a",
        "unit columns",
        "largest error, printed",
        "unscaled, (AᵀA)⁻¹ of Eq. 2.16",
        "unscaled, pseudo-inverse of AᵀA",
        "unit columns, orthogonal",
    ]
    return (
        "### Column scaling (Table 3.7)\n\nAt 1 % noise of Eq. 2.20, one number per phasor, seed 0.\n\n"
        + table(header, rows)
        + "\n\nThe printed numbers before scaling, around 10²⁸, are not met. Dividing the unbalances' columns by the mean "
        "speed, as "
        "§2.3.2 says, lowers the condition number of AᵀA by ω_a², some 10⁴; columns of unit length lower it by 13 to 17 "
        "powers "
        "of ten. Neither moves the least-squares solution, and even the plain inverse of Eq. 2.16 in double precision loses "
        "nothing to two digits. A gain like the printed one appears where AᵀA is inverted by a pseudo-inverse, which cuts "
        "off the "
        "small singular values of the unscaled matrix."
    )


def _likelihood(subject: Subject) -> str:
    rows = []
    for case in CASES:
        printed = TABLE_3_8[case.title]
        for column, n in zip((2, 3), NOISE, strict=True):
            rms = multiplicative_rms(n)
            everything, bearings = all_interfaces(subject, case), bearings_only(subject, case)
            rows.append(
                [
                    f"{case.title}, {n} %",
                    f"{printed[column]:.1f} %",
                    bound_text(bound(everything, subject, rms=rms)),
                    _fits(subject, case, everything, n),
                    bound_text(bound(bearings, subject, rms=rms)),
                    _fits(subject, case, bearings, n),
                ]
            )
    header = [
        "method, case, noise",
        "printed",
        "bound, 16 channels",
        "fit, 16 channels",
        "bound, 8 channels",
        "fit, 8 channels",
    ]
    return (
        "### Maximum likelihood and the Cramér-Rao bound\n\n"
        "The fit starts from coefficients that are off by ± 50 % and sees either the 16 channels of the regression or the "
        "bearings' translations only, with the thesis's noise (one number per phasor); median / largest error over "
        "parameters, "
        f"{len(LIKELIHOOD_SEEDS)} seeds. The bound is that of circular complex noise of the same rms, 0.29 % and 1.44 %: "
        f"for the "
        "thesis's own noise there is no bound, because it leaves the phases exact, and exact phases alone determine "
        "everything "
        "but the unbalances' common scale.\n\n"
        + table(header, rows)
        + "\n\nWith the regression's own 16 channels the fit stays below even the printed errors of Case C, at the bound; "
        "with the 8 "
        "channels of a plant it does better than the regression with 16. What two speeds cannot tell, it reports as not "
        "estimable."
    )


def _fits(subject: Subject, case: Case, train: CondensedTrain, n: int) -> str:
    clean = response(train, coefficients=subject.coefficients, excitations=subject.unbalances)
    if 2 * clean.size <= subject.truth.size:
        return f"{2 * clean.size} numbers for {subject.truth.size} unknowns"
    fit = likelihood if len(train.channels) == subject.train.bearing.size else likelihood_of_all
    found, missing = [], 0
    for seed in LIKELIHOOD_SEEDS:
        noisy = multiplicative_noise(clean, percent=n, rng=np.random.default_rng(seed))
        errors = likelihood_errors(subject, fit(subject, case, noisy, rms=multiplicative_rms(n), seed=seed))
        missing += int(np.count_nonzero(np.isnan(errors)))
        found.append(errors)
    text = median_and_range(np.array(found))
    return text if missing == 0 else f"{text}; {missing / len(found):.1f} of {subject.truth.size} not estimable"


def _parameters(subject: Subject) -> str:
    model, clean = _measured(subject, BEST)
    everywhere = np.median(regression_errors(subject, model, clean, percent=5), axis=0)
    shared = np.median(regression_errors(subject, model, clean, percent=5, sharing="speed"), axis=0)
    matrix_only = np.median(regression_errors(subject, model, clean, percent=5, placement="matrix only"), axis=0)
    fits = []
    for seed in LIKELIHOOD_SEEDS:
        noisy = multiplicative_noise(clean[:, : subject.train.bearing.size], percent=5, rng=np.random.default_rng(seed))
        fits.append(likelihood_errors(subject, likelihood(subject, BEST, noisy, rms=multiplicative_rms(5), seed=seed)))
    fitted = np.nanmedian(np.array(fits), axis=0)
    smallest = bound(bearings_only(subject, BEST), subject, rms=multiplicative_rms(5))
    rows = []
    for k, name in enumerate(subject.names):
        assumed, without, one, _, five = TABLES_3_3_TO_3_6[name]
        printed = [percent(abs(value / assumed - 1)) for value in (without, one, five)]
        ours = [percent(float(errors[k])) for errors in (everywhere, shared, matrix_only, fitted)]
        rows.append([name, *printed, *ours, "infinite" if smallest is None else percent(float(smallest[k]))])
    header = [
        "parameter",
        "printed, no noise",
        "printed, 1 %",
        "printed, 5 %",
        "regression, 5 %",
        "one number per speed",
        "noise in the matrix only",
        "maximum likelihood, 8 channels, 5 %",
        "bound, 8 channels",
    ]
    return (
        "### Every parameter, Case C of Method II (Tables 3.3-3.6)\n\n"
        "Printed errors are against the assumed values of the same printed row; ours are medians over seeds.\n\n"
        + table(header, rows)
        + "\n\nThe coupling's k_φ tells the readings of the noise apart: it follows from the difference of two nearly equal "
        "slopes, so noise of their own halves it (an attenuation, which more data do not mend), and the printed 1 to 3.5 "
        "% at "
        '5 % noise is possible only where both slopes carry the same random number (column "one number per speed").\n\n'
        "The printed tables do not agree with one another. Table 3.6 assumes all four unbalances at 36° (0.0076 + 0.0055j "
        "is "
        "9.4 g·m at 36°, and so on), Table 3.2 says 36°, 108°, 240° and 300°; the real part of the second, 0.0044, is a "
        "slip "
        "for 0.0049, and the first row of Table 3.9 has the magnitudes of Table 3.6's rounded parts with the angles of "
        "Table "
        "3.2. The column without noise is off by 3.5 % at c_xx of B2, the one with 1 % noise by 0.23 %. The largest error "
        "of 54.92 % in Table "
        "3.8 stands at c_xy of B1, in Table 3.4 at c_yx. The 2.7834×10⁵ of k_yx of B4 at 2 % is a slip for 1.2783×10⁵."
    )


def _unbalances() -> str:
    rows = []
    for number, (assumed, printed) in enumerate(TABLE_3_9, start=1):
        rows.append([f"3.9, {number}", _printed_planes(assumed, printed), *_unbalance_errors(assumed, None)])
    for number, (masses, printed) in enumerate(TABLE_3_10, start=1):
        assumed = TABLE_3_9[0][0]
        rows.append([f"3.10, set {number}", _printed_planes(assumed, printed), *_unbalance_errors(assumed, masses)])
    return (
        "### Other unbalances and other disc masses (Tables 3.9-3.10)\n\n"
        "Case C of Method II at 5 % noise, largest error of the four planes in magnitude and in angle; regression with "
        "one random "
        "number per phasor, medians over seeds.\n\n"
        + table(["table, set", "printed", "regression, 16 channels", "maximum likelihood, 8 channels"], rows)
    )


def _unbalance_errors(assumed: Sequence[Plane], masses: Sequence[float] | None) -> list[str]:
    def change(document: Document) -> None:
        for k, disc in enumerate(document["discs"]):
            disc["unbalance"] = {"magnitude": assumed[k][0], "angle_deg": assumed[k][1]}
            if masses is not None:
                disc["mass"] = masses[k]

    subject = load(change)
    model, clean = _measured(subject, BEST)
    regressed, fitted = [], []
    for seed in SEEDS:
        noisy = multiplicative_noise(clean, percent=5, rng=np.random.default_rng(seed))
        solved = regression(subject, model, noisy).values[-8:]
        regressed.append(_plane_errors(solved[::2] + 1j * solved[1::2], subject.unbalances))
    for seed in LIKELIHOOD_SEEDS:
        noisy = multiplicative_noise(clean[:, : subject.train.bearing.size], percent=5, rng=np.random.default_rng(seed))
        outcome = likelihood(subject, BEST, noisy, rms=multiplicative_rms(5), seed=seed)
        found = [one for one in outcome.estimates if one.quantity == "unbalance"]
        if any(one.value is None or one.imaginary is None for one in found):
            continue
        values = np.array([complex(one.value or 0.0, one.imaginary or 0.0) for one in found])
        fitted.append(_plane_errors(values, subject.unbalances))
    return [_plane_text(np.median(regressed, axis=0)), _plane_text(np.median(fitted, axis=0))]


def _plane_errors(found: Complexes, true: Complexes) -> tuple[float, float]:
    turned = np.angle(found / true, deg=True)
    return float(np.max(np.abs(np.abs(found / true) - 1))), float(np.max(np.abs(turned)))


def _printed_planes(assumed: Sequence[Plane], estimated: Sequence[Plane]) -> str:
    return _plane_text(_plane_errors(_phasors(estimated), _phasors(assumed)))


def _phasors(planes: Sequence[Plane]) -> Complexes:
    return np.array([size * np.exp(1j * math.radians(angle)) for size, angle in planes])


def _plane_text(errors: Sequence[float] | Floats) -> str:
    return f"{percent(float(errors[0]))}, {errors[1]:.2g}°"


def _damping(subject: Subject) -> str:
    rows = []
    for ratio in (0.001, 0.01):
        other = damped(subject, ratio)
        model, clean = _measured(other, BEST)
        same = np.abs(regression(other, model, clean).values / subject.truth - 1)
        lacking = eliminated(subject.train, speed=BEST.speed, direction=BEST.direction)
        biased = np.abs(regression(subject, lacking, clean).values / subject.truth - 1)
        rows.append(
            [f"{100 * ratio:g} %", *[f"{percent(float(np.median(e)))} / {percent(float(e.max()))}" for e in (same, biased)]]
        )
    lower, upper = DAMPING_FREQUENCIES
    return (
        "### Rayleigh damping of the shafts (Eq. 3.5, Appendix B)\n\n"
        "The thesis gives the equations but neither a₀ and a₁ nor the ratios, and says elsewhere that no internal damping "
        "is "
        f"considered. With the stated ratio at {lower:g} and {upper:g} rad/s, Case C of Method II, no noise, median / "
        f"largest "
        "error:\n\n" + table(["ratio", "model has it too", "model lacks it"], rows)
    )


def _forces(subject: Subject) -> str:
    case = one_way("curve", np.arange(2.0, 301.0, 2.0))
    model, clean = _measured(subject, BEST)
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
    series = [Series(name, case.speed.tolist(), np.abs(curve[:, 0]).tolist()) for name, curve in curves.items()]
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
    """Rms error of each curve's column but the first's, over the rms of the first, which is the true one."""
    true, *others = [curve[:, column] for curve in curves.values()]
    return [float(np.linalg.norm(other - true) / np.linalg.norm(true)) for other in others]


def transmitted(subject: Subject, case: Case, unknowns: Floats) -> Complexes:
    """Forces and moments (S, 4) that the coupling transmits, for real unknowns (K + 2P,)."""
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
