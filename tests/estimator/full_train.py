"""A dense model of a train with everything a document may hold, written down from the equations of motion, entry by entry.

It shares with the estimator only the free-free shafts' mass, gyroscopic and stiffness matrices; discs, coupling halves,
damping, seals, couplings and excitations are put in here.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimator.fit.identification import Identification
from estimator.machine.document import Machine
from estimator.machine.parts import Bearing, Coupling, Disc, Half, Seal
from estimator.rotor.assembly import assemble_rotor
from tests.estimator.trains import Complexes, Document, Floats

Force = Callable[[float], Complexes]
"""Force (N,) at a speed [rad/s], in rotation from +x to +y."""
FullElements = Callable[[float], tuple[Floats, Floats, Floats]]
"""Stiffness, damping and mass (N, N) of bearings, seals and couplings at a speed [rad/s]."""


@dataclass(frozen=True)
class FullTrain:
    """M q̈ + (C + Ω G) q̇ + (K + Ω H) q = f over (x, y, θx, θy) per node, each matrix (N, N), elements included."""

    mass: Floats
    damping: Floats
    gyroscopic: Floats
    stiffness: Floats
    circulatory: Floats

    def dynamic_stiffness(self, speed: float, *, direction: int = 1) -> Complexes:
        """K - ω² M + jω C at a speed [rad/s]."""
        damping = self.damping + direction * speed * self.gyroscopic
        stiffness = self.stiffness + direction * speed * self.circulatory
        return np.asarray(stiffness - speed**2 * self.mass + 1j * speed * damping)

    def eigenvalues(self, *, spin: float) -> Complexes:
        """All of them [rad/s], at a spin speed [rad/s] with the sign of the sense of rotation."""
        size = len(self.mass)
        inverse = np.linalg.inv(self.mass)
        damping, stiffness = self.damping + spin * self.gyroscopic, self.stiffness + spin * self.circulatory
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ damping]])
        return np.asarray(np.linalg.eigvals(state))


def node_of(machine: Machine, shaft: str, station: float) -> int:
    """First degree of freedom of the node at a station [m] of a shaft."""
    return 4 * assemble_rotor(machine).node(shaft, station)


def coupling_nodes(machine: Machine, coupling: Coupling) -> tuple[int, int]:
    """First degrees of freedom of the nodes that a coupling joins."""
    return node_of(machine, coupling.driver, machine.shaft(coupling.driver).length), node_of(machine, coupling.driven, 0.0)


def bodies(machine: Machine) -> tuple[Floats, Floats]:
    """Mass and gyroscopic matrix (N, N) of discs and coupling halves: I_d θ̈x + Ω I_p θ̇y, I_d θ̈y - Ω I_p θ̇x."""
    size = assemble_rotor(machine).size
    mass, gyroscopic = np.zeros((size, size)), np.zeros((size, size))
    rigid = [(node_of(machine, disc.shaft, disc.station), disc) for disc in machine.discs]
    places: list[tuple[int, Disc | Half]] = [*rigid]
    for coupling in machine.couplings:
        halves = zip(coupling_nodes(machine, coupling), (coupling.driver_half, coupling.driven_half), strict=True)
        places += [(x, half) for x, half in halves if half is not None]
    for x, body in places:
        inertia = (body.mass, body.mass, body.diametral_inertia, body.diametral_inertia)
        mass[range(x, x + 4), range(x, x + 4)] += inertia
        gyroscopic[x + 2, x + 3] += body.polar_inertia
        gyroscopic[x + 3, x + 2] -= body.polar_inertia
    return mass, gyroscopic


def elements(machine: Machine) -> tuple[Floats, Floats, Floats]:
    """Stiffness, damping and mass (N, N) of the nominal bearings, seals and couplings; what is not given is zero."""
    size = assemble_rotor(machine).size
    stiffness, damping, mass = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    to_ground: list[Bearing | Seal] = [*machine.bearings, *machine.seals]
    for part in to_ground:
        x = node_of(machine, part.shaft, part.station)
        stiffness[x : x + 2, x : x + 2] += [[part.kxx or 0, part.kxy or 0], [part.kyx or 0, part.kyy or 0]]
        damping[x : x + 2, x : x + 2] += [[part.cxx or 0, part.cxy or 0], [part.cyx or 0, part.cyy or 0]]
        if isinstance(part, Seal):
            mass[x, x] += part.mxx or 0
            mass[x + 1, x + 1] += part.myy or 0
    for one in machine.couplings:
        turn_y, turn_x = one.kx_phiy or 0, one.ky_phix or 0
        k = np.array(
            [
                [one.kxx or 0, one.kxy or 0, 0, turn_y],
                [one.kyx or 0, one.kyy or 0, turn_x, 0],
                [0, turn_x, one.k_phix or 0, one.k_phixy or 0],
                [turn_y, 0, one.k_phiyx or 0, one.k_phiy or 0],
            ]
        )
        c = np.zeros((4, 4))
        c[:2, :2] = [[one.cxx or 0, one.cxy or 0], [one.cyx or 0, one.cyy or 0]]
        c[2, 2], c[3, 3] = one.c_phix or 0, one.c_phiy or 0
        ends = coupling_nodes(machine, one)
        for row in ends:
            for column in ends:
                sign = 1 if row == column else -1
                stiffness[row : row + 4, column : column + 4] += sign * k
                damping[row : row + 4, column : column + 4] += sign * c
    return stiffness, damping, mass


def full_train(machine: Machine, parts: tuple[Floats, Floats, Floats] | None = None) -> FullTrain:
    """The whole train, with nominal elements or with others.

    Internal damping opposes the velocity that an observer turning with the shaft sees, q̇ - Ω T q, with T the quarter turn
    from +x to +y: -C_i (q̇ - Ω T q), so that H = -C_i T.
    """
    rotor = assemble_rotor(machine)
    stiffness, damping, mass = parts or elements(machine)
    discs = bodies(machine)[0]
    turn = np.kron(np.eye(rotor.size // 2), [[0.0, -1.0], [1.0, 0.0]])
    internal = sum(
        (machine.materials[name].internal_damping * elastic_part(machine, name) for name in rotor.materials),
        np.zeros_like(rotor.mass),
    )
    external = machine.damping.alpha * (rotor.mass - discs) + machine.damping.beta * rotor.stiffness
    return FullTrain(
        mass=rotor.mass + mass,
        damping=damping + external + internal,
        gyroscopic=rotor.gyroscopic,
        stiffness=rotor.stiffness + stiffness,
        circulatory=-internal @ turn,
    )


def elastic_part(machine: Machine, material: str) -> Floats:
    """Stiffness (N, N) of the shafts of one material: those of all others as soft as a breath."""
    soft = {
        name: one if name == material else one.model_copy(update={"young_modulus": 1e-9})
        for name, one in machine.materials.items()
    }
    return assemble_rotor(machine.model_copy(update={"materials": soft})).stiffness


def unbalance_force(machine: Machine, unbalances: Complexes | None = None) -> Force:
    """ω² U along x and -jω² U along y at the discs, by default the document's unbalances."""
    size = assemble_rotor(machine).size
    shape = np.zeros(size, dtype=complex)
    for i, disc in enumerate(machine.discs):
        if unbalances is not None:
            u = complex(unbalances[i])
        elif disc.unbalance is not None:
            u = disc.unbalance.magnitude * complex(np.exp(1j * math.radians(disc.unbalance.angle_deg)))
        else:
            continue
        x = node_of(machine, disc.shaft, disc.station)
        shape[x] += u
        shape[x + 1] -= 1j * u
    return lambda speed: np.asarray(speed**2 * shape)


