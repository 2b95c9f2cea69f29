"""The frame of a payload: one line of ASCII, `rundown/1 <length> <crc32>`, a newline, and the body.

zenoh was seen to deliver wrong bytes under the right key; length and CRC-32 of the body detect them.
"""

import re
import zlib

from formats.wire.rejection import Rejected

LARGEST_MESSAGE = 1 << 20
"""Largest payload, or body over HTTP [bytes]."""

_LINE = re.compile(rb"rundown/1 (\d{1,10}) ([0-9a-f]{8})\n")


def frame(body: bytes) -> bytes:
    """Return a body with length and checksum in front."""
    return b"rundown/1 %d %08x\n" % (len(body), zlib.crc32(body)) + body


def require_size(size: int) -> None:
    """Raise Rejected for a payload above the size limit."""
    if size > LARGEST_MESSAGE:
        raise Rejected("too_large", f"{size} bytes; at most {LARGEST_MESSAGE} are taken")


def unframed(payload: bytes) -> bytes:
    """Return the body of a payload after checking its frame. Raises Rejected."""
    require_size(len(payload))
    match = _LINE.match(payload)
    if match is None:
        raise Rejected("bad_frame", "the payload does not begin with 'rundown/1 <length> <crc32>' and a newline")
    body = payload[match.end() :]
    length, checksum = int(match[1]), int(match[2], 16)
    if len(body) != length:
        raise Rejected("bad_frame", f"the frame promises {length} bytes, {len(body)} came")
    if zlib.crc32(body) != checksum:
        raise Rejected("bad_frame", "the checksum does not fit the body")
    return body
