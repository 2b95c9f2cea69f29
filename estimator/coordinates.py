"""The coordinates in which a train is fitted, and the prior that keeps undetermined directions from running away.

Direct terms are fitted as ln(p / expected), so that they stay positive and a factor counts the same up and down;
cross-coupled terms as p / scale; excitations in units of their own scale, real and imaginary part; scale factors of E and ρ
as logarithms; gains of channels as real and imaginary part of their error, run-outs in units of their spread.
"""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from estimator.condensation import Complexes, CondensedTrain, Floats
from estimator.machine import SpeedDependence
from estimator.parameters import Coefficient, Excitation, Quantity
from estimator.sensitivity import Sensitivity

KNOWN_SPREAD = log(10.0)
"""Prior standard deviation of the logarithm of a direct term whose nominal value the document gives: a factor of 10."""
UNKNOWN_SPREAD = log(1000.0)
"""The same where the document gives none."""
CROSS_SPREAD = 10.0
"""Prior standard deviation of a cross-coupled term in units of its element's direct terms."""
UNBALANCE_SPREAD = 1000.0
"""Prior standard deviation of an unbalance in units of its scale: enough to make the problem regular, no more."""


@dataclass(frozen=True)
class FollowsSpeed:
    """A coefficient that follows the speed: its coordinates are the `count` from `first` on, at each speed mixed by weights.

    weight: (S, count). speeds: (count,) the knots [r/min].
    """

    coefficient: int
    first: int
    weight: Floats
    speeds: tuple[float, ...]


