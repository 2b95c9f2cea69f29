"""Unknowns of a train: their names, the places where they act, and what is believed of them before any measurement.

A coefficient p adds (jω)ⁿ p Σ a bᵀ to the dynamic stiffness, with n = 0 for a stiffness, 1 for a damping, 2 for an inertia and
a, b vectors over the degrees of freedom: `kxy` of a bearing has a at x and b at y. An excitation is complex and enters the
force: a residual unbalance, a bow, a misalignment's equivalent load.
"""

import math
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.bearings.model import BearingForm
from estimator.bearings.registry import CONSTANT
from estimator.bearings.terms import ANGULAR, COUPLING, LATERAL, PEDESTAL, SEAL, Axis, Term
from estimator.machine.document import Machine
from estimator.machine.part_coefficients import nominal_value
from estimator.machine.parts import Bearing, Coupling, LateralCoefficients, Pedestal, Seal, Shaft
from estimator.machine.rules import ParameterRule
from estimator.quantities import UNITS, Quantity
from estimator.rotor.assembly import Rotor
from estimator.rotor.identity_cache import cached_by_identity
from estimator.rotor.shaft_element import NODE_DOFS, PLANE_DOFS
from estimator.units import rpm_to_rad_per_s

_DOF: dict[Axis, int] = {"x": 0, "y": 1, "phix": 2, "phiy": 3}
"""Degree of freedom of a node along each axis."""

Vector = dict[int, float]
"""Sparse vector over the degrees of freedom of the rotor."""


class Coefficient(Struct, frozen=True):
    """One real stiffness, damping or inertia coefficient.

    Attributes:
        name: Name, such as `bearing.B1.kxx`.
        element: Name of the element, such as `bearing.B1`.
        term: The term that it is.
        pairs: Vectors (a, b), each {degree of freedom: sign}; only a coupling of translation and rotation has two pairs.
        nominal: The document's value [unit], of one that follows a table that at the middle of the speed range; None where it
            gives none.
        scale: Magnitude expected of it, always positive [unit].
        fixed: Whether it is kept at the nominal value.
        tied_to: Name of the coefficient whose value it takes.
        spread: Standard deviation from the nominal value, where the document states it: of the logarithm [-], or [unit].
        form: Form of the bearing model that gives it.
    """

    name: str
    element: str
    term: Term
    pairs: tuple[tuple[Vector, Vector], ...]
    nominal: float | None
    scale: float
    fixed: bool = False
    tied_to: str | None = None
    spread: float | None = None
    form: BearingForm = CONSTANT

    @property
    def quantity(self) -> Quantity:
        """Return the physical quantity."""
        return self.term.quantity

    @property
    def direct(self) -> bool:
        """Return whether it is positive by nature, so that its logarithm is fitted."""
        return self.term.direct

    @property
    def unit(self) -> str:
        """Return the SI unit."""
        return UNITS[self.quantity]

    @property
    def order(self) -> int:
        """Return the power of jω with which it acts."""
        return self.term.order

    @property
    def left(self) -> Vector:
        """Return the first pair's a."""
        return self.pairs[0][0]

    @property
    def right(self) -> Vector:
        """Return the first pair's b."""
        return self.pairs[0][1]

    @property
    def expected(self) -> float:
        """Return the best guess before any measurement [unit].

        It is the nominal value; else the scale, or zero for a cross-coupled term.
        """
        if self.nominal is not None:
            return self.nominal
        return self.scale if self.direct else 0.0


class Excitation(Struct, frozen=True, eq=False):
    """One complex unknown of the force: magnitude·e^{j angle}, the angle counted from the keyphasor mark from +x to +y.

    Attributes:
        name: Name, such as `disc.D1.unbalance`.
        element: Name of the element, such as `disc.D1`.
        quantity: Physical quantity.
        nominal: The document's value [unit]; None where it gives none.
        speed_power: Power of ω with which the force goes.
        shape: Shape (N/2,) over (displacement, slope) per node of an excitation that turns with the shaft: of a bow the
            deflection [m/m], of a coupling's run-out the motion at which it is free of load [-], else the force [-].
        stiffened: Whether the force is the shafts' stiffness times the shape.
        coupled: Whether the force is the stiffness of the element, a coupling, times the shape.
        acting: Vector over all degrees of freedom, of an excitation along one degree of freedom only.
        spread: Expected rms distance from the nominal value, or from zero [unit]; None where the data themselves give its
            size.
        fixed: Whether it is kept at the nominal value.
        node: Number of the node, of an unbalance.
    """

    name: str
    element: str
    quantity: Quantity
    nominal: complex | None = None
    speed_power: int = 0
    shape: NDArray[np.float64] | None = None
    stiffened: bool = False
    coupled: bool = False
    acting: Vector | None = None
    spread: float | None = None
    fixed: bool = False
    node: int = -1

    @property
    def unit(self) -> str:
        """Return the SI unit."""
        return UNITS[self.quantity]


