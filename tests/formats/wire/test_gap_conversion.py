"""Gaps at the door: every unit and both signs come to the shaft's place towards the probe; what cannot be told is named."""

import numpy as np
import pytest

from formats.wire import ENCODINGS, JSON, encode_batch
from tests.formats.wire.wire_messages import converted, decoded, reason_of
from tests.plant import batch, document

CHANNELS = 4


def probes(**changes: str) -> list[dict[str, object]]:
    """The machine's probes, of which the document says more."""
    return [{**probe, **changes} for probe in document()["probes"]]


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(("unit", "value"), [("um", 40.0), ("mm", 0.04), ("m", 4e-5), ("mil", 40.0 / 25.4)])
def test_every_unit_and_sign_comes_to_the_place_towards_the_probe(encoding: str, unit: str, value: float) -> None:
    sent = batch([900.0], channels=["B3X"], amplitude=[[1.0]], phase=[[0.0]], gap=[[value]], gap_unit=unit)
    for grows, sign in (("towards", 1.0), ("away", -1.0)):
        found, taken, faults = converted(decoded(encode_batch(sent, encoding), encoding), probes=probes(gap_grows=grows))
        assert faults == []
        assert taken.all()
        assert found.gap[0, 2] == pytest.approx(sign * 4e-5, abs=1e-10)
        assert np.isnan(np.delete(found.gap[0], 2)).all()


def test_volts_need_the_probes_own_sensitivity() -> None:
    """8000 and 4000 V/m; the first two probes have none."""
    sent = batch([900.0], gap=[[-10.0, -10.0, -8.0, -8.0]], gap_unit="V")
    found, taken, faults = converted(sent, probes=probes(gap_grows="towards"))
    assert taken.all()
    assert np.isnan(found.gap[0, :2]).all()
    assert found.gap[0, 2:] == pytest.approx([-1e-3, -2e-3], abs=1e-10)
    assert [fault.reason for fault in faults] == ["gap_undescribed"]
    assert "sensitivity" in faults[0].detail
    assert "B2X, B2Y" in faults[0].detail


def test_gaps_of_probes_without_a_sign_are_left_out_and_named_once_and_the_vibration_stays() -> None:
    found, taken, faults = converted(batch([900.0, 910.0], gap=[[40.0] * CHANNELS] * 2, gap_unit="um"))
    assert taken.all()
    assert found.usable.all()
    assert np.isnan(found.gap).all()
    assert [fault.reason for fault in faults] == ["gap_undescribed"]
    assert "gap_grows" in faults[0].detail
    nothing, _, faults = converted(batch([900.0], gap=[[None] * CHANNELS], gap_unit="um"))
    assert faults == []
    assert np.isnan(nothing.gap).all()


def test_a_gap_in_another_unit_than_said_is_named() -> None:
    """1100 µm, said to be mm."""
    sent = batch([900.0], gap=[[1100.0, None, 1.1, 1.1]], gap_unit="mm")
    found, _, faults = converted(sent, probes=probes(gap_grows="away"))
    assert [fault.reason for fault in faults] == ["gap_out_of_range"]
    assert "is its unit right?" in faults[0].detail
    assert np.isnan(found.gap[0, :2]).all()
    assert found.gap[0, 2:] == pytest.approx([-1.1e-3] * 2, abs=1e-10)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_gaps_have_a_unit_and_the_shape_of_the_samples(encoding: str) -> None:
    rows = [[1.0] * CHANNELS]
    if encoding == JSON:
        assert reason_of(lambda: decoded(encode_batch(batch(gap=rows), encoding), encoding)) == "wrong_shape"
        assert reason_of(lambda: converted(batch(gap=rows, gap_unit="inch"))) == "wrong_unit"
    if encoding != ENCODINGS[0]:
        sent = batch(gap=[[1.0]], gap_unit="um")
        assert reason_of(lambda: decoded(encode_batch(sent, encoding), encoding)) == "wrong_shape"


def test_infinite_and_enormous_gaps_are_no_gaps() -> None:
    sent = batch([900.0], gap=[[float("inf"), 1e308, float("nan"), 1.0]], gap_unit="m")
    found, taken, faults = converted(sent, probes=probes(gap_grows="away"))
    assert taken.all()
    assert np.isnan(found.gap).all()
    assert [fault.reason for fault in faults] == ["gap_out_of_range"] * 3
