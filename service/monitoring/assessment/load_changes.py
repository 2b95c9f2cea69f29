"""Changes of the force and the moment in a misaligned coupling against the bands that their trends are drawn with."""

from collections.abc import Iterator

import numpy as np

from estimator.diagnosis.finding_kind import SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.trends.baseline_band import baseline_band
from service.monitoring.assessment.context import AssessmentContext, ComparedValue


def load_changes(context: AssessmentContext, element: str) -> Iterator[SizePart]:
    """Yield the changes of the loads in a coupling that have left the band of the baseline, the larger in the band first."""
    told = [(one, part) for one in context.loads if one.element == element and (part := change_beyond_band(one)) is not None]
    yield from sorted((part for _, part in told), key=lambda part: -abs(part.value) / max(part.upper - part.value, 1e-300))


def change_beyond_band(one: ComparedValue) -> SizePart | None:
    """Return the change of a value; None where it lies in the band of the baseline."""
    values = np.array([value for value, _ in one.baseline])
    errors = np.array([(half or 0.0) / CONFIDENCE_95 for _, half in one.baseline])
    band = baseline_band(one.name, values, errors)
    now = one.newest
    if band.lower <= now <= band.upper:
        return None
    half = (band.upper - band.lower) / 2.0
    change = now - band.centre
    return SizePart(one.name, one.unit, change, change - half, change + half, before=band.centre)
