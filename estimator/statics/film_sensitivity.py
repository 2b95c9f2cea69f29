"""Derivatives of a train's equilibrium on films by clearances, viscosities and elevations.

The journals rest where S (e + p) = w + f(p), with elevations e, positions p and film forces f. So a change of anything moves
them by dp = (S + K)⁻¹ (∂f - S de), K = -∂f/∂p being the films' stiffness against slow motions (implicit function). A film's
force is a function of p/c times μ/c², its coefficients are ones times μ/c³ (Lund, J. Tribol. 109 (1987) 37).
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.films.film import FilmCoefficients
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain

PARAMETERS = ("clearance", "viscosity", "elevation_x", "elevation_y")
"""Parameters of each bearing, in order; clearance and viscosity by their logarithms."""
FORCE_POWER, COEFFICIENT_POWER = -2, -3
"""Powers of the clearance in a film's force and in its coefficients, at the same place in the clearance."""


@dataclass(frozen=True)
class FilmSensitivity:
    """Derivatives by P = 4n parameters: those of `PARAMETERS` of the first bearing, then of the next.

    Attributes:
        position: Of the journals' positions (P, n, 2) [m, or m/m].
        force: Of the film forces (P, n, 2) [N, or N/m].
        stiffness: Of the films' stiffness (P, n, 2, 2) [N/m, or N/m²].
        damping: Of the films' damping (P, n, 2, 2) [N s/m, or N s/m²].
    """

    position: Floats
    force: Floats
    stiffness: Floats
    damping: Floats


def film_sensitivity(train: FilmTrain, found: FilmEquilibrium) -> FilmSensitivity:
    """Compute the derivatives of an equilibrium (implicit function; powers of the clearance as in Lund 1987).

    Args:
        train: The train on its n films.
        found: Its equilibrium at a speed.

    Returns:
        The derivatives.
    """
    count = len(found.film)
    own = [_own_derivatives(film, place) for film, place in zip(found.film, found.position, strict=True)]
    driving = np.zeros((len(PARAMETERS) * count, 2 * count))
    whole = train.statics.stiffness.copy()
    for number, (force, _, _) in enumerate(own):
        block = slice(2 * number, 2 * number + 2)
        whole[block, block] += found.film[number].static_stiffness
        first = len(PARAMETERS) * number
        driving[first : first + 2, block] = force[:2]
        driving[first + 2 : first + 4] = -train.statics.stiffness[:, block].T
    position = np.asarray(np.linalg.solve(whole, driving.T).T.reshape(-1, count, 2), dtype=float)
    static = np.stack([one.static_stiffness for one in found.film])
    force = -np.einsum("nij,pnj->pni", static, position)
    stiffness = np.einsum("nijk,pnk->pnij", np.stack([one.stiffness_slope for one in found.film]), position)
    damping = np.einsum("nijk,pnk->pnij", np.stack([one.damping_slope for one in found.film]), position)
    for number, parts in enumerate(own):
        first = len(PARAMETERS) * number
        for whole_part, part in zip((force, stiffness, damping), parts, strict=True):
            whole_part[first : first + 2, number] += part
    return FilmSensitivity(position, force, stiffness, damping)


def _own_derivatives(film: FilmCoefficients, place: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the derivatives of a film's force (2, 2), stiffness and damping (2, 2, 2) by the logarithms of its own clearance
    and viscosity, the journal staying where it is."""
    force = np.stack([FORCE_POWER * film.force + film.static_stiffness @ place, film.force])
    stiffness = np.stack([COEFFICIENT_POWER * film.stiffness - film.stiffness_slope @ place, film.stiffness])
    damping = np.stack([COEFFICIENT_POWER * film.damping - film.damping_slope @ place, film.damping])
    return force, stiffness, damping
