"""The assessment as a task of a worker process."""

from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import Assessment, AssessmentContext
from service.workers.time_limit import limit_time


def assess_in_time(task: tuple[AssessmentContext, float]) -> Assessment:
    """Assess within a time limit [s]. Raises OutOfTime."""
    context, timeout_s = task
    with limit_time(timeout_s):
        return assess(context)
