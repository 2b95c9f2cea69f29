"""The unknowns of a train: what each is called, where it acts, what is believed of it before any measurement.

A coefficient p adds p·a bᵀ (stiffness) or jω·p·a bᵀ (damping) to the dynamic stiffness, with a and b vectors over the
degrees of freedom: `kxy` of a bearing has a at x and b at y. An unbalance is complex and enters the force.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from estimator.machine import Coupling, LateralCoefficients, Machine, Shaft
from estimator.rotor import Rotor
from estimator.shaft import NODE_DOFS
from estimator.units import rpm_to_rad_per_s

Quantity = Literal["stiffness", "damping", "angular stiffness", "unbalance"]

UNITS: dict[Quantity, str] = {
    "stiffness": "N/m",
    "damping": "N s/m",
    "angular stiffness": "N m/rad",
    "unbalance": "kg m",
}

LATERAL = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
DIRECT = frozenset({"kxx", "kyy", "cxx", "cyy", "k_phix", "k_phiy"})
"""Coefficients that are positive by nature; they are fitted, compared and averaged as logarithms."""
_AXIS = {"x": 0, "y": 1}


@dataclass(frozen=True)
class Coefficient:
    """One real stiffness or damping coefficient.

    left, right: the vectors a and b over all degrees of freedom of the rotor, as {degree of freedom: sign}.
    direct: positive by nature, so its logarithm is fitted. nominal: the document's value, or None.
    scale: the magnitude expected of it, in its own unit, always positive.
    """

    name: str
    element: str
    quantity: Quantity
    left: dict[int, float]
    right: dict[int, float]
    direct: bool
    nominal: float | None
    scale: float

    @property
    def unit(self) -> str:
        """SI unit."""
        return UNITS[self.quantity]

    @property
    def expected(self) -> float:
        """Best guess before any measurement: the nominal value; else the scale, or zero for a cross-coupled term."""
        if self.nominal is not None:
            return self.nominal
        return self.scale if self.direct else 0.0


@dataclass(frozen=True)
class UnbalancePlane:
    """The residual unbalance of one disc: a complex number magnitude·e^{j angle} [kg m]."""

    name: str
    element: str
    node: int
    nominal: complex | None

    unit: str = UNITS["unbalance"]


@dataclass(frozen=True)
class Unknowns:
    """Everything that an identification determines, coefficients first."""

    coefficients: tuple[Coefficient, ...]
    unbalances: tuple[UnbalancePlane, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Parameter names, as the API and the history know them."""
        return tuple([item.name for item in self.coefficients] + [item.name for item in self.unbalances])

    @property
    def real_count(self) -> int:
        """Number of real unknowns: an unbalance counts twice."""
        return len(self.coefficients) + 2 * len(self.unbalances)


def unknowns(machine: Machine, rotor: Rotor) -> Unknowns:
    """All bearing and coupling coefficients and disc unbalances of a machine, in the document's order."""
    coefficients: list[Coefficient] = []
    for bearing in machine.bearings:
        node = rotor.node(bearing.shaft, bearing.station)
        scales = _scales(machine, machine.shaft(bearing.shaft), bearing)
        coefficients += _lateral(f"bearing.{bearing.id}", bearing, {node: 1.0}, scales)
    for coupling in machine.couplings:
        coefficients += _coupling(machine, rotor, coupling)
    planes = tuple(
        UnbalancePlane(
            name=f"disc.{disc.id}.unbalance",
            element=f"disc.{disc.id}",
            node=rotor.node(disc.shaft, disc.station),
            nominal=None
            if disc.unbalance is None
            else disc.unbalance.magnitude * complex(np.exp(1j * math.radians(disc.unbalance.angle_deg))),
        )
        for disc in machine.discs
    )
    return Unknowns(tuple(coefficients), planes)


def _coupling(machine: Machine, rotor: Rotor, coupling: Coupling) -> list[Coefficient]:
    nodes = {rotor.end_node(coupling.driver): 1.0, rotor.first_node[coupling.driven]: -1.0}
    shaft = machine.shaft(coupling.driver)
    scales = _scales(machine, shaft, coupling)
    element = f"coupling.{coupling.id}"
    angular = [
        Coefficient(
            name=f"{element}.{name}",
            element=element,
            quantity="angular stiffness",
            left={NODE_DOFS * node + dof: sign for node, sign in nodes.items()},
            right={NODE_DOFS * node + dof: sign for node, sign in nodes.items()},
            direct=True,
            nominal=getattr(coupling, name),
            scale=getattr(coupling, name) or 10 * _bending_stiffness(machine, shaft) / shaft.length,
        )
        for name, dof in (("k_phix", 2), ("k_phiy", 3))
    ]
    return [*_lateral(element, coupling, nodes, scales), *angular]


def _lateral(element: str, part: LateralCoefficients, nodes: dict[int, float], scales: dict[str, float]) -> list[Coefficient]:
    return [
        Coefficient(
            name=f"{element}.{name}",
            element=element,
            quantity="stiffness" if name[0] == "k" else "damping",
            left={NODE_DOFS * node + _AXIS[name[1]]: sign for node, sign in nodes.items()},
            right={NODE_DOFS * node + _AXIS[name[2]]: sign for node, sign in nodes.items()},
            direct=name in DIRECT,
            nominal=getattr(part, name),
            scale=scales[name],
        )
        for name in LATERAL
    ]


def _scales(machine: Machine, shaft: Shaft, part: LateralCoefficients) -> dict[str, float]:
    """Magnitudes to expect, from the nominal direct terms where known, else from the shaft's own stiffness and mass."""
    stiffness = 48 * _bending_stiffness(machine, shaft) / shaft.length**3
    known_k = [value for value in (part.kxx, part.kyy) if value is not None]
    k = float(np.mean(known_k)) if known_k else stiffness
    known_c = [value for value in (part.cxx, part.cyy) if value is not None]
    # A tenth of the stiffness force at the middle of the speed range is a usual damping force.
    middle = rpm_to_rad_per_s((machine.speed_range.minimum_rpm + machine.speed_range.maximum_rpm) / 2)
    c = float(np.mean(known_c)) if known_c else 0.1 * k / middle
    values = {name: (k if name[0] == "k" else c) for name in LATERAL}
    for name in ("kxx", "kyy", "cxx", "cyy"):
        values[name] = getattr(part, name) or values[name]
    return values


def _bending_stiffness(machine: Machine, shaft: Shaft) -> float:
    """Length-weighted mean of EI [N m²]."""
    total = math.fsum(
        section.length
        * machine.materials[section.material].young_modulus
        * math.pi
        / 64
        * (section.outer_diameter**4 - section.inner_diameter**4)
        for section in shaft.sections
    )
    return total / shaft.length


def is_direct(name: str) -> bool:
    """Whether a parameter's name, such as `bearing.B1.kxx`, is that of a direct term."""
    return name.rsplit(".", 1)[-1] in DIRECT


def dense(vectors: list[dict[int, float]], size: int) -> NDArray[np.float64]:
    """The sparse vectors as columns of a (size, count) matrix."""
    matrix = np.zeros((size, len(vectors)))
    for column, vector in enumerate(vectors):
        for row, value in vector.items():
            matrix[row, column] = value
    return matrix
