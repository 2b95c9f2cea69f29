"""Chapter 4: how well the dynamic reductions describe the train, their condition numbers, and their misprints."""

import numpy as np

from benchmarks.thesis.chapter_4.cases import CASES, DATA, clean_phasors, high_frequency_model
from benchmarks.thesis.flexible.experiments import NOISE, Subject, one_way, regression, regression_errors
from benchmarks.thesis.flexible.printed import TABLE_4_2, TABLE_4_3
from benchmarks.thesis.tables import median_and_worst, percent, power, table, worst_of_seeds
from estimator.arrays import Complexes
from estimator.thesis.noise import multiplicative_noise
from estimator.thesis.reduced_model import ReducedModel, reduced_response
from estimator.thesis.reduction import dynamic_masters, dynamically_condensed, high_frequency_transformation


def reductions_section(subject: Subject) -> str:
    """Write the section on the dynamic reductions."""
    rows = []
    for speed in (99.0, 150.0, 300.0, 1e4, 1e5, 1e6):
        case = one_way("one", [speed])
        full = subject.response(case)
        dynamic = dynamically_condensed(subject.train, speed=case.speed, direction=case.direction)
        deviations = [
            _deviation(subject, dynamic, full[:, dynamic_masters(subject.train)]),
            _deviation(subject, high_frequency_model(subject, case), full[:, subject.train.bearing]),
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
    """Return the lowest natural frequency [rad/s] of the train condensed at one speed, no damping, no gyroscopic effect."""
    train = subject.train
    transformation = high_frequency_transformation(train, speed=np.array([speed]))[0]
    elastic = ~train.viscous
    unknown = (train.left[:, elastic] * subject.coefficients[elastic]) @ train.right[:, elastic].T
    mass = transformation.T @ train.mass @ transformation
    stiffness = transformation.T @ (train.stiffness + unknown) @ transformation
    return float(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real.min()))


def conditions_section(subject: Subject) -> str:
    """Write the section on condition numbers."""
    rows = []
    for case in CASES:
        printed = TABLE_4_2[case.title]
        row = [case.title, f"{power(printed[0])} → {power(printed[2])}"]
        model = high_frequency_model(subject, case)
        for data in DATA:
            clean = clean_phasors(subject, case, model, data)
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


def misprinted_section(subject: Subject) -> str:
    """Write the section on the misprints."""
    rows = []
    for case in CASES:
        printed, conditions = TABLE_4_3[case.title], TABLE_4_2[case.title]
        model = high_frequency_model(subject, case)
        own = clean_phasors(subject, case, model, "own")
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
        deviations.append(f"{percent(_deviation(subject, high_frequency_model(subject, case), full))} at {speed:g} rad/s")
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
