"""Mode shapes of a train: motion of each shaft in a mode, and the orbit of every node."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.critical_speed import HEAVILY_DAMPED
from estimator.modes.eigenmodes import Modes, modes
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.rotor.system_matrices import system_matrices
from estimator.rotor.whirl import Orbit, orbit, whirl


@dataclass(frozen=True)
class ShaftShape:
    """One shaft in one mode, at its n nodes.

    Attributes:
        shaft: Id of the shaft.
        station: Stations (n,) from the shaft's driver-side end [m].
        x: Complex displacements (n,) along x, over the train's largest [-].
        y: Complex displacements (n,) along y, over the train's largest [-].
        theta_x: Complex slopes (n,) about x, over the largest displacement [1/m].
        theta_y: Complex slopes (n,) about y, over the largest displacement [1/m].
        orbit: Ellipses of the nodes; a semi_minor above zero whirls forward.
    """

    shaft: str
    station: Floats
    x: Complexes
    y: Complexes
    theta_x: Complexes
    theta_y: Complexes
    orbit: Orbit


@dataclass(frozen=True)
class ModeShape:
    """One mode, whose motion is Re(q e^{λt}).

    The largest semi-major axis of the train is 1, and at t = 0 that node is at the end of it.

    Attributes:
        eigenvalue: Eigenvalue λ [rad/s].
        whirl: Sense of whirl of the whole mode, +1 forward to -1 backward [-].
        shafts: Shape of each shaft.
    """

    eigenvalue: complex
    whirl: float
    shafts: tuple[ShaftShape, ...]

    @property
    def frequency(self) -> float:
        """Return the damped natural frequency Im λ [rad/s]."""
        return self.eigenvalue.imag

    @property
    def damping_ratio(self) -> float:
        """Return the damping ratio -Re λ / |λ| [-]."""
        return -self.eigenvalue.real / abs(self.eigenvalue)


def mode_shapes(
    machine: Machine, *, spin: float, highest_frequency: float, coefficients: Floats | None = None
) -> tuple[ModeShape, ...]:
    """Compute the shapes of all modes up to a damped natural frequency.

    Modes so heavily damped that nothing is felt of them are left out. Whirl is forward when it goes with the spin; at
    standstill with the machine's sense of rotation.

    Args:
        machine: The machine.
        spin: Spin speed, signed [rad/s].
        highest_frequency: Highest damped natural frequency [rad/s].
        coefficients: Coefficients (K,) [SI]; None for the expected ones.

    Returns:
        Mode shapes, by ascending frequency [rad/s].
    """
    rotor, basis = assemble_rotor(machine), modal_basis(machine, max(highest_frequency, abs(spin)))
    found = modes(system_matrices(machine, coefficients=coefficients, basis=basis), spin=spin)
    direction = int(np.sign(spin)) or machine.direction
    senses = whirl(found.shape, basis.reduced(rotor).mass, direction=direction)
    shown = np.flatnonzero((found.eigenvalue.imag <= highest_frequency) & (found.damping_ratio < HEAVILY_DAMPED))
    found = Modes(found.eigenvalue[shown], basis.expanded(found.shape[:, shown]), basis.expanded(found.left[:, shown]))
    return tuple(_mode_shape(rotor, found, place, float(senses[number]), direction) for place, number in enumerate(shown))


def _mode_shape(rotor: Rotor, found: Modes, number: int, sense: float, direction: int) -> ModeShape:
    shape = normalised(found.shape[:, number], direction=direction)
    shafts = []
    for shaft, station in rotor.stations.items():
        first = NODE_DOFS * rotor.first_node[shaft]
        x, y, theta_x, theta_y = shape[first : first + NODE_DOFS * station.size].reshape(-1, NODE_DOFS).T
        shafts.append(ShaftShape(shaft, station, x, y, theta_x, theta_y, orbit(x, y, direction=direction)))
    return ModeShape(eigenvalue=complex(found.eigenvalue[number]), whirl=sense, shafts=tuple(shafts))


def normalised(shape: Complexes, *, direction: int) -> Complexes:
    """Scale a shape so that its largest semi-major axis is 1 and that node at the end of it at t = 0.

    Args:
        shape: Shape (N,) over (x, y, θx, θy) per node [any unit].
        direction: Sense of rotation, +1 or -1.

    Returns:
        Scaled shape (N,) [-].
    """
    ellipses = orbit(shape[0::NODE_DOFS], shape[1::NODE_DOFS], direction=direction)
    largest = int(np.argmax(ellipses.semi_major))
    return np.asarray(shape * np.exp(1j * ellipses.delay[largest]) / ellipses.semi_major[largest])
