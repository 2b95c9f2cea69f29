"""Journals' positions and bearings' loads over speed: the train under gravity in its films, on bearings of any elevation.

The train is condensed to the journals; the unknowns are the journals' positions in their bearings. Newton's method at each
speed starts from the position at the speed above it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tests.film_plant.arrays import Floats, Indices
from tests.film_plant.assembly import DOFS, Matrices, assemble, node_stations
from tests.film_plant.film_table import FilmTable, FilmValues, OutsideTable
from tests.film_plant.tilting_table import bearing_table
from tests.film_plant.train import Train

EASY_SPEED = 10.0
"""Multiple of the highest speed at which the journals stand near the middle, from where they are followed [-]."""
STEP = 0.75
"""Ratio of two speeds from one to the next of which the journals are followed [-]."""
SMALLEST_STEP = 0.995
"""Ratio of two speeds between which no position is looked for any more [-]."""
TOLERANCE = 1e-9
"""Largest last step of Newton's method in clearances [-]."""
MOST_STEPS = 40
"""Most steps of Newton's method, and of the heat balance."""
OIL_TOLERANCE = 1e-7
"""Largest last relative change of a viscosity [-]."""


class NoEquilibrium(ValueError):
    """Raised when no position is found in which the films carry the train."""


@dataclass(frozen=True)
class Equilibrium:
    """Static state at S speeds of n bearings.

    Attributes:
        speed: (S,) [rad/s].
        position: Journals in their bearings (S, n, 2) [m].
        load: Force of the film on the journal (S, n, 2) [N].
        stiffness: (S, n, 2, 2) [N/m]; force on the journal = -K x - C ẋ.
        damping: (S, n, 2, 2) [N s/m].
        viscosity: (S, n) [Pa s].
        way: Way of each journal to the wall, 1 where it touches (S, n) [-].
    """

    speed: Floats
    position: Floats
    load: Floats
    stiffness: Floats
    damping: Floats
    viscosity: Floats
    way: Floats


@dataclass(frozen=True)
class _Films:
    """Films of all bearings at one moment: force (2n,), stiffness of slow motions (2n, 2n), blocks (n, 2, 2) at the 1×."""

    force: Floats
    slow: Floats
    stiffness: Floats
    damping: Floats


