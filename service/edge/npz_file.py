"""Waveforms in an NPZ file, an array (N,) for each channel, read piece by piece.

Arrays of one value may add `sampling_rate` [Hz] and `start_ns` (UTC, since 1970).
"""

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import IO

import numpy as np

from estimator.arrays import Floats
from service.edge.file_error import InputFileError, require_columns

CHECKED_AT_ONCE = 1 << 20
"""Bytes read at a time for the check of the checksums."""
NUMBERS = "fiu"
"""Kinds of arrays that are accepted: floats and integers."""


class NpzFile:
    """An NPZ file, compressed or not. Raises InputFileError."""

    def __init__(self, path: Path, columns: list[str]) -> None:
        self._path = path
        self._columns = columns
        try:
            # The checksum at an array's end is the only sign of wrong numbers: check it before any is used.
            with zipfile.ZipFile(path) as archive:
                names = [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]
                require_columns(columns, names)
                for column in columns:
                    with archive.open(f"{column}.npy") as member:
                        while member.read(CHECKED_AT_ONCE):
                            pass
                rate = self._scalar(archive, "sampling_rate") if "sampling_rate" in names else None
                start = self._scalar(archive, "start_ns") if "start_ns" in names else None
        except (
            zipfile.BadZipFile,
            EOFError,
            zlib.error,
            RuntimeError,
        ) as error:  # RuntimeError: encrypted, or an unknown compression
            raise InputFileError("damaged_file", f"not a whole NPZ file: {error}") from error
        self.sampling_rate = None if rate is None else float(rate)
        self.start_ns = None if start is None else int(start)

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from sample `first` on, `size` samples at a time. Raises InputFileError when it is damaged."""
        with ExitStack() as stack:
            archive = stack.enter_context(zipfile.ZipFile(self._path))
            members = [stack.enter_context(archive.open(f"{column}.npy")) for column in self._columns]
            opened = [self._header(member, column) for member, column in zip(members, self._columns, strict=True)]
            length = min(count for count, _ in opened)
            for member, (_, dtype) in zip(members, opened, strict=True):
                member.seek(first * dtype.itemsize, 1)
            for place in range(first, length, size):
                count = min(size, length - place)
                try:
                    raw = [member.read(count * dtype.itemsize) for member, (_, dtype) in zip(members, opened, strict=True)]
                except (zipfile.BadZipFile, EOFError, zlib.error) as error:
                    raise InputFileError("damaged_file", f"from sample {place} on: {error}") from error
                if any(len(part) < count * dtype.itemsize for part, (_, dtype) in zip(raw, opened, strict=True)):
                    raise InputFileError("truncated_file", f"ends within the samples from {place} on")
                parts = (np.frombuffer(part, dtype) for part, (_, dtype) in zip(raw, opened, strict=True))
                yield np.array([part.astype(float) for part in parts])
            if length < max(count for count, _ in opened):
                raise InputFileError("truncated_file", f"some of its arrays end after {length} samples, others do not")

    def _header(self, member: IO[bytes], column: str) -> tuple[int, np.dtype[np.generic]]:
        """Return the length and type of an array, read from its beginning."""
        try:
            version = np.lib.format.read_magic(member)
            reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
            shape, _, dtype = reader(member)
        except (ValueError, zipfile.BadZipFile, zlib.error) as error:
            raise InputFileError("damaged_file", f"array '{column}': {error}") from error
        if len(shape) != 1 or dtype.kind not in NUMBERS:
            raise InputFileError("missing_column", f"array '{column}' has shape {shape} of {dtype}; numbers (N,) are needed")
        return shape[0], dtype

    def _scalar(self, archive: zipfile.ZipFile, name: str) -> float | int:
        with archive.open(f"{name}.npy") as member:
            try:
                value = np.lib.format.read_array(member, allow_pickle=False)
            except ValueError as error:
                raise InputFileError("unreadable_file", f"array '{name}' must hold one number: {error}") from error
        if value.size != 1 or value.dtype.kind not in NUMBERS:
            raise InputFileError("unreadable_file", f"array '{name}' must hold one number")
        return int(value.item()) if value.dtype.kind in "iu" else float(value.item())
