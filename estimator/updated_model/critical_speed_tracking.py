"""Critical speeds followed from the document's model to the updated one, so that each keeps its place in every trend.

The document's model says which there are. Its coefficients go to the identified ones along a straight line in the fit's
coordinates; each crossing with the synchronous line is corrected after every step. A step after which the shape is another
one, by the modal assurance criterion (Allemang & Brown, 1st IMAC, 1982), is halved.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
import scipy
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.campbell import assurance
from estimator.modes.critical_speed import HEAVILY_DAMPED, MatricesOverSpeed, crossing_modes
from estimator.modes.crossing_correction import corrected_crossing
from estimator.modes.eigenmodes import Modes, modes
from estimator.rotor.modal_reduction import Basis
from estimator.rotor.shaft_element import NODE_DOFS, PLANE_DOFS
from estimator.rotor.system_matrices import SystemMatrices
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel, expected_model

HIGHEST_ABOVE_TRIP = 1.25
"""Highest critical speed of the document's model as a multiple of the speed range's end [-]."""
SEARCH_MODES, MODES_PER_MODE = 16, 2
"""Size of the basis of undamped modes in which the document's crossings are searched before they are corrected in full: a
fixed number, and so many for each mode below the highest speed.
"""
SAME_SHAPE = 0.8
"""Modal assurance from which on a shape is still the same after a step [-]."""
SMALLEST_STEP = 1 / 128
"""Part of the way below which a crossing counts as lost [-]."""
SAME_ROOT = 1e-6
"""Relative distance of two eigenvalues up to which they may be one crossing [-]."""
ALIKE = 0.6
"""Assurance of two deflection lines from which on the modes are one bending mode in two planes [-]."""
CACHE_SIZE = 256
"""Number of documents whose crossings are cached."""


@dataclass(frozen=True)
class NominalCrossings:
    """Critical speeds of a document's model, ascending.

    Attributes:
        modes: The c modes that cross the synchronous line, on the whole mesh.
        pairs: Numbers of two modes that are one bending mode in two planes, the lower one first.
    """

    modes: Modes
    pairs: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class FollowedCrossings:
    """Critical speeds of an updated model that were followed from the document's model.

    A number that is missing is so heavily damped that nothing is felt of it any more, or could not be followed.

    Attributes:
        modes: The f modes that were followed, ascending, over the model's basis.
        number: Number (f,) of each among those of the document's model.
        count: Number of critical speeds of the document's model.
        pairs: Numbers of two modes that are one bending mode in two planes, the lower one first.
    """

    modes: Modes
    number: NDArray[np.intp]
    count: int
    pairs: tuple[tuple[int, int], ...]


def followed_crossings(model: UpdatedModel) -> FollowedCrossings:
    """Follow the critical speeds of a document's model to the updated model, one by one.

    They are numbered in ascending order: where two have passed each other, each takes the other's number, and no trend jumps.

    Source: modal assurance of Allemang and Brown, 1st IMAC, 1982, along a straight line of coefficients.

    Args:
        model: The updated model.

    Returns:
        The crossings that were followed.
    """
    nominal = _nominal(model.machine.model_dump_json())
    begins = [_in_basis(model.basis, one) for one in _single_modes(nominal.modes)]
    way = _ModelPath.between(expected_model(model.machine), model)
    ends = _distinct([way.followed(one) for one in begins], way.mass)
    for place in sorted({place for pair in nominal.pairs for place in pair}):
        if ends[place] is None:
            known = [end for end in ends if end is not None]
            ends[place] = _newly_found_crossing(way.at(1.0), begins[place], known, direction=way.direction)
    found = [end for end in ends if end is not None]
    number = np.array([place for place, end in enumerate(ends) if end is not None], dtype=np.intp)
    return FollowedCrossings(_joined(found, way.mass.shape[0]), number, len(ends), nominal.pairs)


def _distinct(ends: Sequence[Modes | None], mass: Floats) -> list[Modes | None]:
    """Return the felt crossings at which ways end, None for the others; of two ways that end at one, the later went astray."""
    found: list[Modes | None] = []
    for end in ends:
        if end is not None:
            astray = any(other is not None and _coincide(other, end, mass) for other in found)
            end = None if astray or end.damping_ratio[0] >= HEAVILY_DAMPED else end
        found.append(end)
    return found


@dataclass(frozen=True)
class _ModelPath:
    """From one model to another, both of one machine. at: the matrices over speed after a part of the way."""

    at: Callable[[float], MatricesOverSpeed]
    direction: int

    @classmethod
    def between(cls, start: UpdatedModel, end: UpdatedModel) -> "_ModelPath":
        def at(part: float) -> MatricesOverSpeed:
            return replace(end, values=start.values + part * (end.values - start.values)).matrices

        return cls(cache(at), end.machine.direction)

    @property
    def mass(self) -> Floats:
        """Return the mass matrix at the end."""
        return self.at(1.0)(1.0).mass

    def followed(self, mode: Modes) -> Modes | None:
        """Follow a crossing from the beginning to the end; None where it is lost."""
        done, step = 0.0, 1.0
        while done < 1.0:
            reached = min(done + step, 1.0)
            found = corrected_crossing(self.at(reached), mode, direction=self.direction)
            if found is not None and _assurance(mode, found, self.mass) >= SAME_SHAPE:
                mode, done, step = found, reached, 2 * step
            elif step > SMALLEST_STEP:
                step /= 2
            else:
                return None
        return mode


def _newly_found_crossing(matrices: MatricesOverSpeed, like: Modes, known: Sequence[Modes], *, direction: int) -> Modes | None:
    """Find a felt crossing with the deflection line of a mode that is none of those known.

    Equal planes make circles out of which any difference makes lines: no step is small enough for such a mode's shape.
    """
    mass = matrices(like.eigenvalue[0].imag).mass
    line = _deflection_line(like.shape[:, 0], mass)
    for guess in _polarised(line, complex(like.eigenvalue[0])):
        found = corrected_crossing(matrices, guess, direction=direction)
        if found is None or found.damping_ratio[0] >= HEAVILY_DAMPED or any(_coincide(one, found, mass) for one in known):
            continue
        other = _deflection_line(found.shape[:, 0], mass)
        if assurance(line[:, None], other[:, None], _plane(mass))[0, 0] >= ALIKE:
            return found
    return None


def _polarised(line: Complexes, eigenvalue: complex) -> Iterator[Modes]:
    """Place a deflection line (N/2,) in the one plane, in the other, and turning either way."""
    displacement, slope = line[::PLANE_DOFS], line[1::PLANE_DOFS]
    for x, y in ((1.0, 0.0), (0.0, 1.0), (1.0, -1j), (1.0, 1j)):
        shape = np.stack([x * displacement, y * displacement, -y * slope, x * slope], axis=1).reshape(-1, 1)
        yield Modes(np.array([eigenvalue]), shape, np.conj(shape))


@lru_cache(maxsize=CACHE_SIZE)
def _nominal(document: str) -> NominalCrossings:
    """Compute the crossings of a document in JSON, of a machine with exact probes."""
    model = expected_model(Machine.model_validate_json(document))
    direction = model.machine.direction
    highest = HIGHEST_ABOVE_TRIP * rpm_to_rad_per_s(model.machine.speed_range.maximum_rpm)
    basis = _basis(model.matrices(highest / 2), highest)

    @cache
    def condensed(speed: float) -> SystemMatrices:
        return model.matrices(speed).project(basis)

    found: list[Modes] = []
    mass = model.matrices(highest).mass
    for root, _ in crossing_modes(condensed, direction=direction, highest=highest):
        crowd = modes(condensed(root.imag), spin=direction * root.imag)
        nearest = int(np.argmin(np.abs(crowd.eigenvalue - root)))
        if crowd.damping_ratio[nearest] >= HEAVILY_DAMPED:
            continue
        guess = Modes(crowd.eigenvalue[[nearest]], basis @ crowd.shape[:, [nearest]], basis @ crowd.left[:, [nearest]])
        exact = corrected_crossing(model.matrices, guess, direction=direction)
        if exact is not None and any(_coincide(other, exact, mass) for other in found):
            exact = _newly_found_crossing(model.matrices, exact, found, direction=direction)
        if exact is not None:
            found.append(exact)
    joined = _joined(found, mass.shape[0])
    # On the whole mesh: later users need not know the basis in which they were found.
    whole = Modes(joined.eigenvalue, model.basis.expanded(joined.shape), model.basis.expanded(joined.left))
    return NominalCrossings(whole, _pairs(joined, mass))


def _basis(matrices: SystemMatrices, highest: float) -> Floats:
    """Compute undamped modes (N, r) of the symmetric part at standstill, enough for motions below a frequency [rad/s]."""
    stiffness = (matrices.stiffness + matrices.stiffness.T) / 2
    squares, shapes = scipy.linalg.eigh(stiffness, matrices.mass)
    count = SEARCH_MODES + MODES_PER_MODE * int(np.count_nonzero(squares < highest**2))
    return np.asarray(shapes[:, :count])


def _pairs(found: Modes, mass: Floats) -> tuple[tuple[int, int], ...]:
    """Pair modes with the same deflection line, the most alike first, each in one pair at most; ascending."""
    lines = np.array([_deflection_line(shape, mass) for shape in found.shape.T]).T
    pairs: list[tuple[int, int]] = []
    if lines.size:
        alike = np.triu(assurance(lines, lines, _plane(mass)), 1)
        for flat in np.argsort(-alike, axis=None):
            first, second = divmod(int(flat), alike.shape[1])
            taken = {number for pair in pairs for number in pair}
            if alike[first, second] >= ALIKE and not taken & {first, second}:
                pairs.append((first, second))
    return tuple(sorted(pairs))


def _deflection_line(shape: Complexes, mass: Floats) -> Complexes:
    """Compute the common part of a mode's deflections in the two planes, (displacement, slope) per node (N/2,)."""
    x, y, about_x, about_y = (shape[dof::NODE_DOFS] for dof in range(NODE_DOFS))
    planes = np.stack([np.stack([x, about_y], 1).reshape(-1), np.stack([y, -about_x], 1).reshape(-1)], axis=1)
    _, main = np.linalg.eigh(np.conj(planes).T @ _plane(mass) @ planes)
    return np.asarray(planes @ main[:, -1])


