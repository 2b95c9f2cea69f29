"""SQLite's write-ahead log, compared with its index: whether frames are missing, and which ones are left.

SQLite does not notice that its log was cut off or overwritten by somebody else: it reads the missing part as zeros,
continues to write after it, and copies the zeros into the main file at the next checkpoint. It compares checksums only after
a crash.
Formats: https://www.sqlite.org/walformat.html
"""

import itertools
import logging
import os
import struct
from pathlib import Path

from storage.files import file_lock
from storage.files.log_checksums import FRAME_HEADER
from storage.files.log_frames import CountedFrames, LogFrames
from storage.files.main_file import Checkpoints
from storage.files.private_files import PRIVATE

logger = logging.getLogger(__name__)

LOOKS = 5
"""Number of looks before a log counts as damaged: between two reads SQLite may have begun it anew."""
_INDEX_HEADER = "=IIIBBHIIIIQII"
"""Version, unused, changes, whether it is valid, byte order, page size, frames, pages, checksum (2), salt, checksum (2)."""
_COPY = struct.calcsize(_INDEX_HEADER)
_COPIED_AT_ONCE = 2**20
_CHECKPOINTED_AT, _BEGUN_AT = 2 * _COPY, 2 * _COPY + 32
"""Places of the numbers of frames that the main file holds already, and that the last checkpoint was to bring there [B]."""


class WriteAheadLog:
    """The log and the index of an open SQLite store, kept open under whatever name they have."""

    def __init__(self, log: Path, index: Path) -> None:
        """Open both. Raises OSError."""
        self._index_place = file_lock.register(index)
        try:
            self._log = os.open(log, os.O_RDWR)
            self._index = file_lock.descriptor(index)
        except OSError:
            file_lock.unregister(self._index_place)
            raise
        self._frames = LogFrames(self._log)
        self._seen = CountedFrames(0, 0, 0)
        self._further = 0

    def is_whole(self, *, further: int = 0) -> bool:
        """Return whether the first, the last and the formerly last frame are there and undamaged.

        further: number of frames looked at besides, with their checksums, in turn from one look to the next.
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
        checkpointed = self._number(_CHECKPOINTED_AT)
        left = self._committed(counted)
        if left < checkpointed:
            os.ftruncate(self._log, 0)
        self._forget_index()
        return max(0, counted.frames - max(left, checkpointed))

    def is_superfluous_where_damaged(self) -> bool:
        """Return whether each damaged frame's page is in the main file already, or in a later frame that is whole.

        A checkpoint then loses nothing. The caller must have the writers' turn.
        """
        counted, done = self._counted(), self._number(_CHECKPOINTED_AT)
        if counted is None:
            return False
        newest = {one.page: one for one in self._frames.read(counted)}
        lost = [one for one in self._frames.read(counted) if not one.whole and one.number > done]
        return all(newest[one.page].whole and one.page for one in lost)

    def write_back(self, main_file: int, copy: Path) -> bool:
        """Write all pages into the main file, where the log has every page; return whether it has. Then empty the log.

        Otherwise the main file stays as it is, and `copy` keeps the log. The caller must have the writers' turn.
        """
        counted = self._counted()
        frames = [] if counted is None else list(self._frames.read(counted))
        newest = {one.page: one for one in frames}
        pages = frames[-1].database_size if frames else 0
        complete = pages > 0 and all(page in newest and newest[page].whole for page in range(1, pages + 1))
        if complete and counted is not None:
            for page in range(1, pages + 1):
                found = os.pread(self._log, counted.page_size, counted.place(newest[page].number) + FRAME_HEADER)
                os.pwrite(main_file, found, (page - 1) * counted.page_size)
            os.ftruncate(main_file, pages * counted.page_size)
            os.fsync(main_file)
        else:
            self._copy_to(copy)
        os.ftruncate(self._log, 0)
        self._forget_index()
        return complete

    def checkpoints(self) -> Checkpoints | None:
        """Return how far the checkpoints are; None while the index is being written."""
        counted = self._counted()
        if counted is None:
            return None
        done = self._number(_CHECKPOINTED_AT)
        return Checkpoints(counted.salt, done, under_way=done != self._number(_BEGUN_AT))

    def _number(self, at: int) -> int:
        return int(struct.unpack("=I", os.pread(self._index, 4, at))[0])

    def _forget_index(self) -> None:
        """Make SQLite read the log anew."""
        os.pwrite(self._index, bytes(2 * _COPY), 0)

    def _copy_to(self, copy: Path) -> None:
        with open(os.open(copy, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, PRIVATE), "wb") as kept:
            at = 0
            while found := os.pread(self._log, _COPIED_AT_ONCE, at):
                kept.write(found)
                at += len(found)

    def close(self) -> None:
        """Close both. SQLite must have closed them before: a file's descriptor takes SQLite's locks along."""
        os.close(self._log)
        file_lock.unregister(self._index_place)

    def _counted(self) -> CountedFrames | None:
        """Return what the index says; None while it is being written."""
        found = os.pread(self._index, 2 * _COPY, 0)
        if len(found) < 2 * _COPY or found[:_COPY] != found[_COPY:]:
            return None
        _, _, _, valid, _, page_size, frames, _, _, _, salt, _, _ = struct.unpack_from(_INDEX_HEADER, found)
        return CountedFrames(frames if valid else 0, 65536 if page_size == 1 else page_size, salt)

    def _holds(self, counted: CountedFrames, further: int) -> bool:
        frames = {1, counted.frames}
        if self._seen.salt == counted.salt:
            frames.add(self._seen.frames)
        there = all(self._frames.is_there(counted, one) for one in frames if 0 < one <= counted.frames)
        if not there or not further or not counted.frames:
            return there
        begin, count = self._further % counted.frames, min(further, counted.frames)
        self._further = (begin + count) % counted.frames
        behind = max(0, begin + count - counted.frames)  # of the frames at the log's beginning
        ranges = (range(begin + 1, begin + count - behind + 1), range(1, behind + 1))
        return all(one.whole for numbers in ranges for one in self._frames.read(counted, numbers))

    def _committed(self, counted: CountedFrames) -> int:
        """Return the last frame that ends a transaction before the first missing or damaged frame."""
        whole = itertools.takewhile(lambda one: one.whole, self._frames.read(counted))
        return max((one.number for one in whole if one.database_size), default=0)
