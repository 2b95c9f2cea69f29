"""Trial of wrong conventions on a run that no fit explains: which of them would make it fit, and how much better.

Each hypothesis is undone on the run and fitted coarsely; swapped probes are first ranked with the document's coefficients
alone. One that leaves far less misfit is fitted as any run is. It is named where that fit is accepted, or is so much better
that nothing else can be the reason; those that fit equally well are named together: the run cannot tell them apart. Derived
here.
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.fit.coarse_fit import coarse_misfit, coarse_problem, linear_misfit
from estimator.fit.fit_samples import NotEnoughData
from estimator.fit.identification import Identification, Options
from estimator.fit.optimisation.maximum_likelihood import HOPELESS_MISFIT
from estimator.fit.optimisation.multistart import FitFailed
from estimator.fit.problem.fit_problem import FitProblem
from estimator.fit.problem_setup import expected_phasors
from estimator.identification.implausible_amplitudes import implausible_unbalance
from estimator.identification.quality_gate import GatedIdentification, identify_gated
from estimator.identification.wrong_conventions import (
    WrongConvention,
    amplitude_scales,
    has_known_weights,
    swapped_probes,
    wrong_conventions,
)
from estimator.machine.document import Machine
from estimator.machine.rules import QualityRules
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.noise import error_size
from estimator.phasors.recorded_run import RecordedRun
from estimator.rotor.elimination import SingularCondensation

COARSELY_BETTER = 4.0
"""Least factor by which a hypothesis must lower the coarse misfit to be fitted [-]."""
BETTER = 1.0
"""Least factor by which the fit itself must be better for a hypothesis to be named whose fit is accepted [-].

What bends until it fits, such as films and outliers, leaves hardly more misfit, but is refused for it.
"""
FAR_BETTER = 30.0
"""Least factor on the squared misfit by which a hypothesis is named although its own fit is refused [-]."""
EQUALLY_WELL = 2.0
"""Largest factor between the misfits of hypotheses that the run cannot tell apart [-]."""
MANY_TIMES = 1000.0
"""Factor from which on its size says nothing more [-]."""
CLEAR_SIGNAL = 100.0
"""Least mean square of phasors over their noise for a conclusive fit [-]; below it any model fits."""
LIKELIEST = 5
"""Number of swapped probes, and of units of amplitudes, that are fitted: the likeliest by the document's coefficients."""
MOST_FITTED = 4
"""Most hypotheses that are fitted in full."""
MOST_LEFT_OUT = 0.1
"""Part of the phasors, those that fit worst, that a comparison of misfits leaves out [-]."""
TRIAL = Options(starts=2)
"""Options of a hypothesis's fit: a right one seldom needs a second start."""
NO_FIT = (NotEnoughData, FitFailed, SingularCondensation)


class NamedConvention(Struct, frozen=True):
    """Wrong convention that explains a run.

    Attributes:
        convention: The convention.
        improvement: Squared misfit of the run as it was sent over that with the convention undone, by their fits or, where
            that tells more, by coarse ones [-].
        accepted: Whether the fit is accepted then.
    """

    convention: WrongConvention
    improvement: float
    accepted: bool


class ConventionVerdict(Struct, frozen=True):
    """An identification with what its run says about the source's conventions.

    Attributes:
        gated: The identification; its verdict begins with what was found.
        named: Wrong conventions that explain the run, the best first; several where it cannot tell them apart.
    """

    gated: GatedIdentification
    named: tuple[NamedConvention, ...] = ()


def with_named_conventions(
    machine: Machine,
    runs: Sequence[RecordedRun],
    measurements: Sequence[Measurement],
    gated: GatedIdentification,
    *,
    rules: QualityRules | None = None,
    gate: bool = True,
) -> ConventionVerdict:
    """Name the wrong conventions that explain a refused fit, or unbalances that no rotor has.

    An accepted fit costs nothing; its amplitudes are only compared with what is plausible.

    Args:
        machine: The machine.
        runs: Recorded runs.
        measurements: The same samples, run by run.
        gated: Their identification behind the quality gate.
        rules: Rules of quality, as `identify_gated` had them.
        gate: Whether points are left out, as `identify_gated` had it.

    Returns:
        The identification with its verdict extended, and the conventions.
    """
    found = gated.identification
    if found is None:
        return ConventionVerdict(gated)
    if found.accepted:
        odd = implausible_unbalance(machine, found)
        return ConventionVerdict(gated if odd is None else _telling(gated, f"{found.verdict}; {odd.words}"))
    trial = _Trial(machine, runs, measurements, rules, gate)
    named = trial.named(found)
    return (
        ConventionVerdict(_telling(gated, f"{_words(named)}; {found.verdict}"), named) if named else ConventionVerdict(gated)
    )


def coarsely_better(machine: Machine, measurements: Sequence[Measurement]) -> tuple[WrongConvention, ...]:
    """Find the wrong conventions that a refused fit would have tried in full: without any, none can be named.

    Args:
        machine: The machine.
        measurements: Samples of its runs, run by run.

    Returns:
        The hypotheses, the best first; without those on amplitudes, which a fit must have found implausible first.
    """
    return tuple(one for one, _ in _Trial(machine, (), measurements, None, gate=False).promising(None))


def _telling(gated: GatedIdentification, verdict: str) -> GatedIdentification:
    assert gated.identification is not None
    return replace(gated, identification=replace(gated.identification, verdict=verdict))


