"""Trial weights of which some are stated in another unit than was meant: g in beside g mm, as where two people write.

Weights of one job are alike in size. Where some are tens of times heavier than all others, two units may be mixed: those of
which there are fewer are taken in a unit that makes them alike, of as many the heavier ones, and the runs calibrated again.
That the others are wrong instead is the same but for a factor on all gains. Derived here.
"""

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.calibration.calibration_runs import CalibrationRun
from estimator.units import KILOGRAM_METRES

GAP = 15.0
"""Ratio between neighbouring sizes of weights from which on they are doubted [-]."""
GAP_OF_ONE = 100.0
"""Such a ratio for single weights in a table, whose unit is that of the column: a slip of one is a thousand [-]."""
NEAR = 1.7
"""Factor within which the ratio of two units explains that of the sizes [-]."""
MOST = 3
"""Most pairs of units that are tried."""


class MixedUnits(Struct, frozen=True, eq=False):
    """Weights that are far heavier, or lighter, than all others.

    Attributes:
        runs: The R runs, or parts of runs, that they are among.
        doubted: Whether the weights of each run on each disc are among them (R, P).
        words: Which they are, in words.
        ratio: Their size over that of the others [-].
        units: Likely pairs of the unit that they were given in and the one that was meant, the likeliest first.
    """

    runs: tuple[CalibrationRun, ...]
    doubted: NDArray[np.bool_]
    words: str
    ratio: float
    units: tuple[tuple[str, str], ...]

    @property
    def remark(self) -> str:
        """Return the doubt as a sentence."""
        pairs = ", ".join(f"{meant} given as {given}" for given, meant in self.units)
        heavier, lighter = f"{self.ratio:.2g} times as heavy as", f"{1.0 / self.ratio:.0f} times lighter than"
        unlike = heavier if self.ratio > 1.0 else lighter
        return f"{self.words} are {unlike} the others: are units mixed (such as {pairs})?"

    def undone(self, given: str, meant: str) -> list[CalibrationRun]:
        """Return the runs with the doubted weights in another unit.

        Args:
            given: Unit in which they were given.
            meant: Unit that is tried.

        Returns:
            The runs.
        """
        factor = KILOGRAM_METRES[meant] / KILOGRAM_METRES[given]
        return [
            run
            if run.measurement.added is None
            else replace(run, measurement=replace(run.measurement, added=np.where(row, factor, 1.0) * run.measurement.added))
            for run, row in zip(self.runs, self.doubted, strict=True)
        ]


def mixed_units(discs: Sequence[str], runs: Sequence[CalibrationRun]) -> MixedUnits | None:
    """Find weights that are so much heavier or lighter than all others that two units explain it.

    They are those of whole runs or discs, or single ones in a table of many.

    Args:
        discs: Ids of the P discs.
        runs: The runs, with their weights.

    Returns:
        Those weights; None where all are alike.
    """
    return _unlike(discs, runs, GAP) or _unlike(discs, [part for run in runs for part in _parts(run)], GAP_OF_ONE)


def _unlike(discs: Sequence[str], runs: Sequence[CalibrationRun], least: float) -> MixedUnits | None:
    """Return the weights of runs that are `least` times heavier or lighter than all others, where two units explain it."""
    size = np.array([_sizes(run, len(discs)) for run in runs])
    found = np.sort(size[size > 0.0])
    if found.size < 2:
        return None
    gap = int(np.argmax(found[1:] / found[:-1]))
    if found[gap + 1] < least * found[gap]:
        return None
    heavier = size >= found[gap + 1]
    lighter = (size > 0.0) & ~heavier
    ratio = float(np.median(found[gap + 1 :]) / np.median(found[: gap + 1]))
    sides = [(heavier, lighter, ratio)]
    if np.count_nonzero(lighter) < np.count_nonzero(heavier):
        sides.insert(0, (lighter, heavier, 1.0 / ratio))
    for doubted, others, unlike in sides:
        units = _pairs(unlike, _units_of(runs, doubted), _units_of(runs, others))
        if units:
            return MixedUnits(tuple(runs), doubted, _words(discs, runs, size, doubted), unlike, units)
    return None


