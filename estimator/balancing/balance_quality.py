"""Residual unbalances against ISO 21940-11 grades and API 617's 4W/N, rotor by rotor, in the planes of its outer bearings.

ISO 21940-11:2016: G = e ω, U_per = 1000 G m / ω [g mm, with G in mm/s, m in kg], divided between the bearing planes by the
lever rule, no plane below 0.3 of it and none above 0.7 (1.3 where the centre of mass lies outside the bearings). API 617:
U = 4 W/N [oz in, W the static load of a journal in lb] = 6350 W/N [g mm, W in kg], N [r/min] the maximum continuous speed.
The standards themselves were not at hand; these are the formulas as commonly quoted.

Both are of rigid rotors: identified disc unbalances are carried to the bearing planes by the lever rule. A rotor that runs
above its first bending mode may pass and still shake; see `model_balancing`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.machine.parts import Bearing
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.shaft_element import PLANE_DOFS
from estimator.units import rad_per_s_to_rpm
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand, phasor_band

STANDARD_GRADES = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)
"""Balance quality grades of ISO 21940-11 [mm/s]."""
GRAM_MILLIMETRE = 1e-6
"""One gram millimetre [kg m]."""
API_617 = 6350.0
"""4 oz in per lb, in g mm per kg: 4 × 28.3495 g × 25.4 mm × 2.20462, rounded as the standard does."""
LEAST_SHARE, LARGEST_SHARE, LARGEST_SHARE_OVERHUNG = 0.3, 0.7, 1.3
"""Bounds on the part of U_per in one plane [-]: least, largest, and largest where the centre of mass lies outside the
bearings.
"""

PlaneVerdict = Literal["met", "not met", "open", "not known"]
"""Verdict on a plane; 'open' where what was measured is not sure enough to tell, 'not known' where it cannot tell at all."""
PlaneUnbalances = Callable[[str, tuple[Bearing, Bearing]], PhasorBand]
"""Function that returns the unbalances (2,) of a shaft in the planes of two bearings [kg m]."""


@dataclass(frozen=True)
class PlaneBalance:
    """Residual unbalance in one bearing plane.

    Attributes:
        bearing: Id of the bearing.
        unbalance: Residual unbalance, complex [kg m].
        lower: Lower end of the 95 % band of its magnitude [kg m].
        upper: Upper end of the 95 % band of its magnitude [kg m].
        load: Mass that the journal carries at rest [kg].
        iso_permissible: Permissible unbalance by ISO 21940-11 [kg m].
        api_permissible: Permissible unbalance by API 617 [kg m].
        grade: Balance quality grade G that the plane reaches [mm/s].
        untold: Why nothing is known of the plane, in words; empty where something is.
        is_whole: False where unbalances of other rotors count in it, so that it is never sure to be met.
    """

    bearing: str
    unbalance: complex
    lower: float
    upper: float
    load: float
    iso_permissible: float
    api_permissible: float
    grade: float
    untold: str = ""
    is_whole: bool = True

    @property
    def iso(self) -> PlaneVerdict:
        """Judge the plane by ISO 21940-11."""
        return _verdict(self, self.iso_permissible)

    @property
    def api(self) -> PlaneVerdict:
        """Judge the plane by API 617, 4W/N."""
        return _verdict(self, self.api_permissible)


@dataclass(frozen=True)
class RotorBalance:
    """Balance of one rotor: a shaft with its discs.

    Attributes:
        shaft: Id of the shaft.
        mass: Mass of the rotor [kg].
        centre: Station of its centre of mass [m].
        planes: Both bearing planes, the driver side's first.
    """

    shaft: str
    mass: float
    centre: float
    planes: tuple[PlaneBalance, PlaneBalance]

    @property
    def grade(self) -> float:
        """Return the grade G of the worse plane [mm/s]."""
        return max(plane.grade for plane in self.planes)

    @property
    def standard_grade(self) -> float | None:
        """Return the finest grade of the standard that both planes meet [mm/s]; None where they meet none."""
        return next((one for one in STANDARD_GRADES if self.grade <= one), None)


def balance_grades(
    model: UpdatedModel, *, grade: float, service_speed: float, maximum_continuous_speed: float
) -> tuple[RotorBalance, ...]:
    """Judge the residual unbalance of each rotor in the planes of its outer two bearings (ISO 21940-11:2016, API 617).

    A shaft on fewer than two bearings cannot be judged by itself and is left out.

    Args:
        model: The identified model.
        grade: Balance quality grade G asked for [mm/s].
        service_speed: Highest service speed, for ISO 21940-11 [rad/s].
        maximum_continuous_speed: Maximum continuous speed, for API 617 [rad/s].

    Returns:
        One balance per rotor with two bearings or more, in the document's order.

    Raises:
        ValueError: The grade or a speed is not positive.
    """
    required = _required(grade, service_speed, maximum_continuous_speed)
    return _balances(model.machine, partial(_identified_unbalances, model), required)


def balance_of_unbalances(
    machine: Machine,
    *,
    unbalance: Complexes,
    covariance: Floats,
    grade: float,
    service_speed: float,
    maximum_continuous_speed: float,
) -> tuple[RotorBalance, ...]:
    """Judge given unbalances of the discs as `balance_grades` does those of a model (ISO 21940-11:2016, API 617).

    Args:
        machine: The machine.
        unbalance: Unbalances of its discs (P,) [kg m].
        covariance: Covariance (2 P, 2 P) of their real and imaginary parts, disc by disc [kg² m²].
        grade: Balance quality grade G asked for [mm/s].
        service_speed: Highest service speed [rad/s].
        maximum_continuous_speed: Maximum continuous speed [rad/s].

    Returns:
        One balance per rotor with two bearings or more, in the document's order.

    Raises:
        ValueError: The grade or a speed is not positive.
    """

    def band(shaft: str, ends: tuple[Bearing, Bearing]) -> PhasorBand:
        transfer = _transfer(machine, shaft, ends)
        slope = np.stack([transfer, 1j * transfer], axis=-1).reshape(len(transfer), -1)
        return phasor_band(transfer @ unbalance, slope, covariance)

    return _balances(machine, band, _required(grade, service_speed, maximum_continuous_speed))


@dataclass(frozen=True)
class _Required:
    """Grade asked for [mm/s] and the speeds at which it counts [rad/s]."""

    grade: float
    service_speed: float
    maximum_continuous_speed: float


def _required(grade: float, service_speed: float, maximum_continuous_speed: float) -> _Required:
    if not min(grade, service_speed, maximum_continuous_speed) > 0:
        raise ValueError("grade, service_speed and maximum_continuous_speed must be positive")
    return _Required(grade, service_speed, maximum_continuous_speed)


def _balances(machine: Machine, band: PlaneUnbalances, required: _Required) -> tuple[RotorBalance, ...]:
    rotor = assemble_rotor(machine)
    result = []
    for shaft in machine.shafts:
        bearings = sorted((one for one in machine.bearings if one.shaft == shaft.id), key=lambda one: one.station)
        if len(bearings) >= 2 and bearings[-1].station > bearings[0].station:
            ends = (bearings[0], bearings[-1])
            result.append(_rotor_balance(rotor, shaft.id, ends, band(shaft.id, ends), required))
    return tuple(result)


def _rotor_balance(
    rotor: Rotor, shaft: str, ends: tuple[Bearing, Bearing], bands: PhasorBand, required: _Required
) -> RotorBalance:
    mass, centre = mass_and_centre(rotor, shaft)
    levers = _levers(centre, ends)
    planes = []
    for number, bearing in enumerate(ends):
        # U_per of the plane is share · m · G/ω; with G in mm/s this is in kg m after a factor of 1e-3.
        of_one_grade = 1e-3 * _share(levers, number) * mass / required.service_speed
        load = mass * abs(levers[number])
        planes.append(
            PlaneBalance(
                bearing=bearing.id,
                unbalance=complex(bands.value[number]),
                lower=float(bands.lower[number]),
                upper=float(bands.upper[number]),
                load=load,
                iso_permissible=required.grade * of_one_grade,
                api_permissible=GRAM_MILLIMETRE * API_617 * load / rad_per_s_to_rpm(required.maximum_continuous_speed),
                grade=float(bands.amplitude[number]) / of_one_grade,
            )
        )
    return RotorBalance(shaft=shaft, mass=mass, centre=centre, planes=(planes[0], planes[1]))


def mass_and_centre(rotor: Rotor, shaft: str) -> tuple[float, float]:
    """Compute the mass of a shaft with its discs and its centre of mass, from rigid motions along x.

    Args:
        rotor: The assembled rotor.
        shaft: Id of the shaft.

    Returns:
        Mass [kg] and station of the centre of mass [m].
    """
    stations = rotor.stations[shaft]
    first, size = PLANE_DOFS * rotor.first_node[shaft], PLANE_DOFS * stations.size
    own = slice(first, first + size)
    along, about = np.zeros(size), np.zeros(size)
    along[0::PLANE_DOFS] = 1.0
    # Turning about the driver-side end: x = z θy.
    about[0::PLANE_DOFS] = stations
    about[1::PLANE_DOFS] = 1.0
    pull = along @ (rotor.discs.mass[own, own] + sum(part.mass[own, own] for part in rotor.materials.values()))
    mass = float(pull @ along)
    return mass, float(pull @ about) / mass


def _levers(station: float, ends: tuple[Bearing, Bearing]) -> tuple[float, float]:
    """Compute the parts of a load at a station that each of two planes carries."""
    second = (station - ends[0].station) / (ends[1].station - ends[0].station)
    return 1.0 - second, second


def _share(levers: tuple[float, float], number: int) -> float:
    largest = LARGEST_SHARE if min(levers) >= 0.0 else LARGEST_SHARE_OVERHUNG
    return min(max(levers[number], LEAST_SHARE), largest)


def _transfer(machine: Machine, shaft: str, ends: tuple[Bearing, Bearing]) -> Floats:
    """Compute the parts (2, P) of each disc's unbalance that act in the planes of two bearings of a rigid rotor."""
    return np.array([_levers(disc.station, ends) if disc.shaft == shaft else (0.0, 0.0) for disc in machine.discs]).T


def _identified_unbalances(model: UpdatedModel, shaft: str, ends: tuple[Bearing, Bearing]) -> PhasorBand:
    """Compute the unbalances (2,) in the planes of two bearings that act on a rigid rotor as those of its discs."""
    transfer = _transfer(model.machine, shaft, ends)
    discs = transfer.shape[1]
    slope = np.zeros((2, model.values.size), dtype=complex)
    places = model.coordinates_at(np.ones(1)).excitation_place[:discs]
    for disc, first in enumerate(places):
        if first >= 0:
            slope[:, first], slope[:, first + 1] = transfer[:, disc], 1j * transfer[:, disc]
    return phasor_band(transfer @ model.excitations[:discs], slope, model.covariance)


def _verdict(plane: PlaneBalance, permissible: float) -> PlaneVerdict:
    if plane.untold:
        return "not known"
    if plane.upper <= permissible:
        return "met" if plane.is_whole else "open"
    return "not met" if plane.lower > permissible else "open"
