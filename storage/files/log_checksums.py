"""Checksums of the frames of SQLite's write-ahead log, many at a time.

A frame's checksum continues that of the frame before. It is linear in the words that it covers, modulo 2^32, so that it is one
product of a matrix (derived here from the recurrence of https://www.sqlite.org/walformat.html#checksum_algorithm).
"""

import functools

import numpy as np
import numpy.typing as npt

FRAME_HEADER = 24
"""Size of the header of a frame [B]."""
_COVERED = 8
"""Bytes of that header which the checksum covers: page number, and size of the database."""
_BIG_ENDIAN = 0x377F0683
"""Magic number of a log whose words are read as big-endian ones."""


def valid_frames(log_header: bytes, before: bytes, frames: bytes, page_size: int) -> npt.NDArray[np.bool_]:
    """Return of frames in a row whether each one's checksum holds.

    log_header: that of the log, 32 bytes. before: header of the frame before the first one; empty where that is the log's own.
    """
    taken = np.frombuffer(frames, np.uint8).reshape(-1, FRAME_HEADER + page_size)
    kept = np.ascontiguousarray(taken[:, 16:24]).view(">u4")
    first = np.frombuffer(before[16:24] or log_header[24:32], ">u4")
    seeds = np.vstack([first[np.newaxis], kept[:-1]])
    words = ">u4" if int.from_bytes(log_header[:4], "big") == _BIG_ENDIAN else "<u4"
    covered = np.ascontiguousarray(np.hstack([taken[:, :_COVERED], taken[:, FRAME_HEADER:]])).view(words)
    own, of_seed = _weights(covered.shape[1] // 2)
    found = covered.astype(np.uint32) @ own + seeds.astype(np.uint32) @ of_seed
    return np.asarray((found == kept).all(axis=1))


@functools.cache
def _weights(pairs: int) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32]]:
    """Return the weights of each word, and of the two sums before, in the two sums of pairs of words."""
    # One step: s0' = s0 + s1 + a, s1' = s1 + s0' + b. For the last pair the weights of a are (1, 1), those of b (0, 1).
    of_words, a, b = [], (1, 1), (0, 1)
    for _ in range(pairs):
        of_words += [b, a]
        a, b = _step(a), _step(b)
    of_seed = [(1, 0), (0, 1)]
    for _ in range(pairs):
        of_seed = [_step(one) for one in of_seed]
    return np.array(of_words[::-1], np.uint32), np.array(of_seed, np.uint32)


def _step(sums: tuple[int, int]) -> tuple[int, int]:
    first = (sums[0] + sums[1]) % 2**32
    return first, (sums[1] + first) % 2**32
