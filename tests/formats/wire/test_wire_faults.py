"""Faults of single samples on the wire: what costs a channel, what costs the sample, and what is taken."""

from typing import Any

import msgspec
import numpy as np
import pytest

from formats.wire import (
    JSON,
    LARGEST_AMPLITUDE,
    Fault,
    SampleBatch,
    encode_batch,
    frame,
)
from storage.clock import FUTURE_TOLERANCE
from tests.formats.wire.wire_messages import HUGE, INFINITY, NAN, NOW, Converted, converted, decoded
from tests.plant import START, batch


def only_fault(one: SampleBatch, **document: Any) -> tuple[Fault, Converted]:
    found = converted(one, **document)
    assert len(found[2]) == 1
    return found[2][0], found


@pytest.mark.parametrize(
    ("field", "value"), [("amplitude", NAN), ("amplitude", INFINITY), ("phase", NAN), ("phase", -INFINITY)]
)
def test_a_value_that_is_not_finite_makes_its_channel_unusable(field: str, value: float) -> None:
    changes: dict[str, Any] = {field: [[1.0] * 4, [1.0, value, 1.0, 1.0]]}
    sent = decoded(encode_batch(batch([900.0, 910.0], **changes)))
    fault, (found, taken, _) = only_fault(sent)
    assert (fault.index, fault.reason) == (1, "not_finite")
    assert "B2Y" in fault.detail
    assert taken.all()
    assert found.usable.tolist() == [[True] * 4, [True, False, True, True]]


@pytest.mark.parametrize("size", [LARGEST_AMPLITUDE * 1.001, 1e308, -LARGEST_AMPLITUDE * 1.001])
def test_an_amplitude_that_no_shaft_has_makes_its_channel_unusable(size: float) -> None:
    sent = batch(amplitude_unit="m", amplitude_kind="peak", amplitude=[[1e-5, 1e-5, size, 1e-5]])
    fault, (found, taken, _) = only_fault(sent)
    assert fault.reason == "amplitude_out_of_range"
    assert "B3X" in fault.detail
    assert taken.all()
    assert found.usable.tolist() == [[True, True, False, True]]


def test_the_largest_amplitude_is_taken() -> None:
    sent = batch(amplitude_unit="m", amplitude_kind="peak", amplitude=[[LARGEST_AMPLITUDE] * 4], phase=[[0.0] * 4])
    assert converted(sent)[2] == []


@pytest.mark.parametrize("value", [NAN, INFINITY, -INFINITY])
def test_a_speed_that_is_not_finite_costs_the_sample(value: float) -> None:
    fault, (_, taken, _) = only_fault(decoded(encode_batch(batch([900.0, value, 920.0]))))
    assert (fault.index, fault.reason) == (1, "not_finite")
    assert taken.tolist() == [True, False, True]


@pytest.mark.parametrize("rpm", [-1.0, 3901.0, 1e30])
def test_a_speed_that_the_machine_never_has_costs_the_sample(rpm: float) -> None:
    fault, (_, taken, _) = only_fault(batch([rpm]))
    assert fault.reason == "speed_out_of_range"
    assert not taken.any()


def test_a_speed_beyond_floats_in_rad_per_s_costs_the_sample() -> None:
    fault, _ = only_fault(batch([1e308], speed_unit="Hz"))
    assert fault.reason in ("speed_out_of_range", "not_finite")


@pytest.mark.parametrize("rpm", [0.0, 3899.0])
def test_standstill_and_overspeed_are_taken(rpm: float) -> None:
    assert converted(batch([rpm]))[2] == []


@pytest.mark.parametrize("moment", [0, -HUGE, -1, NOW + FUTURE_TOLERANCE + 1, 2**63, HUGE])
def test_a_time_that_cannot_be_costs_the_sample(moment: int) -> None:
    sent = batch()
    payload = frame(msgspec.json.encode(sent).replace(str(START).encode(), str(moment).encode()))
    fault, (_, taken, _) = only_fault(decoded(payload, JSON))
    assert fault.reason == "time_out_of_range"
    assert not taken.any()


def test_a_time_a_day_ahead_is_taken() -> None:
    assert converted(batch(start=NOW + FUTURE_TOLERANCE))[2] == []


@pytest.mark.parametrize("value", [NAN, INFINITY, None])
def test_a_scatter_that_is_no_number_is_as_good_as_none(value: float | None) -> None:
    found, _, faults = converted(batch(scatter=[[1.0, value, 1.0, 1.0]]))
    assert np.isnan(found.scatter[0]).tolist() == [False, True, False, False]
    assert faults == []
