"""Chunks of waveforms from files of any kind, from any sample on."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

import numpy as np

from estimator.arrays import Floats
from formats.measuring_systems.measured_files import is_measured_file
from service.edge.condition import Conditions
from service.edge.configuration import InputFile, Waveforms
from service.edge.csv_file import CsvFile
from service.edge.file_error import InputFileError
from service.edge.hdf5_file import Hdf5File
from service.edge.measured_file import MeasuredFile
from service.edge.npz_file import NpzFile
from service.edge.sample_window import Chunk
from service.edge.wav_file import WavFile
from storage.clock import from_datetime

CHUNK_SAMPLES = 16_384
"""Samples read at a time."""
RATE_TOLERANCE = 1e-3
"""Relative difference of two sampling rates that are the same."""
RATE_ROUNDING = 1e-5
"""Relative difference of a sampling rate that a file rounds, as UFF58 does to six digits, from the configured one."""
LONGEST_S = 1e9
"""No recording is longer than thirty years [s]."""


class WaveformFile(Protocol):
    """A file of waveforms; sampling_rate [Hz] and start_ns are None where it does not say them."""

    @property
    def sampling_rate(self) -> float | None:
        """Return the sampling rate [Hz]; None when the file does not state it."""

    @property
    def start_ns(self) -> int | None:
        """Return the time of the first sample [ns, UTC]; None when the file does not state it."""

    def read(self, first: int, size: int) -> Iterator[Floats]:
        """Yield columns (K, n) from sample `first` on, `size` samples at a time. Raises InputFileError."""


def open_file(path: Path, columns: list[str], *, full_scale: float) -> WaveformFile:
    """Open a file by the ending of its name. Raises InputFileError."""
    try:
        match path.suffix.lower():
            case ".wav":
                return WavFile(path, columns, full_scale=full_scale)
            case ".csv":
                return CsvFile(path, columns)
            case ".npz":
                return NpzFile(path, columns)
            case _ if is_measured_file(path):
                return MeasuredFile(path, columns)
            case _:
                return Hdf5File(path, columns)
    except OSError as error:
        raise InputFileError("unreadable_file", str(error.strerror or error)) from error


def read_chunks(
    file: InputFile,
    waveforms: Waveforms,
    columns: list[str],
    conditions: Conditions,
    *,
    first: int = 0,
    anchor: tuple[int, int] | None = None,
    rate: float | None = None,
) -> Iterator[Chunk]:
    """Yield the file's waveforms from sample `first` on. Faults become conditions; what can be read is delivered.

    anchor, rate: where reading goes on, a row of the unbroken waveform with its time [ns], and the sampling rate found before.
    """
    name = file.path.name
    empty = first == 0
    try:
        columns = [*columns, waveforms.time] if waveforms.time is not None else columns
        opened = open_file(file.path, columns, full_scale=waveforms.full_scale)
        said = _sampling_rate(opened.sampling_rate, waveforms.sampling_rate)
        rate = said if rate is None else rate
        start = opened.start_ns if file.start is None else from_datetime(file.start)
        if start is None:
            raise InputFileError("no_start_time", "neither the configuration nor the file says when it begins")
        pieces = opened.read(first, CHUNK_SAMPLES)
        if waveforms.time is None:
            if rate is None:
                raise InputFileError("wrong_sampling_rate", "neither the configuration nor the file says the sampling rate")
            for values in pieces:
                yield Chunk(first, values, rate, anchor=0, anchor_ns=start)
                first, empty = first + values.shape[1], False
        else:
            for chunk in _timed(pieces, name, conditions, first=first, rate=rate, start=start, anchor=anchor):
                yield chunk
                empty = False
        if empty:
            raise InputFileError("truncated_file", "there is no sample in it")
    except InputFileError as trouble:
        conditions.add_event(trouble.name, name, trouble.detail)
    except OSError as error:
        conditions.add_event("damaged_file", name, str(error))


def _timed(
    pieces: Iterator[Floats],
    name: str,
    conditions: Conditions,
    *,
    first: int,
    rate: float | None,
    start: int,
    anchor: tuple[int, int] | None,
) -> Iterator[Chunk]:
    """Yield chunks whose last column is the time [s], without rows back in time; behind a gap the waveform begins anew."""
    latest, last_row = -math.inf, first - 1
    going_on = anchor is not None
    back = 0
    for values in pieces:
        seconds = _checked_rate(values[-1])
        measured = _rate_of(seconds)
        rate = measured if rate is None else rate
        if rate is None or (measured is not None and abs(measured / rate - 1.0) > RATE_TOLERANCE):
            said = "no" if measured is None else f"{measured:.6g} Hz as"
            raise InputFileError("wrong_sampling_rate", f"its times show {said} sampling rate; configured: {rate} Hz")
        later = seconds > np.fmax.accumulate(np.concatenate([[latest], seconds[:-1]]))
        back += int(np.count_nonzero(~later))
        kept = np.flatnonzero(later)
        rows = first + kept
        if kept.size:
            even = np.abs(np.diff(seconds[kept], prepend=latest) * rate - 1.0) < 0.5
            joined = even & (np.diff(rows, prepend=last_row) == 1)
            joined[0] |= going_on
            for piece in np.split(np.arange(kept.size), np.flatnonzero(~joined)):
                if not piece.size:
                    continue
                place, follows = int(rows[piece[0]]), bool(joined[piece[0]])
                if not follows:
                    if anchor is not None:
                        conditions.add_event("input_gap", name, f"before row {place + 2}")
                    anchor = place, start + round(float(seconds[kept[piece[0]]]) * 1e9)
                assert anchor is not None
                yield Chunk(place, values[:-1, kept[piece]], rate, anchor=anchor[0], anchor_ns=anchor[1], follows=follows)
            latest, last_row, going_on = float(seconds[kept[-1]]), int(rows[-1]), False
        first += values.shape[1]
    if back:
        conditions.add_event("time_reversed", name, f"{back} rows are not later than those before them")


def _checked_rate(seconds: Floats) -> Floats:
    """Return times; NaN where a time is impossibly large, or is a single one later than the next row's."""
    believed = np.where(np.abs(seconds) <= LONGEST_S, seconds, np.nan)
    middle = believed[1:-1]
    middle[(middle > believed[2:]) & (believed[2:] > believed[:-2])] = np.nan
    return believed


def _rate_of(seconds: Floats) -> float | None:
    """Return the sampling rate [Hz] that the times show; None where most do not go forward."""
    if seconds.size < 2:
        return None
    step = float(np.nanmedian(np.diff(seconds)))
    return 1.0 / abs(step) if step else None


def _sampling_rate(said: float | None, configured: float | None) -> float | None:
    """Return the sampling rate: what the file says, or the configured one, from which that is rounded.

    Raises InputFileError where the two differ, or what the file says is no rate.
    """
    if said is not None and not (math.isfinite(said) and said > 0.0):
        raise InputFileError("unreadable_file", f"says {said:g} Hz, which is no sampling rate")
    if said is not None and configured is not None and abs(said / configured - 1.0) > RATE_TOLERANCE:
        raise InputFileError("wrong_sampling_rate", f"says {said:g} Hz, {configured:g} Hz is configured: one of them is wrong")
    if said is None or (configured is not None and abs(said / configured - 1.0) <= RATE_ROUNDING):
        return configured
    return said
