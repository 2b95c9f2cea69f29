"""Clearance, viscosity and elevation of each film, and static loads, as parameters of a fit, and the train that they make.

Each film has a few numbers of its own; a parameter of the fit is one of them, or one that several films share, as those do
whose oil comes from one supply. The stiffness of couplings, of pedestals and of bearings that are no films, which is
identified beside the films, is read: the loads follow from it. Of such bearings the elevation is a parameter here.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.journal import JournalForm
from estimator.bearings.model import ModelParameter
from estimator.bearings.registry import OWN_PARAMETERS
from estimator.machine.film_parameter_names import elevation_names, film_parameter_names, unknown_forces
from estimator.machine.films import StaticLoad
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS
from estimator.statics.coupled_train import CoupledTrain
from estimator.statics.equilibrium import FilmTrain
from estimator.statics.film_sensitivity import PARAMETERS
from estimator.statics.journal_bearing import JournalBearing
from estimator.statics.linear_support import LinearSupport

NUMBERS = (*PARAMETERS, "viscosity_slope")
"""Numbers of each film: logarithms of clearance and viscosity over the document's, elevations [m], slope of the viscosity."""
HELD = 1e-6
"""Spread of the logarithm of what is said to be exact [-]."""


@dataclass(frozen=True)
class FilmParameters:
    """The P numbers that n films follow from: C + L stiffnesses and numbers of supports that are read, then their own
    parameters.

    Attributes:
        train: The train on its films as the document gives them.
        forms: Form of each bearing, which states how far its parameters may be off; None of one that is a support.
        coupled: The train at rest, whose couplings and pedestals may be of other stiffness.
        loads: The m static loads of the document, which state how far they may be off.
    """

    train: FilmTrain
    forms: tuple[JournalForm | None, ...]
    coupled: CoupledTrain
    loads: tuple[StaticLoad, ...] = ()

    @property
    def count(self) -> int:
        """Return the number of numbers P."""
        return len(self.parameters)

    @cached_property
    def read(self) -> tuple[ModelParameter, ...]:
        """Return what is identified of couplings, pedestals and supports, whose coordinates the films read."""
        found = {one.name: one for one in self.coupled.parameters}
        found |= {one.name: one for support in self.train.supports.values() for one in support.parameters}
        return tuple(found.values())

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the stiffnesses read, then the films' own parameters; one that films share stands with the first of them."""
        return tuple(one for one, _ in self._acting)

    @cached_property
    def mixing(self) -> Floats:
        """Return the films' numbers, static loads and stiffnesses (5n + 2m + C + L, P) per unit of each fitted number.

        The numbers are in the order of `NUMBERS` [1 of logarithms, m], the loads along x and y of each [N], the stiffnesses of
        couplings and pedestals as logarithms, those of supports as fitted numbers [-].
        """
        behind = self._of_films + 2 * len(self.loads)
        found = np.zeros((behind + len(self._stiffnesses), self.count))
        for column, (one, places) in enumerate(self._acting):
            found[list(places), column] = 1.0 if places[0] >= behind else one.step
        return found

    @cached_property
    def _stiffnesses(self) -> tuple[str, ...]:
        """Return the names of the C stiffnesses of couplings and pedestals, then of the L numbers of all supports."""
        of_supports = (one.name for support in self.train.supports.values() for one in support.parameters)
        return (*(one.name for one in self.coupled.parameters), *of_supports)

    @cached_property
    def _acting(self) -> tuple[tuple[ModelParameter, tuple[int, ...]], ...]:
        """Return each parameter with the places of the numbers that it gives."""
        behind = self._of_films + 2 * len(self.loads)
        found: dict[str, tuple[ModelParameter, tuple[int, ...]]] = {}
        for one in self.read:
            found[one.name] = one, tuple(behind + k for k, name in enumerate(self._stiffnesses) if name == one.name)
        for number, (bearing, form) in enumerate(zip(self.train.bearings, self.forms, strict=True)):
            for what, one in _of_bearing(bearing, form):
                place = len(NUMBERS) * number + NUMBERS.index(what)
                known, places = found.get(one.name, (one, ()))
                found[one.name] = known, (*places, place)
        for name, (load, component) in unknown_forces(self.loads).items():
            found[name] = _force(name, self.loads[load], component), (self._of_films + 2 * load + component,)
        return tuple(found.values())

    @property
    def _of_films(self) -> int:
        return len(NUMBERS) * len(self.forms)

    @property
    def by_load(self) -> Floats:
        """Return the static loads (2m, P) per unit of each fitted number, along x and y of each [N]."""
        return self.mixing[self._of_films : self._of_films + 2 * len(self.loads)]

    @property
    def exact_forces(self) -> tuple[tuple[str, float, int], ...]:
        """Return the components of static loads that the document calls exact: name, value [N], place among all 2m."""
        unknown = unknown_forces(self.loads)
        named = (
            (f"static_load.{one.id}.force_{axis}", value, 2 * number + component)
            for number, one in enumerate(self.loads)
            for component, (axis, value) in enumerate((("x", one.force_x), ("y", one.force_y)))
        )
        return tuple(one for one in named if one[0] not in unknown)

    def load_changes(self, fitted: Floats) -> Floats:
        """Return by how much static loads differ from those of the document.

        Args:
            fitted: Fitted numbers, those of the films first (...) [-].

        Returns:
            Forces (2m,), along x and y of each load [N].
        """
        centre = np.array([one.centre for one in self.parameters])
        return np.asarray(self.by_load @ (self.of(fitted) - centre))

    def factors(self, fitted: Floats) -> Floats:
        """Return how many times as stiff as the document says couplings and pedestals are.

        Args:
            fitted: Fitted numbers, those of the films first (...) [-].

        Returns:
            Factors (C,) [-].
        """
        return np.asarray(np.exp(fitted[: len(self.coupled.parameters)]))

    def place(self, number: int, what: str) -> int:
        """Return the place of the parameter that gives a number of a film.

        Args:
            number: Number of the film.
            what: Name of the number, one of `NUMBERS`.

        Returns:
            Its place among the parameters.
        """
        wanted = len(NUMBERS) * number + NUMBERS.index(what)
        return next(place for place, (_, places) in enumerate(self._acting) if wanted in places)

    def of(self, fitted: Floats) -> Floats:
        """Return what the films follow from among all numbers of a model.

        Args:
            fitted: Fitted numbers, those of the films first (...) [-].

        Returns:
            Fitted numbers (P,) [-].
        """
        return fitted[: self.count]

    def changed(self, fitted: Floats) -> FilmTrain:
        """Return the train with other films, couplings and pedestals.

        Args:
            fitted: Fitted numbers, those of the films first (...) [-].

        Returns:
            The train.
        """
        numbers = (self.mixing[: self._of_films] @ self.of(fitted)).reshape(-1, len(NUMBERS))
        bearings = tuple(
            _support(one, self.read, fitted) if isinstance(one, LinearSupport) else _changed(one, *row)
            for one, row in zip(self.train.bearings, numbers[:, [0, 1, 4]].tolist(), strict=True)
        )
        said = np.array([one.raised for one in self.train.bearings])
        statics = self.coupled.at(self.factors(fitted)) if self.coupled.parameters else self.train.statics
        if self.loads:
            pushed, slopes = self.load_changes(fitted), statics.slopes
            slopes = replace(slopes, weight=slopes.weight + slopes.by_load @ pushed)
            statics = replace(statics, weight=statics.weight + statics.by_load @ pushed, slopes=slopes)
        return FilmTrain(statics, bearings, self.train.elevation - said + numbers[:, 2:4])

    def by_fitted(self, slopes: Floats, *, speed: Floats) -> Floats:
        """Convert derivatives by the parameters of `film_sensitivity` to those by the fitted numbers.

        Args:
            slopes: Derivatives (G, ..., 4n + 2m + C + L) at some speeds [any unit, per 1, m or N].
            speed: The spin speeds (G,) [rad/s].

        Returns:
            Derivatives (G, ..., P) [any unit].
        """
        of_films, others = np.split(slopes, [len(PARAMETERS) * len(self.forms)], axis=-1)
        each = of_films.reshape(*slopes.shape[:-1], -1, len(PARAMETERS))
        fall = np.zeros((speed.size, len(self.forms)))
        for number, one in self.train.journals.items():
            fall[:, number] = one.oil.by_slope(speed)
        along = fall.reshape(speed.size, *(1 for _ in slopes.shape[1:-1]), -1)
        by_slope = each[..., PARAMETERS.index("viscosity")] * along
        whole = np.concatenate([each, by_slope[..., None]], axis=-1)
        return np.asarray(np.concatenate([whole.reshape(*slopes.shape[:-1], -1), others], axis=-1) @ self.mixing)


