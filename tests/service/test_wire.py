"""The message on the wire: what a source means arrives as SI, and whatever is wrong is rejected for the reason it has.

For every `Reason` there is a message here that is rejected for it, and no bytes at all raise anything but `Rejected`.
"""

import math
import zlib
from collections.abc import Callable
from typing import Any, get_args

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS
from service.order import Order
from service.wire import (
    BINARY,
    DIRECTIONS,
    ENCODINGS,
    FUTURE_TOLERANCE,
    JSON,
    LARGEST_AMPLITUDE,
    LARGEST_BATCH,
    LARGEST_CHANNEL_COUNT,
    LARGEST_MESSAGE,
    MESSAGEPACK,
    STATUSES,
    Fault,
    Key,
    Reason,
    Rejected,
    SampleBatch,
    decode_batch,
    encode_batch,
    frame,
    source_key,
    to_samples,
)
from storage.blocks import Samples
from storage.samples import SourceKey
from tests.plant import CHANNELS, KEY, START, batch, few_examples, machine

NOW = START + 3600 * 10**9
NAN, INFINITY = math.nan, math.inf


Converted = tuple[Samples, Any, list[Fault]]


def converted(one: SampleBatch, **document: Any) -> Converted:
    return to_samples(one, machine(**document), received_at=NOW)


def reason_of(act: Callable[[], object]) -> str:
    with pytest.raises(Rejected) as caught:
        act()
    assert caught.value.detail
    return caught.value.reason


def decoded(payload: bytes, encoding: str = MESSAGEPACK, key: Key = KEY) -> SampleBatch:
    return decode_batch(key, payload, encoding)


def body_of(one: SampleBatch, **changes: Any) -> dict[str, Any]:
    """The batch's body as plain data, with fields changed, added, or with `None` taken away."""
    body = msgspec.to_builtins(one) | changes
    return {name: value for name, value in body.items() if value is not None}


def packed(body: Any, encoding: str = MESSAGEPACK) -> bytes:
    return frame(msgspec.msgpack.encode(body) if encoding == MESSAGEPACK else msgspec.json.encode(body))


# --- there and back -------------------------------------------------------------------------------------------------


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
    assert found.scatter[0, 2] == pytest.approx(4e-7)


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
    found, taken, faults = converted(batch(**{field: [[1.0, None, 1.0, 1.0]]}))
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
    assert found.phasor[0] == pytest.approx([size * np.exp(1j * math.radians(lead))] * 4)


def test_the_source_is_named_by_machine_name_and_epoch() -> None:
    assert source_key(batch(epoch=5)) == SourceKey("pump-7", "monitor", 5)


# --- keys -----------------------------------------------------------------------------------------------------------


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


# --- rejected messages ----------------------------------------------------------------------------------------------

HUGE = 10**30
DEEP = 100_000
GOOD = encode_batch(batch())
UNDECODABLE: dict[str, tuple[bytes, str]] = {
    "nothing": (frame(b""), MESSAGEPACK),
    "no map": (packed([1, 2]), MESSAGEPACK),
    "no schema": (packed(body_of(batch(), schema=None)), MESSAGEPACK),
    "schema in words": (packed(body_of(batch(), schema="1")), MESSAGEPACK),
    "field missing": (packed(body_of(batch(), speed=None)), MESSAGEPACK),
    "text for a number": (packed(body_of(batch(), speed=["fast"])), MESSAGEPACK),
    "truth for a number": (packed(body_of(batch(), speed=[True])), MESSAGEPACK),
    "null speed": (packed(body_of(batch(), speed=[None])), MESSAGEPACK),
    "fraction of a nanosecond": (packed(body_of(batch(), time_ns=[1.5])), MESSAGEPACK),
    "bytes for text": (packed(body_of(batch(), source=b"monitor")), MESSAGEPACK),
    "JSON called MessagePack": (encode_batch(batch(), JSON), MESSAGEPACK),
    "MessagePack called JSON": (GOOD, JSON),
    "cut off": (frame(GOOD[24:-1]), MESSAGEPACK),
    "more behind it": (frame(msgspec.msgpack.encode(batch()) + b"\x00"), MESSAGEPACK),
    "not UTF-8": (frame(msgspec.msgpack.encode(batch()).replace(b"monitor", b"monit\xff\xff")), MESSAGEPACK),
    "half a surrogate pair": (frame(msgspec.json.encode(batch()).replace(b"monitor", b"monit\\udc00")), JSON),
    "NaN in JSON": (frame(msgspec.json.encode(batch()).replace(b"1000.0", b"NaN")), JSON),
    "beyond floats": (frame(msgspec.json.encode(batch()).replace(b"1000.0", b"1e999")), JSON),
    "thousands of digits": (frame(msgspec.json.encode(batch()).replace(b'"epoch":1', b'"epoch":1' + b"0" * 5000)), JSON),
    "deep JSON": (frame(b'{"schema":1,"x":' + b"[" * DEEP), JSON),
    "deep MessagePack": (frame(b"\x82\xa6schema\x01\xa1x" + b"\x91" * DEEP), MESSAGEPACK),
    "deep where speeds stand": (frame(b'{"schema":1,"speed":' + b"[" * DEEP + b"]" * DEEP + b"}"), JSON),
    "a length that is a lie": (frame(b"\xdf\xff\xff\xff\xff"), MESSAGEPACK),
}


