"""Equilibrium of a train on its films over speed: journals' positions, loads, and the films' coefficients there.

The journals' positions in their films shift the supports of the coupled shafts, and so the loads (Pennacchi, Vania and
Chatterton, Mech. Syst. Signal Process. 30 (2012) 306). Newton's method finds where films and shafts agree.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from estimator.arrays import Floats
from estimator.films.film import FilmCoefficients
from estimator.films.pad_table import THINNEST_FILM
from estimator.machine.bearings_on_films import loaded_films
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films, reported_rpm, slowest_rpm
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.statics.alike_bearings import covered, films_at
from estimator.statics.coupled_train import train_statics
from estimator.statics.journal_bearing import JournalBearing, journal_bearing
from estimator.statics.linear_support import LinearSupport, linear_support
from estimator.statics.train_statics import MissingFilm, TrainStatics
from estimator.units import rpm_to_rad_per_s

LARGEST_STEP = 0.2
"""Largest change of a journal's position in one step of Newton's method, in clearances [-]."""
STEPS = 80
"""Most steps of Newton's method."""
SETTLED = 1e-9
"""Largest step, in clearances, at which the method has ended [-]."""
HALVINGS = 20
"""Most times that a step is halved where the forces do not come nearer to equilibrium."""
FIRST_PLACES = ((0.0, -0.3), (0.3, -0.3), (0.0, -0.7), (-0.3, -0.3), (0.0, 0.3), (0.5, 0.0), (-0.5, 0.0), (0.0, 0.0))
"""Places from which equilibria are sought, the same in all bearings, in clearances and for rotation from +x to +y [-]."""
SUPPORT_SCALE = 1e-4
"""Length by which motions of journals are measured that rest in no film [m]: a usual clearance."""
SAME_PLACE = 0.01
"""Distance of positions that are one equilibrium, in clearances [-]."""


@dataclass(frozen=True)
class FilmEquilibrium:
    """Equilibrium at one speed, of n bearings.

    Attributes:
        speed: Spin speed, without sign [rad/s].
        position: Positions (n, 2) of the journals relative to their bearings' centres [m].
        film: Film at each journal, or what carries it in place of one.
    """

    speed: float
    position: Floats
    film: tuple[FilmCoefficients, ...]

    @property
    def force(self) -> Floats:
        """Return the forces (n, 2) of the films on the journals [N]."""
        return np.stack([one.force for one in self.film])

    @property
    def stiffness(self) -> Floats:
        """Return the stiffness K of each film (n, 2, 2) [N/m]."""
        return np.stack([one.stiffness for one in self.film])

    @property
    def damping(self) -> Floats:
        """Return the damping C of each film (n, 2, 2) [N s/m]."""
        return np.stack([one.damping for one in self.film])