def probe_rows(machine: Machine) -> Floats:
    """(m, N): displacement along each probe."""
    rows = np.zeros((len(machine.probes), assemble_rotor(machine).size))
    for row, probe in zip(rows, machine.probes, strict=True):
        x, angle = node_of(machine, probe.shaft, probe.station), math.radians(probe.angle_deg)
        row[x : x + 2] = math.cos(angle), math.sin(angle)
    return rows


def full_response(
    machine: Machine,
    speed: Floats,
    *,
    direction: int = 1,
    force: Force | None = None,
    at_speed: FullElements | None = None,
) -> Complexes:
    """Phasors (S, m) [m] of a full solve at each speed.

    force: in rotation from +x to +y, by default the document's unbalances. What is fixed to the shaft is a function of its
    angle, which runs backwards in the other sense: its phasor is the conjugate there. at_speed: elements by speed.
    """
    acting = force or unbalance_force(machine)
    rows = probe_rows(machine)
    train = full_train(machine)
    stiffness, damping, mass = elements(machine)
    found = np.empty((speed.size, len(rows)), dtype=complex)
    for i, omega in enumerate(speed.tolist()):
        dynamic = train.dynamic_stiffness(omega, direction=direction)
        if at_speed is not None:
            k, c, m = at_speed(omega)
            dynamic += (k - stiffness) - omega**2 * (m - mass) + 1j * omega * (c - damping)
        forward = acting(omega)
        found[i] = rows @ np.linalg.solve(dynamic, forward if direction > 0 else forward.conj())
    return found


def true_values(machine: Machine) -> dict[str, complex]:
    """Return the document's own coefficients and unbalances by parameter name, where it gives them."""
    names = ["kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "mxx", "myy", "k_phix", "k_phiy"]
    names += ["k_phixy", "k_phiyx", "c_phix", "c_phiy", "kx_phiy", "ky_phix"]
    found: dict[str, complex] = {}
    for kind, parts in (("bearing", machine.bearings), ("seal", machine.seals), ("coupling", machine.couplings)):
        for part in parts:
            found |= {f"{kind}.{part.id}.{n}": getattr(part, n) for n in names if getattr(part, n, None) is not None}
    for disc in machine.discs:
        if disc.unbalance is not None:
            turn = complex(np.exp(1j * math.radians(disc.unbalance.angle_deg)))
            found[f"disc.{disc.id}.unbalance"] = disc.unbalance.magnitude * turn
    return found


def deviations(found: Identification, expected: dict[str, complex]) -> Floats:
    """(estimate - truth) / standard error of every real number estimated of the expected ones, at least one."""
    result: list[float] = []
    for name, value in expected.items():
        one = found.estimate(name)
        if one.value is None or one.standard_error is None:
            continue
        result.append((one.value - value.real) / one.standard_error)
        if one.imaginary is not None and one.imaginary_standard_error is not None:
            result.append((one.imaginary - value.imag) / one.imaginary_standard_error)
    assert result
    return np.array(result)


def two_material_document(document: Document) -> Document:
    """A Chapter 3 document whose shafts are each half steel, half titanium."""
    document["materials"]["titanium"] = {"young_modulus": 1.16e11, "density": 4430.0, "poisson_ratio": 0.34}
    for shaft in document["shafts"]:
        whole = shaft["sections"][0]
        shaft["sections"] = [
            {**whole, "length": 0.75},
            {**whole, "length": 0.5, "outer_diameter": 0.024, "material": "titanium"},
        ]
    return document
