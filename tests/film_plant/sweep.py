"""Sweeps integrated in time: 1× phasors as a tracking filter sees them while the speed changes, coefficients following it.

With q = Re(z e^{jφ}), φ the shaft's angle, ω = φ̇ and α = ω̇, the envelope z obeys exactly

    M z̈ + (C + ωG + 2jωM) ż + (K - ω²M + jαM + jω(C + ωG)) z = (ω² - jα) u,

which is integrated by Newmark's rule of constant mean acceleration, step by step: no modes of the running train are used, so
that their corrections can be judged by it. The train is reduced to its journals and pedestals and to shafts' modes between
held journals (Craig and Bampton, AIAA J. 6 (1968) 1313). Left out: the moment that speeding up a tilted disc takes, α I_p θ.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.interpolate import CubicSpline

from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.assembly import Matrices
from tests.film_plant.response import eigenvalues_of
from tests.film_plant.statics import Equilibrium

HIGHEST_MODE = 15.0
"""Highest frequency of the modes between held journals, as a multiple of the highest speed [-]."""
LEAD_S = 4.0
"""Time before the first sample during which the sweep is already under way [s]."""


@dataclass(frozen=True)
class SweepRecord:
    """Phasors along a sweep at S samples and 2n probes, x and y at each bearing.

    Attributes:
        time: (S,) [s].
        speed: (S,) [rad/s].
        instant: Envelope at the samples (S, 2n) [m].
        averaged: Its mean from halfway after the sample before to halfway to the next (S, 2n) [m].
        steady: Phasors of steady running at the same speeds (S, 2n) [m].
    """

    time: Floats
    speed: Floats
    instant: Complexes
    averaged: Complexes
    steady: Complexes


class ReducedTrain:
    """A train over its journals' and pedestals' motion and its shafts' modes between held journals.

    Args:
        matrices: The train without films.
        highest: Highest frequency of modes that are kept [rad/s].
    """

    def __init__(self, matrices: Matrices, highest: float) -> None:
        kept = np.concatenate([matrices.journals.ravel(), matrices.pedestals[matrices.pedestals >= 0]])
        inner = np.setdiff1d(np.arange(len(matrices.mass)), kept)
        symmetric = (matrices.stiffness + matrices.stiffness.T) / 2
        within = symmetric[np.ix_(inner, inner)]
        square, modes = scipy.linalg.eigh(within, matrices.mass[np.ix_(inner, inner)], subset_by_value=(-np.inf, highest**2))
        held = -np.linalg.solve(within, symmetric[np.ix_(inner, kept)])
        basis = np.zeros((len(matrices.mass), kept.size + square.size))
        basis[kept, np.arange(kept.size)] = 1.0
        basis[np.ix_(inner, np.arange(kept.size))] = held
        basis[np.ix_(inner, kept.size + np.arange(square.size))] = modes
        self.mass, self.damping, self.gyroscopic, self.stiffness = (
            basis.T @ one @ basis for one in (matrices.mass, matrices.damping, matrices.gyroscopic, matrices.stiffness)
        )
        self.unbalance = basis.T @ matrices.unbalance
        self.turning = basis.T @ matrices.turning
        stands = matrices.pedestals.ravel()
        self.relative = basis[matrices.journals.ravel()] - np.where((stands >= 0)[:, None], basis[stands], 0.0)

    def with_films(self, stiffness: Floats, damping: Floats) -> tuple[Floats, Floats]:
        """Stiffness and damping with films' coefficients (n, 2, 2)."""
        whole = self.stiffness + self.relative.T @ scipy.linalg.block_diag(*stiffness) @ self.relative
        return whole, self.damping + self.relative.T @ scipy.linalg.block_diag(*damping) @ self.relative

    def eigenvalues(self, *, speed: float, stiffness: Floats, damping: Floats) -> Complexes:
        """Eigenvalues [rad/s] at a speed [rad/s] with coefficients (n, 2, 2)."""
        whole, slowed = self.with_films(stiffness, damping)
        return eigenvalues_of(self.mass, whole, slowed + speed * self.gyroscopic)

    def steady(self, speed: float, stiffness: Floats, damping: Floats) -> Complexes:
        """Motion in steady running at a speed [rad/s] with coefficients (n, 2, 2)."""
        whole, slowed = self.with_films(stiffness, damping)
        dynamic = whole - speed**2 * self.mass + 1j * speed * (slowed + speed * self.gyroscopic)
        return np.asarray(np.linalg.solve(dynamic, speed**2 * self.unbalance + self.turning))