def _parts(run: CalibrationRun) -> list[CalibrationRun]:
    """Return the parts of a table of dwells with one mounting and one set of weights each; another run is one part."""
    added = run.measurement.added
    if not run.steady or added is None:
        return [run]
    keys = [(mounting, row.tobytes()) for mounting, row in zip(run.mounting, added, strict=True)]
    if len(set(keys)) == 1:
        return [run]
    parts = []
    for key in dict.fromkeys(keys):
        which = np.array([one == key for one in keys])
        mounting = (key[0],) * int(np.count_nonzero(which))
        parts.append(replace(run, name=f"{key[0]} in {run.name}", measurement=run.measurement.pick(which), mounting=mounting))
    return parts


def explaining_units(
    discs: Sequence[str], runs: Sequence[CalibrationRun], accepted: Callable[[Sequence[CalibrationRun]], bool]
) -> str:
    """Find the mixed units without which runs that no model explains are explained.

    Args:
        discs: Ids of the P discs.
        runs: The runs.
        accepted: Function that calibrates with some runs and returns whether that is accepted.

    Returns:
        The units in words; empty where none explains the runs.
    """
    mixed = mixed_units(discs, runs)
    if mixed is None:
        return ""
    for given, meant in mixed.units:
        if accepted(mixed.undone(given, meant)):
            return f"it fits with {mixed.words}, which were given in {given}, in {meant}"
    return ""


def _sizes(run: CalibrationRun, discs: int) -> list[float]:
    """Return the median size of a run's weights on each disc (P,) [kg m]; 0 where it has none."""
    if run.measurement.added is None:
        return [0.0] * discs
    return [float(np.median(column[column > 0.0])) if column.any() else 0.0 for column in np.abs(run.measurement.added).T]


def _units_of(runs: Sequence[CalibrationRun], which: NDArray[np.bool_]) -> set[str]:
    """Return the units in which some weights (R, P) were given, as far as that is known."""
    return {
        unit for run, row in zip(runs, which, strict=True) for unit, one in zip(run.units, row, strict=False) if one and unit
    }


def _pairs(ratio: float, doubted: set[str], others: set[str]) -> tuple[tuple[str, str], ...]:
    """Return likely pairs of a unit that was given and one that was meant: first those that the weights were given in."""
    away = {
        (given, meant): abs(math.log(ratio * KILOGRAM_METRES[meant] / KILOGRAM_METRES[given]))
        for given, meant in itertools.permutations(KILOGRAM_METRES, 2)
        if not doubted or given in doubted
    }
    near = [pair for pair in away if away[pair] <= math.log(NEAR)]
    return tuple(sorted(near, key=lambda pair: (pair[1] not in others, away[pair])))[:MOST]


def _words(discs: Sequence[str], runs: Sequence[CalibrationRun], size: NDArray[np.float64], doubted: NDArray[np.bool_]) -> str:
    """Return which weights are doubted: those of whole runs, on whole discs, or one by one."""
    loaded = size > 0.0
    whole = [run.name for run, row, all_of in zip(runs, doubted, loaded, strict=True) if row.any() and (row == all_of).all()]
    if len(whole) == int(np.count_nonzero(doubted.any(axis=1))):
        return f"the weights of {', '.join(whole)}"
    columns = [
        disc for disc, row, all_of in zip(discs, doubted.T, loaded.T, strict=True) if row.any() and (row == all_of).all()
    ]
    if len(columns) == int(np.count_nonzero(doubted.any(axis=0))):
        return f"the weights on {', '.join(columns)}"
    named = [f"{runs[run].name} on {discs[disc]}" for run, disc in np.argwhere(doubted)]
    return f"the weights of {', '.join(named)}"
