"""Rubbish for the ingest: wrong messages of every kind, from hypothesis, through decoding and write path into a real store."""

import json
import random
import zlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from formats.wire import (
    BINARY,
    ENCODINGS,
    JSON,
    LARGEST_AMPLITUDE,
    LARGEST_MESSAGE,
    MESSAGEPACK,
    Rejected,
    decode_batch,
    encode_body,
    frame,
)
from service.runs.collector import Collector
from service.write_path.batch import ArrivedBatch
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.encoding.sample_blocks import decode
from storage.measurements import quarantine
from storage.measurements.quarantine import Rejection
from storage.tables.measurements import SampleBlockRow
from tests.plant import CHANNELS, KEY, START, batch

SIZE = 3
A_START = 200
"""Cases of one start of the source."""
STORED_TOGETHER = 100
CASES_AT_ONCE = 5_000
"""Of one run of hypothesis: it remembers what it has tried."""
RECEIVED_AT = START + 86_400 * 10**9 * 365

NUMBERS = (float("nan"), float("inf"), float("-inf"), 1e308, -1e308, 1e-320, -0.0, -1.0, 0.0, 1e5, 2.0**63)
WHOLE = (0, -1, 1, 2**31, 2**53, 2**62, 2**63 - 1, 2**63, 2**64, -(2**63), 10**30)
ANYTHING: list[object] = [None, True, "", "x", "\x00", "ß" * 70, [], [[]], [None], {}, {"a": []}, 0, -1, 1e308, 2**64]
ANYTHING += [[[[1.0]]], "9" * 400]
UNITS = {
    "amplitude_unit": ("um", "mil", "mm", "m", "V", "furlong", ""),
    "speed_unit": ("rpm", "Hz", "rad/s", "knots"),
    "phase_unit": ("deg", "rad", "grad"),
    "amplitude_kind": ("peak", "peak-to-peak", "rms"),
    "phase_convention": ("lag", "lead", "none"),
    "direction": ("positive", "negative", "both"),
}
Message = tuple[bytes, str]
"""Payload and encoding."""


def good(number: int) -> dict[str, Any]:
    """A batch as plain data, behind the one before; now and then of a new start of its source, which forgets wrong numbers."""
    epoch, place = divmod(number, A_START)
    start = START + 10**9 * SIZE * number
    one = batch([1000.0] * SIZE, epoch=epoch, sequence=SIZE * place, start=start, source="edge")
    return dict(msgspec.to_builtins(one))


def _as(body: dict[str, Any], encoding: str) -> bytes:
    """Plain data in an encoding; in JSON also what JSON has not, such as NaN. Binary takes only what a batch holds."""
    if encoding == JSON:
        return json.dumps(body).encode()
    if encoding == MESSAGEPACK:
        return msgspec.msgpack.encode(body)
    return encode_body(msgspec.convert(body, type(batch())), BINARY)


def untouched(draw: random.Random, number: int) -> Message:
    encoding = draw.choice(ENCODINGS)
    return frame(_as(good(number), encoding)), encoding


def noise(draw: random.Random, _number: int) -> Message:
    body = draw.randbytes(draw.randrange(300))
    return (frame(body) if draw.random() < 0.7 else body), draw.choice(ENCODINGS)


def flipped(draw: random.Random, number: int) -> Message:
    """Bits flipped in a body, whose frame fits, or in a message."""
    encoding = draw.choice(ENCODINGS)
    body = bytearray(_as(good(number), encoding))
    whole = draw.random() < 0.3
    if whole:
        body = bytearray(frame(bytes(body)))
    for _ in range(draw.randint(1, 4)):
        body[draw.randrange(len(body))] ^= 1 << draw.randrange(8)
    return (bytes(body) if whole else frame(bytes(body))), encoding


def cut(draw: random.Random, number: int) -> Message:
    """Make a message too short or too long."""
    encoding = draw.choice(ENCODINGS)
    body = _as(good(number), encoding)
    at = draw.randrange(len(body))
    return frame(body[:at] if draw.random() < 0.7 else body + body[at:]), encoding


