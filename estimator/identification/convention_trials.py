"""Trial of wrong conventions on a run that no fit explains: which of them would make it fit, and how much better.

Each hypothesis is undone on the run and fitted coarsely; swapped probes are first ranked with the document's coefficients
alone. One that leaves far less misfit is fitted as any run is. It is named where that fit is accepted, or is so much better
that nothing else can be the reason; those that fit equally well are named together: the run cannot tell them apart. Of several
runs one alone may have been sent so: each hypothesis is then tried on those without which the others fit far better. Derived
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
MOST_ODD = 2
"""Most runs of several on which alone hypotheses are tried."""
MOST_LEFT_OUT = 0.1
"""Part of the phasors, those that fit worst, that a comparison of misfits leaves out [-]."""
TRIAL = Options(starts=2, explain=False)
"""Options of a hypothesis's fit: a right one seldom needs a second start, and a wrong one is not to be explained otherwise."""
NO_FIT = (NotEnoughData, FitFailed, SingularCondensation)


class NamedConvention(Struct, frozen=True):
    """Wrong convention that explains a run.

    Attributes:
        convention: The convention.
        improvement: Squared misfit of the run as it was sent over that with the convention undone, by their fits or, where
            that tells more, by coarse ones [-].
        accepted: Whether the fit is accepted then.
        run: Number of the only run that was sent so, of several; None where all were.
    """

    convention: WrongConvention
    improvement: float
    accepted: bool
    run: int | None = None


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
    names: Sequence[str] = (),
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
        names: Names of the runs in the verdict; none where their numbers do.

    Returns:
        The identification with its verdict extended, and the conventions.
    """
    found = gated.identification
    if found is None:
        return ConventionVerdict(gated)
    if found.accepted:
        odd = implausible_unbalance(machine, found)
        return ConventionVerdict(gated if odd is None else _telling(gated, f"{found.verdict}; {odd.words}"))
    named = _Trial(machine, runs, measurements, rules, gate).named(found)
    if not named:
        return ConventionVerdict(gated)
    whose = names or [f"run {number + 1} of {len(runs)}" for number in range(len(runs))]
    return ConventionVerdict(_telling(gated, f"{_words(named, whose)}; {found.verdict}"), named)


def coarsely_better(machine: Machine, measurements: Sequence[Measurement]) -> tuple[WrongConvention, ...]:
    """Find the wrong conventions that a refused fit would have tried in full: without any, none can be named.

    Args:
        machine: The machine.
        measurements: Samples of its runs, run by run.

    Returns:
        The hypotheses, the best first; without those on amplitudes, which a fit must have found implausible first.
    """
    return tuple(one.convention for one, _ in _Trial(machine, (), measurements, None, gate=False).promising(None))


def _telling(gated: GatedIdentification, verdict: str) -> GatedIdentification:
    assert gated.identification is not None
    return replace(gated, identification=replace(gated.identification, verdict=verdict))


def _words(named: Sequence[NamedConvention], names: Sequence[str]) -> str:
    """Describe what explains the run, or some of the runs of these names, in a sentence's part before the verdict."""
    best = named[0]
    times = (
        f"{best.improvement:.{0 if best.improvement >= 10.0 else 1}f}"
        if best.improvement < MANY_TIMES
        else f"over {MANY_TIMES:.0f}"
    )
    fits = "the run fits" if len(names) == 1 else "the runs fit"
    said = [one.convention.words + ("" if one.run is None else f" in {names[one.run]} alone") for one in named]
    words, others = f"{fits} {times} times better with {said[0]}", said[1:]
    if others:
        words += f", or equally well with {' or with '.join(others)}"
    return words if best.accepted else f"{words}, though something else is wrong too"


