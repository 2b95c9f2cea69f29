"""Waveforms in an HDF5 file, a dataset (N,) for each channel, read piece by piece.

Attributes of the file or of the first channel's group may add `sampling_rate` [Hz] and `start_ns` (UTC, since 1970). h5py is
an optional dependency (`pip install rotorundown[hdf5]`).
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from estimator.arrays import Floats
from service.edge.file_error import InputFileError, require_columns


class Hdf5File:
    """An HDF5 file. Raises InputFileError."""

    def __init__(self, path: Path, columns: list[str]) -> None:
        self._path = path
        self._columns = columns
        with self._open_file() as file:
            there: list[str] = []
            file.visititems(lambda name, item: there.append(name) if hasattr(item, "shape") else None)
            require_columns([column.strip("/") for column in columns], there)
            for column in columns:
                dataset = file[column]
                if dataset.shape is None or len(dataset.shape) != 1 or dataset.dtype.kind not in "fiu":
                    raise InputFileError(
                        "missing_column", f"dataset '{column}' has shape {dataset.shape}; numbers (N,) are needed"
                    )
            said = dict(file[columns[0]].parent.attrs) | dict(file.attrs)
        self.sampling_rate = _number(said["sampling_rate"], "sampling_rate") if "sampling_rate" in said else None
        self.start_ns = int(_number(said["start_ns"], "start_ns")) if "start_ns" in said else None

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from sample `first` on, `size` samples at a time. Raises InputFileError when it is damaged."""
        with self._open_file() as file:
            datasets = [file[column] for column in self._columns]
            lengths = [dataset.shape[0] for dataset in datasets]
            for place in range(first, min(lengths), size):
                part = slice(place, min(place + size, min(lengths)))
                try:
                    yield np.array([dataset[part] for dataset in datasets], dtype=float)
                except OSError as error:
                    raise InputFileError("damaged_file", f"from sample {place} on: {error}") from error
            if min(lengths) < max(lengths):
                raise InputFileError("truncated_file", f"some datasets end after {min(lengths)} samples, others do not")

    def _open_file(self) -> Any:
        try:
            import h5py
        except ImportError as error:
            raise InputFileError("unreadable_file", "HDF5 needs h5py: pip install 'rotorundown[hdf5]'") from error
        try:
            return h5py.File(self._path, "r")
        except OSError as error:
            kind = "truncated_file" if "truncated" in str(error) else "unreadable_file"
            raise InputFileError(kind, f"not a whole HDF5 file: {error}") from error


def _number(said: Any, name: str) -> Any:
    """Return an attribute of one number; integers stay exact."""
    value = np.asarray(said)
    if value.size != 1 or value.dtype.kind not in "fiu":
        raise InputFileError("unreadable_file", f"attribute '{name}' must be one number, it is {str(said)[:60]!r}")
    return value.item()
