"""Identification behind a quality gate: points that break the steady state are left out or corrected, with their reason.

The sweep rate is judged with the machine's own model, the fitted one, or the document's where nothing fits the run as it is.
What the model predicts that the sweep adds is taken off the phasors; points at which it is more than a few times their noise
are left out, and the prediction's own error is added to the scatter of the others. Leaving points out alone is not enough:
what stays below the noise of each is the same at many neighbouring points and moves the estimates by more than their standard
errors.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.fit_samples import NotEnoughData
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.fit.problem_setup import expected_phasors, expected_point
from estimator.identification.sweep_correction import predicted_transient
from estimator.machine.document import Machine
from estimator.machine.rules import QualityRules
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.noise import error_size
from estimator.phasors.quality import Flag, Quality, assess, scatter_from_neighbours, too_few
from estimator.phasors.recorded_run import RecordedRun
from estimator.phasors.sweep_transient import SweepTransient
from estimator.updated_model.model import UpdatedModel, model_at, updated_model

NEGLIGIBLE = 0.1
"""Part of the noise up to which predicted deviations are left alone [-]."""
LARGEST_UNFITTED = 1.0
"""Largest deviation, over the noise, at which a point is kept when the document's model predicts it [-]."""
LARGEST_FITTED = 2.0
"""Largest deviation, over the noise, at which a point is kept when the fitted model predicts it [-]."""
PREDICTION_ERROR = 0.3
"""Rms error of a predicted deviation, as a part of it [-]."""
PASSES = 3
"""Most times the points are judged anew with the model fitted to those that were left."""
SETTLED = 0.1
"""Rms change of the predicted deviations, over the noise, below which they count as unchanged [-]."""
CERTAIN = 25.0
"""Difference of twice the log-likelihoods from which on the data contradict the times [-]."""
LARGEST_SQUARE = 25.0
"""Largest contribution of one phasor, as a squared multiple of its noise [-]."""


class GatedIdentification(Struct, frozen=True):
    """Outcome of an identification behind the quality gate.

    Attributes:
        qualities: Quality of each run.
        identification: The identification; None where the points left do not allow one.
        error: Reason why there is no identification.
    """

    qualities: tuple[Quality, ...]
    identification: Identification | None
    error: str | None = None


class _Treatment(Struct, frozen=True, eq=False):
    """Treatment of the sweep: predicted deviation and error of each phasor (S, m) [m], size the one over the other."""

    deviation: Complexes
    error: Floats
    size: Floats
    excluded: NDArray[np.bool_]
    corrected: NDArray[np.bool_]

    def applied(self, base: Measurement) -> Measurement:
        """Return the measurement without the predicted effect of the sweep."""
        # What was not corrected, with the document's model, counts as an error in full.
        off = np.where(self.corrected, self.deviation, 0.0)
        part = np.where(self.corrected, PREDICTION_ERROR, 1.0) * np.abs(self.deviation)
        scatter = np.where(self.size > NEGLIGIBLE, np.hypot(self.error, part), base.scatter)
        return replace(base, phasor=base.phasor - off, scatter=scatter, usable=base.usable & ~self.excluded)


