"""Unbalance that a machine has gained since its calibration, with the calibration's own uncertainty in its interval.

A later fit finds the whole unbalance T. What it was in the calibration, U, is known together with gains and run-outs: the
later fit's values of these move it by the regression K of U on them, and T - U has the covariance of both, with that of a new
mounting (conditional Gaussian: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, app. A.2).

Where only small trial weights tell the gains, a factor on all of them is uncertain by more than a straight line is good for:
unbalances divided by it make the same vibration. So the calibration is first carried to the later fit's factor, exactly. Of a
factor by which gains may have drifted since, the unbalances take only the part that is the calibration's own error.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.validation.calibration_conflict import SMALLEST_CHANCE
from estimator.machine.calibration import LASTING, Calibration
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe

PARTS = np.array([1.0, 1.0j])
"""Factors (2,) that make a complex number of its real and imaginary part [-]."""


class FittedPoint(Protocol):
    """Fit at its end, just made or read from a store: names of its n coordinates, their values (n,), covariance (n, n)."""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Return the names of the coordinates."""

    @property
    def point(self) -> Floats:
        """Return their values (n,) in SI units [-]."""

    @property
    def covariance(self) -> Floats:
        """Return their covariance (n, n) in SI units [-]."""


class UnbalanceSince(Struct, frozen=True, eq=False):
    """Unbalance of P discs beyond that of the calibration.

    Attributes:
        discs: Ids of the discs.
        value: Complex unbalances (P,) [kg m].
        covariance: Covariance (2P, 2P) of their real and imaginary parts, one disc after the other [kg² m²].
    """

    discs: tuple[str, ...]
    value: Complexes
    covariance: Floats

    def standard_error(self, disc: int) -> float:
        """Return the larger standard error of a disc's two parts.

        Args:
            disc: Index of the disc.

        Returns:
            Standard error [kg m].
        """
        return float(np.sqrt(np.max(np.diag(self.covariance)[2 * disc : 2 * disc + 2])))

    def angle_error_deg(self, disc: int) -> float:
        """Return the half width of the 95 % interval of a disc's angle.

        Args:
            disc: Index of the disc.

        Returns:
            Half width [°]; 180 where the angle is open.
        """
        half, size = CONFIDENCE_95 * self.standard_error(disc), float(abs(self.value[disc]))
        return 180.0 if half >= size else math.degrees(math.asin(half / size))


def unbalance_since(machine: Machine, found: FittedPoint) -> UnbalanceSince | None:
    """Compute the unbalance that a calibrated machine has gained since (Rasmussen and Williams 2006, app. A.2).

    Source: conditional Gaussian, Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, app. A.2.

    Args:
        machine: The machine with its calibration.
        found: A later identification of it.

    Returns:
        The unbalance; None where the document holds no calibration.
    """
    calibration = machine.calibration
    if calibration is None:
        return None
    discs = tuple(disc.id for disc in machine.discs)
    own = [f"disc.{disc}.unbalance.{part}" for disc in discs for part in ("real", "imaginary")]
    if any(name not in found.coordinates or name not in calibration.parameters for name in own):
        return None
    shared = [name for name in calibration.parameters if name in found.coordinates and name not in calibration.unbalances]
    before, after = [calibration.parameters.index(one) for one in own], [found.coordinates.index(one) for one in own]
    there, here = [calibration.parameters.index(one) for one in shared], [found.coordinates.index(one) for one in shared]
    values, carry = _carried(machine, dict(zip(shared, found.point[here].tolist(), strict=True)))
    known = carry @ np.array(calibration.covariance) @ carry.T
    moved = np.diag(calibration.moved_since(machine.operation.healthy_variation))
    if _coefficients_changed(shared, found.point[here] - values[there], (known + moved)[np.ix_(there, there)], found, here):
        lasting = [place for place, name in enumerate(shared) if describe(name).element_kind in LASTING]
        there, here = [there[place] for place in lasting], [here[place] for place in lasting]
    gain = _regression(known, moved, before, there)
    was = values[before] + gain @ (found.point[here] - values[there])
    uncertain = known[np.ix_(before, before)] - gain @ known[np.ix_(there, before)]
    uncertain += gain @ found.covariance[np.ix_(here, here)] @ gain.T
    mixed = found.covariance[np.ix_(after, here)] @ gain.T
    covariance = found.covariance[np.ix_(after, after)] + uncertain - mixed - mixed.T + moved[np.ix_(before, before)]
    parts = found.point[after] - was
    return UnbalanceSince(discs, parts[::2] + 1j * parts[1::2], covariance)


