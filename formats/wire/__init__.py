"""The contract with sources, defined only here: keys of messages, their frame, schema and three encodings, and the conversion
to SI. It imports no other room; `docs/integrators.md` describes the contract for those who write sources.
"""

from formats.wire.answers import Received, SourceReceived
from formats.wire.conversion import (
    EARLIEST_TIME,
    LARGEST_AMPLITUDE,
    LARGEST_PHASE,
    OVERSPEED,
    to_samples,
)
from formats.wire.encodings import (
    BINARY,
    ENCODINGS,
    JSON,
    MESSAGEPACK,
    decode_batch,
    decode_body,
    encode_batch,
    encode_body,
    recognised,
    unknown_fields,
)
from formats.wire.frame import LARGEST_MESSAGE, frame, require_size, unframed
from formats.wire.gap_conversion import as_sent
from formats.wire.keys import ALL_LIVE, ALL_RECEIVED, ALL_SAMPLES, ALL_SUBMIT, IDENTIFIER, Key
from formats.wire.rejection import Fault, InternalErrorReason, Reason, Rejected
from formats.wire.schema import (
    DIRECTIONS,
    LARGEST_BATCH,
    LARGEST_CHANNEL_COUNT,
    LARGEST_CONDITION_COUNT,
    STATUSES,
    TABLES,
    WIRE_SCHEMA,
    SampleBatch,
    source_key,
)

__all__ = [
    "ALL_LIVE",
    "ALL_RECEIVED",
    "ALL_SAMPLES",
    "ALL_SUBMIT",
    "BINARY",
    "DIRECTIONS",
    "EARLIEST_TIME",
    "ENCODINGS",
    "IDENTIFIER",
    "JSON",
    "LARGEST_AMPLITUDE",
    "LARGEST_BATCH",
    "LARGEST_CHANNEL_COUNT",
    "LARGEST_CONDITION_COUNT",
    "LARGEST_MESSAGE",
    "LARGEST_PHASE",
    "MESSAGEPACK",
    "OVERSPEED",
    "STATUSES",
    "TABLES",
    "WIRE_SCHEMA",
    "Fault",
    "InternalErrorReason",
    "Key",
    "Reason",
    "Received",
    "Rejected",
    "SampleBatch",
    "SourceReceived",
    "as_sent",
    "decode_batch",
    "decode_body",
    "encode_batch",
    "encode_body",
    "frame",
    "recognised",
    "require_size",
    "source_key",
    "to_samples",
    "unframed",
    "unknown_fields",
]
