"""A correction, its effect and its check in the units that people use: g mm, °, µm peak-to-peak."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.balancing.balance_quality import GRAM_MILLIMETRE
from estimator.balancing.balancing_check import BalancingCheck, LimitVerdict, limit_verdict
from estimator.balancing.field_balancing import FieldBalancing
from estimator.balancing.measured_influence import circular_band
from estimator.balancing.weight_places import SplitWeight
from estimator.units import METRES, PEAK
from estimator.updated_model.uncertainty import PhasorBand
from estimator.updated_model.vector_angle import angle_deg, angle_half_width_deg

MICROMETRES = METRES["um"] * PEAK["peak-to-peak"]
OTHER_WEIGHTS = 0.1
"""Part of a correction by which the weights that were on may miss it and still pass for it [-]."""


@dataclass(frozen=True)
class WeightToAdd:
    """An unbalance to add to what is on in a plane [g mm, °], with its 95 % interval."""

    plane: str
    g_mm: float
    lower_g_mm: float
    upper_g_mm: float
    angle_deg: float
    half_width_deg: float


@dataclass(frozen=True)
class PlaneWeight(WeightToAdd):
    """A weight of a correction, and the masses (place in °, g) that give it."""

    masses: tuple[tuple[float, float], ...]
    missed: float | None
    """Part of the best unbalance that the places miss [-]."""


@dataclass(frozen=True)
class ChannelEffect:
    """Largest vibration of a channel over the speeds [µm pp]: as it was, predicted with bound, and in the check run.

    check_upper: bound of the prediction for the weights that were on in the check run.
    """

    channel: str
    before: float
    after: float
    upper: float
    check: float | None
    check_upper: float | None
    held: bool | None


def plane_weights(found: FieldBalancing) -> list[PlaneWeight]:
    """Return a row for each plane of a correction."""
    correction = found.correction
    variance = np.real(np.diag(correction.covariance))
    band = circular_band(found.unbalance, variance, widening=correction.influence.widening)
    half = angle_half_width_deg(found.unbalance, band.upper)
    return [
        PlaneWeight(
            plane=plane,
            g_mm=float(abs(found.unbalance[row])) / GRAM_MILLIMETRE,
            lower_g_mm=float(band.lower[row]) / GRAM_MILLIMETRE,
            upper_g_mm=_within_limit(found, plane, float(band.upper[row])) / GRAM_MILLIMETRE,
            angle_deg=float(angle_deg(found.unbalance)[row]),
            half_width_deg=float(half[row]),
            masses=_masses(found, plane),
            missed=found.splits[plane].shortfall if plane in found.splits else None,
        )
        for row, plane in enumerate(found.separation.planes)
    ]


def _within_limit(found: FieldBalancing, plane: str, upper: float) -> float:
    """Return the upper end of a correction's interval [kg m], no higher than the plane's limit or what is put on."""
    put_on = float(abs(found.unbalance[found.separation.planes.index(plane)]))
    return max(put_on, min(upper, found.options.limit.get(plane, np.inf)))


def effect_rows(found: FieldBalancing, check: BalancingCheck | None = None) -> list[ChannelEffect]:
    """Return a row for each channel that the runs show."""
    rows = []
    for channel in found.machine.channels:
        own = [at for at, point in enumerate(found.runs.points) if point.startswith(f"{channel} at ")]
        if own:
            measured = None if check is None or np.all(np.isnan(check.vector[own])) else check
            rows.append(
                ChannelEffect(
                    channel=channel,
                    before=_largest(found.correction.before, own),
                    after=_largest(found.correction.after, own),
                    upper=float(np.max(found.correction.after.upper[own])) / MICROMETRES,
                    check=None if measured is None else float(np.nanmax(np.abs(measured.vector[own]))) / MICROMETRES,
                    check_upper=None if measured is None else _promised(measured, own),
                    held=None if measured is None else meets_prediction(measured, own),
                )
            )
    return rows


def _promised(check: BalancingCheck, points: list[int]) -> float | None:
    """Return the bound for the weights that were on [µm pp]; None where nothing is predicted for them."""
    return None if check.predicted is None else float(np.max(check.predicted.upper[points])) / MICROMETRES


def meets_prediction(check: BalancingCheck, points: list[int]) -> bool | None:
    """Return whether the largest vibration at some points is below what was promised for the weights that were on.

    None where nothing is predicted for them.
    """
    if check.predicted is None:
        return None
    return bool(np.nanmax(np.abs(check.vector[points])) <= np.max(check.predicted.upper[points]))


def has_other_weights(found: FieldBalancing, check: BalancingCheck) -> bool:
    """Return whether a check run had other weights on than the correction's."""
    if check.beside:
        return True
    missing = np.linalg.norm(check.installed - found.unbalance)
    return bool(missing > OTHER_WEIGHTS * np.linalg.norm(found.unbalance))


def limit_verdicts(found: FieldBalancing) -> tuple[float, LimitVerdict] | None:
    """Return the document's vibration limit [µm pp] and whether the prediction keeps it; None where there is no limit."""
    limit = found.machine.operation.vibration_limit
    return None if limit is None else (limit / MICROMETRES, limit_verdict(found.correction.after, limit))


def trim_weights(found: FieldBalancing, check: BalancingCheck) -> Iterator[WeightToAdd]:
    """Yield what to add after a check run; nothing where that cannot be told from noise."""
    if check.is_trim_noise:
        return
    angles: Floats = angle_deg(check.trim)
    half = angle_half_width_deg(check.trim, check.trim_band.upper)
    for row, plane in enumerate(found.separation.planes):
        yield WeightToAdd(
            plane=plane,
            g_mm=float(abs(check.trim[row])) / GRAM_MILLIMETRE,
            lower_g_mm=float(check.trim_band.lower[row]) / GRAM_MILLIMETRE,
            upper_g_mm=float(check.trim_band.upper[row]) / GRAM_MILLIMETRE,
            angle_deg=float(angles[row]),
            half_width_deg=float(half[row]),
        )


def _largest(band: PhasorBand, rows: list[int]) -> float:
    return float(np.max(band.amplitude[rows])) / MICROMETRES


def _masses(found: FieldBalancing, plane: str) -> tuple[tuple[float, float], ...]:
    split: SplitWeight | None = found.splits.get(plane)
    if split is None:
        return ()
    angles = found.options.places[plane].angles_deg
    largest = float(np.max(split.masses, initial=0.0))
    return tuple(
        (float(angle) % 360.0, 1e3 * float(mass))
        for angle, mass in zip(angles, split.masses, strict=True)
        if mass > 1e-6 * largest
    )
