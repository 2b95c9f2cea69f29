"""The frames of SQLite's write-ahead log: pages with a header each, behind the log's own header.

Format: https://www.sqlite.org/walformat.html
"""

import os
import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from storage.files import log_checksums
from storage.files.log_checksums import FRAME_HEADER

_LOG_HEADER = 32
"""Size of the header of the log [B]."""
_FRAMES_AT_ONCE = 256


@dataclass(frozen=True)
class CountedFrames:
    """Frames that the log's index counts. frames: committed ones; salt: salt of the log since it was last begun anew."""

    frames: int
    page_size: int
    salt: int

    def place(self, frame: int) -> int:
        """Return where a frame begins [B]; the first one is 1."""
        return _LOG_HEADER + (frame - 1) * self.size

    @property
    def size(self) -> int:
        """Return the size of a frame [B]."""
        return FRAME_HEADER + self.page_size


@dataclass(frozen=True)
class LogFrame:
    """A frame as the log has it.

    database_size: behind it, 0 within a transaction [pages]; whole: whether its checksum holds.
    """

    number: int
    page: int
    database_size: int
    whole: bool


class LogFrames:
    """The frames of an open log."""

    def __init__(self, log: int) -> None:
        """Set the log's descriptor."""
        self._log = log

    def is_there(self, counted: CountedFrames, frame: int) -> bool:
        """Return whether the log has a frame, by its header."""
        at = counted.place(frame)
        if os.fstat(self._log).st_size < at + counted.size:
            return False
        header = os.pread(self._log, FRAME_HEADER, at)
        return len(header) == FRAME_HEADER and struct.unpack_from("=Q", header, 8)[0] == counted.salt

    def read(self, counted: CountedFrames, numbers: range | None = None) -> Iterator[LogFrame]:
        """Yield the frames of a range, by default all; those that are missing have no page and are not whole."""
        numbers = range(1, counted.frames + 1) if numbers is None else numbers
        log_header = self._read(0, _LOG_HEADER)
        for first in numbers[::_FRAMES_AT_ONCE]:
            count = min(_FRAMES_AT_ONCE, numbers.stop - first)
            before = b"" if first == 1 else self._read(counted.place(first - 1), FRAME_HEADER)
            read = self._read(counted.place(first), count * counted.size)
            whole = log_checksums.valid_frames(log_header, before, read, counted.page_size)
            for number in range(count):
                page, size, salt = struct.unpack_from(">II8s", read, number * counted.size)
                own = int.from_bytes(salt, sys.byteorder) == counted.salt
                yield LogFrame(first + number, page if own else 0, size, bool(whole[number]) and own)

    def _read(self, at: int, size: int) -> bytes:
        """Read from the log; what is missing counts as zeros."""
        return os.pread(self._log, size, at).ljust(size, b"\0")
