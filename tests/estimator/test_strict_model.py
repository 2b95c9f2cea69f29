"""Tests what people write: no truth value becomes a number, and nothing that is unknown passes."""

from typing import Annotated, Any, Self

import pytest
from pydantic import ConfigDict, Field, ValidationError, model_validator

from estimator.machine.document import Machine
from estimator.strict_model import StrictModel, repeatable
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


class _StrictExample(StrictModel):
    """A request with fields of every kind that is looked at before it is read."""

    model_config = ConfigDict(populate_by_name=True)

    begin: float = Field(alias="from")
    speeds: Annotated[list[float], Field(max_length=3)]
    weight: float = Field(gt=0)
    sweep: bool | None = None
    note: str = ""

    @model_validator(mode="after")
    def _agreeing(self) -> Self:
        if self.note == "contradiction":
            raise ValueError("the note contradicts the rest")
        return self


def _told(given: dict[str, Any]) -> list[tuple[Any, ...]]:
    with pytest.raises(ValidationError) as raised:
        _StrictExample.model_validate(given)
    return [(one["loc"], one["type"], one["msg"], one["input"]) for one in raised.value.errors()]


def test_what_is_refused_before_reading_is_reported_among_the_other_errors_in_the_order_of_the_fields() -> None:
    given = {"note": 1, "unknown": 1, "sweep": 0, "weight": -1.0, "speeds": [0.0] * 4, "from": True}
    assert _told(given) == [
        (("from",), "value_error", "Value error, true and false are no values of this field", True),
        (("speeds",), "value_error", "Value error, 4 items; at most 3", [0.0] * 4),
        (("weight",), "greater_than", "Input should be greater than 0", -1.0),
        (("sweep",), "value_error", "Value error, this field is true or false", 0),
        (("note",), "string_type", "Input should be a valid string", 1),
        (("unknown",), "extra_forbidden", "Extra inputs are not permitted", 1),
    ]


def test_a_refused_field_is_not_also_missing_whichever_name_it_was_given_by() -> None:
    for name in ("from", "begin"):
        assert [one[0] for one in _told({name: True, "speeds": [], "weight": 1.0})] == [(name,)]


def test_contradictions_are_not_looked_for_while_a_field_is_refused() -> None:
    assert [one[0] for one in _told({"from": 1.0, "speeds": [True], "weight": 1.0, "note": "contradiction"})] == [("speeds",)]


def test_what_is_wrong_with_the_object_as_a_whole_is_reported_alone() -> None:
    written = document()
    written["bearings"][0]["speed_dependence"] = {"form": "table", "csv": "table.csv", "scale_spread": True}
    with pytest.raises(ValidationError) as raised:
        Machine.model_validate(written)
    assert [one["msg"].partition(":")[0] for one in raised.value.errors()] == ["Value error, csv"]


def test_errors_can_be_raised_once_more_as_they_were() -> None:
    with pytest.raises(ValidationError) as first:
        _StrictExample.model_validate({"from": "x", "speeds": [1.0, "y"], "weight": -1.0, "sweep": 2, "unknown": 1})
    again = ValidationError.from_exception_data("again", repeatable(first.value.errors()))
    assert [one | {"ctx": str(one.get("ctx"))} for one in again.errors()] == [
        one | {"ctx": str(one.get("ctx"))} for one in first.value.errors()
    ]
