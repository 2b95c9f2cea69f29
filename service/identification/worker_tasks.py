"""The functions that worker processes are asked to compute."""

from service.identification.calibration_computation import compute_calibration
from service.identification.computation import compute
from service.monitoring.assessment_task import assess_in_time

TASKS = (compute, compute_calibration, assess_in_time)