def _coefficients_changed(
    shared: Sequence[str], moved: Floats, before: Floats, found: FittedPoint, here: Sequence[int]
) -> bool:
    """Return whether a later run's coefficients are not those of the calibration: its unbalances do not follow these then.

    moved: by how much its k shared parameters differ (k,); before: their covariance (k, k) with what varies from run to run.
    here: their places in the later fit.
    """
    places = [place for place, name in enumerate(shared) if describe(name).term is not None]
    if not places:
        return False
    square = np.ix_(places, places)
    covariance = before[square] + found.covariance[np.ix_(here, here)][square]
    size = np.sqrt(np.diag(covariance))
    away = moved[places] / size
    chi_square = float(away @ np.linalg.solve(covariance / np.outer(size, size), away))
    return bool(scipy.special.chdtrc(len(places), chi_square) < SMALLEST_CHANCE)


def _carried(machine: Machine, later: Mapping[str, float]) -> tuple[Floats, Floats]:
    """Return a calibration carried to the factor on all gains that a later fit found.

    Returns the values (n,) there, where unbalances are divided by the factor, or by its part that did not come of a drift; and
    the derivative (n, n) of the way there. Where a gain is held, there is no such factor.
    later: values that the later fit found, by name.
    """
    calibration = machine.calibration
    if calibration is None:
        raise ValueError("the document holds no calibration")
    names, values = calibration.parameters, np.array(calibration.values)
    carry = np.eye(values.size)
    chains = [f"probe.{probe.id}.gain" for probe in machine.probes]
    pairs = [(f"{one}.real", f"{one}.imaginary") for one in chains]
    if any(name not in later or name not in names for pair in pairs for name in pair):
        return values, carry
    places = np.array([[names.index(name) for name in pair] for pair in pairs])
    gains = 1.0 + values[places] @ PARTS
    factor = complex(np.mean((1.0 + np.array([[later[name] for name in pair] for pair in pairs]) @ PARTS) / gains))
    unbalances = np.array(
        [[names.index(f"disc.{disc.id}.unbalance.{part}") for part in ("real", "imaginary")] for disc in machine.discs]
    )
    # Against +x to +y an unbalance acts as its conjugate.
    divided = (factor if machine.direction > 0 else factor.conjugate()) ** -_own_part(machine, calibration, places, gains)
    for rows, times, offset in ((places, factor, 1.0), (unbalances, divided, 0.0)):
        for row in rows:
            carried = times * (offset + complex(values[row] @ PARTS)) - offset
            values[row] = carried.real, carried.imag
            carry[np.ix_(row, row)] = [[times.real, -times.imag], [times.imag, times.real]]
    return values, carry


def _own_part(machine: Machine, calibration: Calibration, places: NDArray[np.intp], gains: Complexes) -> float:
    """Return which part of the variance of the factor on all gains (m,) is the calibration's; the rest is their drift [-]."""
    weights = (PARTS / (gains[:, None] * gains.size)).reshape(-1)
    chosen = places.reshape(-1)
    own = float((weights @ np.array(calibration.covariance)[np.ix_(chosen, chosen)] @ weights.conj()).real)
    drift = float(np.abs(weights) ** 2 @ calibration.moved_since(machine.operation.healthy_variation)[chosen])
    return own / (own + drift) if drift else 1.0


def _regression(known: Floats, moved: Floats, before: list[int], there: list[int]) -> Floats:
    """Return the regression (2P, k) of the calibration's unbalances on its other parameters as a later fit believes them."""
    whole = (known + moved)[np.ix_(there, there)]
    size = np.sqrt(np.diag(whole))
    scaled = known[np.ix_(before, there)] / size
    return np.asarray(np.linalg.solve(whole / np.outer(size, size), scaled.T).T / size)
