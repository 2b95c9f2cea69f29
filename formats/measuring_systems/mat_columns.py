"""Columns of a MAT file up to version 7: variables (N,), (N, 1) or (1, N), and the columns of matrices as NAME.1, NAME.2, …

Scalars `sampling_rate` [Hz] and `start_ns` (UTC, since 1970) may say the rest. A file of version 7.3 is an HDF5 file.
"""

from pathlib import Path
from typing import Any, cast

import numpy as np

from estimator.arrays import Floats
from formats.measuring_systems.mat_expansion import require_measured
from formats.measuring_systems.measured_columns import BrokenFile, MeasuredColumns


def mat_columns(path: Path) -> MeasuredColumns:
    """Return the columns of a MAT file. Raises BrokenFile."""
    import scipy.io  # half a second, which only those who need it should spend

    require_measured(path)
    try:
        with path.open("rb") as opened:
            found: dict[str, Any] = scipy.io.loadmat(cast(Any, opened))
    except NotImplementedError as error:  # what scipy raises for version 7.3, which is HDF5
        raise BrokenFile("unreadable_file", "a MAT file of version 7.3: save it with -v7, or as HDF5 with vectors") from error
    except OSError as error:
        if error.errno is not None:
            raise  # not of the file's content
        raise BrokenFile(
            "damaged_file", f"not a whole MAT file, cut short or damaged: copy or export it anew ({error})"
        ) from error
    except Exception as error:
        raise BrokenFile(
            "damaged_file", f"not a whole MAT file, cut short or damaged: copy or export it anew ({error})"
        ) from error
    values: dict[str, Floats] = {}
    for name, held in found.items():
        if name.startswith("__") or not isinstance(held, np.ndarray) or held.dtype.kind not in "fiuc" or held.ndim > 2:
            continue
        matrix = np.atleast_2d(held)
        if 1 in matrix.shape:
            values |= _real(name, matrix.reshape(-1))
        else:
            for place, column in enumerate(matrix.T, start=1):
                values |= _real(f"{name}.{place}", column)
    rate, start = (_scalar(found, name) for name in ("sampling_rate", "start_ns"))
    return MeasuredColumns(values, rate, None if start is None else int(start))


def _real(name: str, column: Any) -> dict[str, Floats]:
    """Return a column, or real and imaginary parts of a complex one."""
    if column.dtype.kind == "c":
        return {f"{name}.real": column.real.astype(float), f"{name}.imag": column.imag.astype(float)}
    return {name: column.astype(float)}


def _scalar(found: dict[str, Any], name: str) -> Any:
    held = found.get(name)
    if held is None or held.size != 1 or held.dtype.kind not in "fiu":
        return None
    return held.item()
