"""SQLite's write-ahead log as its index counts it: whether all of it is there, and what is left when it is not.

SQLite does not notice that its log was cut off or overwritten by somebody else: it reads what is missing as zeros, writes on
behind the hole, and copies the zeros into the main file with the next checkpoint. Formats:
https://www.sqlite.org/walformat.html
"""

import logging
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from storage.database import file_lock
from storage.database.private_files import PRIVATE

logger = logging.getLogger(__name__)

LOOKS = 5
"""Number of looks before a log counts as damaged: between two reads SQLite may have begun it anew."""
_LOG_HEADER, _FRAME_HEADER = 32, 24
"""Sizes of the headers of the log and of each frame, a page with its header, in it [B]."""
_INDEX_HEADER = "=IIIBBHIIIIQII"
"""Version, unused, changes, whether it is valid, byte order, page size, frames, pages, checksum (2), salt, checksum (2)."""
_COPY = struct.calcsize(_INDEX_HEADER)
_COPIED_AT_ONCE = 2**20
_CHECKPOINTED_AT = 2 * _COPY
"""Place of the number of frames that the main file holds already, behind the two copies of the header [B]."""


@dataclass(frozen=True)
class _Counted:
    """Frames that the log's index counts. frames: committed ones; salt: of the log since it was last begun anew."""

    frames: int
    page_size: int
    salt: int

    def place(self, frame: int) -> int:
        """Return where a frame begins [B]; the first one is 1."""
        return _LOG_HEADER + (frame - 1) * (_FRAME_HEADER + self.page_size)


class WriteAheadLog:
    """The log and the index of an open SQLite store, kept open under whatever name they have."""

    def __init__(self, log: Path, index: Path) -> None:
        """Open both. Raises OSError."""
        self._index_place = file_lock.use(index)
        try:
            self._log = os.open(log, os.O_RDWR)
            self._index = file_lock.descriptor(index)
        except OSError:
            file_lock.leave(self._index_place)
            raise
        self._seen = _Counted(0, 0, 0)
        self._further = 0

    def is_whole(self, *, further: int = 0) -> bool:
        """Return whether the frames looked at are there: the first, the last, and the one that was last before.

        further: number of frames looked at besides, in turn from one look to the next.
        """
        for _ in range(LOOKS):
            counted = self._counted()
            if counted is None:
                continue
            if self._holds(counted, further):
                self._seen = counted
                return True
            if self._counted() == counted:
                return False
        return True  # in motion: it is looked at again

    def go_back(self, copy: Path) -> int:
        """Make SQLite read the log anew, up to its last whole transaction; return the number of frames that are lost.

        The caller must have the writers' turn. Where the main file is ahead of what the log still holds, the log is emptied.

        copy: file that keeps the log as it was found, for a later rescue, as far as there is room for it.
        """
        try:
            self._copy_to(copy)
        except OSError as error:  # a hole that goes into the main file would be worse
            logger.error("the log that was cut off cannot be copied to %s: %s", copy, error)
        counted = self._counted() or self._seen
        checkpointed = int(struct.unpack("=I", os.pread(self._index, 4, _CHECKPOINTED_AT))[0])
        left = self._committed(counted)
        if left < checkpointed:
            os.ftruncate(self._log, 0)
        os.pwrite(self._index, bytes(2 * _COPY), 0)
        return max(0, counted.frames - max(left, checkpointed))

    def _copy_to(self, copy: Path) -> None:
        with open(os.open(copy, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, PRIVATE), "wb") as kept:
            at = 0
            while found := os.pread(self._log, _COPIED_AT_ONCE, at):
                kept.write(found)
                at += len(found)

    def close(self) -> None:
        """Close both. SQLite must have closed them before: a file's descriptor takes SQLite's locks along."""
        os.close(self._log)
        file_lock.leave(self._index_place)

    def _counted(self) -> _Counted | None:
        """Return what the index says; None while it is being written."""
        found = os.pread(self._index, 2 * _COPY, 0)
        if len(found) < 2 * _COPY or found[:_COPY] != found[_COPY:]:
            return None
        _, _, _, valid, _, page_size, frames, _, _, _, salt, _, _ = struct.unpack_from(_INDEX_HEADER, found)
        return _Counted(frames if valid else 0, 65536 if page_size == 1 else page_size, salt)

    def _holds(self, counted: _Counted, further: int) -> bool:
        frames = {1, counted.frames}
        if self._seen.salt == counted.salt:
            frames.add(self._seen.frames)
        if further and counted.frames:
            begin, count = self._further, min(further, counted.frames)
            frames.update(1 + (begin + number) % counted.frames for number in range(count))
            self._further = (begin + count) % counted.frames
        return all(self._header(counted, one) is not None for one in frames if 0 < one <= counted.frames)

    def _header(self, counted: _Counted, frame: int) -> int | None:
        """Return the size of the database after a frame, 0 within a transaction [pages]; None when the frame is not there."""
        at = counted.place(frame)
        if os.fstat(self._log).st_size < at + _FRAME_HEADER + counted.page_size:
            return None
        header = os.pread(self._log, _FRAME_HEADER, at)
        if len(header) < _FRAME_HEADER or struct.unpack_from("=Q", header, 8)[0] != counted.salt:
            return None
        return int(struct.unpack_from(">I", header, 4)[0])

    def _committed(self, counted: _Counted) -> int:
        """Return the last frame that ends a transaction, of those before the first one that is missing."""
        return max((frame for frame, size in self._whole(counted) if size), default=0)

    def _whole(self, counted: _Counted) -> Iterator[tuple[int, int]]:
        for frame in range(1, counted.frames + 1):
            size = self._header(counted, frame)
            if size is None:
                return
            yield frame, size
