"""Derivatives of a train's equilibrium on films by clearances, viscosities, elevations, loads and stiffnesses.

Supports of a stiffness of their own take the place of films: neither clearance nor viscosity, but parameters of that.

The journals rest where S (e + p) = w + f(p), with elevations e, positions p and film forces f. So a change of anything moves
them by dp = (S + K)⁻¹ (∂f + ∂w - S de - dS (e + p)), K = -∂f/∂p being the films' stiffness against slow motions (implicit
function). A film's force is a function of p/c times μ/c², its coefficients are ones times μ/c³ (Lund, J. Tribol. 109 (1987)
37).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain

PARAMETERS = ("clearance", "viscosity", "elevation_x", "elevation_y")
"""Parameters of each bearing, in order; clearance and viscosity by their logarithms."""
FORCE_POWER, COEFFICIENT_POWER = -2, -3
"""Powers of the clearance in a film's force and in its coefficients, at the same place in the clearance."""


@dataclass(frozen=True)
class FilmSensitivity:
    """Derivatives at S speeds by P = 4n + 2m + C + L parameters: those of `PARAMETERS` of each bearing, then static loads in x
    and y, then logarithms of the stiffnesses of couplings and pedestals, then fitted numbers of bearings that are supports.

    Attributes:
        position: Of the journals' positions (S, P, n, 2) [m, or m/m].
        force: Of the film forces (S, P, n, 2) [N, or N/m].
        stiffness: Of the films' stiffness (S, P, n, 2, 2) [N/m, or N/m²].
        damping: Of the films' damping (S, P, n, 2, 2) [N s/m, or N s/m²].
    """

    position: Floats
    force: Floats
    stiffness: Floats
    damping: Floats


def film_sensitivity(train: FilmTrain, found: Sequence[FilmEquilibrium]) -> FilmSensitivity:
    """Compute the derivatives of equilibria (implicit function; powers of the clearance as in Lund 1987).

    Source: own derivation: implicit function, in the module's docstring; powers of the clearance as in Lund, J. Tribol. 109
    (1987) 37.

    Args:
        train: The train on its n films.
        found: Its equilibria at S speeds.

    Returns:
        The derivatives.
    """
    speeds, count = len(found), len(train.bearings)
    place = np.stack([one.position for one in found])
    force, static, stiffness, damping, stiffness_slope, damping_slope = (
        np.array([[getattr(film, name) for film in one.film] for one in found])
        for name in ("force", "static_stiffness", "stiffness", "damping", "stiffness_slope", "damping_slope")
    )
    # By the logarithms of a film's own clearance and viscosity, its journal staying where it is (S, n, 2, …).
    own_force = np.stack([FORCE_POWER * force + np.einsum("snij,snj->sni", static, place), force], axis=2)
    own_force[:, list(train.supports)] = 0.0
    by_load, slopes = train.statics.by_load, train.statics.slopes
    absolute = (place + train.elevation).reshape(speeds, -1)
    by_stiffness = slopes.weight - np.einsum("cij,sj->sci", slopes.stiffness, absolute)
    of_films = np.zeros((speeds, len(PARAMETERS) * count, 2 * count))
    loads = np.broadcast_to(by_load.T, (speeds, *by_load.T.shape))
    softer = _softened(train, found)
    driving = np.concatenate([of_films, loads, by_stiffness, softer.reshape(*softer.shape[:2], 2 * count)], axis=1)
    whole = np.repeat(train.statics.stiffness[None], speeds, axis=0)
    for number in range(count):
        block, first = slice(2 * number, 2 * number + 2), len(PARAMETERS) * number
        whole[:, block, block] += static[:, number]
        driving[:, first : first + 2, block] = own_force[:, number]
        driving[:, first + 2 : first + 4] = -train.statics.stiffness[:, block].T
    moved = np.linalg.solve(whole, driving.swapaxes(1, 2)).swapaxes(1, 2)
    position = np.asarray(moved.reshape(speeds, -1, count, 2), dtype=float)
    moving = -np.einsum("snij,spnj->spni", static, position)
    for number in range(count):
        first = len(PARAMETERS) * number
        moving[:, first : first + 2, number] += own_force[:, number]
    moving[:, moving.shape[1] - softer.shape[1] :] += softer
    both = ((stiffness, stiffness_slope), (damping, damping_slope))
    return FilmSensitivity(position, moving, *(coefficient_slopes(*one, place=place, position=position) for one in both))


def _softened(train: FilmTrain, found: Sequence[FilmEquilibrium]) -> Floats:
    """Return the derivatives (S, L, n, 2) of the forces of supports by their own numbers, journals staying where they are."""
    speed = np.array([one.speed for one in found])
    parts = [np.zeros((speed.size, 0, len(train.bearings), 2))]
    for number, support in train.supports.items():
        place = np.stack([one.position[number] for one in found])
        part = np.zeros((speed.size, len(support.parameters), len(train.bearings), 2))
        part[:, :, number] = -np.einsum("slij,sj->sli", support.stiffness_slopes(speed), place)
        parts.append(part)
    return np.concatenate(parts, axis=1)


def coefficient_slopes(value: Floats, slope: Floats, *, place: Floats, position: Floats) -> Floats:
    """Compute the derivatives of stiffness or damping where journals stand (powers of the clearance as in Lund 1987).

    Args:
        value: The coefficients (S, n, 2, 2) of n films at S speeds [SI].
        slope: Their derivatives (S, n, 2, 2, 2) by the journal's position, whose component is the last axis [SI per m].
        place: The journals' positions (S, n, 2) [m].
        position: Derivatives (S, P, n, 2) of the positions by the parameters of `FilmSensitivity` [m, or m/m].

    Returns:
        Derivatives (S, P, n, 2, 2) by these parameters [SI].
    """
    # By the logarithms of a film's own clearance and viscosity, its journal staying where it is.
    own = np.stack([COEFFICIENT_POWER * value - np.einsum("snijk,snk->snij", slope, place), value], axis=2)
    found = np.einsum("snijk,spnk->spnij", slope, position)
    for number in range(place.shape[1]):
        first = len(PARAMETERS) * number
        found[:, first : first + 2, number] += own[:, number]
    return np.asarray(found)