def _plane(mass: Floats) -> Floats:
    """Pick from the masses (N, N) those of displacements along x and slopes in that plane (N/2, N/2)."""
    first = np.arange(0, mass.shape[0], NODE_DOFS)
    own = np.stack([first, first + NODE_DOFS - 1], axis=1).reshape(-1)
    return mass[np.ix_(own, own)]


def _assurance(one: Modes, other: Modes, mass: Floats) -> float:
    return float(assurance(one.shape, other.shape, mass)[0, 0])


def _coincide(one: Modes, other: Modes, mass: Floats) -> bool:
    near = abs(one.eigenvalue[0] - other.eigenvalue[0]) <= SAME_ROOT * abs(other.eigenvalue[0])
    return bool(near) and _assurance(one, other, mass) >= SAME_SHAPE


def _in_basis(basis: Basis, found: Modes) -> Modes:
    """Convert modes of the whole mesh to a basis."""
    return Modes(found.eigenvalue, basis.coordinates(found.shape), basis.coordinates(found.left))


def _single_modes(found: Modes) -> list[Modes]:
    return [Modes(found.eigenvalue[[i]], found.shape[:, [i]], found.left[:, [i]]) for i in range(found.eigenvalue.size)]


def _joined(found: Sequence[Modes], size: int) -> Modes:
    """Join single modes of `size` degrees of freedom to one set, by ascending frequency."""
    ascending = sorted(found, key=lambda one: float(one.eigenvalue[0].imag))
    none = np.empty((size, 0), dtype=complex)
    return Modes(
        np.concatenate([np.empty(0, dtype=complex), *(one.eigenvalue for one in ascending)]),
        np.hstack([none, *(one.shape for one in ascending)]),
        np.hstack([none, *(one.left for one in ascending)]),
    )
