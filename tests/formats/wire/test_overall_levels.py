"""Overall levels at the door: in the amplitude's unit and kind, beside the 1×, which stays whatever becomes of them."""

import numpy as np
import pytest

from formats.wire import ENCODINGS, encode_batch
from tests.formats.wire.wire_messages import converted, decoded, reason_of
from tests.plant import batch

CHANNELS = 4


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    ("unit", "kind", "value"), [("um", "peak-to-peak", 80.0), ("um", "peak", 40.0), ("mil", "peak-to-peak", 80.0 / 25.4)]
)
def test_levels_have_unit_and_kind_of_the_amplitude(encoding: str, unit: str, kind: str, value: float) -> None:
    sent = batch(
        [900.0],
        channels=["B3X"],
        amplitude=[[1.0]],
        phase=[[0.0]],
        overall=[[value]],
        amplitude_unit=unit,
        amplitude_kind=kind,
    )
    found, taken, faults = converted(decoded(encode_batch(sent, encoding), encoding))
    assert faults == []
    assert taken.all()
    assert found.overall[0, 2] == pytest.approx(4e-5, abs=1e-10)
    assert np.isnan(np.delete(found.overall[0], 2)).all()


def test_volts_are_recognised_by_the_probes_sensitivity() -> None:
    """8000 V/m."""
    sent = batch([900.0], channels=["B3X"], amplitude=[[0.1]], phase=[[0.0]], overall=[[0.64]], amplitude_unit="V")
    found, _, _ = converted(sent)
    assert found.overall[0, 2] == pytest.approx(4e-5, abs=1e-10)


@pytest.mark.parametrize("wrong", [1e6, -1.0, float("inf")])
def test_an_impossible_level_is_left_out_by_name_and_the_1x_stays(wrong: float) -> None:
    found, taken, faults = converted(batch([900.0], overall=[[wrong, 90.0, None, 90.0]]))
    assert taken.all()
    assert found.usable.all()
    assert [fault.reason for fault in faults] == ["overall_out_of_range"]
    assert "is its unit right?" in faults[0].detail
    assert np.isnan(found.overall[0, [0, 2]]).all()
    assert found.overall[0, [1, 3]] == pytest.approx([4.5e-5] * 2, abs=1e-10)


@pytest.mark.parametrize("encoding", ENCODINGS[1:])
def test_levels_have_the_shape_of_the_samples(encoding: str) -> None:
    assert reason_of(lambda: decoded(encode_batch(batch(overall=[[1.0]]), encoding), encoding)) == "wrong_shape"
