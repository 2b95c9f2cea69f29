"""A plant: a true train, what is believed of it, and what its probes say."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.assembly import Matrices, assemble
from tests.film_plant.discrepancy import FilmChange
from tests.film_plant.response import eigenvalues, response, smallest_damping_ratio
from tests.film_plant.statics import Equilibrium, Statics
from tests.film_plant.sweep import ReducedTrain, SweepRecord, sweep
from tests.film_plant.train import ConstantOil, Train

RPM = np.pi / 30
"""One revolution per minute [rad/s]."""
NOISE_PART, NOISE_FLOOR = 0.01, 1e-7
"""Noise of a phasor: part of the amplitude [-], and floor [m]; rms of the complex error is the root of the sum of squares."""
HIGHEST_MODE = 1.5
"""Highest frequency of modes whose damping is looked at, as a multiple of the highest speed [-]."""
KEPT_MODE = 8.0
"""Highest frequency of modes between held journals that are kept for that, as a multiple of the highest speed [-]."""
SWEEP_SPEEDS = 80
"""Speeds at which films are solved for a sweep."""


@dataclass(frozen=True)
class Truth:
    """Values that an identification should find, at S speeds of n bearings.

    Attributes:
        films: Loads, positions, stiffness and damping over speed, discrepancies included.
        unbalances: Of the discs (P,) [kg m].
        clearance: (n,) [m].
        viscosity: (n,) over those believed [-].
        elevation: Less that at which no coupling carries anything, x and y (n, 2) [m].
    """

    films: Equilibrium
    unbalances: Complexes
    clearance: Floats
    viscosity: Floats
    elevation: Floats


@dataclass(frozen=True)
class Plant:
    """A simulated plant.

    Attributes:
        name: Its name.
        train: The true train.
        believed: The same as its document would describe it: nominal clearances, oil and elevations.
        slowest: Lowest speed of its runs [rad/s].
        fastest: Highest one [rad/s].
        discrepancy: Of its films' coefficients; None for none.
        absolute: Whether its probes stand on the ground, not on the pedestals.
    """

    name: str
    train: Train
    believed: Train
    slowest: float
    fastest: float
    discrepancy: FilmChange | None = None
    absolute: bool = False

    @cached_property
    def matrices(self) -> Matrices:
        """The true train without its films."""
        return assemble(self.train)

    def films(self, speed: Floats) -> Equilibrium:
        """Compute the true films at speeds (S,) [rad/s]."""
        found = Statics(self.train, self.matrices).follow(speed)
        return found if self.discrepancy is None else self._of_films_only(self.discrepancy.applied(found), found)

    def _of_films_only(self, changed: Equilibrium, found: Equilibrium) -> Equilibrium:
        """The changed coefficients of films, those of other bearings as they were."""
        on_films = np.isin(np.arange(len(self.train.bearings)), self.train.on_films)[:, None, None]
        return replace(
            changed,
            stiffness=np.where(on_films, changed.stiffness, found.stiffness),
            damping=np.where(on_films, changed.damping, found.damping),
        )

    def speeds(self, samples: int) -> Floats:
        """Speeds of a run-down (S,) [rad/s], evenly spaced from the highest on."""
        return np.linspace(self.fastest, self.slowest, samples)

    def truth(self, speed: Floats) -> Truth:
        """The truth at speeds (S,) [rad/s]."""
        return Truth(
            films=self.films(speed),
            unbalances=np.array([disc.unbalance for disc in self.train.discs]),
            clearance=self.train.clearances,
            viscosity=_viscosities(self.train) / _viscosities(self.believed),
            elevation=self.train.elevations - self.believed.elevations,
        )

    def phasors(self, films: Equilibrium) -> Complexes:
        """Steady phasors (S, 2n) [m] at the films' speeds: x and y at each bearing."""
        return response(
            self.matrices,
            speed=films.speed,
            stiffness=films.stiffness,
            damping=films.damping,
            absolute=self.absolute,
        )

    def swept(self, *, rate_rpm_per_s: float, samples: int, kind: Literal["run-down", "run-up"] = "run-down") -> SweepRecord:
        """Phasors without noise of a sweep over the whole range at a rate [r/min per s]; probes stand on the pedestals."""
        films = self.films(np.linspace(self.fastest, self.slowest, SWEEP_SPEEDS))
        first, last = (self.fastest, self.slowest) if kind == "run-down" else (self.slowest, self.fastest)
        return sweep(self.matrices, films, first=first, last=last, rate=rate_rpm_per_s * RPM, samples=samples)

    def damping_ratios(self, speed: Floats) -> Floats:
        """Smallest damping ratio of the train's modes at speeds (S,) [rad/s]; negative where it whirls [-]."""
        films = self.films(speed)
        found = []
        for w, k, c in zip(speed, films.stiffness, films.damping, strict=True):
            values = eigenvalues(self.matrices, speed=float(w), stiffness=k, damping=c)
            found.append(smallest_damping_ratio(values, HIGHEST_MODE * self.fastest))
        return np.array(found)

    def is_damped(self, speed: Floats, *, ratio: float) -> bool:
        """Tell whether all modes are damped by more than a ratio [-] at speeds (S,) [rad/s].

        Modes between held journals far above them are left out: eigenvalues of fewer degrees of freedom cost less.
        """
        films, train = self.films(speed), ReducedTrain(self.matrices, KEPT_MODE * self.fastest)
        return all(
            smallest_damping_ratio(train.eigenvalues(speed=float(w), stiffness=k, damping=c), HIGHEST_MODE * self.fastest)
            > ratio
            for w, k, c in zip(speed, films.stiffness, films.damping, strict=True)
        )

    def with_discrepancy(self, discrepancy: FilmChange) -> "Plant":
        """The same plant with films that differ from their model."""
        return replace(self, discrepancy=discrepancy)


def noisy(clean: Complexes, rng: np.random.Generator, *, part: float = NOISE_PART, floor: float = NOISE_FLOOR) -> Complexes:
    """Add circular complex noise to phasors [m]: a part of the amplitude [-], and a floor [m]."""
    size = np.sqrt((part * np.abs(clean)) ** 2 + floor**2) / np.sqrt(2.0)
    return np.asarray(clean + size * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)))


def _viscosities(train: Train) -> Floats:
    """Viscosities (n,) of constant oils [Pa s], or the factors of oils that are warmed [-]."""
    return np.array(
        [one.oil.value if isinstance(one.oil, ConstantOil) else getattr(one.oil, "factor", np.nan) for one in train.bearings]
    )