def odd_field(draw: random.Random, number: int) -> Message:
    """Anything at all in a field, a field that is missing, one that nobody knows."""
    body = good(number)
    name = draw.choice(sorted(body))
    chance = draw.random()
    if chance < 0.1:
        del body[name]
    elif chance < 0.2:
        body[name + "_"] = draw.choice(ANYTHING)
    else:
        body[name] = draw.choice(ANYTHING)
    return frame(json.dumps(body).encode()), JSON


def odd_numbers(draw: random.Random, number: int) -> Message:
    """NaN, infinities, 1e308 and the like among amplitudes, phases and speeds."""
    encoding = draw.choice(ENCODINGS)
    body = good(number)
    for _ in range(draw.randint(1, 4)):
        row, name = draw.randrange(SIZE), draw.choice(("amplitude", "phase", "speed", "scatter"))
        if name == "speed":
            body["speed"][row] = draw.choice(NUMBERS)
            continue
        table = body.setdefault(name, [[1.0] * len(CHANNELS) for _ in range(SIZE)])
        table[row][draw.randrange(len(CHANNELS))] = draw.choice((*NUMBERS, None))
    return frame(_as(body, encoding)), encoding


def odd_times(draw: random.Random, number: int) -> Message:
    """Times and numbers that overflow or go back."""
    body = good(number)
    if draw.random() < 0.5:
        body["time_ns"][draw.randrange(SIZE)] = draw.choice((*WHOLE, START))
    else:
        body["epoch"] = draw.choice(WHOLE) if draw.random() < 0.1 else body["epoch"]
        body["sequence"] = draw.choice([one for one in WHOLE if not 2**30 > one > 1])
    return frame(json.dumps(body).encode()), JSON


def other_units(draw: random.Random, number: int) -> Message:
    encoding = draw.choice((JSON, MESSAGEPACK))
    body = good(number)
    for _ in range(draw.randint(1, 2)):
        name = draw.choice(sorted(UNITS))
        body[name] = draw.choice(UNITS[name])
    return frame(_as(body, encoding)), encoding


def no_channels(draw: random.Random, number: int) -> Message:
    """Leave out channels or samples, or make rows of other lengths."""
    encoding = draw.choice(ENCODINGS)
    body = good(number)
    chance = draw.random()
    if chance < 0.4:
        body |= {"channels": [], "amplitude": [[] for _ in range(SIZE)], "phase": [[] for _ in range(SIZE)]}
    elif chance < 0.7:
        body |= {"time_ns": [], "speed": [], "amplitude": [], "phase": []}
    else:
        body["channels"] = body["channels"][: draw.randrange(1, len(CHANNELS))]
        encoding = JSON
    return frame(_as(body, encoding)), encoding


def other_encoding(draw: random.Random, number: int) -> Message:
    """State another encoding than the message has, or one that does not exist."""
    said = draw.choice((*ENCODINGS, "", "zenoh/bytes", "text/plain", "application/json; charset=utf-16", "\x00"))
    return frame(_as(good(number), draw.choice(ENCODINGS))), said


def wrong_frame(draw: random.Random, number: int) -> Message:
    body = _as(good(number), JSON)
    lines = (
        b"rundown/1 %d %08x\n" % (len(body) + draw.randint(-2, 2), zlib.crc32(body)),
        b"rundown/2 %d %08x\n" % (len(body), zlib.crc32(body)),
        b"rundown/1 9999999999 00000000\n",
        b"rundown/1 -1 %08x\n" % zlib.crc32(body),
        b"",
    )
    return draw.choice(lines) + body, JSON


