"""Progress of a change: how large it was in each run since it began, how fast it grows, and when it reaches a limit.

A run shows a cause by the part of the cause's change that explains it best: generalised least squares (Aitken 1935,
doi:10.1017/S0370164600014346) along that change, beside the other causes. Its growth is the slope of Theil and Sen
(doi:10.1080/01621459.1968.10480934) over those runs.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.baseline_reference import Reference
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.observation import Observation
from estimator.fit.estimates import CONFIDENCE_95
from estimator.trends import drift as slow_drift
from estimator.trends.drift import Drift, time_to_limit

FEWEST = slow_drift.FEWEST
"""Fewest runs since a change began that tell how fast it grows."""
LARGEST_PART = 100.0
"""Largest part of a cause's change that a run is taken to show [-]."""


@dataclass(frozen=True)
class LimitAhead:
    """A limit that a change has not reached, and the weeks until it does at the present rate.

    Attributes:
        limit: The limit [unit of the size].
        expected: Time by the rate [weeks]; None where the change does not grow.
        earliest: Earliest time by the rate's 95 % interval [weeks].
        latest: Latest time [weeks]; None where the interval holds a rate of zero or less.
    """

    limit: float
    expected: float | None
    earliest: float | None
    latest: float | None


@dataclass(frozen=True)
class ChangeProgress:
    """Progress of a change since it began.

    Attributes:
        runs: Number of runs since then, those that tell nothing left out.
        newest: Size that the newest of them shows [unit of the size]; None where there is none.
        per_week: Rate [unit/week]; None for fewer than four runs.
        lower: Lower end of its 95 % interval [unit/week].
        upper: Upper end of its 95 % interval [unit/week].
        ahead: The next limit; None where there is none, or no rate.
    """

    runs: int
    newest: float | None = None
    per_week: float | None = None
    lower: float | None = None
    upper: float | None = None
    ahead: LimitAhead | None = None

    @property
    def grows(self) -> bool:
        """Return whether it is certain (95 %) that the change gets larger."""
        return self.lower is not None and self.lower > 0.0


def shown_part(baseline: Reference, cause: Cause, beside: Sequence[Cause], one: Observation) -> float | None:
    """Return the part of a cause's change that one run shows (generalised least squares, Aitken 1935).

    Args:
        baseline: The baseline.
        cause: The cause, which has quantities.
        beside: The other causes.
        one: Observation of the run.

    Returns:
        The part [-], at least 0; None for a run that tells nothing of it.
    """
    seen, drawn = baseline.alone(one)
    white = _white(baseline, cause)
    for other in beside:
        drawn = drawn - seen @ _white(baseline, other)
    known = float(white @ seen @ white)
    if known < 1.0:
        return None
    return min(max(0.0, float(white @ drawn) / known), LARGEST_PART)


def change_progress(
    baseline: Reference,
    cause: Cause,
    beside: Sequence[Cause],
    runs: Sequence[tuple[float, Observation]],
    *,
    size: Callable[[Cause], float | None],
    limit: float | None,
) -> ChangeProgress:
    """Follow a change over the runs since it began (slope of Theil and Sen, doi:10.1080/01621459.1968.10480934).

    Args:
        baseline: The baseline.
        cause: The cause.
        beside: The other causes.
        runs: Time [weeks] and observation of each run since the cause began, in ascending order of time.
        size: Function that returns the size of a cause [any unit]; None where it has none.
        limit: Limit of the size [unit of the size]; None for none.

    Returns:
        The progress.
    """
    times: list[float] = []
    sizes: list[float] = []
    for time, one in runs:
        part = shown_part(baseline, cause, beside, one) if cause.names else None
        found = None if part is None else size(replace(cause, change=part * cause.change))
        if found is not None and (not times or time > times[-1]):
            times.append(time)
            sizes.append(abs(found))
    newest = sizes[-1] if sizes else None
    if len(times) < FEWEST:
        return ChangeProgress(len(times), newest)
    drift = slow_drift.drift(np.array(times), np.array(sizes))
    rates = (drift.slope, drift.slope_lower, drift.slope_upper)
    ahead = None if limit is None or drift.level >= limit else _ahead(drift, limit, np.array(times), np.array(sizes))
    return ChangeProgress(len(times), newest, *rates, ahead)


def _ahead(drift: Drift, limit: float, times: Floats, sizes: Floats) -> LimitAhead:
    """Return when a limit is reached: by the ends of the rate's interval, from the ends of that of the newest size.

    The scatter of the runs about the line is that of the newest size as well (derived here).
    """
    residual = sizes - drift.level - drift.slope * (times - times[-1])
    half = CONFIDENCE_95 * float(np.sqrt(residual @ residual / (len(times) - 2)))
    expected = time_to_limit(drift, limit).expected
    soonest = time_to_limit(replace(drift, level=drift.level + half), limit).earliest if drift.level + half < limit else 0.0
    return LimitAhead(limit, expected, soonest, time_to_limit(replace(drift, level=drift.level - half), limit).latest)


def _white(baseline: Reference, cause: Cause) -> Floats:
    """Return the change (N,) of a cause in units of the run-to-run variation [-]."""
    white = np.zeros(len(baseline.names))
    white[[baseline.names.index(name) for name in cause.names]] = cause.change
    return np.asarray(white / baseline.unit)