class _Hypothesis(Struct, frozen=True):
    """A wrong convention of all runs, or of one alone."""

    convention: WrongConvention
    only: int | None = None

    def concerns(self, number: int) -> bool:
        """Return whether a run was sent so."""
        return self.only is None or self.only == number

    def measurements(self, given: Sequence[Measurement]) -> list[Measurement]:
        """Return the samples of runs with right conventions."""
        return [self.convention.measurement(one) if self.concerns(number) else one for number, one in enumerate(given)]

    def runs(self, given: Sequence[RecordedRun]) -> list[RecordedRun]:
        """Return runs with right conventions."""
        return [self.convention.run(one) if self.concerns(number) else one for number, one in enumerate(given)]

    def is_far_better(self, factor: float, *, accepted: bool) -> bool:
        """Return whether a misfit that is so many times less speaks for it."""
        if self.only is not None and self.convention.amplitude != 1.0:
            return accepted and factor >= BETTER  # unbalances that have grown are nearly such a factor
        return factor >= (BETTER if accepted else FAR_BETTER)


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
            if result is None:
                continue
            after = max(self._misfit(result, self._whole(one)), 1e-300)
            if one.is_far_better(before / after, accepted=result.accepted):
                improvement = max(before / after, coarsely if result.accepted else 0.0)
                named.append((after, NamedConvention(one.convention, improvement, result.accepted, one.only)))
        named.sort(key=lambda pair: (not pair[1].accepted, pair[0]))
        return tuple(
            one for after, one in named if one.accepted == named[0][1].accepted and after <= EQUALLY_WELL * named[0][0]
        )

    def promising(self, refused: Identification | None) -> list[tuple[_Hypothesis, float]]:
        """Return the hypotheses that leave far less misfit in a coarse fit, and how many times less, the best first.

        Those on the amplitudes of all runs only by a refused fit.
        """
        whole = joined(list(self.measurements))
        try:
            as_sent = self._coarsely(whole)
            tried = [(_Hypothesis(one), as_sent) for one in self._of_any_run(whole)]
            for number, misfit in self._odd(as_sent):
                tried += [(_Hypothesis(one, number), misfit) for one in self._of_one_run(number)]
        except NO_FIT:
            return []
        good = self._better(tried)
        if refused is None or any(one.only is None for one, _ in good):
            return good
        # A factor on all amplitudes goes with much that is wrong: it is the reason only where no other of all runs is.
        of_all = self._better([(_Hypothesis(one), as_sent) for one in self._amplitudes(refused, whole)])
        return [*of_all, *good]

    def _of_any_run(self, measurement: Measurement) -> list[WrongConvention]:
        """Return the hypotheses on samples of any run or runs: of swapped probes the likeliest, and none on amplitudes."""
        problem = coarse_problem(self.machine, measurement)
        swapped = sorted(swapped_probes(self.machine), key=lambda one: linear_misfit(_permuted(problem, one)))
        return [*wrong_conventions(self.machine, measurement), *swapped[:LIKELIEST]]

    def _of_one_run(self, number: int) -> list[WrongConvention]:
        """Return the hypotheses on one run of several, whose amplitudes the others' unbalances speak of."""
        scales = sorted(amplitude_scales(), key=lambda one: self._linear_misfit(_Hypothesis(one, number)))
        return [*self._of_any_run(self.measurements[number]), *scales[:LIKELIEST]]

    def _odd(self, as_sent: float) -> list[tuple[int, float]]:
        """Return the runs of several without which the others fit far better, those first without which best.

        With each its misfit alone where that is more than that of all: there it does not pass for outliers.
        """
        count = len(self.measurements)
        if count == 1:
            return []
        found = []
        for number in range(count):
            others = [one for place, one in enumerate(self.measurements) if place != number]
            misfit = max(as_sent, self._coarsely(self.measurements[number]))
            found.append((self._coarsely(joined(others)), number, misfit))
        found.sort()
        return [(number, misfit) for without, number, misfit in found[:MOST_ODD] if without <= misfit / COARSELY_BETTER]

    def _coarsely(self, measurement: Measurement) -> float:
        """Return the misfit of samples as they were sent in a coarse fit."""
        return coarse_misfit(coarse_problem(self.machine, measurement), starts=TRIAL.starts)

    def _better(self, tried: Sequence[tuple[_Hypothesis, float]]) -> list[tuple[_Hypothesis, float]]:
        """Return those of hypotheses, each with a misfit as sent, that leave far less, and how many times less, best first."""
        misfits = [(self._coarse_misfit(one), one, as_sent) for one, as_sent in tried]
        good = [each for each in misfits if each[0] <= min(HOPELESS_MISFIT, each[2] / COARSELY_BETTER)]
        good.sort(key=lambda each: each[0])
        return [(one, as_sent / max(misfit, 1e-300)) for misfit, one, as_sent in good[:MOST_FITTED]]

    def _amplitudes(self, refused: Identification, whole: Measurement) -> list[WrongConvention]:
        """Return the units of amplitudes to be tried: where known weights fix them, or the unbalances speak against theirs."""
        if has_known_weights(whole):
            kinds = [one for one in amplitude_scales() if one.name == "amplitude-kind"]
            units = [one for one in amplitude_scales() if one.name != "amplitude-kind"]
            return [*kinds, *sorted(units, key=lambda one: self._linear_misfit(_Hypothesis(one)))[:LIKELIEST]]
        odd = implausible_unbalance(self.machine, refused)
        return [] if odd is None else odd.units

    def _coarse_misfit(self, one: _Hypothesis) -> float:
        whole = self._whole(one)
        if not self._is_clear(whole if one.only is None else one.convention.measurement(self.measurements[one.only])):
            return float("inf")
        try:
            return coarse_misfit(coarse_problem(self.machine, whole))
        except (*NO_FIT, ValueError):  # such as amplitudes that no shaft reaches
            return float("inf")

    def _is_clear(self, measurement: Measurement) -> bool:
        """Return whether phasors stand out of their noise: what vanishes in it fits any model."""
        amplitude = np.abs(measurement.phasor[measurement.usable])
        error = error_size(self.machine.noise, amplitude, measurement.scatter[measurement.usable])
        return bool(np.mean(amplitude**2) >= CLEAR_SIGNAL * np.mean(error**2))

    def _linear_misfit(self, one: _Hypothesis) -> float:
        try:
            return linear_misfit(coarse_problem(self.machine, self._whole(one)))
        except (*NO_FIT, ValueError):
            return float("inf")

    def _whole(self, one: _Hypothesis) -> Measurement:
        return joined(one.measurements(self.measurements))

    def _fitted(self, one: _Hypothesis) -> Identification | None:
        runs, measurements = one.runs(self.runs), one.measurements(self.measurements)
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
