"""The functions that worker processes are asked to compute."""

from service.assessment_task import assess_in_time
from service.worker import compute

TASKS = (compute, assess_in_time)