def deep(draw: random.Random, _number: int) -> Message:
    """Nested without end, or said to be huge."""
    depth = draw.choice((10, 1_000, 100_000))
    bodies = {
        JSON: (b"[" * depth, b'{"schema":' * depth, b'{"schema":1,"plant":' + b"[" * depth),
        MESSAGEPACK: (b"\x91" * depth, b"\xdd\xff\xff\xff\xff", b"\xdf\xff\xff\xff\xff\xa1a", b"\xc6\xff\xff\xff\xff"),
        BINARY: (b"RDSW\x01\x00\x48\x00" + b"\xff" * 64, b"RDSW\x01\x00\xff\xff" + b"\x00" * 200),
    }
    encoding = draw.choice(ENCODINGS)
    return frame(draw.choice(bodies[encoding])), encoding


def too_large(draw: random.Random, _number: int) -> Message:
    return frame(bytes(LARGEST_MESSAGE + draw.randrange(1, 1000))), draw.choice(ENCODINGS)


KINDS: tuple[Callable[[random.Random, int], Message], ...] = (
    untouched, noise, flipped, cut, odd_field, odd_numbers, odd_times, other_units, no_channels, other_encoding, wrong_frame,
    deep,
)  # fmt: skip
RARE = 500
"""One message in so many is of more bytes than are taken."""


@dataclass
class Fuzzed:
    """Takes rubbish as the ingest does. reasons: of every rejected message, sample and value; taken: samples stored."""

    database: Database
    cases: int = 0
    taken: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    _waiting: list[ArrivedBatch] = field(default_factory=list)
    _rejections: list[Rejection] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._writer = SampleWriter(self.database, Collector())

    def run(self, cases: int, *, number: int) -> None:
        """Run so many more cases, from a seed of their own."""
        last = self.cases + cases

        @seed(number)
        @settings(
            max_examples=cases,
            database=None,
            deadline=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(st.sampled_from(KINDS), st.integers(0, 2**64 - 1))
        def one(kind: Callable[[random.Random, int], Message], chance: int) -> None:
            if self.cases < last:
                self._case(kind, random.Random(chance))

        one()
        while self.cases < last:  # hypothesis may have tried less than it was allowed
            self._case(KINDS[self.cases % len(KINDS)], random.Random(f"{number} {self.cases}"))
        self._store()

    def _case(self, kind: Callable[[random.Random, int], Message], chance: random.Random) -> None:
        self.cases += 1
        if self.cases % RARE == 0:
            kind = too_large
        payload, encoding = kind(chance, self.cases)
        self.kinds[kind.__name__] += 1
        try:
            read = decode_batch(KEY, payload, encoding)
        except Rejected as rejected:
            self.reasons[rejected.reason] += 1
            self._rejections.append(
                Rejection.of_message(
                    received_at=RECEIVED_AT,
                    key=KEY.samples,
                    machine_id=KEY.machine,
                    reason=rejected.reason,
                    detail=rejected.detail,
                    payload=payload,
                )
            )
        else:
            self._waiting.append(ArrivedBatch(read, KEY.samples, payload, RECEIVED_AT))
        if len(self._waiting) + len(self._rejections) >= STORED_TOGETHER:
            self._store()

    def _store(self) -> None:
        for outcome in self._writer.store(self._waiting, self._rejections):
            self.taken += outcome.received
            if outcome.rejected is not None:
                self.reasons[outcome.rejected.reason] += 1
            self.reasons.update(fault.reason for fault in outcome.faults)
        self._waiting.clear()
        self._rejections.clear()

    def check(self) -> None:
        """All that was rejected is counted by its reason, and nothing that no shaft does is in the store for a fit to find."""
        with self.database.reading() as session:
            assert quarantine.counts(session) == dict(self.reasons)
            stored = 0
            for (data,) in session.query(SampleBlockRow.data).yield_per(100):
                held = decode(data)
                stored += len(held)
                usable = held.phasor[held.usable]
                assert np.all(np.isfinite(usable))
                assert np.all(np.abs(usable) <= LARGEST_AMPLITUDE * (1 + 1e-12))
                assert np.all(np.isfinite(held.speed))
                assert not np.any(np.isinf(held.scatter))
            assert stored == self.taken