def _words(named: Sequence[NamedConvention]) -> str:
    """Describe what explains the run, in a sentence's part that stands before the verdict."""
    best = named[0]
    times = (
        f"{best.improvement:.{0 if best.improvement >= 10.0 else 1}f}"
        if best.improvement < MANY_TIMES
        else f"over {MANY_TIMES:.0f}"
    )
    words = f"the run fits {times} times better with {best.convention.words}"
    others = [one.convention.words for one in named[1:]]
    if others:
        words += f", or equally well with {' or with '.join(others)}"
    return words if best.accepted else f"{words}, though something else is wrong too"


class _Trial(Struct, frozen=True):
    """Runs that no fit explains, and how they were judged."""

    machine: Machine
    runs: Sequence[RecordedRun]
    measurements: Sequence[Measurement]
    rules: QualityRules | None
    gate: bool

    def named(self, refused: Identification) -> tuple[NamedConvention, ...]:
        """Return the hypotheses that explain the runs, the best first."""
        found = [(one, coarsely, self._fitted(one)) for one, coarsely in self.promising(refused)]
        before = self._misfit(refused, joined(list(self.measurements)))
        named = []
        for one, coarsely, result in found:
            after = float("inf") if result is None else max(self._misfit(result, self._whole(one)), 1e-300)
            if result is not None and before >= (BETTER if result.accepted else FAR_BETTER) * after:
                improvement = max(before / after, coarsely if result.accepted else 0.0)
                named.append((after, NamedConvention(one, improvement, result.accepted)))
        named.sort(key=lambda pair: (not pair[1].accepted, pair[0]))
        return tuple(
            one for after, one in named if one.accepted == named[0][1].accepted and after <= EQUALLY_WELL * named[0][0]
        )

    def promising(self, refused: Identification | None) -> list[tuple[WrongConvention, float]]:
        """Return the hypotheses that leave far less misfit in a coarse fit, and how many times less, the best first.

        Those on amplitudes only by a refused fit.
        """
        whole = joined(list(self.measurements))
        try:
            problem = coarse_problem(self.machine, whole)
        except NO_FIT:
            return []
        as_sent = coarse_misfit(problem, starts=TRIAL.starts)
        tried = list(wrong_conventions(self.machine, whole))
        tried += sorted(swapped_probes(self.machine), key=lambda one: linear_misfit(_permuted(problem, one)))[:LIKELIEST]
        good = self._better(tried, as_sent)
        # A factor on all amplitudes goes with much that is wrong: it is the reason only where nothing else is.
        return good if good or refused is None else self._better(self._amplitudes(refused, whole), as_sent)

    def _better(self, tried: Sequence[WrongConvention], as_sent: float) -> list[tuple[WrongConvention, float]]:
        """Return those with far less misfit in a coarse fit than the run as sent, and how many times less, the best first."""
        limit = min(HOPELESS_MISFIT, as_sent / COARSELY_BETTER)
        misfits = [(self._coarse_misfit(one), one) for one in tried]
        good = sorted(((misfit, one) for misfit, one in misfits if misfit <= limit), key=lambda pair: pair[0])
        return [(one, as_sent / max(misfit, 1e-300)) for misfit, one in good[:MOST_FITTED]]

    def _amplitudes(self, refused: Identification, whole: Measurement) -> list[WrongConvention]:
        """Return the units of amplitudes to be tried: where known weights fix them, or the unbalances speak against theirs."""
        if has_known_weights(whole):
            kinds = [one for one in amplitude_scales() if one.name == "amplitude-kind"]
            units = [one for one in amplitude_scales() if one.name != "amplitude-kind"]
            return [*kinds, *sorted(units, key=self._linear_misfit)[:LIKELIEST]]
        odd = implausible_unbalance(self.machine, refused)
        return [] if odd is None else odd.units

    def _coarse_misfit(self, one: WrongConvention) -> float:
        whole = self._whole(one)
        amplitude = np.abs(whole.phasor[whole.usable])
        error = error_size(self.machine.noise, amplitude, whole.scatter[whole.usable])
        if np.mean(amplitude**2) < CLEAR_SIGNAL * np.mean(error**2):
            return float("inf")
        try:
            return coarse_misfit(coarse_problem(self.machine, whole))
        except (*NO_FIT, ValueError):  # such as amplitudes that no shaft reaches
            return float("inf")

    def _linear_misfit(self, one: WrongConvention) -> float:
        try:
            return linear_misfit(coarse_problem(self.machine, self._whole(one)))
        except (*NO_FIT, ValueError):
            return float("inf")

    def _whole(self, one: WrongConvention) -> Measurement:
        return one.measurement(joined(list(self.measurements)))

    def _fitted(self, one: WrongConvention) -> Identification | None:
        runs = [one.run(run) for run in self.runs]
        measurements = [one.measurement(measurement) for measurement in self.measurements]
        try:
            return identify_gated(
                self.machine, runs, measurements, options=TRIAL, rules=self.rules, gate=self.gate
            ).identification
        except NO_FIT:
            return None

    def _misfit(self, found: Identification, measurement: Measurement) -> float:
        """Return the mean squared misfit over the noise, without the phasors that fit worst [-]."""
        model = expected_phasors(self.machine, measurement, found.point)
        error = error_size(self.machine.noise, np.abs(model), measurement.scatter)
        there = measurement.usable & (error > 0.0)
        size = np.sort(np.abs(measurement.phasor - model)[there] ** 2 / error[there] ** 2)
        kept = size[: max(1, int((1.0 - MOST_LEFT_OUT) * size.size))]
        return float(np.mean(kept)) if kept.size else float("inf")


def _permuted(problem: FitProblem, one: WrongConvention) -> FitProblem:
    return replace(problem, measurement=one.measurement(problem.measurement), outlier=np.zeros_like(problem.outlier))
