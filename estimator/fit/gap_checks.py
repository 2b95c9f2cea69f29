"""Gaps beside a fit of the phasors: which of them may be believed, and the fit with those.

The phasors alone say where the shaft stands, to some micrometres. A gap that moves the other way, many times as far, or not
at all, has another sign or unit than the document says, or comes through an input that is not coupled for direct current; one
that jumps has lost its probe (ratio by generalised least squares: Aitken, Proc. R. Soc. Edinb. 55 (1935) 42,
doi:10.1017/S0370164600014346). Such gaps are left out by name, and the fit of the phasors stands as it was.
"""

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import fit
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem.gap_rows import ChannelGaps, GapRows, gap_rows, seen_noise
from estimator.fit.validation.goodness_of_fit import accepted, judge
from estimator.units import METRES, rad_per_s_to_rpm

LARGEST_JUMP = 1e-5
"""Step between neighbouring samples, beside the motion before and behind it, that no shaft on films takes [m]."""
JUMP = 15.0
"""Multiple of the gap's noise that a step must exceed, too [-]."""
LARGEST_ERROR = 5.0
"""Standard errors by which the ratio of a gap's motion to that expected may differ from one [-]."""
SAME = 0.25
"""Least tolerance of that ratio about one [-]: films deviate from their model by as much."""


class GapVerdict(Struct, frozen=True):
    """Outcome of a fit with gaps.

    Attributes:
        problem: The fit's problem, with the gaps that are believed.
        found: Its end.
        remarks: What is said of the gaps, in words.
    """

    problem: FitProblem
    found: FitResult
    remarks: tuple[str, ...] = ()


def with_gaps(problem: FitProblem, found: FitResult) -> GapVerdict:
    """Fit the gaps of a measurement with its phasors, as far as they may be believed (module's docstring).

    Source: generalised least squares of Aitken, Proc. R. Soc. Edinb. 55 (1935) 42, doi:10.1017/S0370164600014346.

    Args:
        problem: The problem of the phasors.
        found: Its fit.

    Returns:
        The fit with gaps; the one given where there are none to believe.
    """
    gaps, machine = problem.measurement.gaps, problem.train.machine
    if gaps is None or machine is None:
        return GapVerdict(problem, found)
    from estimator.statics.film_model import FilmModel  # films are loaded where a train has them
    from estimator.statics.shaft_centreline import ShaftCentreline, probe_views

    placed = next((one for one in problem.coordinates.models if isinstance(one.model, FilmModel)), None)
    if placed is None or not judge(problem, found).accepted:
        return GapVerdict(problem, found)
    model = placed.model
    assert isinstance(model, FilmModel)
    centreline = ShaftCentreline(model.films, probe_views(machine), problem.measurement.speed)
    rows = gap_rows(
        model,
        centreline,
        gaps,
        rules=machine.centreline,
        speed=problem.measurement.speed,
        places=placed.numbers,
        fitted=placed.own(found.theta),
    )
    doubts = [(one, _gap_fault(problem, found, rows, one)) for one in rows.channels]
    remarks = tuple(words for _, words in doubts if words)
    kept = rows.without([one for one, words in doubts if words])
    if kept is None:
        return GapVerdict(problem, found, remarks)
    return _fitted(problem, found, kept, remarks)


def _fitted(problem: FitProblem, found: FitResult, rows: GapRows, remarks: tuple[str, ...]) -> GapVerdict:
    """Return the fit with gaps, begun where that of the phasors has ended; that one where both do not fit together."""
    whole = replace(with_fitted_noise(problem, found), gaps=rows)
    again = fit(whole, found.theta, near=True)
    cost = rows.cost(again.theta)
    if not judge(whole, again).accepted or not accepted(cost, rows.freedom):
        words = (
            f"the shaft centreline is left out: it does not fit together with the vibration, χ²/dof {cost / rows.freedom:.3g}"
        )
        return GapVerdict(problem, found, (*remarks, words))
    names = sorted({problem.train.channels[one.channel] for one in rows.channels})
    words = f"with the shaft centreline of {len(names)} channels, χ²/dof {cost / rows.freedom:.3g}"
    return GapVerdict(whole, replace(again, iterations=found.iterations + again.iterations), (*remarks, words))


def _gap_fault(problem: FitProblem, found: FitResult, rows: GapRows, one: ChannelGaps) -> str:
    """Return why the gaps of a channel are not believed; empty where they are."""
    channel = problem.train.channels[one.channel]
    jump = _jump(one)
    if jump is not None:
        at, size = rad_per_s_to_rpm(float(problem.measurement.speed[one.samples[jump]])), float(_steps(one.place)[jump - 1])
        return (
            f"the gap of {channel} jumps by {size / METRES['um']:.0f} µm at {at:.0f} r/min and is left out: the probe, its "
            "holder or its cable has moved"
        )
    ratio, error, misfit = _ratio(problem, found, rows, one)
    if abs(ratio - 1.0) > max(SAME, LARGEST_ERROR * error):
        return f"the gap of {channel} {_ratio_words(problem, one.channel, ratio)}; it is left out"
    if not accepted(misfit, one.freedom):
        return f"the gap of {channel} does not move as the journals do, χ²/dof {misfit / one.freedom:.3g}; it is left out"
    return ""


def _steps(place: Floats) -> Floats:
    return np.asarray(np.diff(place))


def _jump(one: ChannelGaps) -> int | None:
    """Return the sample at which a gap has jumped, among the channel's own; None where it has not."""
    steps = _steps(one.place)
    usual = np.array([np.median(steps[max(0, k - 3) : k + 4]) for k in range(steps.size)])
    beside = np.abs(steps - usual)
    limit = max(LARGEST_JUMP, JUMP * max(seen_noise(one.place), 0.0))
    worst = int(np.argmax(beside))
    return worst + 1 if beside[worst] > limit else None


def _ratio(problem: FitProblem, found: FitResult, rows: GapRows, one: ChannelGaps) -> tuple[float, float, float]:
    """Estimate how many times as far a gap has moved as the phasors' fit expects (generalised least squares, Aitken 1935).

    Returns the ratio, its standard error, and χ² of the gap against the expectation; the error of the expectation counts, too.
    """
    own = found.theta[rows.places]
    covariance = np.linalg.inv(found.information + problem.coordinates.prior.precision)[np.ix_(rows.places, rows.places)]
    expected = one.whitened(rows.centreline.values(own)[:, one.channel])
    slopes = one.whitened(rows.centreline.derivatives(own)[:, one.channel])
    whole = np.eye(expected.size) + slopes @ covariance @ slopes.T
    solved = np.linalg.solve(whole, np.column_stack([expected, one.measured]))
    power = float(expected @ solved[:, 0])
    residual = one.measured - expected
    misfit = float(residual @ np.linalg.solve(whole, residual))
    if power <= 0.0:
        return 1.0, float("inf"), misfit
    return float(expected @ solved[:, 1]) / power, power**-0.5, misfit


def _ratio_words(problem: FitProblem, channel: int, ratio: float) -> str:
    """Return the words on the ratio of a gap's measured motion to the expected one."""
    machine = problem.train.machine
    said = None if machine is None else machine.probes[channel].gap_grows
    if -2.0 < ratio < -0.5:
        other = "towards" if said == "away" else "away"
        return f"moves the other way than the journals do: gap_grows is {said} in the document, is it {other}?"
    if abs(ratio) < SAME:
        return f"hardly moves, {ratio:.2g} times as the journals do: is its input coupled for direct current?"
    return f"moves {ratio:.2g} times as the journals do: are its unit and sensitivity right?"