def _of_bearing(bearing: JournalBearing | LinearSupport, form: JournalForm | None) -> Iterator[tuple[str, ModelParameter]]:
    """Yield the numbers of a bearing that are fitted here, with the parameters that give them."""
    if isinstance(bearing, LinearSupport):
        yield from _elevations(elevation_names(bearing.name), bearing.raised, bearing.elevation.spread)
    elif form is not None:
        yield from _of_film(bearing, form)


def _of_film(bearing: JournalBearing, form: JournalForm) -> Iterator[tuple[str, ModelParameter]]:
    """Yield the numbers of a film that are fitted, with the parameters that give them."""
    said, names = bearing.described, film_parameter_names(bearing.name, bearing.described, form)
    yield "clearance", _logarithmic(names["clearance"], said.radial_clearance, form.clearance_spread)
    thick = bearing.oil.value if said.oil.supply is None else 1.0
    yield "viscosity", _logarithmic(names["viscosity"], thick, form.viscosity_spread)
    if "viscosity_ratio" in names:
        yield "viscosity", _logarithmic(names["viscosity_ratio"], 1.0, form.viscosity_ratio_spread)
    yield from _elevations(names, bearing.raised, form.elevation_spread)
    if "viscosity_slope" in names:
        spread = form.viscosity_slope_spread
        yield "viscosity_slope", ModelParameter(names["viscosity_slope"], "slope", UNITS["slope"], False, 0.0, 1.0, spread)