class Statics:
    """Static problem of a train."""

    def __init__(self, train: Train, matrices: Matrices | None = None) -> None:
        self.train = train
        self._tables: list[FilmTable] = [bearing_table(one.profile, round(one.slenderness, 6)) for one in train.bearings]
        whole = assemble(train) if matrices is None else matrices
        self._stiffness, self._carried = condensed(whole)
        self._soft = np.array(
            [(0.0, 0.0) if one.pedestal is None else 1.0 / np.array(one.pedestal.stiffness) for one in train.bearings]
        ).ravel()
        self._elevation = train.elevations.ravel()
        # The train was aligned with its weight on the pedestals.
        self._at_rest = self._stiffness @ aligned_elevations(train).ravel() - self._carried
        self._clearance = np.repeat(train.clearances, 2)
        self._last: dict[int, tuple[Floats, FilmValues]] = {}

    def follow(self, speed: Floats) -> Equilibrium:
        """Find the equilibria at speeds (S,) [rad/s], in any order."""
        order = np.argsort(-speed)
        position = np.tile([0.05, -0.05], len(self.train.bearings)) * self._clearance
        # On the way to the highest speed the oil is as warm as half way to the wall there.
        fastest = float(speed[order[0]])
        viscosity = self._oil(fastest, np.tile([0.0, -0.5], len(self.train.bearings)) * self._clearance)
        at = fastest * EASY_SPEED
        position = self._newton(at, viscosity, position)
        position = self._down(at, fastest, position, viscosity, warming=False)[0]
        at, states = fastest, []
        position, viscosity = self._balanced(fastest, viscosity, position)
        for wanted in speed[order]:
            position, viscosity = self._down(at, float(wanted), position, viscosity)
            at = float(wanted)
            states.append((position, viscosity, self._films(at, viscosity, position)))
        back = np.argsort(order)
        return self._gathered(speed, [states[k] for k in back])

    def _down(
        self, at: float, wanted: float, position: Floats, viscosity: Floats, *, warming: bool = True
    ) -> tuple[Floats, Floats]:
        """Follow the journals from one speed down to another, in shorter steps where a long one fails."""
        ratio = STEP
        while at > wanted:
            target = max(wanted, at * ratio)
            try:
                if warming:
                    position, viscosity = self._balanced(target, viscosity, position)
                else:
                    position = self._newton(target, viscosity, position)
                at, ratio = target, STEP
            except NoEquilibrium:
                ratio = np.sqrt(ratio)
                if ratio > SMALLEST_STEP:
                    raise
        return position, viscosity

    def _balanced(self, speed: float, viscosity: Floats, position: Floats) -> tuple[Floats, Floats]:
        """Find position and viscosity that go with each other."""
        for _ in range(MOST_STEPS):
            position = self._newton(speed, viscosity, position)
            due = self._oil(speed, position)
            if np.max(np.abs(np.log(due / viscosity))) < OIL_TOLERANCE:
                return position, due
            viscosity = np.sqrt(viscosity * due)
        raise NoEquilibrium(f"the heat balance does not settle at {speed:.0f} rad/s")

    def _oil(self, speed: float, position: Floats) -> Floats:
        """Viscosities (n,) [Pa s]."""
        ways = [one.way(e) for one, e in zip(self._tables, self._places(position), strict=True)]
        return np.array(
            [one.oil.viscosity(one, speed=speed, eccentricity=way) for one, way in zip(self.train.bearings, ways, strict=True)]
        )

    def _places(self, position: Floats) -> Floats:
        """Positions (n, 2) in clearances."""
        return np.asarray((position / self._clearance).reshape(-1, 2))

    def _films(self, speed: float, viscosity: Floats, position: Floats) -> _Films:
        """The films with the journals at positions (2n,) [m]."""
        size = position.size
        force, slow = np.zeros(size), np.zeros((size, size))
        stiffness, damping = np.zeros((size // 2, 2, 2)), np.zeros((size // 2, 2, 2))
        for k, (bearing, place) in enumerate(zip(self.train.bearings, self._places(position), strict=True)):
            if bearing.own is not None:
                here = slice(2 * k, 2 * k + 2)
                stiffness[k], damping[k] = bearing.own.at(speed)
                slow[here, here] = stiffness[k]
                force[here] = self._at_rest[here] - stiffness[k] @ position[here]
                continue
            film = self._film(k, place)
            unit = bearing.force_unit(viscosity=float(viscosity[k]), speed=speed)
            here = slice(2 * k, 2 * k + 2)
            force[here] = unit * film.force
            slow[here, here] = unit / bearing.clearance * (film.stiffness if film.slow is None else film.slow)
            stiffness[k] = unit / bearing.clearance * film.stiffness
            damping[k] = unit / bearing.clearance / speed * film.damping
        return _Films(force, slow, stiffness, damping)

    def _film(self, number: int, place: Floats) -> FilmValues:
        """Film of a bearing, in its table's units, at a place (2,) [clearances]; the last one, which is asked for again at
        the next speed, is remembered."""
        before, film = self._last.get(number, (None, None))
        if film is None or before is None or before[0] != place[0] or before[1] != place[1]:
            film = self._tables[number].at(place)
            self._last[number] = place, film
        return film

    def _residual(self, films: _Films, position: Floats) -> Floats:
        """Force (2n,) that is missing for equilibrium [N]."""
        place = position + self._elevation - self._soft * (films.force - self._at_rest)
        return np.asarray(self._stiffness @ place - self._carried - films.force)

    def _newton(self, speed: float, viscosity: Floats, position: Floats) -> Floats:
        """Positions (2n,) in equilibrium at given viscosities [m]."""
        films = self._films(speed, viscosity, position)
        for _ in range(MOST_STEPS):
            residual = self._residual(films, position)
            jacobian = self._stiffness @ (np.eye(position.size) + self._soft[:, None] * films.slow) + films.slow
            step = np.asarray(np.linalg.solve(jacobian, -residual), dtype=float)
            position, films = self._stepped(speed, viscosity, position, step)
            if np.max(np.abs(step / self._clearance)) < TOLERANCE:
                return position
        raise NoEquilibrium(f"Newton's method does not end at {speed:.0f} rad/s")

    def _stepped(self, speed: float, viscosity: Floats, position: Floats, step: Floats) -> tuple[Floats, _Films]:
        """Go a step, but by no more than a fifth of a clearance and not out of a table."""
        size = float(np.max(np.abs(step / self._clearance)))
        factor = min(1.0, 0.2 / size) if size > 0.0 else 1.0
        for _ in range(12):
            try:
                return position + factor * step, self._films(speed, viscosity, position + factor * step)
            except OutsideTable:
                factor /= 2
        raise NoEquilibrium(f"a journal runs to the wall of its bearing at {speed:.0f} rad/s")

    def _gathered(self, speed: Floats, states: Sequence[tuple[Floats, Floats, _Films]]) -> Equilibrium:
        """Put the states of all speeds together."""
        n = len(self.train.bearings)
        position = np.array([one for one, _, _ in states]).reshape(-1, n, 2)
        return Equilibrium(
            speed=np.asarray(speed, dtype=float),
            position=position,
            load=np.array([films.force for _, _, films in states]).reshape(-1, n, 2),
            stiffness=np.array([films.stiffness for _, _, films in states]),
            damping=np.array([films.damping for _, _, films in states]),
            viscosity=np.array([one for _, one, _ in states]),
            way=np.array(
                [[self._tables[k].way(row[k] / self.train.bearings[k].clearance) for k in range(n)] for row in position]
            ),
        )


def condensed(matrices: Matrices) -> tuple[Floats, Floats]:
    """Stiffness (2n, 2n) [N/m] and force of gravity (2n,) [N] of the train at its journals."""
    outer = matrices.journals.ravel()
    shafts = np.flatnonzero(~np.isin(np.arange(len(matrices.mass)), matrices.pedestals))
    inner = np.setdiff1d(shafts, outer)
    stiffness = matrices.stiffness
    through = np.linalg.solve(
        stiffness[np.ix_(inner, inner)], np.column_stack([stiffness[np.ix_(inner, outer)], matrices.weight[inner]])
    )
    across = stiffness[np.ix_(outer, inner)]
    kept = stiffness[np.ix_(outer, outer)] - across @ through[:, :-1]
    return kept, matrices.weight[outer] - across @ through[:, -1]


def aligned_elevations(train: Train) -> Floats:
    """Elevations (n, 2) of the bearings at which no coupling carries shear or moment while each shaft rests on its bearings.

    The first shaft's bearings stand at zero [m]. Each shaft needs two bearings.
    """
    found = np.zeros((len(train.bearings), 2))
    end = np.zeros(2)
    for number, shaft in enumerate(train.shafts):
        own = [k for k, one in enumerate(train.bearings) if one.shaft == number]
        start, last = _resting(train, number)
        height, slope = (0.0, 0.0) if number == 0 else end - start
        for k in own:
            found[k, 1] = height + slope * train.bearings[k].station
        end = last + np.array([height + slope * shaft.length, slope])
    return found


def _resting(train: Train, number: int) -> tuple[Floats, Floats]:
    """Deflection and slope in the vertical plane at both ends of a shaft alone that rests on its own bearings."""
    bearings = tuple(one for one in train.bearings if one.shaft == number)
    alone = Train(train.shafts, train.discs, bearings, train.couplings, train.material, train.gravity, train.refinement)
    loose = assemble(alone)
    free = Train(train.shafts, train.discs, bearings, (), train.material, train.gravity, train.refinement)
    stiffness = assemble(free).stiffness
    sizes = _sizes(alone)
    own = np.arange(sizes[number], sizes[number + 1])
    vertical = own[(own % 4) >= 2]
    held = loose.journals[:, 1]
    inner = np.setdiff1d(vertical, held)
    line = np.zeros(len(stiffness))
    line[inner] = np.linalg.solve(stiffness[np.ix_(inner, inner)], loose.weight[inner])
    return line[own[2:4]], line[own[-2:]]


def _sizes(train: Train) -> Indices:
    """First degree of freedom of each shaft, and the number of all."""
    return np.cumsum([0, *(DOFS * len(one) for one in node_stations(train))])