@dataclass(frozen=True)
class Coordinates:
    """The map between physical parameters and fit coordinates θ (n,).

    names: of the coordinates. centre, spread: mean and standard deviation of the prior on θ. origin, unit: origin + unit·θ
    is the value in SI, of positive ones its logarithm. Of the coefficients (K,): logarithmic, True for direct terms;
    expected, scale in SI; place, the first coordinate of each, -1 where it is fixed; follows, those that follow the speed.
    Of the excitations (E,): excitation_place, -1 where fixed; excitation_scale; held, the value of those that are fixed.
    scale_place (F,), gain_place and run_out_place (m,): coordinate of each, -1 where it is taken as exact. quantities: (K,)
    what each coefficient is; guessed: (K,) True for direct terms whose expected value no document gave.
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
    follows: tuple[FollowsSpeed, ...]
    excitation_place: NDArray[np.intp]
    excitation_scale: Floats
    held: Complexes
    scale_place: NDArray[np.intp]
    gain_place: NDArray[np.intp]
    run_out_place: NDArray[np.intp]
    quantities: tuple[Quantity, ...]
    guessed: NDArray[np.bool_]

    @classmethod
    def of(cls, train: CondensedTrain, *, unbalance_scale: float) -> "Coordinates":
        """Coordinates and prior for the unknowns of a train."""
        return _CoordinateBuilder(train, unbalance_scale).build()

    @property
    def size(self) -> int:
        """n."""
        return len(self.names)

    @property
    def channel_count(self) -> int:
        """Number of coordinates that belong to channels, which a prior keeps small."""
        return 2 * int(np.count_nonzero(self.gain_place >= 0) + np.count_nonzero(self.run_out_place >= 0))

    def point(self, theta: Floats) -> Floats:
        """Physical values (n,) over the coordinates: logarithms of positive ones, everything else in SI."""
        return self.origin + self.unit * theta

    def theta(self, point: Floats) -> Floats:
        """Fit coordinates (n,) of physical values as `point` gives them."""
        return (point - self.origin) / self.unit

    def places(self, coefficient: int) -> range:
        """Coordinates of a coefficient: one, or one per knot, or none where it is fixed."""
        for one in self.follows:
            if one.coefficient == coefficient:
                return range(one.first, one.first + one.weight.shape[1])
        place = int(self.place[coefficient])
        return range(place, place + 1) if place >= 0 else range(0)

    def coefficients(self, theta: Floats) -> Floats:
        """Physical coefficients [SI]: (K,), or (S, K) when one of them follows the speed."""
        at = np.where(self.place >= 0, theta[self.place], self._fixed) if theta.size else self._fixed
        if self.follows:
            at = np.repeat(at[None, :], len(self.follows[0].weight), axis=0)
            for one in self.follows:
                at[:, one.coefficient] = one.weight @ theta[one.first : one.first + one.weight.shape[1]]
        exponent = np.where(self.logarithmic, at, 0.0)
        return np.where(self.logarithmic, self.expected * np.exp(exponent), self.scale * at)

    def excitations(self, theta: Floats) -> Complexes:
        """Complex excitations (E,) [SI]."""
        free = self.excitation_place >= 0
        found = self.held.copy()
        first = self.excitation_place[free]
        found[free] = self.excitation_scale[free] * (theta[first] + 1j * theta[first + 1])
        return found

    def scales(self, theta: Floats) -> Floats:
        """Scale factors (F,) of E and ρ [-]."""
        return np.exp(theta[self.scale_place])

    def gains(self, theta: Floats) -> Complexes:
        """Gain (m,) of each channel [-]: measured over true."""
        return np.asarray(1.0 + self._pairs(theta, self.gain_place))

    def run_outs(self, theta: Floats) -> Complexes:
        """Run-out (m,) of each channel in rotation from +x to +y [m]."""
        return self._pairs(theta, self.run_out_place)

    def with_coefficients(self, theta: Floats, coefficients: Floats) -> Floats:
        """θ with the coordinates of coefficients (K,), constant over speed. Raises ValueError for a direct term <= 0."""
        if np.any(coefficients[self.logarithmic] <= 0):
            raise ValueError("direct terms must be positive")
        positive = np.where(self.logarithmic, coefficients / np.where(self.logarithmic, self.expected, 1.0), 1.0)
        value = np.where(self.logarithmic, np.log(positive), coefficients / self.scale)
        result = theta.copy()
        result[self.place[self.place >= 0]] = value[self.place >= 0]
        for one in self.follows:
            result[one.first : one.first + one.weight.shape[1]] = value[one.coefficient]
        return result

    def jacobian(self, theta: Floats, found: Sensitivity, coefficients: Floats, direction: Floats, block: slice) -> Complexes:
        """∂ phasor/∂θ (n, S, m) for some of the speeds, from the derivatives by physical parameters there."""
        whole = np.zeros((self.size, *found.phasor.shape), dtype=complex)
        slope = np.where(self.logarithmic, coefficients, self.scale)
        slope = slope[:, None, None] if slope.ndim == 1 else slope[block].T[:, :, None]
        by_coefficient = found.by_coefficient * slope
        free = self.place >= 0
        for k in np.flatnonzero(free):
            whole[self.place[k]] += by_coefficient[k]  # tied coefficients share a coordinate
        for one in self.follows:
            for knot in range(one.weight.shape[1]):
                whole[one.first + knot] += one.weight[block, knot, None] * by_coefficient[one.coefficient]
        for column in np.flatnonzero(self.excitation_place >= 0):
            first = self.excitation_place[column]
            whole[first : first + 2] = self.excitation_scale[column] * found.by_excitation[2 * column : 2 * column + 2]
        whole[self.scale_place] = found.by_scale
        whole *= self.gains(theta)
        for channel in np.flatnonzero(self.gain_place >= 0):
            first = self.gain_place[channel]
            whole[first, :, channel] = self.unit[first] * found.phasor[:, channel]
            whole[first + 1, :, channel] = 1j * self.unit[first] * found.phasor[:, channel]
        for channel in np.flatnonzero(self.run_out_place >= 0):
            first = self.run_out_place[channel]
            whole[first, :, channel] = self.unit[first]
            whole[first + 1, :, channel] = 1j * self.unit[first] * direction
        return whole

    @property
    def _fixed(self) -> Floats:
        """Coordinate of each coefficient (K,) at its expected value."""
        return np.where(self.logarithmic, 0.0, self.expected / self.scale)

    def _pairs(self, theta: Floats, place: NDArray[np.intp]) -> Complexes:
        found = np.zeros(place.size, dtype=complex)
        first = place[place >= 0]
        found[place >= 0] = self.unit[first] * (theta[first] + 1j * theta[first + 1])
        return found


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
        place, follows = self._coefficients(coefficients)
        excitation_scale = np.array([e.spread if e.spread is not None else self.unbalance_scale for e in excitations])
        excitation_place = [
            -1 if one.fixed else self._excitation(one, float(scale))
            for one, scale in zip(excitations, excitation_scale, strict=True)
        ]
        scale_place = [self.add(n, 0.0, float(s), 1.0) for n, s in zip(train.scale_names, train.scale_spread, strict=True)]
        gain_place = self._channels("gain", train.gain_spread)
        run_out_place = self._channels("run_out", train.run_out_spread)
        return Coordinates(
            names=tuple(self.names),
            centre=np.array(self.centre),
            spread=np.array(self.spread),
            origin=np.array(self.origin),
            unit=np.array(self.unit),
            logarithmic=np.array([c.direct for c in coefficients], dtype=bool),
            expected=np.array([c.expected for c in coefficients], dtype=float),
            scale=np.array([c.scale for c in coefficients], dtype=float),
            place=place,
            follows=follows,
            excitation_place=np.array(excitation_place, dtype=np.intp),
            excitation_scale=excitation_scale,
            held=np.array([(e.nominal or 0j) if e.fixed else 0j for e in excitations], dtype=complex),
            scale_place=np.array(scale_place, dtype=np.intp),
            gain_place=gain_place,
            run_out_place=run_out_place,
            quantities=tuple(c.quantity for c in coefficients),
            guessed=np.array([c.direct and c.nominal is None for c in coefficients], dtype=bool),
        )

    def _excitation(self, one: Excitation, scale: float) -> int:
        if one.spread is None:
            return self.add_pair(one.name, UNBALANCE_SPREAD, scale)
        return self.add_pair(one.name, sqrt(0.5), scale, centre=(one.nominal or 0j) / scale)

    def _coefficients(self, coefficients: tuple[Coefficient, ...]) -> tuple[NDArray[np.intp], tuple[FollowsSpeed, ...]]:
        place = np.full(len(coefficients), -1, dtype=np.intp)
        follows: list[FollowsSpeed] = []
        for k, one in enumerate(coefficients):
            if one.fixed or one.tied_to is not None:
                continue
            unit, origin = (1.0, log(one.expected)) if one.direct else (one.scale, 0.0)
            centre = 0.0 if one.direct else one.expected / one.scale
            if one.speed_dependence is None:
                place[k] = self.add(one.name, centre, _spread(one), unit, origin)
                continue
            knots = one.speed_dependence.knots_rpm
            first = min([self.add(f"{one.name}@{knot:g}rpm", centre, _spread(one), unit, origin) for knot in knots])
            follows.append(FollowsSpeed(k, first, knot_weights(one.speed_dependence, self.train.speed), knots))
        return self._tied(coefficients, place, follows)

    @staticmethod
    def _tied(
        coefficients: tuple[Coefficient, ...], place: NDArray[np.intp], follows: list[FollowsSpeed]
    ) -> tuple[NDArray[np.intp], tuple[FollowsSpeed, ...]]:
        index = {one.name: k for k, one in enumerate(coefficients)}
        leaders = {one.coefficient: one for one in follows}
        for k, one in enumerate(coefficients):
            if one.tied_to is None:
                continue
            leader = index[one.tied_to]
            place[k] = place[leader]
            if leader in leaders:
                of = leaders[leader]
                follows.append(FollowsSpeed(k, of.first, of.weight, of.speeds))
        return place, tuple(follows)

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


def knot_weights(dependence: SpeedDependence, speed: Floats) -> Floats:
    """Weights (S, knots) with which the values at the knots make the value at each speed [rad/s]."""
    knots = np.array(dependence.knots_rpm) * pi / 30.0
    unit = np.eye(knots.size)
    if dependence.form == "piecewise":
        return np.stack([np.interp(speed, knots, row) for row in unit], axis=1)
    # Lagrange's polynomials, one per knot.
    return np.stack(
        [np.prod([(speed - other) / (own - other) for other in knots if other != own], axis=0) for own in knots],
        axis=1,
    )


def _spread(coefficient: Coefficient) -> float:
    if coefficient.spread is not None:
        # A part of nothing is no spread: a cross-coupled term of zero is measured by the direct terms beside it.
        part = 1.0 if coefficient.direct else abs(coefficient.expected) / coefficient.scale or 1.0
        return coefficient.spread * part
    if not coefficient.direct:
        return CROSS_SPREAD
    return UNKNOWN_SPREAD if coefficient.nominal is None else KNOWN_SPREAD