def _elevations(names: Mapping[str, str], raised: tuple[float, float], spread: float) -> Iterator[tuple[str, ModelParameter]]:
    for what, value in zip(("elevation_x", "elevation_y"), raised, strict=True):
        yield what, ModelParameter(names[what], "elevation", UNITS["elevation"], False, value, spread or 1e-9, 1.0)


def _force(name: str, load: StaticLoad, component: int) -> ModelParameter:
    value = (load.force_x, load.force_y)[component]
    step = (load.force_x_spread, load.force_y_spread)[component]
    return ModelParameter(name, "force", UNITS["force"], False, value, step, 1.0)


def _logarithmic(name: str, value: float, spread: float) -> ModelParameter:
    own = OWN_PARAMETERS[describe(name).quantity]
    return ModelParameter(name, own.quantity, own.unit, True, value, value, spread or HELD)


def _support(one: LinearSupport, read: Sequence[ModelParameter], fitted: Floats) -> LinearSupport:
    """Return a support with its own of the numbers that are read, which come first."""
    places = {parameter.name: place for place, parameter in enumerate(read)}
    return one.changed(fitted[[places[parameter.name] for parameter in one.parameters]])


def _changed(bearing: JournalBearing, wider: float, thicker: float, slope: float) -> JournalBearing:
    """Return a bearing with other logarithms of clearance and viscosity, and another slope of this."""
    said = bearing.described.model_copy(update={"radial_clearance": bearing.described.radial_clearance * float(np.exp(wider))})
    return replace(bearing, described=said, oil=bearing.oil.changed(factor=float(np.exp(thicker)), slope=slope))
