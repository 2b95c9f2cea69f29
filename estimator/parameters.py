"""The unknowns of a train: what each is called, where it acts, what is believed of it before any measurement.

A coefficient p adds (jω)ⁿ p Σ a bᵀ to the dynamic stiffness, with n = 0 for a stiffness, 1 for a damping, 2 for an inertia and
a, b vectors over the degrees of freedom: `kxy` of a bearing has a at x and b at y. An excitation is complex and enters the
force: a residual unbalance, a bow, a misalignment's equivalent load.
"""

import math
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from estimator.machine import Bearing, Coupling, LateralCoefficients, Machine, ParameterRule, Seal, Shaft, SpeedDependence
from estimator.references import ANGULAR, LATERAL, OPTIONAL
from estimator.remembered import remembered
from estimator.rotor import Rotor
from estimator.shaft import NODE_DOFS, PLANE_DOFS
from estimator.units import rpm_to_rad_per_s

Quantity = Literal[
    "stiffness",
    "damping",
    "inertia",
    "angular stiffness",
    "angular damping",
    "coupled stiffness",
    "unbalance",
    "bow",
    "force",
    "moment",
    "scale factor",
    "gain",
    "run-out",
]

UNITS: dict[Quantity, str] = {
    "stiffness": "N/m",
    "damping": "N s/m",
    "inertia": "kg",
    "angular stiffness": "N m/rad",
    "angular damping": "N m s/rad",
    "coupled stiffness": "N/rad",
    "unbalance": "kg m",
    "bow": "m",
    "force": "N",
    "moment": "N m",
    "scale factor": "1",
    "gain": "1",
    "run-out": "m",
}
ORDER: dict[Quantity, int] = {"damping": 1, "angular damping": 1, "inertia": 2}
"""Power of jω with which a coefficient acts; 0 where it is not named."""

DIRECT = frozenset({"kxx", "kyy", "cxx", "cyy", "mxx", "myy", "k_phix", "k_phiy", "c_phix", "c_phiy"})
"""Coefficients that are positive by nature; they are fitted, compared and averaged as logarithms."""
SCALE_FACTORS = frozenset({"young_modulus", "density"})
"""Factors on a material's properties, positive and fitted as logarithms too."""
_AXIS = {"x": 0, "y": 1}
_ROTATION = {"x": 2, "y": 3}

Vector = dict[int, float]
"""A sparse vector over the degrees of freedom of the rotor."""


@dataclass(frozen=True)
class Coefficient:
    """One real stiffness, damping or inertia coefficient.

    pairs: the vectors (a, b), each {degree of freedom: sign}; only what couples translation and rotation has two.
    direct: positive by nature, so its logarithm is fitted. nominal: the document's value, or None. scale: the magnitude
    expected of it, in its own unit, always positive. fixed: kept at the nominal value. tied_to: name of the coefficient whose
    value it takes. spread: how far from the nominal value, where the document says so: of the logarithm, or in its own unit.
    speed_dependence: None while it is constant.
    """

    name: str
    element: str
    quantity: Quantity
    pairs: tuple[tuple[Vector, Vector], ...]
    direct: bool
    nominal: float | None
    scale: float
    fixed: bool = False
    tied_to: str | None = None
    spread: float | None = None
    speed_dependence: SpeedDependence | None = None

    @property
    def unit(self) -> str:
        """SI unit."""
        return UNITS[self.quantity]

    @property
    def order(self) -> int:
        """Power of jω with which it acts."""
        return ORDER.get(self.quantity, 0)

    @property
    def left(self) -> Vector:
        """The first pair's a."""
        return self.pairs[0][0]

    @property
    def right(self) -> Vector:
        """The first pair's b."""
        return self.pairs[0][1]

    @property
    def expected(self) -> float:
        """Best guess before any measurement: the nominal value; else the scale, or zero for a cross-coupled term."""
        if self.nominal is not None:
            return self.nominal
        return self.scale if self.direct else 0.0


@dataclass(frozen=True)
class Excitation:
    """One complex unknown of the force: magnitude·e^{j angle}, the angle counted from the keyphasor mark from +x to +y.

    speed_power: the force goes with this power of ω. shape: over (displacement, slope) per node, of what turns with the
    shaft; of a bow the deflection [m/m], else the force. stiffened: the force is the shafts' stiffness times the shape.
    acting: for what acts along one degree of freedom only, the vector over all of them. spread: rms expected of its distance
    from the nominal value, or from zero, None where the data themselves give its size. node: of an unbalance.
    """

    name: str
    element: str
    quantity: Quantity
    nominal: complex | None = None
    speed_power: int = 0
    shape: NDArray[np.float64] | None = None
    stiffened: bool = False
    acting: Vector | None = None
    spread: float | None = None
    fixed: bool = False
    node: int = -1

    @property
    def unit(self) -> str:
        """SI unit."""
        return UNITS[self.quantity]


