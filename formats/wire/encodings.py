"""The three encodings of the schema, distinguished by the message's zenoh encoding or its Content-Type."""

from typing import TypeVar

import msgspec

from formats.wire.binary import decode_binary, encode_binary
from formats.wire.frame import frame, unframed
from formats.wire.keys import Key
from formats.wire.rejection import Rejected
from formats.wire.schema import SampleBatch, require_schema, require_shape

BINARY, MESSAGEPACK, JSON = "application/x-rundown-batch", "application/msgpack", "application/json"
ENCODINGS = (BINARY, MESSAGEPACK, JSON)

LONGEST_NAME, MOST_UNKNOWN = 64, 20
"""Characters of a field's name, and such fields, that are named at most."""
UNSAID = ("", "zenoh/bytes")
"""Encodings of a message that does not state one; it is read as MessagePack."""

_T = TypeVar("_T")


class _Version(msgspec.Struct):
    schema: int


def recognised(body: bytes) -> str:
    """Return the encoding of a body that states none: JSON begins with a brace, the binary one with its name."""
    if body.startswith(b"RDSW"):
        return BINARY
    return JSON if body.lstrip()[:1] == b"{" else MESSAGEPACK


def encode_body(batch: SampleBatch, encoding: str = MESSAGEPACK) -> bytes:
    """Return an encoded batch without its frame, as HTTP carries it."""
    if encoding == BINARY:
        return encode_binary(batch)
    return msgspec.json.encode(batch) if encoding == JSON else msgspec.msgpack.encode(batch)


def encode_batch(batch: SampleBatch, encoding: str = MESSAGEPACK) -> bytes:
    """Return the payload that carries a batch: encoded and framed."""
    return frame(encode_body(batch, encoding))


def decode_batch(key: Key, payload: bytes, encoding: str) -> SampleBatch:
    """Decode a payload and check all that does not need the machine's document. Raises Rejected."""
    batch = decode_body(unframed(payload), encoding)
    if (batch.plant, batch.machine) != (key.plant, key.machine):
        raise Rejected("key_mismatch", f"body says {batch.plant}/{batch.machine}, key says {key.plant}/{key.machine}")
    return batch


def decode_body(body: bytes, encoding: str) -> SampleBatch:
    """Return the batch in a body, with its shape checked. Raises Rejected."""
    kind = encoding.split(";")[0].strip().lower()
    if kind in UNSAID:
        kind = MESSAGEPACK
    if kind not in ENCODINGS:
        raise Rejected("undecodable", f"encoding '{encoding[:80]}' is not one of {', '.join(ENCODINGS)}")
    if kind == BINARY:
        batch = decode_binary(body)
    else:
        try:
            require_schema(_decoded(_Version, body, kind).schema)
            batch = _decoded(SampleBatch, body, kind)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            raise Rejected("undecodable", f"body is not a sample batch in {kind}: {error}") from None
    require_shape(batch)
    return batch


def unknown_fields(body: bytes, encoding: str) -> list[str]:
    """Return the names of a body's fields that the schema does not have and that are ignored; none of what cannot be read."""
    kind = encoding.split(";")[0].strip().lower()
    if kind == BINARY:
        return []
    try:
        names = _decoded(dict[str, msgspec.Raw], body, kind)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return []
    return [name[:LONGEST_NAME] for name in names if name not in SampleBatch.__struct_fields__][:MOST_UNKNOWN]


def _decoded(kind: type[_T], body: bytes, encoding: str) -> _T:
    return msgspec.json.decode(body, type=kind) if encoding == JSON else msgspec.msgpack.decode(body, type=kind)
