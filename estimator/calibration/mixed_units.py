"""Trial weights of which some are stated in another unit than was meant: g in beside g mm, as where two people write.

Weights of one job are alike in size. Where some are tens of times heavier than all others, two units may be mixed: the
heavier ones are taken in the lighter unit and the runs calibrated again. That the lighter ones are wrong instead is the same
but for a factor on all gains. Derived here.
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
"""Ratio between neighbouring sizes of weights from which on the heavier ones are doubted [-]."""
NEAR = 1.7
"""Factor within which the ratio of two units explains that of the sizes [-]."""
MOST = 3
"""Most pairs of units that are tried."""


class MixedUnits(Struct, frozen=True, eq=False):
    """Weights that are far heavier than all others.

    Attributes:
        heavier: Whether the weights of each run on each disc are among them (R, P).
        words: Which they are, in words.
        ratio: Their size over that of the others [-].
        units: Likely pairs of the unit that they were given in and the one that was meant, the likeliest first.
    """

    heavier: NDArray[np.bool_]
    words: str
    ratio: float
    units: tuple[tuple[str, str], ...]

    @property
    def remark(self) -> str:
        """Return the doubt as a sentence."""
        pairs = ", ".join(f"{meant} given as {given}" for given, meant in self.units)
        return f"{self.words} are {self.ratio:.2g} times as heavy as the others: are units mixed (such as {pairs})?"

    def undone(self, runs: Sequence[CalibrationRun], given: str, meant: str) -> list[CalibrationRun]:
        """Return the runs with the heavier weights in another unit.

        Args:
            runs: The R runs.
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
            for run, row in zip(runs, self.heavier, strict=True)
        ]


def mixed_units(discs: Sequence[str], runs: Sequence[CalibrationRun]) -> MixedUnits | None:
    """Find weights that are so much heavier than all others that two units explain it.

    Args:
        discs: Ids of the P discs.
        runs: The R runs, with their weights.

    Returns:
        Those weights; None where all are alike.
    """
    size = np.array([_sizes(run, len(discs)) for run in runs])
    found = np.sort(size[size > 0.0])
    if found.size < 2:
        return None
    gap = int(np.argmax(found[1:] / found[:-1]))
    if found[gap + 1] < GAP * found[gap]:
        return None
    heavier = size >= found[gap + 1]
    ratio = float(np.median(found[gap + 1 :]) / np.median(found[: gap + 1]))
    units = _pairs(ratio, _units_of(runs, heavier), _units_of(runs, (size > 0.0) & ~heavier))
    return MixedUnits(heavier, _words(discs, runs, size, heavier), ratio, units) if units else None


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
        if accepted(mixed.undone(runs, given, meant)):
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


def _pairs(ratio: float, heavier: set[str], lighter: set[str]) -> tuple[tuple[str, str], ...]:
    """Return likely pairs of a unit that was given and one that was meant: first those that the weights were given in."""
    away = {
        (given, meant): abs(math.log(ratio * KILOGRAM_METRES[meant] / KILOGRAM_METRES[given]))
        for given, meant in itertools.permutations(KILOGRAM_METRES, 2)
        if not heavier or given in heavier
    }
    near = [pair for pair in away if away[pair] <= math.log(NEAR)]
    return tuple(sorted(near, key=lambda pair: (pair[1] not in lighter, away[pair])))[:MOST]


def _words(discs: Sequence[str], runs: Sequence[CalibrationRun], size: NDArray[np.float64], heavier: NDArray[np.bool_]) -> str:
    """Return which weights are heavier: those of whole runs, on whole discs, or one by one."""
    loaded = size > 0.0
    whole = [run.name for run, row, all_of in zip(runs, heavier, loaded, strict=True) if row.any() and (row == all_of).all()]
    if len(whole) == int(np.count_nonzero(heavier.any(axis=1))):
        return f"the weights of {', '.join(whole)}"
    columns = [
        disc for disc, row, all_of in zip(discs, heavier.T, loaded.T, strict=True) if row.any() and (row == all_of).all()
    ]
    if len(columns) == int(np.count_nonzero(heavier.any(axis=0))):
        return f"the weights on {', '.join(columns)}"
    named = [f"{runs[run].name} on {discs[disc]}" for run, disc in np.argwhere(heavier)]
    return f"the weights of {', '.join(named)}"
