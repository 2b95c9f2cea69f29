"""Coordinates in which a train is fitted, and the prior that keeps undetermined directions from running away.

Direct terms are fitted as ln(p / expected), so that they stay positive and a factor counts the same up and down; cross-coupled
terms as p / scale; excitations in units of their own scale, real and imaginary part; scale factors of E and ρ as logarithms;
gains of channels as real and imaginary part of their error, run-outs in units of their spread.
"""

from collections.abc import Iterator
from functools import cached_property
from math import sqrt

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.bearings.model import CoefficientModel, ModelParameter, ReadingModel
from estimator.fit.problem.channel_coordinates import ChannelCoordinates
from estimator.fit.problem.placed_models import FollowingCoefficients, PlacedModel
from estimator.fit.problem.prior import Prior, calibrated_prior, variance_between_runs
from estimator.fit.problem.train_models import train_models
from estimator.machine.document import Machine
from estimator.quantities import Quantity
from estimator.rotor.coefficient_models import expects_a_law
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.parameters import Coefficient, Excitation

UNBALANCE_SPREAD = 1000.0
"""Prior standard deviation of an unbalance in units of its scale: enough to make the problem regular, no more."""


class Coordinates(Struct, frozen=True, eq=False, dict=True):
    """Map between physical parameters and fit coordinates θ (n,).

    The train has K coefficients, E excitations and m channels.

    Attributes:
        names: Names of the n coordinates.
        centre: Mean (n,) of the prior on θ [-].
        spread: Standard deviation (n,) of the prior on θ [-].
        origin: Offset (n,) [SI, logarithms of positive ones]: origin + unit·θ is the physical value.
        unit: Unit (n,) of θ [SI, 1 for logarithms].
        logarithmic: True for direct terms (K,).
        expected: Expected value of each coefficient (K,) [SI].
        scale: Scale of each coefficient (K,) [SI].
        place: Coordinate of each constant coefficient (K,); -1 where it is fixed or follows the speed.
        models: Models of the coefficients that follow the speed.
        parameters: Parameters of all models, which are the first coordinates.
        excitation_place: First coordinate of each excitation (E,); -1 where it is fixed.
        excitation_scale: Scale of each excitation (E,) [SI].
        held: Value of each fixed excitation (E,), 0 for the others [SI].
        scale_place: Coordinate of each scale factor (F,).
        channels: Gains and run-outs of the channels.
        quantities: Physical quantity of each of the K coefficients.
        guessed: True for direct terms whose expected value no document gave (K,).
        calibrated: Precision (n, n) of the prior [-] where a calibration gave it, in place of that of `spread`.
        calibrated_places: Indices of the coordinates that the calibration holds.
        between_runs: Part (n,) of the prior's variance by which each varies from run to run of one machine [-].
    """

    names: tuple[str, ...]
    centre: Floats
    spread: Floats
    origin: Floats
    unit: Floats
    logarithmic: NDArray[np.bool_]
    expected: Floats
    scale: Floats
    place: NDArray[np.intp]
    models: tuple[PlacedModel, ...]
    parameters: tuple[ModelParameter, ...]
    excitation_place: NDArray[np.intp]
    excitation_scale: Floats
    held: Complexes
    scale_place: NDArray[np.intp]
    channels: ChannelCoordinates
    quantities: tuple[Quantity, ...]
    guessed: NDArray[np.bool_]
    between_runs: Floats
    calibrated: Floats | None = None
    calibrated_places: tuple[int, ...] = ()

    @classmethod
    def of(cls, train: CondensedTrain, *, unbalance_scale: float) -> "Coordinates":
        """Build coordinates and prior for the unknowns of a train.

        Args:
            train: The condensed train.
            unbalance_scale: Scale of the excitations that have no spread of their own [SI].

        Returns:
            The coordinates.
        """
        found = _CoordinateBuilder(train, unbalance_scale).build()
        return found if train.machine is None else _calibrated(found, train.machine)

    @cached_property
    def nuisance(self) -> NDArray[np.bool_]:
        """Return which coordinates are not reported (n,)."""
        found = np.zeros(self.size, dtype=bool)
        found[: len(self.parameters)] = [one.nuisance for one in self.parameters]
        return found

    @cached_property
    def following(self) -> FollowingCoefficients:
        """Return the coefficients that follow the speed, those at the same knots together."""
        return FollowingCoefficients(self.models)

    @property
    def size(self) -> int:
        """Return the number of coordinates n."""
        return len(self.names)

    @cached_property
    def prior(self) -> Prior:
        """Return the prior on θ."""
        return Prior(self.centre, np.diag(self.spread**-2) if self.calibrated is None else self.calibrated)

    def point(self, theta: Floats) -> Floats:
        """Convert fit coordinates to physical values.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Physical values (n,) [SI, logarithms of positive ones].
        """
        return self.origin + self.unit * theta

    def theta(self, point: Floats) -> Floats:
        """Convert physical values to fit coordinates.

        Args:
            point: Physical values (n,) as `point` returns them [SI, logarithms of positive ones].

        Returns:
            Fit coordinates θ (n,) [-].
        """
        return (point - self.origin) / self.unit

    def at_speeds(self, speed: Floats) -> "Coordinates":
        """Return the same coordinates at other speeds.

        Args:
            speed: Speeds (S,), without sign [rad/s].

        Returns:
            The coordinates.
        """
        curves = {id(one.model): one.model.at(speed) for one in self.models}  # tied ones share their leader's
        return replace(self, models=tuple(replace(one, curves=curves[id(one.model)]) for one in self.models))

    def places(self, coefficient: int) -> range:
        """Return the coordinates of a coefficient.

        Args:
            coefficient: Index of the coefficient.

        Returns:
            Indices of its coordinates: one; those of its model, without what this reads from others; none where it is fixed.
        """
        for one in self.models:
            if coefficient in one.coefficients:
                return one.places
        place = int(self.place[coefficient])
        return range(place, place + 1) if place >= 0 else range(0)

    def coefficients(self, theta: Floats) -> Floats:
        """Compute the physical coefficients.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Coefficients (K,), or (S, K) when one of them follows the speed [SI].
        """
        fixed = np.where(self.logarithmic, 0.0, self.expected / self.scale)
        at = np.where(self.place >= 0, theta[self.place], fixed) if theta.size else fixed
        exponent = np.where(self.logarithmic, at, 0.0)
        constant = np.where(self.logarithmic, self.expected * np.exp(exponent), self.scale * at)
        return self.following.among(constant, theta) if self.models else constant

    def excitations(self, theta: Floats) -> Complexes:
        """Compute the complex excitations.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Excitations (E,) [SI].
        """
        free = self.excitation_place >= 0
        found = self.held.copy()
        first = self.excitation_place[free]
        found[free] = self.excitation_scale[free] * (theta[first] + 1j * theta[first + 1])
        return found

    def scales(self, theta: Floats) -> Floats:
        """Compute the scale factors of Young's moduli E and densities ρ.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Factors (F,) [-].
        """
        return np.exp(theta[self.scale_place])

    def with_coefficients(self, theta: Floats, coefficients: Floats) -> Floats:
        """Return θ with the coordinates of other coefficients, constant over speed.

        Args:
            theta: Fit coordinates θ (n,) [-].
            coefficients: Coefficients (K,) [SI].

        Returns:
            Fit coordinates θ (n,) [-].

        Raises:
            ValueError: A direct term is not positive, or a model's coefficients cannot be constant.
        """
        if np.any(coefficients[self.logarithmic] <= 0):
            raise ValueError("direct terms must be positive")
        positive = np.where(self.logarithmic, coefficients / np.where(self.logarithmic, self.expected, 1.0), 1.0)
        value = np.where(self.logarithmic, np.log(positive), coefficients / self.scale)
        result = theta.copy()
        result[self.place[self.place >= 0]] = value[self.place >= 0]
        for one in self.models:
            if len(one.coefficients) == len(one.model.coefficients):  # a tied one of several has no say
                result[one.first : one.places.stop] = one.model.level(value[list(one.coefficients)])
        return result


