"""Columns of a universal file with datasets of type 58: ordinates by the response's name or `id1`, and their abscissa `x`.

A complex ordinate, such as an order over speed, gives NAME.real and NAME.imag. pyuff is an optional dependency.
"""

from pathlib import Path
from typing import Any

import numpy as np

from estimator.arrays import Floats
from formats.measuring_systems.measured_columns import BrokenFile, MeasuredColumns, named_once

TIME = 17
"""Type of an abscissa that is time."""
MARK = b"    -1"
"""End of the line before each dataset, and of the last one of it, where binary numbers may stand before it."""
DIGITS = 1e-5
"""Relative error of an abscissa that is written with six digits [-]."""


def uff58_columns(path: Path) -> MeasuredColumns:
    """Return the columns of a universal file. Raises BrokenFile."""
    try:
        import pyuff
    except ImportError as error:
        raise BrokenFile("unreadable_file", "UFF58 needs pyuff: pip install 'rotorundown[uff]'") from error
    marks = sum(line.rstrip(b"\r").endswith(MARK) for line in path.read_bytes().split(b"\n"))
    try:
        read = pyuff.UFF(str(path)).read_sets()
    except OSError:
        raise
    except Exception as error:
        raise BrokenFile("damaged_file", f"not a whole universal file: {error}") from error
    sets = [one for one in (read if isinstance(read, list) else [read]) if one.get("type") == 58]
    if not sets:
        raise BrokenFile("damaged_file" if marks else "unreadable_file", "no whole dataset of type 58 is in it")
    listed = [part for one in sets for part in _parts(one)]
    values, twice = named_once(listed)
    abscissa = np.asarray(sets[0]["x"], dtype=float)
    same = [_same(abscissa, np.asarray(one["x"], dtype=float)) for one in sets for _ in _parts(one)]
    first = next(iter(values)).removesuffix(".real")
    other = f"has another abscissa than {first}, whose is `x`: export all datasets over the same one"
    return MeasuredColumns(
        {"x": abscissa, **{name: column for (name, column), fits in zip(values.items(), same, strict=True) if fits}},
        _rate(sets[0], abscissa),
        cut="its last dataset has no end" if marks % 2 else "",
        twice=twice,
        unusable={name: other for name, fits in zip(values, same, strict=True) if not fits},
    )


def _same(abscissa: Floats, other: Floats) -> bool:
    """Return whether two datasets were taken at the same values."""
    if abscissa.shape != other.shape:
        return False
    return abscissa.size == 0 or float(np.max(np.abs(other - abscissa))) <= DIGITS * float(np.max(np.abs(abscissa)))


def _parts(one: dict[str, Any]) -> list[tuple[str, str, Floats]]:
    """Return short name, long name and values of an ordinate, of a complex one those of both parts."""
    entity, identity = str(one.get("rsp_ent_name", "NONE")).strip(), str(one.get("id1", "NONE")).strip()
    short = next((name for name in (entity, identity) if name not in ("", "NONE")), f"{one['rsp_node']}")
    long = f"{short}:{one['rsp_node']}:{one['rsp_dir']}"
    data = np.asarray(one["data"])
    if data.dtype.kind != "c":
        return [(short, long, data.astype(float))]
    return [(f"{short}.{part}", f"{long}.{part}", getattr(data, part).astype(float)) for part in ("real", "imag")]


def _rate(one: dict[str, Any], abscissa: Floats) -> float | None:
    """Return the sampling rate [Hz] of an abscissa that is time; None for any other."""
    if one.get("abscissa_spec_data_type") != TIME or abscissa.size < 2 or not abscissa[-1] > abscissa[0]:
        return None
    even = np.linspace(abscissa[0], abscissa[-1], abscissa.size)
    if np.max(np.abs(abscissa - even)) > DIGITS * np.max(np.abs(abscissa)):
        return None
    return float((abscissa.size - 1) / (abscissa[-1] - abscissa[0]))
