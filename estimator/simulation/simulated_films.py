"""Oil films of a simulated machine: drawn from what its document believes of them, moved by runs, oil and misalignment."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter
from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.coupling_neighbours import neighbouring_bearings, shafts_behind
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe
from estimator.machine.parts import Coupling
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.statics.film_model import FilmModel, film_model
from estimator.statics.film_parameters import FilmParameters
from estimator.statics.film_stability import least_damped_whirl

DRAWN = 0.5
"""Part of its prior standard deviation by which a film's own numbers are drawn: machines at its ends may whirl [-]."""
DRAWN_ELEVATION = 15e-6
"""Largest standard deviation by which elevations are drawn: documents allow for far more than machines are left with [m]."""
LEAST_DECREMENT = 0.02
"""Least logarithmic decrement, at the highest speed, of a machine that is drawn [-]."""
MOST_DRAWS = 50
VISCOSITY_SCATTER = 0.02
"""Run-to-run scatter of the viscosity of all films together, relative rms [-]."""
ELEVATION_SCATTER = 1e-6
"""Run-to-run scatter of each bearing's elevation, in each direction [m]."""
THINNING = -0.03
"""Change of the logarithm of viscosity with a usual change of a condition, such as 10 K of oil [-]."""
SETTLEMENT = 2.0
"""Distance by which the bearings behind a coupling are lower at the end of the misalignment scenario, in clearances [-]."""