def _calibrated(coordinates: Coordinates, machine: Machine) -> Coordinates:
    """Return the coordinates with the calibration's values and joint covariance as the prior of those that it holds."""
    if machine.calibration is None:
        return coordinates
    given = calibrated_prior(
        machine.calibration,
        names=coordinates.names,
        origin=coordinates.origin,
        unit=coordinates.unit,
        between_runs=coordinates.between_runs,
        variation=machine.operation.healthy_variation,
    )
    if given is None:
        return coordinates
    centre, spread, between_runs = coordinates.centre.copy(), coordinates.spread.copy(), coordinates.between_runs.copy()
    centre[given.places], spread[given.places] = given.centre, np.sqrt(np.diag(given.covariance))
    between_runs[given.places] = given.between_runs
    precision = np.diag(spread**-2)
    precision[np.ix_(given.places, given.places)] = given.precision
    held = tuple(given.places.tolist())
    return replace(
        coordinates,
        centre=centre,
        spread=spread,
        between_runs=between_runs,
        calibrated=precision,
        calibrated_places=held,
    )


class _CoordinateBuilder:
    """Collects coordinates one by one."""

    def __init__(self, train: CondensedTrain, unbalance_scale: float) -> None:
        self.train = train
        self.unbalance_scale = unbalance_scale
        self.names: list[str] = []
        self.centre: list[float] = []
        self.spread: list[float] = []
        self.origin: list[float] = []
        self.unit: list[float] = []

    def add(self, name: str, centre: float, spread: float, unit: float, origin: float = 0.0) -> int:
        self.names.append(name)
        self.centre.append(centre)
        self.spread.append(spread)
        self.unit.append(unit)
        self.origin.append(origin)
        return len(self.names) - 1

    def add_pair(self, name: str, spread: float, unit: float, centre: complex = 0j) -> int:
        first = self.add(f"{name}.real", centre.real, spread, unit)
        self.add(f"{name}.imaginary", centre.imag, spread, unit)
        return first

    def build(self) -> Coordinates:
        train = self.train
        coefficients, excitations = train.unknowns.coefficients, train.unknowns.excitations
        parameters, place, models = self._coefficients(coefficients)
        excitation_scale = np.array([e.spread if e.spread is not None else self.unbalance_scale for e in excitations])
        excitation_place = [
            -1 if one.fixed else self._excitation(one, float(scale))
            for one, scale in zip(excitations, excitation_scale, strict=True)
        ]
        scale_place = [self.add(n, 0.0, float(s), 1.0) for n, s in zip(train.scale_names, train.scale_spread, strict=True)]
        gain = self._channels("gain", train.gain_spread)
        run_out = self._channels("run_out", train.run_out_spread)
        unit = np.array(self.unit)
        following = {k for one in models if expects_a_law(one.model) for k in one.coefficients}
        return Coordinates(
            names=tuple(self.names),
            centre=np.array(self.centre),
            spread=np.array(self.spread),
            origin=np.array(self.origin),
            unit=unit,
            logarithmic=np.array([c.direct for c in coefficients], dtype=bool),
            expected=np.array([c.expected for c in coefficients], dtype=float),
            scale=np.array([c.scale for c in coefficients], dtype=float),
            place=place,
            models=models,
            parameters=parameters,
            excitation_place=np.array(excitation_place, dtype=np.intp),
            excitation_scale=excitation_scale,
            held=np.array([(e.nominal or 0j) if e.fixed else 0j for e in excitations], dtype=complex),
            scale_place=np.array(scale_place, dtype=np.intp),
            channels=ChannelCoordinates(gain=gain, run_out=run_out, unit=unit),
            quantities=tuple(c.quantity for c in coefficients),
            guessed=np.array(
                [c.direct and c.nominal is None and k not in following for k, c in enumerate(coefficients)], dtype=bool
            ),
            between_runs=variance_between_runs(parameters, len(self.names)),
        )

    def _excitation(self, one: Excitation, scale: float) -> int:
        if one.spread is None:
            return self.add_pair(one.name, UNBALANCE_SPREAD, scale)
        return self.add_pair(one.name, sqrt(0.5), scale, centre=(one.nominal or 0j) / scale)

    def _coefficients(
        self, coefficients: tuple[Coefficient, ...]
    ) -> tuple[tuple[ModelParameter, ...], NDArray[np.intp], tuple[PlacedModel, ...]]:
        place = np.full(len(coefficients), -1, dtype=np.intp)
        parameters: list[ModelParameter] = []
        models: list[PlacedModel] = []
        for one in train_models(self.train):
            first = len(self.names)
            for parameter in one.model.parameters:
                self.add(parameter.name, parameter.centre, parameter.spread, parameter.step, parameter.origin)
                parameters.append(parameter)
            if one.model.constant:
                place[one.coefficients[0]] = first
            else:
                columns = tuple(range(len(one.coefficients)))
                models.append(PlacedModel(one.model, one.coefficients, columns, first, one.model.at(self.train.speed)))
        models = [replace(one, read=self._read(one.model)) for one in models]
        return tuple(parameters), place, (*models, *_tied(coefficients, place, models))

    def _read(self, model: CoefficientModel) -> tuple[int, ...]:
        return tuple(map(self.names.index, model.read)) if isinstance(model, ReadingModel) else ()

    def _channels(self, what: str, spread: Floats) -> NDArray[np.intp]:
        if spread.size == 0:
            return np.full(len(self.train.channels), -1, dtype=np.intp)
        return np.array(
            [
                self.add_pair(f"probe.{channel}.{what}", sqrt(0.5), float(size)) if size > 0.0 else -1
                for channel, size in zip(self.train.channels, spread, strict=True)
            ],
            dtype=np.intp,
        )


def _tied(coefficients: tuple[Coefficient, ...], place: NDArray[np.intp], models: list[PlacedModel]) -> Iterator[PlacedModel]:
    """Yield models of tied coefficients, with the coordinates of those they are tied to.

    Places of constant ones are filled in.
    """
    index = {one.name: k for k, one in enumerate(coefficients)}
    for k, one in enumerate(coefficients):
        if one.tied_to is None:
            continue
        leader = index[one.tied_to]
        place[k] = place[leader]
        for of in models:
            if leader in of.coefficients:
                yield replace(of, coefficients=(k,), columns=(of.columns[of.coefficients.index(leader)],))