def sweep(
    matrices: Matrices, films: Equilibrium, *, first: float, last: float, rate: float, samples: int, step: float = 4e-3
) -> SweepRecord:
    """Integrate a sweep with constant acceleration.

    Args:
        matrices: The train without films.
        films: Films at speeds that cover the sweep, dense enough for splines between them.
        first: Speed at the first sample [rad/s].
        last: Speed at the last one [rad/s].
        rate: Size of the acceleration [rad/s²].
        samples: Number of samples S, evenly spaced.
        step: Time of a step, at most [s].

    Returns:
        The phasors.
    """
    duration = abs(last - first) / rate
    acceleration = np.sign(last - first) * rate
    between = 2 * int(np.ceil(duration / (samples - 1) / step / 2))
    step = duration / (samples - 1) / between
    lead = int(np.ceil(LEAD_S / step))
    time = np.asarray(step * np.arange(-lead, between * (samples - 1) + between // 2 + 1), dtype=float)
    speed = np.asarray(np.maximum(first + acceleration * time, 0.05 * min(first, last)), dtype=float)
    train = ReducedTrain(matrices, HIGHEST_MODE * max(first, last))
    stiffness, damping = films_between(films, speed)
    seen = _envelope(train, speed, acceleration, step, stiffness, damping) @ train.relative.T
    place = lead + between * np.arange(samples)
    steady = np.array([train.relative @ train.steady(speed[k], stiffness[k], damping[k]) for k in place])
    sums = np.concatenate([np.zeros((1, seen.shape[1])), np.cumsum((seen[1:] + seen[:-1]) / 2, axis=0)])
    half = between // 2
    averaged = (sums[place + half] - sums[place - half]) / between
    return SweepRecord(time[place], speed[place], seen[place], averaged, steady)


def films_between(films: Equilibrium, speed: Floats) -> tuple[Floats, Floats]:
    """Stiffness and damping (S, n, 2, 2) at speeds (S,) [rad/s] between those of films, level beyond them."""
    order = np.argsort(films.speed)
    known = films.speed[order]
    inside = np.clip(speed, known[0], known[-1])
    return CubicSpline(known, films.stiffness[order])(inside), CubicSpline(known, films.damping[order])(inside)


def _envelope(
    train: ReducedTrain, speed: Floats, acceleration: float, step: float, stiffness: Floats, damping: Floats
) -> Complexes:
    """Envelope of the reduced motion at each step, from steady running at the first."""
    found = np.empty((speed.size, len(train.mass)), dtype=complex)
    found[0] = train.steady(speed[0], stiffness[0], damping[0])
    velocity, second = np.zeros((2, len(train.mass)), dtype=complex)
    for k in range(1, speed.size):
        w = speed[k]
        whole, slowed = train.with_films(stiffness[k], damping[k])
        turning = slowed + w * train.gyroscopic
        damped = turning + 2j * w * train.mass
        held = whole - w**2 * train.mass + 1j * (acceleration * train.mass + w * turning)
        ahead = found[k - 1] + step * velocity + step**2 / 4 * second
        faster = velocity + step / 2 * second
        force = (w**2 - 1j * acceleration) * train.unbalance + train.turning
        second = np.linalg.solve(train.mass + step / 2 * damped + step**2 / 4 * held, force - damped @ faster - held @ ahead)
        velocity = faster + step / 2 * second
        found[k] = ahead + step**2 / 4 * second
    return found
