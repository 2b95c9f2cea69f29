"""The form of the tasks that travel pickled: it counts up when a class that they hold has moved, or another one is held."""

import inspect
import sys
from typing import Any, get_args, get_origin, get_type_hints

from service.identification.task import IdentificationTask
from service.identification.worker_tasks import TASKS
from service.workers.dask_task import TASK_FORM
from tests.paths import PACKAGES

FORM = 8
HELD = """
estimator.bearings.journal
estimator.bearings.knots
estimator.bearings.model
estimator.bearings.table
estimator.bearings.table_columns
estimator.diagnosis.change_progress
estimator.diagnosis.finding_kind
estimator.diagnosis.observation
estimator.fit.estimates
estimator.fit.identification
estimator.fit.validation.channel_sensitivity
estimator.fit.validation.doubted_force
estimator.machine.alignment_rules
estimator.machine.calibration
estimator.machine.document
estimator.machine.films
estimator.machine.parts
estimator.machine.rules
estimator.machine.sparkplug
estimator.phasors.beating
estimator.phasors.quality
estimator.phasors.slow_roll
estimator.trends.parameter_vector
estimator.trends.rate_of_change
estimator.updated_model.derived_quantities
service.alerts.lifecycle
service.identification.calibration_task
service.identification.task
service.monitoring.assessment.context
service.monitoring.assessment.rate_of_change
service.monitoring.rules.limit_rule
service.monitoring.rules.limits
"""
"""Modules of the classes that tasks and their results hold, by which a worker unpickles them."""


def classes_by_name() -> dict[str, Any]:
    """Return all classes that are loaded of the packages: some fields name theirs for the type checker only."""
    loaded = [module for name, module in sorted(sys.modules.items()) if name.split(".")[0] in PACKAGES]
    return {name: one for module in loaded for name, one in vars(module).items() if inspect.isclass(one)}


def held(kind: Any, known: dict[str, Any], found: set[Any]) -> set[Any]:
    """Return the classes of the packages that a type holds, in its fields and their fields."""
    for part in get_args(kind):
        held(part, known, found)
    one = get_origin(kind) or kind
    if inspect.isclass(one) and one.__module__.split(".")[0] in PACKAGES and one not in found:
        found.add(one)
        for field in get_type_hints(one, localns=known).values():
            held(field, known, found)
    return found


def test_the_form_of_tasks_counts_up_when_a_class_in_them_moves() -> None:
    known, found = classes_by_name(), set[Any]()
    for task in TASKS:
        for kind in get_type_hints(task, localns=known).values():
            held(kind, known, found)
    assert {one.__module__ for one in found} == set(HELD.split()), (
        "count TASK_FORM of service/workers/dask_task.py up, and name the modules here: workers of the commit before could "
        "not unpickle the tasks"
    )
    assert TASK_FORM == FORM


def test_classes_in_fields_of_fields_are_found() -> None:
    found = {one.__name__ for one in held(dict[str, list[IdentificationTask]], classes_by_name(), set())}
    assert {"IdentificationTask", "SlowRoll", "QualityRules", "Options"} <= found
    assert held(dict[str, int], {}, set()) == set()
