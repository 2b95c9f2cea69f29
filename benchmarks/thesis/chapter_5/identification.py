"""Chapter 5: what the rig's sensors determine, by regression and by maximum likelihood."""

import math
from collections.abc import Sequence

import numpy as np

from benchmarks.thesis.chapter_5.rig import (
    BELOW,
    BOTH_WAYS,
    DENSE,
    DETERMINED,
    FLOOR,
    KINDS,
    LOST,
    PRINTED,
    PRINTED_WITH_FLOOR,
    RELATIVE_NOISE,
    RESONANCES,
    RUN_UP,
    RUN_UP_WITHOUT_FLOOR,
    SETS,
    Rig,
    bounds,
    fitted,
    one_way,
    regressed,
    regression,
)
from benchmarks.thesis.plots import PlottedCurve, chart, save
from benchmarks.thesis.tables import percent, power, table
from estimator.fit.identification import Identification
from estimator.machine.parameter_description import describe
from estimator.thesis.flexible_train import parts
from estimator.thesis.regression import solve

LIKELIHOOD_SETS = 20


def directions_section(rig: Rig) -> str:
    """Return the section on what the speeds determine, by the Fisher information at the truth."""
    rows = []
    for campaign in (PRINTED, PRINTED_WITH_FLOOR, DENSE, BOTH_WAYS, BELOW, RESONANCES, RUN_UP):
        found = bounds(rig, campaign)
        kinds = [float(np.median(found.parameters[_members(rig, element_kind, ends)])) for _, element_kind, ends in KINDS]
        rows.append(
            [
                campaign.title,
                str(int(np.sum(found.directions < DETERMINED))),
                str(int(np.sum(found.directions > LOST))),
                *[percent(value) for value in kinds],
                percent(float(np.median(found.parameters[len(rig.names) :]))),
            ]
        )
    printed = bounds(rig, PRINTED).parameters
    needed = [RELATIVE_NOISE * DETERMINED / float(np.median(printed[_members(rig, *kind[1:])])) for kind in KINDS]
    header = ["speeds", "directions within 10 %", "not within 100 %", *[name for name, _, _ in KINDS], "unbalance"]
    return (
        "### What eight speeds determine\n\n"
        "Cramér-Rao bounds (standard errors; median over the parameters of a kind) at 1 % noise without any prior, and how "
        "many of the 46 independent directions in parameter space the data fix. Direct terms count by their logarithm.\n\n"
        + table(header, rows)
        + "\n\nThe regression counts 128 equations for 46 unknowns (three speeds would do, says §5.5) and the count is not "
        "the difficulty. At 17 to 41 Hz each channel says X = ω² a, one complex number: eight channels fix 16 directions, "
        "and more speeds in the same range only repeat them. What is fixed is displacement per unbalance, each bearing's "
        "flexibility times the force that reaches it: stiffness and unbalance can grow together and nothing changes. Only "
        "the next order, (ω/ωₙ)² or 7 % at the top, tells them apart, and the coupling and all damping come later still. For "
        f"10 % of a bearing's direct stiffness the eight speeds would need a noise of {percent(needed[0])}, for its damping "
        f"{percent(needed[1])}, for the coupling's stiffness {percent(needed[2])}. Eight speeds do determine the rig when "
        "they lie "
        "around two resonances; a run-up through both does better.\n\n" + _bound_figure(rig)
    )


def _bound_figure(rig: Rig) -> str:
    """Draw the bounds over the highest speed of a run-up."""
    highest = [
        41.0,
        60.0,
        80.0,
        100.0,
        120.0,
        135.0,
        145.0,
        150.0,
        155.0,
        170.0,
        185.0,
        200.0,
        215.0,
        240.0,
        280.0,
        330.0,
        380.0,
    ]
    found = [bounds(rig, one_way("", np.linspace(5.0, top, 200), floor=FLOOR)).parameters for top in highest]
    series = [
        PlottedCurve(name, highest, [100.0 * float(np.median(one[_members(rig, element_kind, ends)])) for one in found])
        for name, element_kind, ends in KINDS
    ]
    figure = save(
        "chapter-5-bounds",
        chart(
            title="Rig: what 200 speeds determine, by the highest of them",
            x_label="highest speed [Hz]",
            y_label="Cramér-Rao bound, median [%]",
            series=series,
            logarithmic=True,
        ),
    )
    return f"![Bounds by the highest speed]({figure})"


def _members(rig: Rig, element_kind: str, ends: tuple[str, ...]) -> list[int]:
    said = map(describe, rig.names)
    return [k for k, one in enumerate(said) if one.element_kind == element_kind and one.quantity in ends]


