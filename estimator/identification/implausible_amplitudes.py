"""Unbalances that no rotor has, as a sign that the amplitudes came in another unit than the declared one.

A factor on all amplitudes is a factor on all unbalances: nothing in a run without known weights contradicts it. What speaks
against it is the size: ISO 21940-11:2016 knows grades e ω from G 0.4 to G 4000 mm/s, and the document may state unbalances.
"""

import math

import numpy as np
from msgspec import Struct

from estimator.fit.identification import Identification
from estimator.identification.wrong_conventions import WrongConvention, amplitude_scales
from estimator.machine.document import Machine
from estimator.units import rpm_to_rad_per_s

GRADES = (0.4, 4000.0)
"""Least and largest balance quality grade of ISO 21940-11 [mm/s]."""
STATED_FACTOR = 100.0
"""Factor by which unbalances differ from those that the document states, either way, to be implausible [-]."""
GRADE_FACTOR = 10.0
"""Factor beyond the grades, where the document states none [-]."""
CERTAIN = 3.0
"""Standard errors that an unbalance must have to speak for too large amplitudes [-]."""
NEAREST = 10.0
"""Factor from the plausible within which a unit explains the amplitudes [-]."""


class ImplausibleUnbalance(Struct, frozen=True):
    """Unbalances that are implausible by orders of magnitude.

    Attributes:
        grade: Balance quality grade e ω of all discs together [mm/s].
        ratio: Grade over a plausible one [-].
        against: What it is compared with, in words.
    """

    grade: float
    ratio: float
    against: str

    @property
    def units(self) -> list[WrongConvention]:
        """Return the units of amplitudes that explain it, the nearest first."""

        def distance(one: WrongConvention) -> float:
            return abs(math.log(self.ratio * one.amplitude))

        units = sorted((one for one in amplitude_scales() if one.name == "amplitude-unit"), key=distance)
        return [one for one in units if distance(one) <= math.log(NEAREST)]

    @property
    def words(self) -> str:
        """Return the finding in words."""
        units = [one.words for one in self.units]
        meaning = f"{' or '.join(units)}?" if units else "are the amplitudes' units right?"
        return f"the unbalances would be G {self.grade:.2g}, {self.against}: {meaning}"


def implausible_unbalance(machine: Machine, found: Identification) -> ImplausibleUnbalance | None:
    """Find unbalances that are implausible by orders of magnitude (ISO 21940-11:2016, or the document's own).

    Args:
        machine: The machine.
        found: Its identification, accepted or not.

    Returns:
        What is implausible; None where nothing is.
    """
    grade, error = _grade(machine, found)
    stated = _stated_grade(machine)
    low, high = GRADES[0] / GRADE_FACTOR, GRADES[1] * GRADE_FACTOR
    against = f"ISO 21940-11 knows grades from G {GRADES[0]:g} to G {GRADES[1]:g}"
    if stated > 0.0:
        low, high = stated / STATED_FACTOR, stated * STATED_FACTOR
        against = f"the document states G {stated:.2g}"
    if grade > high and grade > CERTAIN * error:
        return ImplausibleUnbalance(grade, grade / (stated or GRADES[1]), against)
    if grade > 0.0 and grade + CERTAIN * error < low:
        return ImplausibleUnbalance(grade, grade / (stated or GRADES[0]), against)
    return None


def _grade(machine: Machine, found: Identification) -> tuple[float, float]:
    """Return e ω of all discs together, whose unbalances are added without regard to their angles, with its error [mm/s]."""
    point = dict(zip(found.coordinates, found.point, strict=True))
    spread = dict(zip(found.coordinates, np.sqrt(np.diag(found.covariance)), strict=True))
    size = error = 0.0
    for disc in machine.discs:
        parts = [f"disc.{disc.id}.unbalance.{part}" for part in ("real", "imaginary")]
        size += math.hypot(*(point[name] for name in parts))
        error += math.hypot(*(spread[name] for name in parts))
    # Where the stated noise is too large, so are the errors.
    error *= math.sqrt(min(1.0, found.chi_square / found.degrees_of_freedom))
    factor = 1e3 * rpm_to_rad_per_s(machine.speed_range.maximum_rpm) / sum(disc.mass for disc in machine.discs)
    return factor * size, factor * error


def _stated_grade(machine: Machine) -> float:
    """Return the same of the unbalances that the document states [mm/s], 0 where it leaves one out."""
    stated = [disc.unbalance for disc in machine.discs]
    if None in stated:
        return 0.0
    size = sum(one.magnitude for one in stated if one is not None)
    return 1e3 * rpm_to_rad_per_s(machine.speed_range.maximum_rpm) * size / sum(disc.mass for disc in machine.discs)
