"""Messages that are rejected, each for the reason that it has.

For every `Reason` there is a message here that is rejected for it, and no bytes at all raise anything but `Rejected`.
"""

import zlib
from collections.abc import Callable
from functools import partial
from typing import Any, get_args

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.units import METRES, RAD_PER_S
from formats.wire import (
    ENCODINGS,
    JSON,
    LARGEST_BATCH,
    LARGEST_CHANNEL_COUNT,
    LARGEST_MESSAGE,
    MESSAGEPACK,
    Reason,
    Rejected,
    decode_batch,
    encode_batch,
    frame,
    to_samples,
)
from service.write_path.plausibility import Plausibility
from tests.formats.wire.wire_messages import HUGE, NAN, NOW, body_of, converted, decoded, packed, reason_of
from tests.plant import CHANNELS, KEY, batch, document, few_examples, machine

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
        assert reason_of(partial(decoded, packed(body, encoding), encoding)) == "future_schema"


@pytest.mark.parametrize("schema", [0, -1])
def test_a_schema_that_never_was_is_rejected(schema: int) -> None:
    assert reason_of(lambda: decoded(packed(body_of(batch(), schema=schema)))) in get_args(Reason)


@pytest.mark.parametrize("changes", [{"plant": "plant-2"}, {"machine": "pump-8"}, {"plant": ""}, {"machine": "x" * 100_000}])
def test_a_body_for_another_machine_is_rejected(changes: dict[str, Any]) -> None:
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


def test_a_wrong_unit_is_reported_with_the_right_ones() -> None:
    with pytest.raises(Rejected, match="speed_unit 'RPM' is not one of rpm, rad/s, Hz"):
        converted(batch(speed_unit="RPM"))
    with pytest.raises(Rejected, match=r"sensitivity \[V/m\] in the document for B2X, B2Y"):
        converted(batch(amplitude_unit="V"))


def test_an_unknown_channel_is_rejected_with_the_known_ones() -> None:
    sent = batch(channels=["B2X", "B2Y", "B3X", "B9Z"])
    assert reason_of(lambda: converted(sent)) == "unknown_channel"
    with pytest.raises(Rejected, match="has no channel B9Z; it has B2X, B2Y, B3X, B3Y"):
        converted(sent)


def reasons_met() -> set[str]:
    """Reasons for which the messages of this module are rejected; `unknown_machine` is the ingest's own to give."""
    rejected: list[Callable[[], object]] = [partial(decoded, *payload) for payload in UNDECODABLE.values()]
    rejected += [partial(decoded, payload) for payload in BAD_FRAMES.values()]
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
    probes = [probe | {"gap_grows": "away"} for probe in document()["probes"]]
    _, _, beside = converted(
        batch(gap=[[1e3] * 4], gap_unit="m", overall=[[1e9] * 4]), probes=[*probes[:3], document()["probes"][3]]
    )
    return met | {fault.reason for fault in faults + beside + Plausibility().check(machine(), found, taken)}


def test_every_reason_is_met() -> None:
    assert reasons_met() == set(get_args(Reason)) - {
        "unknown_machine",
        "sequence_out_of_range",  # those need the store
        "retained",  # and this a broker
    }


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
