"""Unbalances to add that leave least vibration, by a model."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from estimator.arrays import Floats
from estimator.balancing.balance_quality import GRAM_MILLIMETRE
from estimator.balancing.model_balancing import Correction, balance
from estimator.close_matches import did_you_mean
from estimator.errors import Invalid
from estimator.units import RAD_PER_S
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.vector_angle import angle_deg
from rotorundown.model_results.origin import origin_notes, require_unbalance
from rotorundown.model_results.result_tables import Cells, RowTable, figure
from rotorundown.model_results.vibration import PredictedVibration, whole_degrees


class WrongPlane(Invalid):
    """Raised for planes that cannot be corrected in; the message says which there are."""


class CorrectionRow(msgspec.Struct, frozen=True):
    """An unbalance to add.

    Attributes:
        disc: Id of the disc.
        g_mm: Unbalance to add [g mm].
        angle_deg: Its angle from the keyphasor mark, from +x to +y [°].
    """

    disc: str
    g_mm: float
    angle_deg: float


@dataclass(frozen=True, eq=False, repr=False)
class BalanceCorrection(RowTable[CorrectionRow]):
    """Unbalances to add to discs, and the vibration before and after.

    Attributes:
        title: Title of the table.
        rows: The unbalances.
        before: PredictedVibration before the correction.
        after: PredictedVibration predicted with it.
        si: The estimator's own correction, in SI units, with the condition number of the influence coefficients.
        notes: Notes on it.
    """

    title: str
    rows: tuple[CorrectionRow, ...]
    before: PredictedVibration
    after: PredictedVibration
    si: Correction
    notes: tuple[str, ...] = ()
    kind = CorrectionRow

    def _cells(self) -> Cells:
        return {
            "disc": [one.disc for one in self.rows],
            "g mm to add": [figure(one.g_mm) for one in self.rows],
            "at °": [whole_degrees(one.angle_deg) for one in self.rows],
        }


def balance_correction(model: UpdatedModel, speed_rpm: Floats, *, planes: Any) -> BalanceCorrection:
    """Return the correction that leaves least vibration at speeds (S,) [r/min]. planes: discs; None for all.

    Raises WrongPlane, UnbalanceUnknown.
    """
    discs = _discs(model, planes)
    require_unbalance(model)
    found = balance(model, planes=discs, speed=speed_rpm * RAD_PER_S["rpm"])
    rows = [
        CorrectionRow(disc, float(abs(value)) / GRAM_MILLIMETRE, float(angle))
        for disc, value, angle in zip(found.planes, found.unbalance, angle_deg(found.unbalance), strict=True)
    ]
    origin, machine = origin_notes(model), model.machine.id
    before, after = (
        PredictedVibration(
            f"{machine}: 1× {when} the correction [µm peak-to-peak, phase lag]", found.channels, speed_rpm, band, origin
        )
        for when, band in (("before", found.before), ("after", found.after))
    )
    notes = (
        f"largest 1× at its probes {figure(float(np.max(before.amplitude_um_pp)))} µm pp, "
        f"afterwards {figure(float(np.max(after.amplitude_um_pp)))}, at most {figure(float(np.max(after.upper_um_pp)))} "
        "(before, after: over speed)",
        f"condition number of the influence coefficients {figure(found.condition_number)}",
    )
    title = f"{machine}: unbalance to add for least vibration at {_speed_words(speed_rpm)} (angles: mark, +x to +y)"
    return BalanceCorrection(title, tuple(rows), before, after, found, (*origin, *notes))


def _speed_words(speed_rpm: Floats) -> str:
    several = speed_rpm.size > 1
    return f"{speed_rpm.min():.0f} to {speed_rpm.max():.0f} r/min" if several else f"{speed_rpm[0]:.0f} r/min"


def _discs(model: UpdatedModel, planes: Any) -> list[str]:
    """Return the discs that are named, all where none is. Raises WrongPlane."""
    known = [disc.id for disc in model.machine.discs]
    if planes is None:
        return known
    there_are = f"there are {', '.join(known)}"
    if not isinstance(planes, Iterable):
        raise WrongPlane(f"planes are ids of discs, not {planes!r:.40}; {there_are}")
    wanted = [planes] if isinstance(planes, str) else list(planes)
    if not wanted:
        raise WrongPlane(f"no plane is named; {there_are}")
    for place, one in enumerate(wanted):
        if one not in known:
            raise WrongPlane(f"'{one}' is no disc of '{model.machine.id}'; {there_are}{did_you_mean(str(one), known)}")
        if one in wanted[:place]:
            raise WrongPlane(f"plane '{one}' is named twice")
    return wanted