@dataclass(frozen=True)
class FilmTrain:
    """A train on oil films, beside which bearings with coefficients of their own may carry it.

    Attributes:
        statics: The train at rest, condensed to its journals.
        bearings: Its n bearings.
        elevation: Positions (n, 2) of the bearings' centres [m].
        scale: Lengths (n,) by which journals' motions are measured, of films their clearances [m].
        reach: Largest step (n,) of each journal in Newton's method; infinite in no film [m].
    """

    statics: TrainStatics
    bearings: tuple[JournalBearing | LinearSupport, ...]
    elevation: Floats
    scale: Floats = field(init=False, repr=False)
    reach: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        clearance = np.array([one.clearance for one in self.bearings])
        object.__setattr__(self, "scale", np.where(np.isfinite(clearance), clearance, SUPPORT_SCALE))
        object.__setattr__(self, "reach", LARGEST_STEP * clearance)

    @property
    def journals(self) -> dict[int, JournalBearing]:
        """Return the bearings on films by their numbers among all."""
        return {number: one for number, one in enumerate(self.bearings) if isinstance(one, JournalBearing)}

    @property
    def supports(self) -> dict[int, LinearSupport]:
        """Return the bearings with coefficients of their own by their numbers among all."""
        return {number: one for number, one in enumerate(self.bearings) if isinstance(one, LinearSupport)}

    def equilibrium(self, speed: float, *, start: Floats | None = None) -> FilmEquilibrium | None:
        """Find the equilibrium at a speed by Newton's method with steps that are halved.

        Source: Pennacchi, Vania and Chatterton, Mech. Syst. Signal Process. 30 (2012) 306.

        Args:
            speed: Spin speed, without sign [rad/s].
            start: Positions (n, 2) to start from, such as those at a speed beside [m]; None for several.

        Returns:
            The equilibrium; None where none is found with films of at least a twentieth of the clearance.
        """
        starts = self._first_places() if start is None else [start, *self._first_places()]
        for one in starts:
            found = self._newton(one, speed)
            if found is not None:
                return found
        return None

    def equilibria(self, speed: float) -> tuple[FilmEquilibrium, ...]:
        """Find the equilibria that lie apart, from all the usual places.

        Source: Pennacchi, Vania and Chatterton, Mech. Syst. Signal Process. 30 (2012) 306.

        Args:
            speed: Spin speed, without sign [rad/s].

        Returns:
            The equilibria, often one.
        """
        found: list[FilmEquilibrium] = []
        for start in self._first_places():
            one = self._newton(start, speed)
            if one is not None and all(self._distance(one.position, other.position) > SAME_PLACE for other in found):
                found.append(one)
        return tuple(found)

    def follow(self, speeds: Floats) -> tuple[FilmEquilibrium | None, ...]:
        """Follow the equilibrium over speeds, from the highest down.

        Args:
            speeds: Spin speeds (S,), without sign [rad/s].

        Returns:
            The equilibrium at each; None where the films are too thin.
        """
        found: list[FilmEquilibrium | None] = [None] * speeds.size
        start: Floats | None = None
        for place in np.argsort(speeds)[::-1].tolist():
            one = found[place] = self.equilibrium(float(speeds[place]), start=start)
            start = one.position if one is not None else start
        return tuple(found)

    def carried(self, position: Floats) -> bool:
        """Return whether no film is thinner than a twentieth of its clearance.

        Args:
            position: Positions (n, 2) of the journals relative to their bearings' centres [m].

        Returns:
            Whether that is so.
        """
        thinnest = [one.thinnest(position[number]) / one.clearance for number, one in self.journals.items()]
        return min(thinnest, default=1.0) >= THINNEST_FILM - 1e-12

    def _first_places(self) -> list[Floats]:
        # A journal on a support of its own begins where it stands aligned.
        wide = np.where(np.isfinite(self.reach), self.scale, 0.0)
        direction = next((one.direction for one in self.journals.values()), 1)
        return [wide[:, None] * np.array([direction * x, y]) for x, y in FIRST_PLACES]

    def _distance(self, one: Floats, other: Floats) -> float:
        return float(np.max(np.linalg.norm(one - other, axis=1) / self.scale))

    def _newton(self, start: Floats, speed: float) -> FilmEquilibrium | None:
        position = self._inside(start)
        films = self._films(position, speed)
        lacking = self._lacking(position, films)
        for _ in range(STEPS):
            step = self._step(films, lacking)
            if np.max(np.linalg.norm(step, axis=1) / self.scale) < SETTLED:
                return FilmEquilibrium(speed, position, tuple(films)) if self.carried(position) else None
            for _ in range(HALVINGS):
                trial = position + step
                if self._covers(trial):
                    trial_films = self._films(trial, speed)
                    trial_lacking = self._lacking(trial, trial_films)
                    if np.linalg.norm(trial_lacking) < np.linalg.norm(lacking):
                        break
                step = step / 2
            else:
                return None
            position, films, lacking = trial, trial_films, trial_lacking
        return None

    def _step(self, films: Sequence[FilmCoefficients], lacking: Floats) -> Floats:
        """Return the step (n, 2) that Newton's method takes, none longer than allowed [m]."""
        whole = self.statics.stiffness.copy()
        for number, one in enumerate(films):
            block = slice(2 * number, 2 * number + 2)
            whole[block, block] += one.static_stiffness
        step = np.linalg.solve(whole, -lacking.reshape(-1)).reshape(-1, 2)
        longest = float(np.max(np.linalg.norm(step, axis=1) / self.reach))
        return np.asarray(step / max(1.0, longest))

    def _lacking(self, position: Floats, films: Sequence[FilmCoefficients]) -> Floats:
        """Return the forces (n, 2) by which films fall short of what the train needs there [N]."""
        return self.statics.film_force(position + self.elevation) - np.stack([one.force for one in films])

    def _films(self, position: Floats, speed: float) -> list[FilmCoefficients]:
        return [one.one_of(0) for one in films_at(self.bearings, position[None], speed=np.array([speed]))]

    def _covers(self, position: Floats) -> bool:
        return bool(covered(self.bearings, position[None])[0])

    def _inside(self, position: Floats) -> Floats:
        """Return positions drawn towards the centres until all films are known there."""
        for _ in range(HALVINGS):
            if self._covers(position):
                return position
            position = position / 2
        return np.zeros_like(position)


def film_train(machine: Machine) -> FilmTrain:
    """Make the films and the statics of a train.

    Args:
        machine: The machine: each of its bearings says what its film is, or some are on films and the others are supports.

    Returns:
        The train on its films.

    Raises:
        MissingFilm: A bearing says nothing of its film.
        UnsupportedShaft: Something would fall although all journals are held.
        InvalidSlenderness: A bearing has an impossible ratio of length to diameter.
    """
    lacking = [one.id for one in machine.bearings if one.film is None]
    if lacking and not follows_films(machine):
        raise MissingFilm(f"static loads need the film of each bearing: {', '.join(lacking)} have none in the document")
    statics = train_statics(machine)
    at_rest = statics.film_force(statics.aligned)
    low, high = slowest_rpm(machine), machine.speed_range.maximum_rpm
    speeds = rpm_to_rad_per_s(low), rpm_to_rad_per_s(high), rpm_to_rad_per_s(reported_rpm(machine)[-1])
    coefficients = unknowns(machine, assemble_rotor(machine)).coefficients
    bearings = tuple(
        linear_support(one.id, one.elevation, load=force, coefficients=coefficients)
        if film is None
        else journal_bearing(one.id, film, direction=machine.direction, load=-force, speeds=speeds)
        for one, film, force in zip(machine.bearings, loaded_films(machine.bearings), at_rest, strict=True)
    )
    return FilmTrain(statics, bearings, statics.aligned + np.array([one.raised for one in bearings]))
