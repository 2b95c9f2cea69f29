"""Operating conditions that ride along with samples on the wire."""

import math

import numpy as np
import pytest

from formats.wire import (
    BINARY,
    ENCODINGS,
    Fault,
    Rejected,
    SampleBatch,
    decode_batch,
    encode_batch,
    to_samples,
)
from storage.encoding.sample_blocks import Samples
from tests.formats.wire.wire_messages import NAN, NOW, converted
from tests.plant import KEY, batch, machine

CONDITIONS = [{"name": "oil", "unit": "degC"}, {"name": "load", "unit": "%"}]


def with_conditions(sent: SampleBatch) -> tuple[Samples, list[bool], list[Fault]]:
    """The batch as a machine takes it that names oil and load."""
    found, taken, faults = to_samples(sent, machine(conditions=CONDITIONS), received_at=NOW)
    return found, taken.tolist(), faults


def test_conditions_come_in_the_order_of_the_document() -> None:
    found, taken, faults = with_conditions(batch([900.0, 901.0], conditions={"load": [80.0, None], "oil": [61.5, NAN]}))
    assert found.conditions[0].tolist() == [61.5, 80.0]
    assert np.isnan(found.conditions[1]).all()
    assert (taken, faults) == ([True, True], [])


def test_a_condition_that_does_not_come_was_not_measured() -> None:
    found, _, _ = with_conditions(batch(conditions={"load": [70.0]}))
    assert np.isnan(found.conditions[0, 0])
    assert found.conditions[0, 1] == 70.0
    found, _, _ = with_conditions(batch())
    assert found.conditions.shape == (1, 2)
    assert np.isnan(found.conditions).all()


def test_an_infinite_condition_is_a_fault_and_the_sample_is_taken() -> None:
    found, taken, faults = with_conditions(batch([900.0, 901.0], conditions={"oil": [60.0, math.inf]}))
    assert [(fault.index, fault.reason, fault.detail) for fault in faults] == [(1, "not_finite", "condition oil is infinite")]
    assert taken == [True, True]
    assert np.isnan(found.conditions[1, 0])


def test_an_unknown_condition_is_rejected_with_the_known_ones() -> None:
    sent = batch(conditions={"oil": [60.0], "humidity": [40.0]})
    with pytest.raises(Rejected, match="has no condition humidity; it has oil, load"):
        with_conditions(sent)
    with pytest.raises(Rejected, match="has no condition oil, humidity; its document names none"):
        converted(sent)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    ("conditions", "said"),
    [
        ({"oil": [1.0, 2.0]}, "condition oil has 2 values for 1 samples"),
        ({f"c{i}": [1.0] for i in range(17)}, "17 conditions; at most 16 ride along"),
    ],
)
def test_conditions_of_a_wrong_shape_are_rejected(encoding: str, conditions: dict[str, list[float | None]], said: str) -> None:
    if encoding == BINARY and len(conditions) == 1:
        said = "undecodable|bytes"  # its columns are as long as the samples are many
    with pytest.raises(Rejected, match=said):
        decode_batch(KEY, encode_batch(batch(conditions=conditions), encoding), encoding)
