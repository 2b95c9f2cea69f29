"""Laboratory rig of the thesis's Chapter 5: the numbers printed of it, and misalignment as a growth of its coefficients.

The text gives one number per case, the largest growth, and the impact tests' frequencies; the rest was in figures. Both are
turned into growths of all coefficients here, by assumptions that each function states.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy.optimize

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.eigenmodes import eigenvalues
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import Unknowns, unknowns

SPEEDS_HZ = (17.0, 21.0, 25.0, 29.0, 31.0, 33.0, 37.0, 41.0)
"""Speeds at which the rig was measured [Hz] (§5.4)."""
H1: Complexes = np.array(
    [
        5.57e-5 - 3.57e-6j,
        -4.63e-5 + 3.43e-5j,
        1.17e-5 + 5.29e-5j,
        4.04e-5 + 2.99e-5j,
        4.11e-5 - 4.67e-5j,
        4.77e-5 - 4.57e-5j,
        8.91e-6 + 6.45e-5j,
        -5.82e-5 - 3.77e-5j,
    ]
)
"""Horizontal response of bearing 1 at these speeds [m] (Table 5.3)."""
ALIGNED_HZ = (150.0, 203.0, 364.0)
"""Natural frequencies in the impact test without misalignment, both couplings mounted [Hz] (Table 5.5)."""


@dataclass(frozen=True)
class MisalignmentCase:
    """One misalignment of the rig (thesis Table 5.4).

    Attributes:
        name: Name of the case.
        angle_deg: Angular misalignment Δα [°].
        offset_mm: Parallel misalignment Δδ [mm].
        growth: Growth of c_yx of bearing 4, the largest of all [-] (§5.7).
        frequencies_hz: Natural frequencies in the impact test [Hz] (Table 5.5), where they are printed.
    """

    name: str
    angle_deg: float
    offset_mm: float
    growth: float
    frequencies_hz: tuple[float, float, float] | None = None


CASES = (
    MisalignmentCase("A₁", 0.16, 0.0, 0.12, (153.0, 206.0, 366.0)),
    MisalignmentCase("A₂", 0.32, 0.0, 0.18),
    MisalignmentCase("B₁", 0.0, 0.5, 0.31, (154.0, 207.0, 366.0)),
    MisalignmentCase("B₂", 0.0, 1.0, 0.56),
    MisalignmentCase("C₁", 0.16, 0.5, 0.60, (156.0, 207.0, 366.0)),
    MisalignmentCase("C₂", 0.32, 1.0, 0.68),
)
"""Misalignments of the rig."""


@dataclass(frozen=True)
class BearingGrowth:
    """Relative growth of the coefficients of each shaft's bearings; the coupling grows with the driven shaft's bearings.

    Attributes:
        driver: Growth of the driving shaft's bearings [-].
        driven: Growth of the driven shaft's bearings [-].
        misfit: Relative frequency errors (3,) that are left [-].
    """

    driver: float
    driven: float
    misfit: Floats

    @classmethod
    def to_reach(cls, machine: Machine, change: Floats) -> Self:
        """Fit the growths that change the first three frequencies by given factors, in the least-squares sense.

        Three frequencies cannot tell more apart. Growth between -90 % and +900 %.

        Source: own derivation: least squares on the first three frequencies that the thesis, Chapter 5, prints.

        Args:
            machine: The machine.
            change: Factors (3,) on the frequencies [-].

        Returns:
            The growths.
        """
        nominal, _ = nominal_values(machine)
        aligned = plane_frequencies(machine, coefficients=nominal)

        def misfit(logarithms: Floats) -> Floats:
            driver, driven = np.exp(logarithms)
            factors = shaft_factors(machine, driver=float(driver), driven=float(driven))
            return np.asarray(plane_frequencies(machine, coefficients=nominal * factors) / aligned / change - 1.0)

        found = scipy.optimize.least_squares(misfit, np.zeros(2), bounds=(-np.log(10.0), np.log(10.0)))
        driver, driven = np.expm1(found.x)
        return cls(float(driver), float(driven), misfit(found.x))


def printed_growth(case: MisalignmentCase, unknowns: Unknowns) -> Floats:
    """Return the growth of a case (thesis §5.7): c_yx of bearing 4 as printed, all others half of it, which is assumed.

    Args:
        case: The case.
        unknowns: The unknowns.

    Returns:
        Factor on each coefficient (K,) [-].
    """
    largest = "bearing.B4.cyx"
    return np.array([1.0 + case.growth * (1.0 if one.name == largest else 0.5) for one in unknowns.coefficients])


def shaft_factors(machine: Machine, *, driver: float, driven: float) -> Floats:
    """Return one factor for the bearings of the first shaft, and one for those of the second and the coupling.

    The rig was misaligned by lifting the second shaft's bearings, so the coupling is taken to follow them.

    Args:
        machine: The machine.
        driver: Factor of the first shaft's bearings [-].
        driven: Factor of the second shaft's bearings and the coupling [-].

    Returns:
        Factor on each coefficient (K,) [-].
    """
    shaft = {f"bearing.{bearing.id}": bearing.shaft for bearing in machine.bearings}
    by_shaft = {machine.shafts[0].id: driver, machine.shafts[1].id: driven}
    elements = [one.element for one in _unknowns(machine).coefficients]
    return np.array([by_shaft[shaft[element]] if element in shaft else driven for element in elements])


def nominal_values(machine: Machine) -> tuple[Floats, Complexes]:
    """Return the nominal values of a document that gives them all.

    Args:
        machine: The machine.

    Returns:
        Coefficients (K,) [SI] and unbalances (P,) [kg m].

    Raises:
        ValueError: The document lacks a value.
    """
    unknown = _unknowns(machine)
    missing = [one.name for one in unknown.coefficients if one.nominal is None]
    missing += [plane.name for plane in unknown.unbalances if plane.nominal is None]
    if missing:
        raise ValueError(f"the document of '{machine.id}' gives no value of {', '.join(missing)}")
    return (
        np.array([one.nominal for one in unknown.coefficients], dtype=float),
        np.array([one.nominal for one in unknown.unbalances], dtype=complex),
    )


def plane_frequencies(machine: Machine, *, coefficients: Floats, count: int = 3) -> Floats:
    """Compute the first natural frequencies at standstill, each the mean of its two planes.

    They are |λ|/2π, undamped frequencies: a damped one is what a run through resonance shows, and differs little.

    Args:
        machine: The machine.
        coefficients: Coefficients (K,) [SI].
        count: Number of frequencies.

    Returns:
        Frequencies (count,) [Hz].
    """
    roots = eigenvalues(machine, coefficients=coefficients)[: 2 * count]
    return np.asarray(np.abs(roots).reshape(count, 2).mean(axis=1) / (2.0 * np.pi))


def _unknowns(machine: Machine) -> Unknowns:
    return unknowns(machine, assemble_rotor(machine))
