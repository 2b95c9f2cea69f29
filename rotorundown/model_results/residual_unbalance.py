"""Residual unbalance of a model's rotors against the grades of ISO 21940-11 and API 617."""

from dataclasses import dataclass

import msgspec
import numpy as np

from estimator.arrays import Floats
from estimator.balancing.balance_quality import GRAM_MILLIMETRE, PlaneBalance, RotorBalance, balance_grades
from estimator.errors import Invalid
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.vector_angle import angle_deg
from rotorundown.model_results.origin import origin_notes, require_unbalance
from rotorundown.model_results.result_tables import Cells, RowTable, figure
from rotorundown.model_results.vibration import whole_degrees


class WrongGrade(Invalid):
    """Raised for what is no balance quality grade."""


class ResidualRow(msgspec.Struct, frozen=True):
    """Residual unbalance in a bearing's plane, judged at a speed.

    Attributes:
        speed_rpm: Service speed and maximum continuous speed [r/min].
        shaft: Id of the shaft.
        bearing: Id of the bearing.
        g_mm: Residual unbalance [g mm].
        lower_g_mm: Lower end of its 95 % band [g mm].
        upper_g_mm: Upper end of its 95 % band [g mm].
        angle_deg: Its angle from the keyphasor mark, from +x to +y [°].
        grade: Balance quality grade G that the plane reaches [mm/s].
        iso_21940_11: Verdict by ISO 21940-11: `met`, `not met`, or `open` where the band says neither.
        iso_permissible_g_mm: Permissible unbalance by ISO 21940-11 [g mm].
        api_617: Verdict by API 617, 4W/N.
        api_permissible_g_mm: Permissible unbalance by API 617 [g mm].
    """

    speed_rpm: float
    shaft: str
    bearing: str
    g_mm: float
    lower_g_mm: float
    upper_g_mm: float
    angle_deg: float
    grade: float
    iso_21940_11: str
    iso_permissible_g_mm: float
    api_617: str
    api_permissible_g_mm: float


@dataclass(frozen=True, eq=False, repr=False)
class BalanceGrades(RowTable[ResidualRow]):
    """Residual unbalances in the planes of each rotor's outer bearings, at one speed or several.

    Attributes:
        title: Title of the table.
        rows: The planes.
        si: The estimator's own balance of each rotor for each speed, in SI units.
        notes: Notes on where they come from.
    """

    title: str
    rows: tuple[ResidualRow, ...]
    si: tuple[tuple[RotorBalance, ...], ...]
    notes: tuple[str, ...] = ()
    kind = ResidualRow

    def _cells(self) -> Cells:
        return {
            "r/min": [f"{one.speed_rpm:.0f}" for one in self.rows],
            "shaft": [one.shaft for one in self.rows],
            "bearing": [one.bearing for one in self.rows],
            "g mm": [figure(one.g_mm) for one in self.rows],
            "95 % from": [figure(one.lower_g_mm) for one in self.rows],
            "to": [figure(one.upper_g_mm) for one in self.rows],
            "at °": [whole_degrees(one.angle_deg) for one in self.rows],
            "G": [figure(one.grade) for one in self.rows],
            "ISO 21940-11": [f"{one.iso_21940_11} ({figure(one.iso_permissible_g_mm)})" for one in self.rows],
            "API 617": [f"{one.api_617} ({figure(one.api_permissible_g_mm)})" for one in self.rows],
        }


def balance_grades_of(model: UpdatedModel, speed_rpm: Floats, *, grade: float) -> BalanceGrades:
    """Return the residual unbalances of a model's rotors, judged at speeds (S,) [r/min]. grade: G asked for [mm/s].

    Raises WrongGrade, UnbalanceUnknown.
    """
    if isinstance(grade, bool | str) or not isinstance(grade, int | float | np.number) or not 0.0 < float(grade) < np.inf:
        raise WrongGrade(f"grade is a balance quality grade G above 0 [mm/s], such as 2.5, not {grade!r:.40}")
    require_unbalance(model)
    speeds = [rpm_to_rad_per_s(float(one)) for one in speed_rpm]
    found = tuple(balance_grades(model, grade=float(grade), service_speed=one, maximum_continuous_speed=one) for one in speeds)
    rows = [
        _row(float(rpm), rotor.shaft, plane)
        for rpm, rotors in zip(speed_rpm, found, strict=True)
        for rotor in rotors
        for plane in rotor.planes
    ]
    title = f"{model.machine.id}: residual unbalance in bearing planes, asked for G {float(grade):g} (permissible g mm)"
    return BalanceGrades(title, tuple(rows), found, origin_notes(model))


def _row(rpm: float, shaft: str, plane: PlaneBalance) -> ResidualRow:
    return ResidualRow(
        speed_rpm=rpm,
        shaft=shaft,
        bearing=plane.bearing,
        g_mm=abs(plane.unbalance) / GRAM_MILLIMETRE,
        lower_g_mm=plane.lower / GRAM_MILLIMETRE,
        upper_g_mm=plane.upper / GRAM_MILLIMETRE,
        angle_deg=float(angle_deg(np.array([plane.unbalance]))[0]),
        grade=plane.grade,
        iso_21940_11=plane.iso,
        iso_permissible_g_mm=plane.iso_permissible / GRAM_MILLIMETRE,
        api_617=plane.api,
        api_permissible_g_mm=plane.api_permissible / GRAM_MILLIMETRE,
    )