def identify_gated(
    machine: Machine,
    runs: Sequence[RecordedRun],
    measurements: Sequence[Measurement],
    *,
    options: Options | None = None,
    rules: QualityRules | None = None,
    gate: bool = True,
    beginning: Floats | None = None,
) -> GatedIdentification:
    """Judge runs and identify the machine from what may be used of all of them together.

    Args:
        machine: The machine.
        runs: Recorded runs.
        measurements: The same samples, run by run, with trial weights where there were any.
        options: Options of the fit.
        rules: Rules of quality; None for the document's.
        gate: Whether points are left out; without it the quality is stated, but only what the source itself calls unusable is
            left out.
        beginning: Values (N,) of an earlier identification to start from, as in `identify` [SI, logarithms of direct terms].

    Returns:
        Qualities and identification; a lack of data becomes its error.

    Raises:
        FitFailed: No start leads anywhere.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    rules = rules or machine.quality
    qualities = tuple(assess(run, noise=machine.noise, rules=rules) for run in runs)
    triples = zip(runs, measurements, qualities, strict=True)
    base = joined([_usable_measurement(machine, *one) for one in triples] if gate else list(measurements))
    error, found = None, None
    try:
        if rules.sweep_rate and all(_clock_trusted(*one) for one in zip(runs, qualities, strict=True)):
            qualities, found = _without_sweep(machine, runs, base, qualities, options, correct=gate, beginning=beginning)
        else:
            found = identify(machine, base, options, beginning=beginning)
    except NotEnoughData as reason:
        error = str(reason)
    # Dwells at constant speeds have no times, and a few of them are enough.
    qualities = tuple(
        one if run.time is None else replace(one, findings=(*one.findings, *too_few(one)))
        for one, run in zip(qualities, runs, strict=True)
    )
    left_out = "; ".join(one.words for one in qualities if one.words) if gate else ""
    if left_out:
        error = f"{error}; {left_out}" if error else None
        found = replace(found, verdict=f"{found.verdict}; {left_out}") if found else None
    return GatedIdentification(qualities, found, error)


def _usable_measurement(machine: Machine, run: RecordedRun, measurement: Measurement, quality: Quality) -> Measurement:
    stated = "noise" in machine.model_fields_set
    scatter = measurement.scatter if stated else scatter_from_neighbours(run, quality)
    return replace(measurement, usable=measurement.usable & quality.usable, scatter=scatter)


def _clock_trusted(run: RecordedRun, quality: Quality) -> bool:
    ascending = run.time is not None and run.time.size > 1 and bool(np.all(np.diff(run.time) > 0.0))
    return ascending and not quality.clock_doubted


def _without_sweep(
    machine: Machine,
    runs: Sequence[RecordedRun],
    base: Measurement,
    qualities: tuple[Quality, ...],
    options: Options | None,
    *,
    correct: bool,
    beginning: Floats | None,
) -> tuple[tuple[Quality, ...], Identification]:
    """Identify from the points that the sweeps left usable."""
    pieces = _run_slices(runs)
    plain = identify(machine, base, replace(options or Options(), starts=1), beginning=beginning)
    used, found = base, plain
    if not plain.accepted:
        used, found = _by_the_document(machine, runs, base, options, correct=correct)
    for _ in range(PASSES):
        steady = expected_phasors(machine, base, found.point)
        transient = _transient(updated_model(machine, found), runs, base, pieces)
        deviation = _closest_transient(machine, base, steady, transient)
        treatment = _treatment(machine, base, steady, deviation, limit=LARGEST_FITTED, correct=True)
        wanted = treatment.applied(base) if correct else base
        if _is_unchanged(used, wanted, treatment.error):
            break
        used = wanted
        # A few points have changed: the fit goes on from where it stands, and a hopeless one is not begun again and again.
        again = replace(options or Options(), starts=1)
        found = replace(identify(machine, used, again, beginning=found.point), starts=found.starts + 1)
    # The clock is believed unless the data clearly contradict it: a free enough model can take in what the sweep has added.
    steady_is_better = _steady_fits_better(machine, base, plain, treatment, steady)
    if plain.accepted and steady_is_better:
        found = plain
    each = zip(qualities, pieces, strict=True)
    if (found.accepted or not correct) and not steady_is_better:
        return tuple(_with_findings(one, piece, treatment, base) for one, piece in each), found
    return tuple(_with_doubtful_steady_state(one, piece, base, treatment, fitted=found.accepted) for one, piece in each), found


def _by_the_document(
    machine: Machine, runs: Sequence[RecordedRun], base: Measurement, options: Options | None, *, correct: bool
) -> tuple[Measurement, Identification]:
    """Find the usable points by the document's own model, and fit them: for sweeps with which nothing fits as it is."""
    model = model_at(machine, *expected_point(machine, base))
    transient = _transient(model, runs, base, _run_slices(runs))
    treatment = _treatment(machine, base, base.phasor, transient.instant, limit=LARGEST_UNFITTED, correct=False)
    if correct and np.any(treatment.excluded & base.usable):
        used = treatment.applied(base)
        found = _identified_if_enough(machine, used, options)
        if found is not None:
            return used, found
    # The document's model may be wrong: when it leaves too little, that is not the last word.
    return base, identify(machine, base, options)


def _run_slices(runs: Sequence[RecordedRun]) -> list[slice]:
    """Return the slice of each run's samples among those of all."""
    ends = np.cumsum([run.speed.size for run in runs])
    return [slice(end - run.speed.size, end) for end, run in zip(ends, runs, strict=True)]


def _identified_if_enough(machine: Machine, measurement: Measurement, options: Options | None) -> Identification | None:
    try:
        return identify(machine, measurement, options)
    except NotEnoughData:
        return None


def _transient(model: UpdatedModel, runs: Sequence[RecordedRun], base: Measurement, pieces: Sequence[slice]) -> SweepTransient:
    """Predict the transients of all runs, one after the other, each in its sense of rotation and with its trial weight."""
    each = []
    for run, piece in zip(runs, pieces, strict=True):
        if run.time is None:
            continue
        added = None if base.added is None else base.added[piece][0]
        turning = 1 if np.sum(base.direction[piece]) >= 0.0 else -1
        each.append(predicted_transient(model.turning(turning), time=run.time - run.time[0], speed=run.speed, added=added))
    return SweepTransient(np.concatenate([one.instant for one in each]), np.concatenate([one.averaged for one in each]))


