"""The API keeps to its own document: a short form of `benchmarks.faults.contract`, with a service process and real data."""

from pathlib import Path

import pytest

from benchmarks.faults.contract import against_service
from service.commands import openapi

EXAMPLES = 2
SEQUENCES = 5


@pytest.mark.long
def test_the_api_answers_as_its_document_says(tmp_path: Path) -> None:
    found = against_service(tmp_path, examples=EXAMPLES, sequences=SEQUENCES, seed=1, limits=False)
    assert found.errors == []
    assert found.failures == {}
    paths = openapi.document()["paths"]
    described = {f"{method.upper()} {path}" for path, item in paths.items() for method in item}
    assert found.asked["fuzzing"].keys() == described
    assert found.asked["stateful"].total() >= 2 * SEQUENCES
    assert {200, 201, 404, 422} <= found.answered.keys()
