"""Adjustment of identified parameters to the mean operating conditions of the baseline they are compared with."""

from collections.abc import Sequence

from sqlalchemy.orm import Session

from estimator.trends.covariates import Adjustment, adjustment
from estimator.trends.parameter_vector import Point
from estimator.trends.trend_tests import DatedPoint
from service.monitoring.assessment.context import WEEK
from service.monitoring.comparison import Compared
from storage.findings import identifications
from storage.machines import machines
from storage.tables.findings import IdentificationRow


def points(session: Session, found: Compared, rows: Sequence[IdentificationRow]) -> list[Point]:
    """Return the parameters of some of these identifications, adjusted to the baseline's mean operating conditions."""
    known = identifications.points(session, rows)
    adjusted = condition_adjustment(session, found).adjusted
    return [adjusted(known[row.id], row.conditions or {}) for row in rows]


def condition_adjustment(session: Session, found: Compared) -> Adjustment:
    """Return how parameters followed the operating conditions over the baseline; it adjusts nothing with too few
    measurements."""
    row = found.identification
    conditions = machines.document(session, row.machine_id, row.revision).conditions
    known = identifications.points(session, found.baseline) if conditions else {}
    baseline = [one for one in found.baseline if one.id in known]
    return adjustment([known[one.id] for one in baseline], [one.conditions or {} for one in baseline], conditions)


def readings(session: Session, found: Compared) -> list[DatedPoint]:
    """Return the runs after the baseline at their times [weeks since 1970]; of runs measured at one time only the last."""
    by_time = dict(zip([row.measured_at for row in found.after], points(session, found, found.after), strict=True))
    return [DatedPoint(moment / WEEK, point) for moment, point in by_time.items()]