@pytest.mark.parametrize("name", UNDECODABLE)
def test_a_body_that_is_no_batch_is_undecodable(name: str) -> None:
    payload, encoding = UNDECODABLE[name]
    assert reason_of(lambda: decoded(payload, encoding)) == "undecodable"


BODY = msgspec.msgpack.encode(batch())
BAD_FRAMES = {
    "nothing": b"",
    "only a body": BODY,
    "another protocol": frame(BODY).replace(b"rundown/1", b"rundown/2"),
    "too short": frame(BODY)[:-1],
    "too long": frame(BODY) + b"\x00",
    "wrong checksum": b"rundown/1 %d %08x\n" % (len(BODY), zlib.crc32(BODY) ^ 1) + BODY,
    "changed body": frame(BODY)[:-1] + bytes([BODY[-1] ^ 1]),
    "no newline": frame(BODY).replace(b"\n", b" ", 1),
    "negative length": b"rundown/1 -1 00000000\n",
    "endless length": b"rundown/1 " + b"9" * 1000 + b" 00000000\n",
}


@pytest.mark.parametrize("name", BAD_FRAMES)
def test_a_frame_that_does_not_fit_is_rejected(name: str) -> None:
    assert reason_of(lambda: decoded(BAD_FRAMES[name])) == "bad_frame"


def test_a_message_may_be_so_large_and_no_larger() -> None:
    assert reason_of(lambda: decoded(b"x" * (LARGEST_MESSAGE + 1))) == "too_large"
    assert reason_of(lambda: decoded(b"x" * LARGEST_MESSAGE)) == "bad_frame"


@pytest.mark.parametrize("encoding", [MESSAGEPACK, JSON])
def test_a_schema_of_the_future_is_said_to_be_one_whatever_else_it_holds(encoding: str) -> None:
    for body in ({"schema": 2}, {"schema": 2**62, "plant": 7}, body_of(batch(), schema=2)):
        assert reason_of(lambda body=body: decoded(packed(body, encoding), encoding)) == "future_schema"


@pytest.mark.parametrize("schema", [0, -1])
def test_a_schema_that_never_was_is_rejected(schema: int) -> None:
    assert reason_of(lambda: decoded(packed(body_of(batch(), schema=schema)))) in get_args(Reason)


@pytest.mark.parametrize("changes", [{"plant": "plant-2"}, {"machine": "pump-8"}, {"plant": ""}, {"machine": "x" * 100_000}])
def test_a_body_for_another_machine_is_rejected(changes: dict[str, str]) -> None:
    assert reason_of(lambda: decoded(encode_batch(batch(**changes)))) == "key_mismatch"