def _treatment(
    machine: Machine, base: Measurement, steady: Complexes, deviation: Complexes, *, limit: float, correct: bool
) -> _Treatment:
    error = error_size(machine.noise, np.abs(np.where(np.isfinite(steady), steady, 0.0)), base.scatter)
    size = np.divide(np.abs(deviation), error, out=np.full(error.shape, np.inf), where=error > 0.0)
    excluded = size > limit
    return _Treatment(deviation, error, size, excluded, (size > NEGLIGIBLE) & ~excluded & correct)


def _closest_transient(machine: Machine, base: Measurement, steady: Complexes, transient: SweepTransient) -> Complexes:
    """Choose the predicted transient that is nearer to the data: of phasors of an instant, or of means over a block."""
    error = error_size(machine.noise, np.abs(steady), base.scatter)
    telling = base.usable & (np.abs(transient.instant) > NEGLIGIBLE * error)
    rest = np.where(telling, base.phasor - steady, 0.0)

    def misfit(deviation: Complexes) -> float:
        # A model with growing modes predicts transients whose squares no number holds.
        size = np.abs((rest - deviation)[telling]) / error[telling]
        return float(np.sum(np.minimum(size, math.sqrt(LARGEST_SQUARE)) ** 2))

    return min((transient.averaged, transient.instant), key=misfit)


def _steady_fits_better(
    machine: Machine, base: Measurement, plain: Identification, treatment: _Treatment, steady: Complexes
) -> bool:
    """Check whether the fit without the sweep explains the data clearly better than the one with it taken off.

    Twice the negative log-likelihood of all phasors under either, each with its own fit; the contribution of one phasor is
    limited.
    """
    there = base.usable & (treatment.error > 0.0)
    if not np.any((treatment.size > NEGLIGIBLE) & there):
        return False
    without = expected_phasors(machine, base, plain.point)
    error = error_size(machine.noise, np.abs(without), base.scatter)
    widened = np.hypot(treatment.error, PREDICTION_ERROR * np.abs(treatment.deviation))

    def cost(model: Complexes, size: Floats) -> float:
        ratio = np.abs(base.phasor - model)[there] / size[there]
        squares = np.minimum(ratio, math.sqrt(LARGEST_SQUARE)) ** 2
        return float(np.sum(2.0 * squares + 4.0 * np.log(size[there])))

    return cost(without, error) + CERTAIN < cost(steady + treatment.deviation, widened)


def _is_unchanged(before: Measurement, after: Measurement, error: Floats) -> bool:
    if not np.array_equal(before.usable, after.usable):
        return False
    moved = np.abs(before.phasor - after.phasor)[after.usable] / error[after.usable]
    return bool(not moved.size or np.sqrt(np.mean(moved**2)) < SETTLED)


def _with_doubtful_steady_state(
    quality: Quality, piece: slice, base: Measurement, treatment: _Treatment, *, fitted: bool
) -> Quality:
    """Return the quality of a run whose phasors are those of a steady state, although its times say otherwise."""
    beyond = int(np.count_nonzero(base.usable[piece] & (treatment.size[piece] > LARGEST_UNFITTED)))
    if not beyond:
        return quality
    words = f"sweep rate: by the times {beyond} phasors should deviate from the steady state by more than their noise, "
    # A model that does not fit would call every run a steady one.
    words += (
        "and the data say that they do not: the times are not those of the measurement, the phasors were computed, "
        "or the model has taken in what the sweep added"
        if fitted
        else "and no fit explains the data, with that taken off or not: the sweep may have been too fast"
    )
    return replace(quality, findings=(*quality.findings, words))


def _with_findings(quality: Quality, piece: slice, treatment: _Treatment, base: Measurement) -> Quality:
    """Return the quality of one run, a piece of all samples, with flags and findings on what was done."""
    usable = base.usable[piece]
    excluded, corrected = treatment.excluded[piece] & usable, treatment.corrected[piece] & usable
    if not excluded.any() and not corrected.any():
        return quality
    largest = float(np.max(np.where(usable, treatment.size[piece], 0.0)))
    words = (
        f"sweep rate: the model predicts deviations from the steady state of up to {largest:.2g} times the noise; "
        f"{int(np.count_nonzero(excluded))} phasors left out, {int(np.count_nonzero(corrected))} corrected"
    )
    return quality.with_flag(Flag.SWEEP_RATE, excluded, words).with_flag(Flag.CORRECTED, corrected)
