"""Equilibria of a train on its films at many speeds at once, by Newton's method with steps that are halved.

Nocedal and Wright, Numerical Optimization, 2006, sec. 11.1 and 11.2.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.films.film import FilmCoefficients
from estimator.statics.alike_bearings import covered, films_at
from estimator.statics.equilibrium import HALVINGS, SETTLED, STEPS, FilmEquilibrium, FilmTrain

LAST_STEP = 1e-5
"""Largest step, in clearances, along which films are taken as linear [-]: what is left out is of the order of its square."""


@dataclass(frozen=True)
class _JournalsOverSpeed:
    """Journals at S speeds.

    Attributes:
        position: Positions (S, n, 2) relative to the bearings' centres [m].
        films: Film of each of the n bearings, at S positions.
        lacking: Forces (S, n, 2) by which films fall short of what the train needs there [N].
    """

    position: Floats
    films: tuple[FilmCoefficients, ...]
    lacking: Floats

    def at(self, place: int) -> tuple[FilmCoefficients, ...]:
        """Return the films at one speed."""
        return tuple(one.one_of(place) for one in self.films)

    def moved(self, step: Floats) -> "_JournalsOverSpeed":
        """Return the journals after a last step (S, n, 2), along which their films are linear [m]."""
        films = tuple(one.moved(step[:, number]) for number, one in enumerate(self.films))
        return _JournalsOverSpeed(self.position + step, films, np.zeros_like(self.lacking))


def equilibria_near(train: FilmTrain, speeds: Floats, start: Floats) -> tuple[FilmEquilibrium, ...] | None:
    """Find the equilibria at some speeds from known positions nearby, such as those of slightly different films.

    Source: Nocedal and Wright, Numerical Optimization, 2006, sec. 11.1 and 11.2.

    Args:
        train: The train on its n films.
        speeds: Spin speeds (S,), without sign [rad/s].
        start: Positions (S, n, 2) of the journals to start from [m].

    Returns:
        The equilibrium at each speed; None where one is not found.
    """
    if not covered(train.bearings, start).all():
        return None
    state = _state(train, speeds, start)
    settled = LAST_STEP if all(one.pads is None for one in state.films) else SETTLED
    for _ in range(STEPS):
        step = _newton_step(train, state)
        if np.max(np.linalg.norm(step, axis=2) / train.scale) < settled:
            state = state.moved(step)
            return tuple(
                FilmEquilibrium(float(speed), state.position[place], state.at(place)) for place, speed in enumerate(speeds)
            )
        moved = _shortened(train, speeds, state, step)
        if moved is None:
            return None
        state = moved
    return None


def _state(train: FilmTrain, speeds: Floats, position: Floats) -> _JournalsOverSpeed:
    films = films_at(train.bearings, position, speed=speeds)
    return _JournalsOverSpeed(position, films, _lacking(train, position, [one.force for one in films]))


def _lacking(train: FilmTrain, position: Floats, forces: Sequence[Floats]) -> Floats:
    absolute = (position + train.elevation).reshape(len(position), -1)
    needed = absolute @ train.statics.stiffness.T - train.statics.weight
    return np.asarray(needed.reshape(position.shape) - np.stack(forces, axis=1))


def _newton_step(train: FilmTrain, state: _JournalsOverSpeed) -> Floats:
    """Return the steps (S, n, 2) of Newton's method, none longer than allowed [m]."""
    count = len(state.position)
    whole = np.repeat(train.statics.stiffness[None], count, axis=0)
    for number, one in enumerate(state.films):
        block = slice(2 * number, 2 * number + 2)
        whole[:, block, block] += one.static_stiffness
    step = np.linalg.solve(whole, -state.lacking.reshape(count, -1, 1)).reshape(state.position.shape)
    longest = np.max(np.linalg.norm(step, axis=2) / train.reach, axis=1)
    return np.asarray(step / np.maximum(1.0, longest)[:, None, None])


def _shortened(train: FilmTrain, speeds: Floats, state: _JournalsOverSpeed, step: Floats) -> _JournalsOverSpeed | None:
    """Return the journals after steps, halved until all stay in the films with smaller residuals; None when none do."""
    part = np.ones(len(step))
    before = np.linalg.norm(state.lacking, axis=(1, 2))
    for _ in range(HALVINGS):
        trial = state.position + part[:, None, None] * step
        inside = covered(train.bearings, trial)
        if inside.all():
            found = _state(train, speeds, trial)
            better = np.linalg.norm(found.lacking, axis=(1, 2)) < before
            # At its end Newton's method lacks nothing but rounding.
            better |= before < 1e-9 * np.linalg.norm(train.statics.weight)
            if better.all():
                return found
            inside = better
        part = np.where(inside, part, part / 2)
    return None
