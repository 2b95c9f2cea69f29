"""Chapter 3: errors of the regression without and with noise, column scaling, and maximum likelihood."""

import numpy as np

from benchmarks.thesis.chapter_3.cases import CASES, measured
from benchmarks.thesis.flexible.experiments import (
    LIKELIHOOD_SEEDS,
    NOISE,
    SEEDS,
    FlexibleCase,
    Subject,
    all_interfaces,
    bearings_only,
    bound,
    bound_text,
    likelihood,
    likelihood_errors,
    likelihood_of_all,
    median_and_range,
    rank,
    regression,
    regression_errors,
    scaled_matrix,
)
from benchmarks.thesis.flexible.misprints import with_printed_rotary_inertia
from benchmarks.thesis.flexible.printed import TABLE_3_7, TABLE_3_8
from benchmarks.thesis.tables import percent, power, table, worst_of_seeds
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import response
from estimator.thesis.noise import multiplicative_noise, multiplicative_rms


def clean_section(subject: Subject) -> str:
    """Write the section on errors without noise."""
    rows = []
    for case in CASES:
        model, clean = measured(subject, case)
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


def worst_section(subject: Subject) -> str:
    """Write the section on the largest errors with noise."""
    rows = []
    misprinted = with_printed_rotary_inertia(subject)
    for case in CASES:
        printed = TABLE_3_8[case.title]
        row = [case.title, f"{printed[2]:.1f} %, {printed[3]:.1f} %"]
        model, clean = measured(subject, case)
        if rank(scaled_matrix(subject, model, clean)) < subject.truth.size:
            rows.append([*row, *["undetermined"] * 5])
            continue
        independent = [regression_errors(subject, model, clean, percent=n) for n in NOISE]
        shared = [regression_errors(subject, model, clean, percent=n, sharing="speed") for n in NOISE]
        one_sided = [regression_errors(subject, model, clean, percent=n, placement="matrix only") for n in NOISE]
        other, as_printed = measured(misprinted, case)
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


def scaling_section(subject: Subject) -> str:
    """Write the section on column scaling."""
    rows = []
    for case in CASES:
        model, clean = measured(subject, case)
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


def likelihood_section(subject: Subject) -> str:
    """Write the section on maximum likelihood on the same data."""
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


def _fits(subject: Subject, case: FlexibleCase, train: CondensedTrain, n: int) -> str:
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
