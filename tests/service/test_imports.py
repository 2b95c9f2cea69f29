"""What stores samples computes nothing of the science: no document, however large, makes anybody's samples wait."""

import pytest

from tests.imports import imported_by

STATES_AND_COUNTS = {
    "arrays",
    "capture",
    "channel_status",
    "coverage",
    "machine",
    "measurement",
    "operating_state",
    "recorded",
    "references",
    "segmentation",
    "speed_bins",
    "speed_reading",
    "units",
    "written",
}
"""Modules of the estimator that hold data, count samples and follow the speed; their work does not grow with the model."""


@pytest.mark.parametrize("module", ["service.ingest", "service.closing", "storage.runs", "storage.samples"])
def test_storing_and_closing_need_no_model_of_the_machine(module: str) -> None:
    found = imported_by(module)
    assert {one.removeprefix("estimator.") for one in found if one.startswith("estimator.")} <= STATES_AND_COUNTS
    assert "scipy" not in found
    assert {"numpy", "sqlalchemy"} <= found, "the look at imports sees nothing"
