"""The train of the thesis's Chapter 2: two rigid rotors on two bearings each, joined by a flexible coupling, 8 DOF.

The degrees of freedom are the journals' displacements (x_b1 … x_b4, y_b1 … y_b4), from which everything else follows
(Eq. 2.1). Shafts and discs give the mass matrix; there is no gyroscopic effect. The print is corrected as the evidence page
says: the inertia I of Eq. 2.2 without the discs' m l̄², which their translation already contains; [K] and [C] of Eq. 2.8 as
sums of outer products; unbalance weights 3/4 and 1/4 as in Eq. 2.1.

Kept from the print: the coupling's bending term resists (x_b1 - x_b2)/l_1 + (x_b3 - x_b4)/l_2. Since Eq. 2.1 counts φ_y1 and
φ_y2 with opposite signs, this is the sum of the two shafts' slopes and not the angle between them. Only with it do the
printed natural frequencies come out.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, eigvals

from estimator.arrays import Complexes, Floats
from estimator.bearings.terms import LATERAL, TERMS, Term
from estimator.quantities import Quantity
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.elimination import GivenShafts
from estimator.rotor.parameters import Coefficient, Excitation, Unknowns, dense

SIZE = 8
"""Number of degrees of freedom."""
BEARINGS = 4
"""Number of bearings."""
X, Y = 0, 4
"""First degree of freedom of each plane."""
DISC_WEIGHTS = ((0.75, 0.25, 0.0, 0.0), (0.25, 0.75, 0.0, 0.0), (0.0, 0.0, 0.75, 0.25), (0.0, 0.0, 0.25, 0.75))
"""Displacement of each disc per displacement of each journal [-] (Eq. 2.1)."""
COUPLING_WEIGHTS = (-0.25, 1.25, -1.25, 0.25)
"""x_c1 - x_c2 per displacement of each journal [-] (Eq. 2.1)."""


@dataclass(frozen=True)
class RigidTrain:
    """Known properties of the two rotors and the values assumed for the unknowns.

    Attributes:
        span: Distance of the bearings of each shaft [m].
        shaft_mass: Mass of each shaft [kg].
        shaft_inertia: Moment of inertia of each shaft [kg m²].
        disc_mass: Mass of each disc [kg].
        disc_inertia: Moment of inertia of each disc [kg m²].
        coefficients: Coefficients (42,) in the order of `names` [N/m, N m/rad, N s/m].
        unbalances: Complex unbalances (4,) [kg m].
    """

    span: tuple[float, float]
    shaft_mass: tuple[float, float]
    shaft_inertia: tuple[float, float]
    disc_mass: tuple[float, float, float, float]
    disc_inertia: tuple[float, float, float, float]
    coefficients: Floats
    unbalances: Complexes

    @property
    def values(self) -> Floats:
        """Return the 50 real unknowns (50,) in the order of Table 2.1 [SI]."""
        return np.concatenate([self.coefficients, np.stack([self.unbalances.real, self.unbalances.imag], axis=-1).reshape(-1)])


def printed_train() -> RigidTrain:
    """Return the train of Tables 2.2-2.7, with the shafts' moment of inertia halved to 0.0498 kg m².

    The bearings of a shaft of 1.25 m are 1 m apart. Unbalances as in Table 2.3.

    Returns:
        The train.
    """
    bearing_stiffness = [
        (2.5e5, 1.2e5, 1.35e5, 2.75e5),
        (2.75e5, 1.46e5, 1.39e5, 2.82e5),
        (2.27e5, 1.31e5, 1.44e5, 2.53e5),
        (2.14e5, 1.21e5, 1.29e5, 2.56e5),
    ]
    coupling_stiffness = (2.12e5, 1.11e5, 1.31e5, 1.99e5, 2.5e5, 2.2e5)
    bearing_damping = [(300.0, 20, 50, 399), (315, 59, 79, 300), (225, 75, 55, 275), (335, 64, 55, 295)]
    coupling_damping = (225.0, 20, 50, 295)
    return RigidTrain(
        span=(1.0, 1.0),
        shaft_mass=(0.765, 0.765),
        shaft_inertia=(0.0498, 0.0498),
        disc_mass=(5.0, 3.0, 2.0, 6.0),
        disc_inertia=(2.48e-5, 1.40e-5, 1.01e-5, 1.88e-5),
        coefficients=np.concatenate(
            [np.ravel(bearing_stiffness), coupling_stiffness, np.ravel(bearing_damping), coupling_damping]
        ),
        unbalances=unbalances_of((9.5e-3, 6.0e-3, 7.9e-3, 11.2e-3), (36.0, 108.0, 240.0, 300.0)),
    )


def unbalances_of(magnitude: tuple[float, ...], angle_deg: tuple[float, ...]) -> Complexes:
    """Convert magnitudes and angles to complex unbalances.

    Args:
        magnitude: Magnitudes (P,) [kg m].
        angle_deg: Angles (P,) [°].

    Returns:
        Unbalances (P,) [kg m].
    """
    return np.asarray(np.array(magnitude) * np.exp(1j * np.deg2rad(angle_deg)))


def names() -> tuple[str, ...]:
    """List the 50 real unknowns in the order of Table 2.1.

    Returns:
        Their names.
    """
    parts = [f"disc.D{disc}.unbalance.{part}" for disc in range(1, 5) for part in ("real", "imaginary")]
    return (*(coefficient.name for coefficient in _coefficients(printed_train())), *parts)


def mass(train: RigidTrain) -> Floats:
    """Assemble the mass matrix from the kinetic energy of thesis Eq. 2.2, the discs' m l̄² left out of I.

    Args:
        train: The train.

    Returns:
        Mass matrix (8, 8) [kg].
    """
    planes = []
    for shaft in (0, 1):
        first, second = 2 * shaft, 2 * shaft + 1
        inertia = train.disc_inertia[first] + train.disc_inertia[second] + train.shaft_inertia[shaft]
        tilt = np.array([1.0, -1.0]) / train.span[shaft]
        planes.append(
            train.disc_mass[first] * _square([0.75, 0.25])
            + train.disc_mass[second] * _square([0.25, 0.75])
            + train.shaft_mass[shaft] * _square([0.5, 0.5])
            + inertia * _square(tilt)
        )
    return np.asarray(block_diag(*planes, *planes))


def condensed(train: RigidTrain, *, speed: Floats, direction: Floats) -> CondensedTrain:
    """Condense the train at S speeds (thesis Eq. 2.8-2.10), ready for `response` and `sensitivity`.

    Its channels are the 8 degrees of freedom.

    Args:
        train: The train.
        speed: Speeds (S,), positive [rad/s].
        direction: Sense of rotation (S,) [-]: +1 from +x to +y, -1 against it.

    Returns:
        The condensed train.
    """
    coefficients = _coefficients(train)
    planes = tuple(
        Excitation(f"disc.D{disc + 1}.unbalance", f"disc.D{disc + 1}", "unbalance", complex(unbalance), node=disc)
        for disc, unbalance in enumerate(train.unbalances)
    )
    return CondensedTrain(
        speed=np.asarray(speed, dtype=float),
        direction=np.asarray(direction, dtype=float),
        shafts=GivenShafts(
            stiffness=(-(np.asarray(speed, dtype=float)[:, None, None] ** 2) * mass(train)).astype(complex),
            forces=_force(np.asarray(speed, dtype=float), np.asarray(direction, dtype=float)),
        ),
        left=dense([coefficient.left for coefficient in coefficients], SIZE),
        right=dense([coefficient.right for coefficient in coefficients], SIZE),
        output=np.eye(SIZE),
        unknowns=Unknowns(coefficients, planes),
        channels=tuple(f"{axis}_b{bearing}" for axis in "xy" for bearing in range(1, BEARINGS + 1)),
    )


def stiffness_and_damping(train: RigidTrain) -> tuple[Floats, Floats]:
    """Assemble [K] and [C] of thesis Eq. 2.8 as sums of outer products.

    Args:
        train: The train.

    Returns:
        [K] (8, 8) [N/m] and [C] (8, 8) [N s/m].
    """
    coefficients = _coefficients(train)
    left = dense([one.left for one in coefficients], SIZE)
    right = dense([one.right for one in coefficients], SIZE)
    damping = np.array([one.quantity == "damping" for one in coefficients])
    terms = train.coefficients * left
    return terms[:, ~damping] @ right[:, ~damping].T, terms[:, damping] @ right[:, damping].T


def natural_frequencies(train: RigidTrain) -> Floats:
    """Solve for the undamped natural frequencies.

    Args:
        train: The train.

    Returns:
        Frequencies (8,), ascending [rad/s].
    """
    stiffness, _ = stiffness_and_damping(train)
    return np.sort(np.sqrt(eigvals(stiffness, mass(train))).real)


def _square(vector: list[float] | Floats) -> Floats:
    return np.outer(vector, vector)


def _force(speed: Floats, direction: Floats) -> Complexes:
    """Assemble force columns (S, 8, 8): ω² U (1, -j) per plane from +x to +y, its mirror image against it (Eq. 2.9)."""
    force = np.zeros((speed.size, SIZE, 2 * len(DISC_WEIGHTS)), dtype=complex)
    square = speed[:, None] ** 2
    sense = direction[:, None]
    for disc, weights in enumerate(DISC_WEIGHTS):
        along_x = square * np.array(weights)
        force[:, X:Y, 2 * disc], force[:, Y:, 2 * disc] = along_x, -1j * sense * along_x
        force[:, X:Y, 2 * disc + 1], force[:, Y:, 2 * disc + 1] = 1j * sense * along_x, along_x
    return force


def _coefficients(train: RigidTrain) -> tuple[Coefficient, ...]:
    """List the 42 coefficients in the order of Table 2.1: stiffnesses of bearings and coupling, then dampings."""
    journals = [(f"bearing.B{bearing + 1}", {bearing: 1.0}) for bearing in range(BEARINGS)]
    coupling = ("coupling.C", dict(enumerate(COUPLING_WEIGHTS)))
    bending = {0: 1 / train.span[0], 1: -1 / train.span[0], 2: 1 / train.span[1], 3: -1 / train.span[1]}
    places: list[tuple[str, Term, dict[int, float], dict[int, float]]] = []
    quantities: tuple[Quantity, ...] = ("stiffness", "damping")
    for quantity in quantities:
        for element, weights in (*journals, coupling):
            places += [
                (element, term, _in_plane(weights, term.force), _in_plane(weights, term.motion))
                for term in LATERAL
                if term.quantity == quantity
            ]
        if quantity == "stiffness":
            # [K] and [kʳ] put k_phix into the x-plane, Eq. 2.4 into the other; [K] is followed.
            for name, axis in (("k_phix", "x"), ("k_phiy", "y")):
                vector = _in_plane(bending, axis)
                places.append((coupling[0], TERMS[name], vector, vector))
    return tuple(
        Coefficient(
            name=f"{element}.{term.name}",
            element=element,
            term=term,
            pairs=((left, right),),
            nominal=float(value),
            scale=abs(float(value)),
        )
        for (element, term, left, right), value in zip(places, train.coefficients, strict=True)
    )


def _in_plane(weights: dict[int, float], axis: str) -> dict[int, float]:
    return {(X if axis == "x" else Y) + journal: weight for journal, weight in weights.items()}
