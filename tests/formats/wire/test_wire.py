"""The message on the wire: what a source means arrives as SI, under the key that names it."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS
from formats.wire import (
    DIRECTIONS,
    ENCODINGS,
    JSON,
    MESSAGEPACK,
    STATUSES,
    Key,
    encode_batch,
    source_key,
)
from storage.encoding.packing import QUANTUM
from storage.encoding.source_key import SourceKey
from tests.formats.wire.wire_messages import body_of, converted, decoded, packed, reason_of
from tests.plant import KEY, batch, few_examples


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_batch_arrives_as_it_was_sent(encoding: str) -> None:
    sent = batch([900.0, 910.0], sequence=7, status=[["good"] * 4] * 2, scatter=[[1.0, None, 2.0, 3.0]] * 2)
    sent.amplitude[1][2] = None
    assert decoded(encode_batch(sent, encoding), encoding) == sent


def test_json_may_say_its_character_set_and_nothing_at_all_means_message_pack() -> None:
    assert decoded(encode_batch(batch(), JSON), "application/json;charset=utf-8") == batch()
    assert decoded(encode_batch(batch()), "") == batch()


@pytest.mark.parametrize("encoding", [MESSAGEPACK, JSON])
def test_fields_of_a_later_minor_version_are_left_aside(encoding: str) -> None:
    assert decoded(packed(body_of(batch(), temperature=[20.0]), encoding), encoding) == batch()


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("speed_unit", RAD_PER_S)
@pytest.mark.parametrize("amplitude_unit", [*METRES, "V"])
@pytest.mark.parametrize("amplitude_kind", PEAK)
@pytest.mark.parametrize("phase_convention", LEAD)
@pytest.mark.parametrize("phase_unit", RADIANS)
def test_every_unit_comes_to_the_same_si(
    encoding: str, speed_unit: str, amplitude_unit: str, amplitude_kind: str, phase_convention: str, phase_unit: str
) -> None:
    """100 rad/s, 40 µm 0-to-peak, a lead of -50°, each written as a source in other units would."""
    speed = {"rpm": 954.929658551372, "rad/s": 100.0, "Hz": 15.915494309189533}[speed_unit]
    size = {"m": 4e-5, "mm": 0.04, "um": 40.0, "mil": 4e-5 / 2.54e-5, "V": 0.32}[amplitude_unit]
    size *= {"peak": 1.0, "peak-to-peak": 2.0}[amplitude_kind]
    phase = {"deg": 50.0, "rad": math.radians(50.0)}[phase_unit] * {"lead": -1.0, "lag": 1.0}[phase_convention]
    sent = batch(
        [speed],
        channels=["B3X"],  # 8000 V/m
        speed_unit=speed_unit,
        amplitude_unit=amplitude_unit,
        amplitude_kind=amplitude_kind,
        phase_convention=phase_convention,
        phase_unit=phase_unit,
        amplitude=[[size]],
        phase=[[phase]],
        scatter=[[size / 100]],
    )
    found, taken, faults = converted(decoded(encode_batch(sent, encoding), encoding))
    assert faults == []
    assert taken.tolist() == [True]
    assert found.speed[0] == pytest.approx(100.0)
    assert found.phasor[0, 2] == pytest.approx(4e-5 * np.exp(-1j * math.radians(50.0)))
    assert found.scatter[0, 2] == pytest.approx(4e-7, abs=QUANTUM)


def test_each_probe_has_its_own_sensitivity() -> None:
    sent = batch(channels=["B3Y", "B3X"], amplitude_unit="V", amplitude_kind="peak", amplitude=[[0.4, 0.4]], phase=[[0.0] * 2])
    found, _, _ = converted(sent)
    assert np.abs(found.phasor[0, 2:]) == pytest.approx([5e-5, 1e-4])


@pytest.mark.parametrize(("direction", "sign"), DIRECTIONS.items())
def test_the_sense_of_rotation_arrives(direction: str, sign: int) -> None:
    assert converted(batch([900.0, 910.0], direction=direction))[0].direction.tolist() == [sign, sign]


def test_channels_come_in_the_order_of_the_document() -> None:
    found, _, _ = converted(batch(channels=["B3X", "B2X"], amplitude=[[60.0, 20.0]], phase=[[0.0, 0.0]]))
    assert np.abs(found.phasor[0, [0, 2]]) == pytest.approx([1e-5, 3e-5])
    assert found.usable.tolist() == [[True, False, True, False]]
    assert np.isnan(found.phasor[0, [1, 3]]).all()


@pytest.mark.parametrize("status", STATUSES)
def test_only_good_values_are_used(status: str) -> None:
    found, taken, faults = converted(batch(status=[["good", status, "good", "good"]], scatter=[[1.0] * 4]))
    good = status == "good"
    assert found.usable.tolist() == [[True, good, True, True]]
    assert np.isfinite(found.phasor).all()  # a value that is not good is kept for people to look at
    assert np.isfinite(found.scatter).all()
    assert taken.all()
    assert faults == []


@pytest.mark.parametrize("field", ["amplitude", "phase"])
def test_a_value_that_is_not_there_is_no_fault(field: str) -> None:
    changes: dict[str, Any] = {field: [[1.0, None, 1.0, 1.0]]}
    found, taken, faults = converted(batch(**changes))
    assert found.usable.tolist() == [[True, False, True, True]]
    assert taken.all()
    assert faults == []


@few_examples
@given(st.floats(0.0, 400.0), st.floats(0.0, 0.0199), st.floats(-720.0, 720.0), st.sampled_from(ENCODINGS))
def test_any_sensible_sample_arrives(speed: float, size: float, lead: float, encoding: str) -> None:
    sent = batch(
        [speed],
        speed_unit="rad/s",
        amplitude_unit="m",
        amplitude_kind="peak",
        phase_convention="lead",
        amplitude=[[size] * 4],
        phase=[[lead] * 4],
    )
    found, taken, faults = converted(decoded(encode_batch(sent, encoding), encoding))
    assert faults == []
    assert taken.all()
    assert found.time.tolist() == sent.time_ns
    assert found.speed.tolist() == [speed]
    assert found.phasor[0] == pytest.approx([size * np.exp(1j * math.radians(lead))] * 4, abs=QUANTUM)


def test_the_source_is_named_by_machine_name_and_epoch() -> None:
    assert source_key(batch(epoch=5)) == SourceKey("pump-7", "monitor", 5)


def test_keys_lead_back_to_plant_and_machine() -> None:
    assert Key.parse(KEY.samples) == Key.parse(KEY.log) == KEY
    assert KEY.samples == "rundown/v1/plant-1/pump-7/samples"
    assert KEY.live == "rundown/v1/live/plant-1/pump-7"


@pytest.mark.parametrize(
    "key",
    [
        "",
        "rundown/v1/p/m",
        "rundown/v2/p/m/samples",
        "other/v1/p/m/samples",
        "rundown/v1//m/samples",
        "rundown/v1/p/ü/samples",
        "rundown/v1/p/m/samples/more",
        "rundown/v1/p/m\n/samples",
        f"rundown/v1/p/{'m' * 65}/samples",
        "////",
    ],
)
def test_other_keys_are_rejected(key: str) -> None:
    assert reason_of(lambda: Key.parse(key)) == "key_mismatch"