def fits_section(rig: Rig) -> str:
    """Return the section on three sets of data, by regression and by maximum likelihood."""
    truth = np.concatenate([rig.coefficients, parts(rig.unbalances)])
    exact = regression(rig, PRINTED, seed=None, own_model=True)
    thesis_scaled, norm_scaled = solve(exact, scaling="thesis"), solve(exact, scaling="norm")
    stiffness = _members(rig, "bearing", ("kxx", "kyy"))
    rows = []
    for campaign in (PRINTED, DENSE, RUN_UP_WITHOUT_FLOOR):
        for own_model in (True, False):
            source = "its own reduced model" if own_model else "the full model"
            for seeds, label in (((None,), "none"), (tuple(SETS), "1 %")):
                values = np.array([regressed(rig, campaign, seed=seed, own_model=own_model) for seed in seeds])
                error = np.abs(values / truth - 1.0)
                ratio = values[:, stiffness] / truth[stiffness]
                spread = (
                    "-" if len(seeds) == 1 else percent(float(np.median(ratio.std(axis=0, ddof=1) / np.abs(ratio.mean(0)))))
                )
                rows.append(
                    [
                        campaign.title,
                        source,
                        label,
                        _or_rounding(float(np.median(error))),
                        _or_rounding(float(np.median(np.abs(ratio - 1.0)))),
                        spread,
                    ]
                )
    return (
        "### Three sets of data\n\n"
        "Chapter 4's regression (Eq. 4.71 as 5.3), columns scaled to equal norm. At the eight speeds its condition number is "
        f"{_power(thesis_scaled.condition_number_before)} before scaling, {_power(thesis_scaled.condition_number_after)} "
        f"after the thesis's (1 over the mean speed) and {_power(norm_scaled.condition_number_after)} after this one: with "
        "the thesis's scaling, rounding alone undoes even data without noise. Errors relative to the truth; spread: "
        "standard deviation over the three sets over their mean, median of the bearings' direct stiffnesses.\n\n"
        + table(
            ["speeds", "data from", "noise", "all: median error", "bearing k direct: median error", "spread over three sets"],
            rows,
        )
        + "\n\n"
        + _likelihood(rig)
    )


def _power(condition_number: float) -> str:
    return "beyond 1e16" if condition_number > 1e16 else power(condition_number)


def _or_rounding(error: float) -> str:
    return "rounding" if error < 1e-6 else percent(error)


def _likelihood(rig: Rig) -> str:
    rows = []
    stiffness = [rig.names[k] for k in _members(rig, "bearing", ("kxx", "kyy"))]
    for campaign in (PRINTED, PRINTED_WITH_FLOOR, DENSE, BOTH_WAYS, BELOW, RESONANCES, RUN_UP):
        fits = [fitted(rig, campaign, seed=seed) for seed in range(LIKELIHOOD_SETS)]
        outcomes = [outcome for outcome in fits if outcome.accepted]
        within, judged = np.sum([_coverage(rig, outcome) for outcome in outcomes], axis=0)
        rows.append(
            [
                campaign.title,
                f"{len(outcomes)} of {len(fits)}",
                _range([sum(one.value is not None for one in outcome.estimates) for outcome in outcomes]),
                f"{within} of {judged}: {100 * within / judged:.0f} %",
                *_stiffness_errors(rig, outcomes, stiffness),
                power(float(np.median([outcome.condition_number for outcome in outcomes]))),
            ]
        )
    header = [
        "speeds",
        "fits accepted",
        f"estimates given, of {len(rig.names) + rig.unbalances.size}",
        "truth inside the 95 % interval",
        f"bearing k direct given, of {len(stiffness)}",
        "their rms error",
        "spread over the sets",
        "condition number, median",
    ]
    return (
        f"Maximum likelihood on data of the full model, {LIKELIHOOD_SETS} noise seeds, from a document whose coefficients "
        "are off by ± 50 %. What the data leave open is reported as not estimable, with the reason.\n\n"
        + table(header, rows)
        + "\n\nOnly accepted fits are counted. From the eight printed speeds a handful of cross-coupled terms is bounded by "
        "the size of the direct ones beside them. A direct stiffness is hardly ever given, and where one is, it is wrong by "
        "more than its interval says (at most 40 % is let through): intervals are linearised at the point where the fit ends, "
        "and the valley of equal misfit is long and bent. The condition number tells these fits, beyond a million, from the "
        "others, whose intervals hold as often as they say. Both senses of rotation, or speeds up to 130 Hz, give the "
        "bearings' stiffnesses within a tenth or two; only resonances give the coupling.\n\n"
        "Repeatability is no evidence of truth. At a hundred speeds the regression's three sets agree within a per cent or "
        "so, and the stiffnesses are wrong by tens of times: noise in the regressors biases every set alike, and so does the "
        "high-frequency condensation far below the resonances. From data of its own reduced model without noise the "
        "regression is exact; 1 % of noise is enough to undo it. Figure 5.18's agreement of three sets therefore does not "
        "say that its stiffnesses are the rig's."
    )


def _range(counts: Sequence[int]) -> str:
    """Write median, smallest and largest."""
    return f"{np.median(counts):.0f} ({min(counts)} to {max(counts)})"


def _coverage(rig: Rig, outcome: Identification) -> tuple[int, int]:
    """Return how many of the estimated coefficients have the truth inside their interval, and how many there are."""
    given = [
        (one.lower, true, one.upper)
        for one, true in zip(outcome.estimates[: len(rig.names)], rig.coefficients, strict=True)
        if one.lower is not None and one.upper is not None
    ]
    return sum(lower <= true <= upper for lower, true, upper in given), len(given)


def _stiffness_errors(rig: Rig, outcomes: Sequence[Identification], names: Sequence[str]) -> list[str]:
    """Return how many are given; rms of ln(estimate/truth); rms over parameters of its standard deviation over the sets."""
    true = dict(zip(rig.names, rig.coefficients, strict=True))
    found = np.array([[outcome.estimate(name).value or math.nan for name in names] for outcome in outcomes])
    error = np.log(found / [true[name] for name in names])
    given = np.isfinite(error)
    count = _range([int(one) for one in given.sum(axis=1)])
    if not given.any():
        return [count, "-", "-"]
    whole = error[:, given.all(axis=0)]
    spread = percent(float(np.sqrt(np.mean(whole.var(axis=0, ddof=1))))) if whole.size else "-"
    return [count, percent(float(np.sqrt(np.nanmean(error**2)))), spread]
