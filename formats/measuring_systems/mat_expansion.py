"""Bounds what a compressed MAT file becomes, before it is read: 2 MB may hold 2 GB of zeros."""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from formats.measuring_systems.measured_columns import BrokenFile

MOST_EXPANDED = 100
"""Most bytes that a byte of a file may become: measured values become 8 at the most, zeros 1,000."""
ALWAYS_TAKEN = 64 << 20
"""Content that is taken from any file [B]."""
_HEADER, _COMPRESSED, _PIECE = 128, 15, 1 << 20


def require_measured(path: Path) -> None:
    """Raise BrokenFile where compressed variables of a MAT file become more than any measured values would."""
    most = max(ALWAYS_TAKEN, MOST_EXPANDED * path.stat().st_size)
    total = 0
    with path.open("rb") as opened:
        for size in _expanded(opened):
            total += size
            if total > most:
                said = f"it holds more than {most / 2**20:.0f} MiB in {path.stat().st_size / 2**20:.1f} MiB"
                raise BrokenFile(
                    "unreadable_file", f"{said}, which no measured values do: export it anew, without compression"
                )


def _expanded(opened: BinaryIO) -> Iterator[int]:
    """Yield the sizes of the content of compressed variables, piece by piece [B]; of a file that has none, nothing."""
    order = {b"IM": "<", b"MI": ">"}.get(opened.read(_HEADER)[-2:])
    while order is not None and len(tag := opened.read(8)) == 8:
        kind, size = struct.unpack(f"{order}II", tag)
        if kind != _COMPRESSED:
            opened.seek(size, 1)
            continue
        stream, left = zlib.decompressobj(), size
        while left > 0 and not stream.eof:
            piece = opened.read(min(left, _PIECE))
            left -= len(piece)
            if not piece:
                return
            while piece and not stream.eof:
                try:
                    yield len(stream.decompress(piece, _PIECE))
                except zlib.error:  # whoever reads it says what is wrong
                    return
                piece = stream.unconsumed_tail
        opened.seek(left, 1)
