"""Tests what people write: no truth value becomes a number, and nothing that is unknown passes."""

import pytest
from pydantic import ValidationError

from estimator.machine.document import Machine
from tests.plant import document


@pytest.mark.parametrize(
    ("part", "field"), [("bearings", "kxx"), ("discs", "station"), ("probes", "angle_deg"), ("couplings", "cxx")]
)
@pytest.mark.parametrize("truth", [True, False])
def test_a_truth_value_is_no_number(part: str, field: str, truth: bool) -> None:
    written = document()
    written[part][0][field] = truth
    with pytest.raises(ValidationError, match="true and false are no values of this field"):
        Machine.model_validate(written)


def test_a_truth_value_in_a_list_is_no_number() -> None:
    written = document()
    written["quality"] = {"accepted_rpm": [True, 3000.0]}
    with pytest.raises(ValidationError, match="true and false are no values of this field"):
        Machine.model_validate(written)


def test_where_a_truth_value_is_asked_for_it_is_taken() -> None:
    written = document()
    written["quality"] = {"sweep_rate": False}
    assert Machine.model_validate(written).quality.sweep_rate is False


def test_numbers_as_the_documents_language_writes_them_are_taken() -> None:
    """YAML 1.1 reads 1e8 as a text."""
    written = document()
    written["bearings"][0]["kxx"] = "1e8"
    assert Machine.model_validate(written).bearings[0].kxx == 1e8


@pytest.mark.parametrize("value", [0, 1, 0.0, "no", "true"])
def test_nothing_else_is_a_truth_value(value: object) -> None:
    written = document()
    written["quality"] = {"sweep_rate": value}
    with pytest.raises(ValidationError, match="this field is true or false"):
        Machine.model_validate(written)
