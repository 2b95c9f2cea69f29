"""Tests that what stores samples computes nothing of the science: no document, however large, makes anybody's samples wait."""

import pytest

from estimator.bearings.registry import FORMS
from tests.imports import imported_by, imported_directly_by

STATES_AND_COUNTS = {
    "arrays",
    "bearings.constant",
    "bearings.defaults",
    "bearings.mixed_coefficient",
    "bearings.model",
    "bearings.monotone_cubic",
    "bearings.registry",
    "bearings.table_columns",
    "bearings.terms",
    "close_matches",
    "errors",
    "field_types",
    "machine.alignment_rules",
    "machine.bearings_on_films",
    "machine.calibration",
    "machine.consistency",
    "machine.document",
    "machine.films",
    "machine.parameter_description",
    "machine.part_coefficients",
    "machine.parts",
    "machine.rules",
    "machine.sparkplug",
    "machine.unfinished_document",
    "phasors.channel_status",
    "phasors.measurement",
    "phasors.near_speed",
    "phasors.recorded_run",
    "quantities",
    "runs.coverage",
    "runs.dwells",
    "runs.operating_state",
    "runs.sample_selection",
    "runs.segmentation",
    "runs.speed_bins",
    "runs.speed_filter",
    "strict_model",
    "units",
    "usual_values",
}
"""Modules of the estimator that hold data, count samples and follow the speed; their work does not grow with the model."""
FORM_MODULES = {form.__module__.removeprefix("estimator.") for form in FORMS}
"""Those of the forms that a document may choose."""


@pytest.mark.parametrize(
    "module",
    ["service.ingest.ingest_thread", "service.runs.closing", "storage.measurements.runs", "storage.measurements.samples"],
)
def test_storing_and_closing_need_no_model_of_the_machine(module: str) -> None:
    found = imported_by(module)
    assert {
        one.removeprefix("estimator.") for one in found if one.startswith("estimator.")
    } <= STATES_AND_COUNTS | FORM_MODULES
    assert "scipy" not in found
    assert {"numpy", "sqlalchemy"} <= found, "the look at imports sees nothing"


@pytest.mark.parametrize(
    ("module", "known"),
    [
        (
            "service.monitoring.context_loading",
            {
                "estimator.machine.document",
                "estimator.machine.parameter_description",
                "estimator.machine.parameter_description.describe",  # a name in its parts
                "estimator.trends.parameter_vector",
            },
        ),
        ("service.monitoring.conclusions", set[str]()),
        ("service.monitoring.assessment_queue", set[str]()),
        ("service.alerts.transitions", set[str]()),
        ("service.monitoring.finding_text", {"estimator.machine.parameter_description"}),
        ("service.identification.scheduler", {"estimator.fit.identification"}),
        ("service.identification.job_submission", {"estimator.fit.identification"}),
        ("service.identification.result_filing", {"estimator.fit.identification"}),
        ("service.identification.task_builder", {"estimator.fit.identification", "estimator.machine.document"}),
        ("service.identification.job_options", {"estimator.fit.identification", "estimator.machine.rules"}),
        (
            "service.identification.calibration_jobs",
            {
                "estimator.calibration.calibrated_document",
                "estimator.calibration.calibrated_document.calibrated_document",  # documents made of and compared with others
                "estimator.calibration.calibrated_document.is_the_same_but_for_calibrations",
                "estimator.calibration.calibrated_document.with_gain_drift",
                "estimator.calibration.calibration_runs",
                "estimator.machine.document",
                "estimator.runs.dwells",
                "estimator.runs.dwells.dwelling",  # follows the speed of samples that are read already
            },
        ),
        (
            "service.api.machines.balancings",
            {
                "estimator.balancing.field_balancing",
                "estimator.balancing.weight_places",
                "estimator.machine.disc_scale",
                "estimator.machine.document",
                "estimator.units",
                "estimator.units.rpm_to_rad_per_s",
                "estimator.balancing.balance_quality",
            },
        ),
    ],
)
def test_what_works_within_transactions_asks_workers_and_computes_nothing_itself(module: str, known: set[str]) -> None:
    """They name documents, options and points, which are data; what judges and identifies is imported by the worker only."""
    named = {
        one
        for one in imported_directly_by(module)
        if one.startswith("estimator.") or (one + ".").startswith("service.monitoring.assessment.assess.")
    }
    named.discard("estimator.errors")
    reading = {f"{one}.{function}" for one in known for function in ("parse_machine", "describe")}
    assert {one for one in named if not one.rpartition(".")[2][:1].isupper()} <= known | reading
