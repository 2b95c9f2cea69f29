"""The binary encoding: the same batch as in the other two, every byte where the page says it is, and nothing believed that
does not fit."""

import math
import struct
from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS
from formats.wire import (
    BINARY,
    DIRECTIONS,
    ENCODINGS,
    STATUSES,
    Rejected,
    SampleBatch,
    decode_batch,
    decode_body,
    encode_batch,
)
from formats.wire.binary import (
    AMPLITUDE_KINDS,
    AMPLITUDE_UNITS,
    PHASE_CONVENTIONS,
    PHASE_UNITS,
    SENSES,
    SPEED_UNITS,
    encode_binary,
    int16,
    int32,
)
from tests.plant import KEY, START, batch, few_examples

numbers = st.floats(allow_nan=False, allow_infinity=False)
cells = st.none() | numbers

BatchValue = TypeVar("BatchValue")


@st.composite
def batches(draw: st.DrawFn) -> SampleBatch:
    """Any batch of the schema, whatever a machine would say to its values."""
    count, channels = draw(st.integers(1, 6)), draw(st.integers(1, 5))

    def table(values: st.SearchStrategy[BatchValue]) -> st.SearchStrategy[list[list[BatchValue]]]:
        return st.lists(st.lists(values, min_size=channels, max_size=channels), min_size=count, max_size=count)

    second, with_gap = draw(st.booleans()), draw(st.booleans())
    with_overall = draw(st.booleans())
    names = draw(st.lists(st.sampled_from(["oil", "load", "Druck-ü"]), unique=True))
    values = st.lists(cells, min_size=count, max_size=count)
    return SampleBatch(
        schema=1,
        plant=KEY.plant,
        machine=KEY.machine,
        source=draw(st.from_regex(r"[A-Za-z0-9_-]{1,64}", fullmatch=True)),
        epoch=draw(st.integers(0, 2**63 - 1)),
        sequence=draw(st.integers(0, 2**62 - 1)),
        channels=[f"P{i}-ü" for i in range(channels)],
        speed_unit=draw(st.sampled_from(SPEED_UNITS)),
        amplitude_unit=draw(st.sampled_from(AMPLITUDE_UNITS)),
        amplitude_kind=draw(st.sampled_from(AMPLITUDE_KINDS)),
        phase_convention=draw(st.sampled_from(PHASE_CONVENTIONS)),
        phase_unit=draw(st.sampled_from(PHASE_UNITS)),
        direction=draw(st.sampled_from(SENSES)),
        time_ns=draw(st.lists(st.integers(-(2**63), 2**63 - 1), min_size=count, max_size=count)),
        speed=draw(st.lists(numbers, min_size=count, max_size=count)),
        amplitude=draw(table(cells)),
        phase=draw(table(cells)),
        status=draw(st.none() | table(st.sampled_from(list(STATUSES)))),
        scatter=draw(st.none() | table(cells)),
        amplitude_2x=draw(table(cells)) if second else None,
        phase_2x=draw(table(cells)) if second else None,
        gap=draw(table(cells)) if with_gap else None,
        gap_unit=draw(st.sampled_from(AMPLITUDE_UNITS)) if with_gap else None,
        overall=draw(table(cells)) if with_overall else None,
        conditions={name: draw(values) for name in names} or None,
    )


@few_examples
@given(batches())
def test_all_encodings_carry_the_same_batch(sent: SampleBatch) -> None:
    for encoding in ENCODINGS:
        assert decode_batch(KEY, encode_batch(sent, encoding), encoding) == sent


@few_examples
@given(st.lists(st.none() | st.integers(-32767, 32767), min_size=8, max_size=8), st.sampled_from([0.01, 0.1, 3.7, 1e-9]))
def test_multiples_of_a_quantum_come_back_as_they_were(steps: list[int | None], quantum: float) -> None:
    rows = [[None if step is None else step * quantum for step in steps[i : i + 4]] for i in (0, 4)]
    sent = batch([900.0, 910.0], amplitude=rows, phase=rows, scatter=rows)
    for number in (int16(quantum), int32(quantum)):
        assert decode_body(encode_binary(sent, amplitude=number, phase=number, scatter=number), BINARY) == sent


def test_a_quantum_is_what_is_lost_at_most_and_what_does_not_fit_is_refused() -> None:
    sent = batch([900.0], amplitude=[[12.3456, 0.004, 654.32, 0.0]])
    found = decode_body(encode_binary(sent, amplitude=int32(0.01)), BINARY)
    assert np.abs(np.array(found.amplitude) - np.array(sent.amplitude)).max() <= 0.005 + 1e-12
    with pytest.raises(ValueError, match=r"654\.32 is beyond <i2"):
        encode_binary(sent, amplitude=int16(0.01))