@dataclass(frozen=True)
class SimulatedFilms:
    """Films of a machine, as fitted numbers of their model.

    Attributes:
        model: The model of the films.
        fitted: The numbers (P,) [-].
    """

    model: FilmModel
    fitted: Floats

    def over_speed(self, speed: Floats) -> Floats:
        """Compute the films' coefficients.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            Coefficients (S, 8n), in the order of `coefficients` [SI].
        """
        return self.model.at(speed).values(self.fitted)

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the names of the 8n coefficients."""
        return self.model.coefficients

    @property
    def parameters(self) -> Mapping[str, float]:
        """Return the true values of what an identification determines, by name [SI]."""
        found = zip(self.model.numbers, self.fitted, strict=True)
        return {one.name: float(one.value(number)) for one, number in found if not one.nuisance}

    def of_run(self, rng: np.random.Generator) -> "SimulatedFilms":
        """Draw the films of one run: oil and alignment are never quite the same.

        Args:
            rng: Random generator.

        Returns:
            The films of the run.
        """
        elevations = self._places("elevation")
        moved = ELEVATION_SCATTER * rng.standard_normal(len(elevations)) / self._scale[elevations]
        return self._with(VISCOSITY_SCATTER * rng.standard_normal(), elevations, moved)

    def with_stiffness(self, stiffness: Mapping[str, float]) -> "SimulatedFilms":
        """Return the films of a train with couplings, pedestals and bearings beside them of some stiffness.

        Args:
            stiffness: Their coefficients by name [SI].

        Returns:
            The films.
        """
        fitted = self.fitted.copy()
        fitted[: len(self.model.read)] = _read_numbers(self.model.own, stiffness)
        return replace(self, fitted=fitted)

    def under_conditions(self, change: float) -> "SimulatedFilms":
        """Return the films with thinner oil.

        Args:
            change: Rise of all operating conditions, in usual changes [-].

        Returns:
            The films.
        """
        return self._with(THINNING * change, [], np.zeros(0))

    def settled(self, machine: Machine, coupling: Coupling, progress: float) -> "SimulatedFilms":
        """Return the films with all bearings behind a coupling lowered.

        Args:
            machine: The machine.
            coupling: The coupling.
            progress: Part of the way, from 0 to 1 [-].

        Returns:
            The films.
        """
        behind = shafts_behind(machine, coupling)
        lower = [f"bearing.{one.id}.elevation_y" for one in machine.bearings if one.shaft in behind]
        places = [place for place, one in enumerate(self.model.numbers) if one.name in lower]
        beside = neighbouring_bearings(machine, coupling)
        films = bearings_on_films(machine.bearings)
        near = [one for one in films if one.id in beside] or films
        clearance = min(one.film.radial_clearance for one in near)
        return self._with(0.0, places, -progress * SETTLEMENT * clearance / self._scale[places])

    def _with(self, thicker: float, places: list[int], moved: Floats) -> "SimulatedFilms":
        fitted = self.fitted.copy()
        fitted[self._places("viscosity")] += thicker
        fitted[places] += moved
        return replace(self, fitted=fitted)

    def _places(self, quantity: str) -> list[int]:
        """Return the places of the numbers of a quantity; of the viscosity, its factors too."""
        wanted = ("viscosity", "viscosity_factor") if quantity == "viscosity" else (f"{quantity}_x", f"{quantity}_y")
        return [k for k, one in enumerate(self.model.numbers) if describe(one.name).quantity in wanted]

    @cached_property
    def _scale(self) -> Floats:
        return np.array([one.step for one in self.model.numbers])


def draw_films(machine: Machine, stiffness: Mapping[str, float], rng: np.random.Generator) -> SimulatedFilms | None:
    """Draw the films of a machine near its document.

    Args:
        machine: The machine.
        stiffness: True coefficients by name, which loads follow from [SI].
        rng: Random generator.

    Returns:
        The films; None of a machine whose coefficients do not follow from films.

    Raises:
        ValueError: Of many that were drawn none carries its journals without whirling.
    """
    if not follows_films(machine):
        return None
    model = film_model(machine)
    centre, spread = (np.array([getattr(one, what) for one in model.parameters]) for what in ("centre", "spread"))
    part = np.array([_drawn_part(one) for one in model.parameters])
    given = np.zeros(len(model.read))
    for _ in range(MOST_DRAWS):
        drawn = centre + part * spread * rng.standard_normal(centre.size)
        found = SimulatedFilms(model, np.concatenate([given, drawn])).with_stiffness(stiffness)
        if _runs(machine, found, stiffness):
            return found
    raise ValueError(f"to simulate '{machine.id}': of {MOST_DRAWS} draws of its films none runs without whirling")


def _read_numbers(own: FilmParameters, coefficients: Mapping[str, float]) -> Floats:
    """Return the numbers of what films read that give some coefficients [SI], whatever the speed: of factors on a table those
    by which its direct terms are off."""
    expected = {name: value for one in own.train.supports.values() for name, value in one.expected.items()}
    found = []
    for one in own.read:
        name = one.coefficient or describe(one.name).coefficient
        found.append(one.fitted(coefficients[name] / (1.0 if one.coefficient else expected[name])))
    return np.array(found)


def _drawn_part(parameter: ModelParameter) -> float:
    """Return the part of its prior standard deviation by which a number is drawn."""
    if parameter.nuisance:
        # As the films of the machine deviate, not those of single runs.
        return float(np.sqrt(1.0 - (parameter.between_runs / parameter.spread) ** 2))
    return min(DRAWN, DRAWN_ELEVATION / parameter.step) if parameter.quantity == "elevation" else DRAWN


def _runs(machine: Machine, films: SimulatedFilms, stiffness: Mapping[str, float]) -> bool:
    """Return whether films carry their journals and, as they deviate from their model, damp all modes at the highest speed."""
    found = films.model.films.equilibria(films.fitted)
    if found is None:
        return False
    there = films.over_speed(np.array([found[-1].speed]))[0]
    true = {**stiffness, **dict(zip(films.coefficients, there.tolist(), strict=True))}
    listed = unknowns(machine, assemble_rotor(machine)).coefficients
    coefficients = np.array([true.get(one.name, one.expected) for one in listed])
    mode = least_damped_whirl(machine, found[-1], coefficients=coefficients)
    return mode is not None and mode.log_decrement > LEAST_DECREMENT