WRONG_SHAPES: dict[str, dict[str, Any]] = {
    "no samples": {"time_ns": [], "speed": [], "amplitude": [], "phase": []},
    "too many samples": {"time_ns": list(range(LARGEST_BATCH + 1))},
    "no channels": {"channels": []},
    "a channel twice": {"channels": ["B2X", "B2X", "B3X", "B3Y"]},
    "too many channels": {"channels": [f"c{i}" for i in range(LARGEST_CHANNEL_COUNT + 1)]},
    "no source": {"source": ""},
    "a source with a space": {"source": "a b"},
    "a long source": {"source": "s" * 65},
    "a negative epoch": {"epoch": -1},
    "an epoch of 64 bits": {"epoch": 2**63},
    "a negative sequence": {"sequence": -1},
    "a sequence of 63 bits": {"sequence": 2**62},
    "a speed too many": {"speed": [1.0, 2.0]},
    "a row too many": {"amplitude": [[1.0] * 4] * 2},
    "a row too short": {"phase": [[1.0] * 3]},
    "no status row": {"status": []},
    "a status too many": {"status": [["good"] * 5]},
    "no scatter row": {"scatter": []},
}


@pytest.mark.parametrize("name", WRONG_SHAPES)
def test_a_batch_whose_parts_do_not_fit_is_rejected(name: str) -> None:
    assert reason_of(lambda: decoded(encode_batch(batch(**WRONG_SHAPES[name])))) == "wrong_shape"


def test_a_huge_epoch_in_json_is_rejected() -> None:
    payload = frame(msgspec.json.encode(batch()).replace(b'"epoch":1', b'"epoch":%d' % HUGE))
    assert reason_of(lambda: decoded(payload, JSON)) == "wrong_shape"


WRONG_UNITS: dict[str, dict[str, Any]] = {
    "speed": {"speed_unit": "RPM"},
    "amplitude": {"amplitude_unit": "inch"},
    "kind": {"amplitude_kind": "rms"},
    "convention": {"phase_convention": "late"},
    "phase": {"phase_unit": "grad"},
    "direction": {"direction": "clockwise"},
    "status": {"status": [["good", "good", "fine", "good"]]},
    "volts without a sensitivity": {"amplitude_unit": "V"},
    "nothing": {"speed_unit": ""},
}


@pytest.mark.parametrize("name", WRONG_UNITS)
def test_a_batch_in_unknown_units_is_rejected(name: str) -> None:
    assert reason_of(lambda: converted(batch(**WRONG_UNITS[name]))) == "wrong_unit"


def test_a_wrong_unit_is_told_with_the_right_ones() -> None:
    with pytest.raises(Rejected, match="speed_unit 'RPM' is not one of rpm, rad/s, Hz"):
        converted(batch(speed_unit="RPM"))
    with pytest.raises(Rejected, match=r"sensitivity \[V/m\] in the document for B2X, B2Y"):
        converted(batch(amplitude_unit="V"))


def test_an_unknown_channel_is_rejected_with_the_known_ones() -> None:
    sent = batch(channels=["B2X", "B2Y", "B3X", "B9Z"])
    assert reason_of(lambda: converted(sent)) == "unknown_channel"
    with pytest.raises(Rejected, match="has no channel B9Z; it has B2X, B2Y, B3X, B3Y"):
        converted(sent)


# --- operating conditions -------------------------------------------------------------------------------------------


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


# --- faults of single samples ---------------------------------------------------------------------------------------


def only_fault(one: SampleBatch, **document: Any) -> tuple[Fault, Converted]:
    found = converted(one, **document)
    assert len(found[2]) == 1
    return found[2][0], found


@pytest.mark.parametrize(
    ("field", "value"), [("amplitude", NAN), ("amplitude", INFINITY), ("phase", NAN), ("phase", -INFINITY)]
)
def test_a_value_that_is_not_finite_makes_its_channel_unusable(field: str, value: float) -> None:
    sent = decoded(encode_batch(batch([900.0, 910.0], **{field: [[1.0] * 4, [1.0, value, 1.0, 1.0]]})))
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


# --- every reason, and nothing but reasons --------------------------------------------------------------------------


