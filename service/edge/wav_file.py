"""Waveforms in a WAV file, read piece by piece: integers of 8 to 32 bits, floats of 32 or 64; channels are numbered from 1.

The RIFF chunks are parsed here because a truncated recording is to be used as far as it goes, and because files may be larger
than memory (https://www.mmsp.ece.mcgill.ca/Documents/AudioFormats/WAVE/WAVE.html describes them).
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from estimator.arrays import Floats
from service.edge.file_error import InputFileError, require_columns

PCM, FLOAT, EXTENSIBLE = 1, 3, 0xFFFE
UNKNOWN_SIZE = 0xFFFFFFFF
"""Size of the data when the writer did not know it; a writer that was killed leaves 0."""


class WavFile:
    """A WAV file. full_scale: value of the largest number. Raises InputFileError."""

    start_ns: int | None = None

    def __init__(self, path: Path, columns: list[str], *, full_scale: float) -> None:
        self._path = path
        self._full_scale = full_scale
        with path.open("rb") as file:
            head = file.read(12)
            if len(head) < 12 or head[:4] != b"RIFF" or head[8:] != b"WAVE":
                raise InputFileError("unreadable_file", "not a WAV file: it does not begin with RIFF … WAVE")
            kind = self._format(self._chunk(file, b"fmt "))
            file.seek(12)
            self._data, self._bytes = self._find(file, b"data")
        self._available = max(0, path.stat().st_size - self._data)
        self._kind, self._width, self._channels, self.sampling_rate = kind
        require_columns(columns, [str(number) for number in range(1, self._channels + 1)])
        self._columns = [int(column) - 1 for column in columns]

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from sample `first` on, `size` samples at a time. Raises InputFileError when it ends early."""
        frame = self._channels * self._width
        promised = self._bytes // frame if self._bytes not in (0, UNKNOWN_SIZE) else self._available // frame
        there = min(promised, self._available // frame)
        with self._path.open("rb") as file:
            file.seek(self._data + first * frame)
            for place in range(first, there, size):
                count = min(size, there - place)
                raw = file.read(count * frame)
                if len(raw) < count * frame:
                    raise InputFileError("truncated_file", f"ends within sample {place + len(raw) // frame}")
                yield self._values(raw).reshape(count, self._channels)[:, self._columns].T
        if self._bytes == 0 and there:
            raise InputFileError("truncated_file", f"its writer did not finish it; {there} samples are there")
        if there < promised:
            raise InputFileError("truncated_file", f"its header promises {promised} samples, {there} are there")

    def _values(self, raw: bytes) -> Floats:
        if self._kind == FLOAT:
            return np.frombuffer(raw, f"<f{self._width}").astype(float) * self._full_scale
        if self._width == 1:  # the only unsigned format
            return (np.frombuffer(raw, "u1").astype(float) - 128.0) * (self._full_scale / 128.0)
        # The bytes become the upper ones of 32 bits; the lower ones are zero.
        bytes_ = np.frombuffer(raw, "u1").reshape(-1, self._width)
        wide = np.zeros((len(bytes_), 4), "u1")
        wide[:, 4 - self._width :] = bytes_
        return np.asarray(wide.view("<i4")[:, 0] * (self._full_scale / 2.0**31))

    def _chunk(self, file: BinaryIO, name: bytes) -> bytes:
        place, size = self._find(file, name)
        file.seek(place)
        return file.read(size)

    def _find(self, file: BinaryIO, name: bytes) -> tuple[int, int]:
        """Return the place and size of a chunk."""
        while len(head := file.read(8)) == 8:
            found, size = struct.unpack("<4sI", head)
            if found == name:
                return file.tell(), size
            file.seek(size + size % 2, 1)
        raise InputFileError("unreadable_file", f"a WAV file without its part '{name.decode().strip()}'")

    def _format(self, chunk: bytes) -> tuple[int, int, int, float]:
        """Return the kind of the values, bytes of each, channels, sampling rate [Hz]."""
        if len(chunk) < 16:
            raise InputFileError("unreadable_file", "a WAV file whose format is cut short")
        kind, channels, rate, _, _, bits = struct.unpack_from("<HHIIHH", chunk)
        if kind == EXTENSIBLE and len(chunk) >= 26:
            (kind,) = struct.unpack_from("<H", chunk, 24)
        widths = {PCM: (8, 16, 24, 32), FLOAT: (32, 64)}.get(kind, ())
        if bits not in widths or not channels or not rate:
            raise InputFileError("unreadable_file", f"WAV format {kind} with {bits} bits, {channels} channels at {rate} Hz")
        return kind, bits // 8, channels, float(rate)