def test_the_numbers_of_the_units_are_those_of_the_schema() -> None:
    tables: list[tuple[Sequence[str], Iterable[str]]] = [
        (SPEED_UNITS, RAD_PER_S),
        (AMPLITUDE_UNITS, [*METRES, "V"]),
        (AMPLITUDE_KINDS, PEAK),
        (PHASE_CONVENTIONS, LEAD),
        (PHASE_UNITS, RADIANS),
        (SENSES, DIRECTIONS),
    ]
    for places, table in tables:
        assert sorted(places) == sorted(table)
        assert len(set(places)) == len(places)


def by_hand() -> bytes:
    """One sample on two channels, every byte written out as `docs/integrators.md` describes it."""
    names = b"plant-1\npump-7\nmonitor\nB2X\nB2Y"
    return b"".join(
        [
            b"RDSW",
            struct.pack("<HH", 1, 72),
            struct.pack("<QQ", 5, 40),
            struct.pack("<IHH", 1, 2, len(names)),
            bytes([2, 0, 1, 0, 0, 1]),  # Hz, µm, peak-to-peak, lag, degrees, negative
            bytes([4]),  # status
            bytes([2, 1, 0]),  # int16, int32, float64
            bytes(6),
            struct.pack("<ddd", 0.5, 0.25, 1.0),
            names,
            bytes(-len(names) % 8),
            struct.pack("<q", START),
            struct.pack("<d", 16.0),
            struct.pack("<hh", 41, -32768),
            struct.pack("<ii", 120, -4),
            bytes([0, 3]),
        ]
    )


def test_every_byte_is_where_the_page_says() -> None:
    found = decode_body(by_hand(), BINARY)
    assert (found.plant, found.machine, found.source) == ("plant-1", "pump-7", "monitor")
    assert (found.epoch, found.sequence, found.channels) == (5, 40, ["B2X", "B2Y"])
    assert (found.speed_unit, found.amplitude_unit, found.amplitude_kind) == ("Hz", "um", "peak-to-peak")
    assert (found.phase_convention, found.phase_unit, found.direction) == ("lag", "deg", "negative")
    assert (found.time_ns, found.speed) == ([START], [16.0])
    assert (found.amplitude, found.phase, found.status) == ([[20.5, None]], [[30.0, -1.0]], [["good", "out_of_range"]])
    assert found.scatter is None
    assert found.amplitude_2x is None


def test_a_longer_header_of_a_later_version_is_skipped() -> None:
    body = by_hand()
    longer = body[:6] + struct.pack("<H", 80) + body[8:72] + b"whatever" + body[72:]
    assert decode_body(longer, BINARY) == decode_body(body, BINARY)


@pytest.mark.parametrize(
    ("at", "value", "reason"),
    [
        (0, b"X", "undecodable"),
        (4, struct.pack("<H", 0), "undecodable"),
        (4, struct.pack("<H", 2), "future_schema"),
        (6, struct.pack("<H", 71), "undecodable"),
        (6, struct.pack("<H", 65535), "undecodable"),
        (8, struct.pack("<Q", 2**64 - 1), "wrong_shape"),
        (24, struct.pack("<I", 2), "undecodable"),
        (24, struct.pack("<I", 2**32 - 1), "undecodable"),
        (28, struct.pack("<H", 3), "undecodable"),
        (30, struct.pack("<H", 3), "undecodable"),
        (32, b"\x03", "wrong_unit"),
        (33, b"\x05", "wrong_unit"),
        (38, b"\x0c", "undecodable"),
        (39, b"\x03", "undecodable"),
        (48, struct.pack("<d", 0.0), "undecodable"),
        (48, struct.pack("<d", math.nan), "undecodable"),
        (75, b"\xff", "undecodable"),
        (-1, b"\x04", "wrong_unit"),
    ],
)
def test_what_does_not_fit_is_rejected(at: int, value: bytes, reason: str) -> None:
    body = bytearray(by_hand())
    at %= len(body)
    body[at : at + len(value)] = value
    with pytest.raises(Rejected) as caught:
        decode_body(bytes(body), BINARY)
    assert caught.value.reason == reason


def test_no_cut_is_taken() -> None:
    body = by_hand()
    for size in range(len(body)):
        with pytest.raises(Rejected) as caught:
            decode_body(body[:size], BINARY)
        assert caught.value.reason == "undecodable"


def test_an_encoding_that_nobody_knows_is_named() -> None:
    with pytest.raises(Rejected, match="'text/csv' is not one of application/x-rundown-batch"):
        decode_body(by_hand(), "text/csv")


def test_binary_batches_are_the_smallest() -> None:
    values = [[100.0 / 3.0] * 4] * 50
    one = batch([2000.0 / 3.0] * 50, amplitude=values, phase=values)
    sizes = {encoding: len(encode_batch(one, encoding)) for encoding in ENCODINGS}
    assert sizes[BINARY] < sizes["application/msgpack"] < sizes["application/json"]
    assert len(encode_binary(one, amplitude=int16(0.1), phase=int16(0.1))) < 0.5 * sizes[BINARY]