def reasons_met() -> set[str]:
    """Reasons for which the messages of this module are rejected; `unknown_machine` is the ingest's own to give."""
    rejected = [lambda payload=payload: decoded(*payload) for payload in UNDECODABLE.values()]
    rejected += [lambda payload=payload: decoded(payload) for payload in BAD_FRAMES.values()]
    rejected += [
        lambda: decoded(bytes(LARGEST_MESSAGE + 1)),
        lambda: decoded(packed({"schema": 2})),
        lambda: decoded(encode_batch(batch(plant="p"))),
        lambda: decoded(encode_batch(batch(source=""))),
        lambda: converted(batch(channels=["a", "b", "c", "d"])),
        lambda: converted(batch(conditions={"humidity": [40.0]})),
        lambda: converted(batch(speed_unit="")),
    ]
    met = {reason_of(act) for act in rejected}
    one = batch([900.0, NAN, -1.0, 905.0, 905.0, 2000.0], amplitude=[[1e9, 1.0, 1.0, 1.0]] * 6, step=10**8)
    one.time_ns[3] = 0
    one.time_ns[4] = one.time_ns[0]
    found, taken, faults = converted(one)
    return met | {fault.reason for fault in faults + Order().check(machine(), found, taken)}


def test_every_reason_is_met() -> None:
    assert reasons_met() == set(get_args(Reason)) - {"unknown_machine", "sequence_out_of_range"}  # those need the store


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.binary(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=4),
    max_leaves=8,
)


def assert_taken_or_rejected(payload: bytes, encoding: str) -> None:
    try:
        one = decode_batch(KEY, payload, encoding)
        found, taken, faults = to_samples(one, machine(), received_at=NOW)
    except Rejected:
        return
    assert len(found) == len(taken) == len(one.time_ns)
    assert np.isfinite(found.phasor[found.usable]).all()
    assert all(0 <= fault.index < len(found) for fault in faults)
    found.pick(taken).measurement()


@few_examples
@given(st.binary(max_size=200), st.sampled_from([*ENCODINGS, "", "text/plain"]))
def test_random_bytes_are_rejected(noise: bytes, encoding: str) -> None:
    assert reason_of(lambda: decoded(noise, encoding)) == "bad_frame"
    assert reason_of(lambda: decoded(frame(noise), encoding)) in ("undecodable", "future_schema")


@few_examples
@given(st.integers(0), st.integers(1, 255), st.sampled_from(ENCODINGS))
def test_a_batch_with_a_changed_byte_is_taken_or_rejected(place: int, change: int, encoding: str) -> None:
    payload = encode_batch(batch([900.0, 910.0], status=[["good"] * 4] * 2, scatter=[[1.0] * 4] * 2), encoding)
    body = bytearray(payload[payload.index(b"\n") + 1 :])
    body[place % len(body)] ^= change
    assert_taken_or_rejected(frame(bytes(body)), encoding)


@few_examples
@given(st.sampled_from(sorted(body_of(batch(status=[[]], scatter=[[]])))), json_values)
def test_a_batch_with_anything_in_a_field_is_taken_or_rejected(field: str, value: Any) -> None:
    try:
        payload = packed(body_of(batch()) | {field: value})
    except (OverflowError, ValueError):  # MessagePack itself cannot say it
        return
    assert_taken_or_rejected(payload, MESSAGEPACK)


floats_or_none = st.none() | st.floats()


@few_examples
@given(
    st.lists(st.tuples(st.integers(), st.floats()), min_size=1, max_size=3),
    st.lists(floats_or_none, min_size=4, max_size=4),
    st.lists(floats_or_none, min_size=4, max_size=4),
    st.lists(floats_or_none, min_size=4, max_size=4),
    st.sampled_from([*RAD_PER_S]),
    st.sampled_from([*METRES]),
)
def test_a_batch_of_any_numbers_is_taken_or_rejected(
    rows: list[tuple[int, float]], sizes: list[float], phases: list[float], scatters: list[float], speed: str, unit: str
) -> None:
    count = len(rows)
    one = batch(
        [value for _, value in rows],
        time_ns=[moment for moment, _ in rows],
        amplitude=[sizes] * count,
        phase=[phases] * count,
        scatter=[scatters] * count,
        speed_unit=speed,
        amplitude_unit=unit,
    )
    found, taken, _ = to_samples(one, machine(), received_at=NOW)
    assert np.isfinite(found.phasor[found.usable]).all()
    assert not np.isinf(found.phasor).any()
    assert np.isfinite(found.speed[taken]).all()
    assert not np.isinf(found.scatter).any()


def test_the_channels_of_these_tests_are_the_machine_s() -> None:
    assert machine().channels == CHANNELS
