"""Messages that the tests of the wire send, take apart and expect."""

import math
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from formats.wire import (
    MESSAGEPACK,
    Fault,
    Key,
    Rejected,
    SampleBatch,
    decode_batch,
    frame,
    to_samples,
)
from storage.encoding.sample_blocks import Samples
from tests.plant import KEY, START, machine

NOW = START + 3600 * 10**9
HUGE = 10**30
"""Beyond any integer of 64 bits."""
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