@dataclass(frozen=True)
class Unknowns:
    """Everything in the model of a train that an identification determines: coefficients, then excitations."""

    coefficients: tuple[Coefficient, ...]
    excitations: tuple[Excitation, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all of them."""
        return tuple([item.name for item in self.coefficients] + [item.name for item in self.excitations])

    @property
    def unbalances(self) -> tuple[Excitation, ...]:
        """The residual unbalances, which are the first excitations."""
        return tuple(item for item in self.excitations if item.quantity == "unbalance")


@remembered
def unknowns(machine: Machine, rotor: Rotor) -> Unknowns:
    """All coefficients and excitations of a machine, in the document's order."""
    coefficients: list[Coefficient] = []
    to_ground: list[Bearing | Seal] = [*machine.bearings, *machine.seals]
    for part in to_ground:
        coefficients += _to_ground(machine, rotor, part)
    for coupling in machine.couplings:
        coefficients += _coupling(machine, rotor, coupling)
    unbalances = [_held(one, machine.parameters) for one in _unbalances(machine, rotor)]
    return Unknowns(
        _tied([_ruled(one, machine.parameters) for one in coefficients]),
        (*unbalances, *_bows(machine, rotor), *_loads(machine, rotor)),
    )


def is_direct(name: str) -> bool:
    """Whether a parameter's name, such as `bearing.B1.kxx@1500rpm`, is that of a direct term or a scale factor."""
    return name.partition("@")[0].rsplit(".", 1)[-1] in DIRECT | SCALE_FACTORS


def dense(vectors: list[Vector], size: int) -> NDArray[np.float64]:
    """The sparse vectors as columns of a (size, count) matrix."""
    matrix = np.zeros((size, len(vectors)))
    for column, vector in enumerate(vectors):
        for row, value in vector.items():
            matrix[row, column] = value
    return matrix


def _to_ground(machine: Machine, rotor: Rotor, part: Bearing | Seal) -> list[Coefficient]:
    node = rotor.node(part.shaft, part.station)
    scales = _scales(machine, machine.shaft(part.shaft), part)
    element = f"seal.{part.id}" if isinstance(part, Seal) else f"bearing.{part.id}"
    found = _lateral(element, part, {node: 1.0}, scales)
    for name in OPTIONAL["seals"] if isinstance(part, Seal) else ():
        if getattr(part, name) is not None:
            at: Vector = {NODE_DOFS * node + _AXIS[name[1]]: 1.0}
            found.append(_coefficient(element, part, name, "inertia", ((at, at),), getattr(part, name)))
    return found


def _coupling(machine: Machine, rotor: Rotor, coupling: Coupling) -> list[Coefficient]:
    nodes = {rotor.end_node(coupling.driver): 1.0, rotor.first_node[coupling.driven]: -1.0}
    shaft = machine.shaft(coupling.driver)
    element = f"coupling.{coupling.id}"
    rotation = {axis: _relative(nodes, dof) for axis, dof in _ROTATION.items()}
    translation = {axis: _relative(nodes, dof) for axis, dof in _AXIS.items()}
    found = _lateral(element, coupling, nodes, _scales(machine, shaft, coupling))
    stiff = 10 * _bending_stiffness(machine, shaft) / shaft.length
    for name in ANGULAR:
        pair = ((rotation[name[-1]], rotation[name[-1]]),)
        found.append(_coefficient(element, coupling, name, "angular stiffness", pair, getattr(coupling, name) or stiff))
    for name in OPTIONAL["couplings"]:
        value = getattr(coupling, name)
        if value is None:
            continue
        if name.startswith("k_phi"):
            beside = math.sqrt((coupling.k_phix or stiff) * (coupling.k_phiy or stiff))
            pair = ((rotation[name[-2]], rotation[name[-1]]),)
            found.append(_coefficient(element, coupling, name, "angular stiffness", pair, beside))
        elif name.startswith("c_phi"):
            pair = ((rotation[name[-1]], rotation[name[-1]]),)
            found.append(_coefficient(element, coupling, name, "angular damping", pair, value))
        else:
            force, turn = translation[name[1]], rotation[name[-1]]
            size = abs(value) or stiff / shaft.length
            found.append(_coefficient(element, coupling, name, "coupled stiffness", ((force, turn), (turn, force)), size))
    return found


def _relative(nodes: dict[int, float], dof: int) -> Vector:
    return {NODE_DOFS * node + dof: sign for node, sign in nodes.items()}


def _lateral(element: str, part: LateralCoefficients, nodes: dict[int, float], scales: dict[str, float]) -> list[Coefficient]:
    return [
        _coefficient(
            element,
            part,
            name,
            "stiffness" if name[0] == "k" else "damping",
            ((_relative(nodes, _AXIS[name[1]]), _relative(nodes, _AXIS[name[2]])),),
            scales[name],
        )
        for name in LATERAL
    ]


def _coefficient(
    element: str,
    part: LateralCoefficients,
    name: str,
    quantity: Quantity,
    pairs: tuple[tuple[Vector, Vector], ...],
    scale: float,
) -> Coefficient:
    dependence = part.speed_dependence
    if dependence is not None and dependence.coefficients is not None and name not in dependence.coefficients:
        dependence = None
    return Coefficient(
        name=f"{element}.{name}",
        element=element,
        quantity=quantity,
        pairs=pairs,
        direct=name in DIRECT,
        nominal=getattr(part, name),
        scale=scale,
        speed_dependence=dependence,
    )


def _unbalances(machine: Machine, rotor: Rotor) -> list[Excitation]:
    found = []
    for disc in machine.discs:
        node = rotor.node(disc.shaft, disc.station)
        shape = np.zeros(rotor.plane_size)
        shape[PLANE_DOFS * node] = 1.0
        nominal = None if disc.unbalance is None else _complex(disc.unbalance.magnitude, disc.unbalance.angle_deg)
        element = f"disc.{disc.id}"
        found.append(Excitation(f"{element}.unbalance", element, "unbalance", nominal, speed_power=2, shape=shape, node=node))
    return found


def _complex(magnitude: float, angle_deg: float) -> complex:
    return magnitude * complex(np.exp(1j * math.radians(angle_deg)))


def _bows(machine: Machine, rotor: Rotor) -> list[Excitation]:
    """A half sine over each shaft's length, measured at its middle."""
    found = []
    for shaft in machine.shafts:
        if shaft.bow_spread == 0.0:
            continue
        angle = math.pi * rotor.stations[shaft.id] / shaft.length
        first = PLANE_DOFS * rotor.first_node[shaft.id]
        shape = np.zeros(rotor.plane_size)
        shape[first : first + 2 * angle.size : 2] = np.sin(angle)
        shape[first + 1 : first + 2 * angle.size : 2] = math.pi / shaft.length * np.cos(angle)
        element = f"shaft.{shaft.id}"
        found.append(Excitation(f"{element}.bow", element, "bow", shape=shape, stiffened=True, spread=shaft.bow_spread))
    return found


def _loads(machine: Machine, rotor: Rotor) -> list[Excitation]:
    found = []
    for coupling in machine.couplings:
        if coupling.load is None:
            continue
        nodes = {rotor.end_node(coupling.driver): 1.0, rotor.first_node[coupling.driven]: -1.0}
        element = f"coupling.{coupling.id}"
        quantities: tuple[tuple[Quantity, dict[str, int], float], ...] = (
            ("force", _AXIS, coupling.load.force_spread),
            ("moment", _ROTATION, coupling.load.moment_spread),
        )
        for quantity, places, spread in quantities:
            for axis, dof in places.items():
                acting = _relative(nodes, dof)
                found.append(Excitation(f"{element}.{quantity}_{axis}", element, quantity, acting=acting, spread=spread))
    return found


def _ruled(coefficient: Coefficient, rules: tuple[ParameterRule, ...]) -> Coefficient:
    """The coefficient with the last rule that names it."""
    name = coefficient.name
    for rule in reversed(rules):
        if fnmatchcase(name, rule.names):
            if rule.tied_to is not None:
                return replace(coefficient, tied_to=f"{rule.tied_to}.{name.rsplit('.', 1)[-1]}")
            return replace(coefficient, fixed=rule.fixed, spread=rule.spread)
    return coefficient


def _tied(coefficients: list[Coefficient]) -> tuple[Coefficient, ...]:
    """Tied coefficients expect what the one expects whose value they take."""
    by_name = {one.name: one for one in coefficients}

    def led(one: Coefficient) -> Coefficient:
        if one.tied_to is None:
            return one
        of = by_name[one.tied_to]
        return replace(one, nominal=of.nominal, scale=of.scale, speed_dependence=of.speed_dependence)

    return tuple(led(one) for one in coefficients)


def _held(unbalance: Excitation, rules: tuple[ParameterRule, ...]) -> Excitation:
    """The unbalance with the last rule that names it."""
    for rule in reversed(rules):
        if fnmatchcase(unbalance.name, rule.names):
            spread = None if rule.spread is None else rule.spread * abs(unbalance.nominal or 0.0)
            return replace(unbalance, fixed=rule.fixed, spread=spread)
    return unbalance


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
