"""Model of all bearings of a train by their oil films: coefficients over speed from clearances, viscosities and elevations.

The loads on the films follow from the statics of the whole train, so that one model gives the coefficients of all bearings.
Equilibria are solved at a few speeds, with exact derivatives; between them coefficients follow splines, in lobed bores the
films where the journals stand, whose positions do (`films_between`). Films of real bearings deviate from any model by some
per cent: each term may be off by a Gaussian process over speed (Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425,
doi:10.1111/1467-9868.00294), whose numbers are fitted with the others and not reported.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.defaults import NeverLevel
from estimator.bearings.model import ModelParameter
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.document import Machine
from estimator.machine.film_speeds import slowest_rpm
from estimator.rotor.identity_cache import cached_without_probes
from estimator.statics.coupled_train import coupled_train
from estimator.statics.equilibrium import film_train
from estimator.statics.film_curves import FilmCurves
from estimator.statics.film_deviations import TERMS, FilmDeviations
from estimator.statics.film_parameters import FilmParameters
from estimator.statics.solved_films import NominalFilms, SolvedFilms
from estimator.units import rpm_to_rad_per_s


@dataclass(frozen=True)
class FilmModel(NeverLevel):
    """The 8n coefficients of n films as functions of their own parameters and of their deviations.

    Bearings beside them that are no films carry loads by coefficients of their own, which other models give.

    Attributes:
        own: Clearance, viscosity and elevation of each film, elevation of each other bearing, and what they read.
        deviations: The films' deviations.
        nominal: The films as the document gives them.
        constant: False.
    """

    own: FilmParameters
    deviations: FilmDeviations
    nominal: NominalFilms
    constant: bool = False

    law: ClassVar[str] = "oil films"

    @cached_property
    def coefficients(self) -> tuple[str, ...]:
        """Return the names of the 8n coefficients."""
        return tuple(f"bearing.{name}.{term}" for name in self.deviations.names for term in TERMS)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the parameters: clearance, viscosity and elevation of each film, then the deviations of each."""
        return self.numbers[len(self.read) :]

    @cached_property
    def read(self) -> tuple[str, ...]:
        """Return the names of what loads follow from and other models have: stiffness of couplings, pedestals and bearings."""
        return tuple(one.name for one in self.own.read)

    @cached_property
    def numbers(self) -> tuple[ModelParameter, ...]:
        """Return the numbers that the curves are functions of: what is read, then the parameters."""
        return (*self.own.parameters, *self.deviations.parameters)

    @cached_property
    def films(self) -> SolvedFilms:
        """Return the films at the speeds at which they are solved.

        Raises:
            FilmTooThin: As the document gives them, there is no equilibrium at one of these speeds.
        """
        return SolvedFilms(self.own, self.nominal)

    def at(self, speed: Floats) -> FilmCurves:
        """Return the curves at some speeds; beyond the document's range they are level.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            The curves.
        """
        return FilmCurves(self.films, self.deviations, np.clip(speed, self.nominal.slowest, self.nominal.fastest))


def film_model(machine: Machine) -> FilmModel:
    """Make the model of a machine's films.

    What follows from the document alone is computed once for a machine; equilibria of other films are sought by each model
    anew, so that what one fit finds does not depend on another.

    Args:
        machine: The machine, bearings of which have a film and the form `journal`.

    Returns:
        The model.

    Raises:
        MissingFilm: A bearing says nothing of its film.
        UnsupportedShaft: Something would fall although all journals are held.
        InvalidSlenderness: A bearing has an impossible ratio of length to diameter.
    """
    return replace(_untouched(machine))


@cached_without_probes
def _untouched(machine: Machine) -> FilmModel:
    """Return a model with which no films but the nominal ones are solved."""
    train = film_train(machine)
    forms = {one.number: one.form for one in bearings_on_films(machine.bearings)}
    slowest, fastest = rpm_to_rad_per_s(slowest_rpm(machine)), rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    names = tuple(one.name for one in train.journals.values())
    return FilmModel(
        FilmParameters(train, tuple(map(forms.get, range(len(train.bearings)))), coupled_train(machine), machine.static_loads),
        FilmDeviations(
            names, tuple(forms.values()), slowest, fastest, run_damping=machine.operation.healthy_variation.damping
        ),
        NominalFilms(train, slowest, fastest),
    )