class ScaleFactor(Struct, frozen=True):
    """A factor on a property of a material that is not known exactly.

    Attributes:
        material: Id of the material.
        what: The property.
        spread: Relative rms spread [-].
    """

    material: str
    what: Literal["young_modulus", "density"]
    spread: float

    @property
    def element(self) -> str:
        """Return the name of the material, such as `material.steel`."""
        return f"material.{self.material}"

    @property
    def name(self) -> str:
        """Return the name of the factor, such as `material.steel.density`."""
        return f"{self.element}.{self.what}"


class Unknowns(Struct, frozen=True, dict=True):
    """Everything in the model of a train that an identification determines.

    Attributes:
        coefficients: The K coefficients.
        excitations: The E excitations, the residual unbalances first.
    """

    coefficients: tuple[Coefficient, ...]
    excitations: tuple[Excitation, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names of all coefficients, then of all excitations."""
        return tuple([item.name for item in self.coefficients] + [item.name for item in self.excitations])

    @cached_property
    def order_of_terms(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the coefficient (T,) that each pair of vectors belongs to, ascending, and the power (T,) of jω with it."""
        owner = np.repeat(np.arange(len(self.coefficients)), [len(one.pairs) for one in self.coefficients])
        return owner, np.array([one.order for one in self.coefficients], dtype=np.intp)[owner]

    @property
    def unbalances(self) -> tuple[Excitation, ...]:
        """Return the residual unbalances, which are the first excitations."""
        return tuple(item for item in self.excitations if item.quantity == "unbalance")


@cached_by_identity
def unknowns(machine: Machine, rotor: Rotor) -> Unknowns:
    """List all coefficients and excitations of a machine (thesis Eq. 3.7, 3.9), in the document's order.

    Args:
        machine: The machine.
        rotor: Its assembled rotor.

    Returns:
        The unknowns.
    """
    coefficients: list[Coefficient] = []
    to_ground: list[Bearing | Seal] = [*machine.bearings, *machine.seals]
    for part in to_ground:
        coefficients += _to_ground(machine, rotor, part)
    for coupling in machine.couplings:
        coefficients += _coupling(machine, rotor, coupling)
    for pedestal in machine.pedestals:
        coefficients += _pedestal(rotor, pedestal)
    unbalances = [_with_rule(one, machine.parameters) for one in _unbalances(machine, rotor)]
    return Unknowns(
        _tied([_ruled(one, machine.parameters) for one in coefficients]),
        (*unbalances, *_bows(machine, rotor), *_loads(machine, rotor), *_rotating_errors(machine, rotor)),
    )


def scale_factors(machine: Machine, rotor: Rotor) -> tuple[ScaleFactor, ...]:
    """List the factors of E and ρ of a machine's materials that are not known exactly.

    Args:
        machine: The machine.
        rotor: Its assembled rotor.

    Returns:
        The F factors.
    """
    found: list[ScaleFactor] = []
    for name in rotor.materials:
        material = machine.materials[name]
        if material.young_modulus_spread > 0.0:
            found.append(ScaleFactor(name, "young_modulus", material.young_modulus_spread))
        if material.density_spread > 0.0:
            found.append(ScaleFactor(name, "density", material.density_spread))
    return tuple(found)


def dense(vectors: list[Vector], size: int) -> NDArray[np.float64]:
    """Convert sparse vectors to the columns of a matrix.

    Args:
        vectors: The sparse vectors.
        size: Number of rows.

    Returns:
        Matrix (size, count) [-].
    """
    matrix = np.zeros((size, len(vectors)))
    for column, vector in enumerate(vectors):
        for row, value in vector.items():
            matrix[row, column] = value
    return matrix


def _to_ground(machine: Machine, rotor: Rotor, part: Bearing | Seal) -> list[Coefficient]:
    nodes = {rotor.node(part.shaft, part.station): 1.0}
    pedestal = machine.pedestal_of(part.id) if isinstance(part, Bearing) else None
    if pedestal is not None:
        nodes[rotor.pedestal_node[pedestal.id]] = -1.0
    scales = _scales(machine, machine.shaft(part.shaft), part)
    rpm = machine.speed_range.middle_rpm
    element = f"seal.{part.id}" if isinstance(part, Seal) else f"bearing.{part.id}"
    found = [_coefficient(element, part, term, nodes, scales[term.name], rpm) for term in LATERAL]
    for term in SEAL if isinstance(part, Seal) else ():
        value = getattr(part, term.name)
        if value is not None:
            found.append(_coefficient(element, part, term, nodes, value, rpm))
    return found


def _coupling(machine: Machine, rotor: Rotor, coupling: Coupling) -> list[Coefficient]:
    nodes = {rotor.end_node(coupling.driver): 1.0, rotor.first_node[coupling.driven]: -1.0}
    shaft = machine.shaft(coupling.driver)
    element = f"coupling.{coupling.id}"
    scales = _scales(machine, shaft, coupling)
    stiff = 10 * _bending_stiffness(machine, shaft) / shaft.length
    rpm = machine.speed_range.middle_rpm
    found = [_coefficient(element, coupling, term, nodes, scales[term.name], rpm) for term in LATERAL]
    found += [_coefficient(element, coupling, term, nodes, getattr(coupling, term.name) or stiff, rpm) for term in ANGULAR]
    for term in COUPLING:
        value = getattr(coupling, term.name)
        if value is not None:
            scale = _coupling_scale(coupling, term, value, stiff, shaft)
            found.append(_coefficient(element, coupling, term, nodes, scale, rpm))
    return found


def _pedestal(rotor: Rotor, pedestal: Pedestal) -> list[Coefficient]:
    element, nodes = f"pedestal.{pedestal.id}", {rotor.pedestal_node[pedestal.id]: 1.0}
    values = {term: float(getattr(pedestal, term.name)) for term in PEDESTAL}
    return [
        Coefficient(f"{element}.{term.name}", element, term, _pairs(term, nodes), nominal=value, scale=value)
        for term, value in values.items()
    ]


def _coupling_scale(coupling: Coupling, term: Term, value: float, stiff: float, shaft: Shaft) -> float:
    """Return the magnitude expected of a coupling's term that its document gives; stiff: of its angular stiffness [N
    m/rad]."""
    if term.direct:
        return value
    if term.quantity == "angular stiffness":
        return math.sqrt((coupling.k_phix or stiff) * (coupling.k_phiy or stiff))
    return abs(value) or stiff / shaft.length


def _relative(nodes: dict[int, float], dof: int) -> Vector:
    return {NODE_DOFS * node + dof: sign for node, sign in nodes.items()}


def _pairs(term: Term, nodes: dict[int, float]) -> tuple[tuple[Vector, Vector], ...]:
    return tuple((_relative(nodes, _DOF[force]), _relative(nodes, _DOF[motion])) for force, motion in term.axes)


def _coefficient(
    element: str, part: LateralCoefficients, term: Term, nodes: dict[int, float], scale: float, rpm: float
) -> Coefficient:
    """Build a coefficient; rpm: speed at which its nominal value is taken [r/min]."""
    form = part.speed_dependence
    return Coefficient(
        name=f"{element}.{term.name}",
        element=element,
        term=term,
        pairs=_pairs(term, nodes),
        nominal=nominal_value(part, term.name, rpm=rpm),
        scale=scale,
        form=form if form is not None and form.governs(term.name) else CONSTANT,
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
    """Build a half sine over each shaft's length, measured at its middle."""
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
        quantities: tuple[tuple[Quantity, dict[str, Axis], float], ...] = (
            ("force", {"x": "x", "y": "y"}, coupling.load.force_spread),
            ("moment", {"x": "phix", "y": "phiy"}, coupling.load.moment_spread),
        )
        for quantity, axes, spread in quantities:
            for axis, along in axes.items():
                acting = _relative(nodes, _DOF[along])
                found.append(Excitation(f"{element}.{quantity}_{axis}", element, quantity, acting=acting, spread=spread))
    return found


def _rotating_errors(machine: Machine, rotor: Rotor) -> list[Excitation]:
    """Build the run-outs of bore and face of each coupling that the document asks for.

    A coupling whose bores are off centre by e, or whose faces are askew by α, is free of load where the driven shaft's end
    stands off the driver's by that. Both turn with the shafts, so that the coupling pulls the ends apart with K e and K_φ α,
    whatever the speed (coupling errors as rotating forces and moments: Bachschmid, Pennacchi and Vania, J. Sound Vib. 254
    (2002) 327, doi:10.1006/jsvi.2001.4096). K is the stiffness that the coupling has, not the one expected of it: a rigid
    coupling bends its shafts by e however stiff it is.
    """
    found = []
    for coupling in machine.couplings:
        said, element = coupling.rotating_error, f"coupling.{coupling.id}"
        if said is None:
            continue
        parts: tuple[tuple[str, Quantity, float], ...] = (
            ("rotating_offset", "rotating offset", said.offset_spread),
            ("rotating_angle", "rotating angle", said.angle_spread),
        )
        for dof, (name, quantity, spread) in enumerate(parts):
            shape = np.zeros(rotor.plane_size)
            shape[PLANE_DOFS * rotor.first_node[coupling.driven] + dof] = 1.0
            found.append(Excitation(f"{element}.{name}", element, quantity, shape=shape, coupled=True, spread=spread))
    return found


def _ruled(coefficient: Coefficient, rules: tuple[ParameterRule, ...]) -> Coefficient:
    """Return the coefficient with the last rule that names it."""
    name = coefficient.name
    for rule in reversed(rules):
        if fnmatchcase(name, rule.names):
            if rule.tied_to is not None:
                return replace(coefficient, tied_to=f"{rule.tied_to}.{coefficient.term.name}")
            return replace(coefficient, fixed=rule.fixed, spread=rule.spread)
    return coefficient


def _tied(coefficients: list[Coefficient]) -> tuple[Coefficient, ...]:
    """Return the coefficients, tied ones with the expectations of those whose value they take."""
    by_name = {one.name: one for one in coefficients}

    def led(one: Coefficient) -> Coefficient:
        if one.tied_to is None:
            return one
        of = by_name[one.tied_to]
        return replace(one, nominal=of.nominal, scale=of.scale, form=of.form)

    return tuple(led(one) for one in coefficients)


def _with_rule(unbalance: Excitation, rules: tuple[ParameterRule, ...]) -> Excitation:
    """Return the unbalance with the last rule that names it."""
    for rule in reversed(rules):
        if fnmatchcase(unbalance.name, rule.names):
            spread = None if rule.spread is None else rule.spread * abs(unbalance.nominal or 0.0)
            return replace(unbalance, fixed=rule.fixed, spread=spread)
    return unbalance


def _scales(machine: Machine, shaft: Shaft, part: LateralCoefficients) -> dict[str, float]:
    """Estimate magnitudes from the nominal direct terms where known, else from the shaft's own stiffness and mass."""
    stiffness = 48 * _bending_stiffness(machine, shaft) / shaft.length**3
    rpm = machine.speed_range.middle_rpm
    nominal = {term.name: nominal_value(part, term.name, rpm=rpm) for term in LATERAL if term.direct}
    known_k = [value for name in ("kxx", "kyy") if (value := nominal[name]) is not None]
    k = float(np.mean(known_k)) if known_k else stiffness
    known_c = [value for name in ("cxx", "cyy") if (value := nominal[name]) is not None]
    # A tenth of the stiffness force at the middle of the speed range is a usual damping force.
    c = float(np.mean(known_c)) if known_c else 0.1 * k / rpm_to_rad_per_s(rpm)
    values = {term.name: (k if term.quantity == "stiffness" else c) for term in LATERAL}
    values |= {name: value for name, value in nominal.items() if value is not None}
    return values


def _bending_stiffness(machine: Machine, shaft: Shaft) -> float:
    """Compute the length-weighted mean of EI [N m²]."""
    total = math.fsum(
        section.length
        * machine.materials[section.material].young_modulus
        * math.pi
        / 64
        * (section.outer_diameter**4 - section.inner_diameter**4)
        for section in shaft.sections
    )
    return total / shaft.length
