"""Films of a train at the few speeds at which their equilibria are solved, with exact derivatives.

Splines between them: de Boor, A Practical Guide to Splines, Springer 1978.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.errors import Invalid
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain
from estimator.statics.film_parameters import FilmParameters
from estimator.statics.film_sensitivity import PARAMETERS, FilmSensitivity, film_sensitivity
from estimator.statics.films_over_speed import equilibria_near
from estimator.statics.first_touch import first_touch_words
from estimator.units import rad_per_s_to_rpm

SPEEDS = 12
"""Number of speeds at which equilibria are solved."""


WAYPOINTS = 6
"""Number of steps from the document's films to others that are too far for one."""


class FilmTooThin(Invalid):
    """Raised when a film of the document does not carry its journal at a speed at which the machine is watched."""


@dataclass(frozen=True)
class NominalFilms:
    """The films as the document gives them.

    Attributes:
        train: The train on its films.
        slowest: Lowest speed of the document at which all films carry [rad/s].
        fastest: Highest one [rad/s].
    """

    train: FilmTrain
    slowest: float
    fastest: float

    @cached_property
    def speed(self) -> Floats:
        """Return the speeds at which equilibria are solved (G,), ascending [rad/s]."""
        return np.geomspace(self.slowest, self.fastest, SPEEDS)

    @cached_property
    def spline(self) -> "scipy.interpolate.CubicSpline":
        """Return the spline over the logarithm of the speed by which values (G,) at these speeds weigh at others.

        Source: splines of de Boor, A Practical Guide to Splines, Springer 1978.
        """
        return scipy.interpolate.CubicSpline(np.log(self.speed), np.eye(SPEEDS))

    @cached_property
    def equilibria(self) -> tuple[FilmEquilibrium, ...]:
        """Return the equilibria at these speeds.

        Source: Pennacchi, Vania and Chatterton, Mech. Syst. Signal Process. 30 (2012) 306.

        Raises:
            FilmTooThin: There is none at a speed, or the range holds no speed at which all films carry.
        """
        if self.slowest >= self.fastest:
            raise FilmTooThin(
                f"valid_above_rpm of a film is {rad_per_s_to_rpm(self.slowest):.0f} r/min, and the speed range ends at "
                f"{rad_per_s_to_rpm(self.fastest):.0f} r/min: at no speed of it all films carry"
            )
        found = []
        for speed, one in zip(self.speed.tolist(), self._followed(), strict=True):
            if one is None or not self.train.carried(one.position):
                raise FilmTooThin(
                    f"at {rad_per_s_to_rpm(speed):.0f} r/min a journal would be within a twentieth of the clearance of its "
                    f"bearing: are geometry and oil right? {first_touch_words(self.train, speed)}. Below the speed at which "
                    "films carry, give valid_above_rpm"
                )
            found.append(one)
        return tuple(found)

    def _followed(self) -> Sequence[FilmEquilibrium | None]:
        """Return the equilibria near that at the highest speed, all at once; where that fails, followed from there down."""
        highest = self.train.equilibrium(self.fastest)
        if highest is not None:
            found = equilibria_near(self.train, self.speed, np.repeat(highest.position[None], SPEEDS, axis=0))
            if found is not None:
                return found
        return self.train.follow(self.speed)


@dataclass(frozen=True)
class _Solution:
    """Equilibria that were found last, from which others are sought.

    Attributes:
        own: The films' own fitted numbers (P,) [-]; none of the document's films.
        train: The train on its films.
        found: Its equilibria.
        slopes: Derivatives (G, n, 2, P) of the positions by the own fitted numbers [m]; None where they are not known.
    """

    own: Floats
    train: FilmTrain
    found: tuple[FilmEquilibrium, ...]
    slopes: Floats | None = None

    def continued_to(self, own: Floats, train: FilmTrain, speed: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria of other films near these; None where there are none."""
        for start in self.starts(own, train):
            found = equilibria_near(train, speed, start)
            if found is not None:
                return found
        return None

    def starts(self, own: Floats, train: FilmTrain) -> Iterator[Floats]:
        """Yield positions (G, n, 2) near which equilibria of other films may be: along the derivatives, else in proportion to
        the clearances."""
        position = np.stack([one.position for one in self.found])
        if self.slopes is not None:
            yield position + self.slopes @ (own - self.own)
        wider = np.ones((len(train.bearings), 1))
        for number, old in self.train.journals.items():
            wider[number] = train.bearings[number].clearance / old.clearance
        yield position * wider


@dataclass(frozen=True)
class _Slopes:
    """Derivatives by the P own fitted numbers of coefficients (G, 8n, P) [SI], positions and forces (G, n, 2, P) [m, N]."""

    coefficients: Floats
    position: Floats
    force: Floats


class SolvedFilms:
    """Films at the speeds at which equilibria are solved, remembered for the last fitted numbers.

    Equilibria are sought from the last ones on, beginning with the nominal ones.

    Attributes:
        own: The films' own parameters.
        nominal: The films as the document gives them.
    """

    def __init__(self, own: FilmParameters, nominal: NominalFilms) -> None:
        """Take the equilibria that the document says.

        Args:
            own: The films' own parameters.
            nominal: The films as the document gives them.

        Raises:
            FilmTooThin: There is no equilibrium at a speed.
        """
        self.own = own
        self.nominal = nominal
        self._last = _Solution(np.zeros(0), nominal.train, nominal.equilibria)
        # Each is one object, so that a thread that reads it while another replaces it gets a pair that belongs together.
        self._solved: tuple[bytes, tuple[FilmEquilibrium, ...] | None] = (b"", None)
        self._slopes: tuple[bytes, _Slopes] = (b"", _Slopes(np.zeros(0), np.zeros(0), np.zeros(0)))

    def factors(self, fitted: Floats) -> Floats:
        """Return how many times as stiff as the document says couplings and pedestals are.

        Args:
            fitted: Fitted numbers, those of the films first (...) [-].

        Returns:
            Factors (C,) [-].
        """
        return self.own.factors(fitted)

    @property
    def viscosities(self) -> list[int]:
        """Return the places of the own parameters that are viscosities, or factors of several."""
        return sorted({self.own.place(number, "viscosity") for number in self.nominal.train.journals})

    @property
    def count(self) -> int:
        """Return the number of coefficients, 8n of the n bearings that are on films."""
        return 8 * len(self.nominal.train.journals)

    def coefficients(self, fitted: Floats) -> Floats:
        """Compute the films' own coefficients.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Coefficients (G, 8n) [SI]; NaN where a film is too thin.
        """
        found = self.equilibria(fitted)
        if found is None:
            return np.full((self.nominal.speed.size, self.count), np.nan)
        return film_rows(
            self.nominal.train, np.stack([one.stiffness for one in found]), np.stack([one.damping for one in found])
        )

    def equilibria(self, fitted: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria at these speeds.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            The equilibria; None where a film is too thin.
        """
        key, solved = self.own.of(fitted).tobytes(), self._solved
        if solved[0] != key:
            solved = self._solved = key, self._solve(fitted)
        return solved[1]

    def equilibria_at(self, fitted: Floats, speed: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Solve for the equilibria at other speeds, from those between which they lie.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].
            speed: Spin speeds (S,) within the model's range [rad/s].

        Returns:
            The equilibria; None where a film is too thin.
        """
        known = self.equilibria(fitted)
        if known is None:
            return None
        position = np.stack([one.position for one in known])
        start = np.tensordot(np.asarray(self.nominal.spline(np.log(speed))), position, 1)
        return equilibria_near(self.own.changed(fitted), speed, start)

    def _solve(self, fitted: Floats) -> tuple[FilmEquilibrium, ...] | None:
        train = self.own.changed(fitted)
        found = self._last.continued_to(self.own.of(fitted), train, self.nominal.speed)
        if found is None:
            found = self._from_nominal(fitted)
        if found is not None:
            self._last = _Solution(self.own.of(fitted).copy(), train, found)
        return found

    def _from_nominal(self, fitted: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria that the document's lead to through films between its own and these; None where that ends."""
        centre, own = np.array([one.centre for one in self.own.parameters]), self.own.of(fitted)
        solution = _Solution(centre, self.nominal.train, self.nominal.equilibria)
        for part in np.linspace(0.0, 1.0, WAYPOINTS + 1)[1:]:
            between = centre + part * (own - centre)
            train = self.own.changed(between)
            found = solution.continued_to(between, train, self.nominal.speed)
            if found is None:
                return None
            solution = _Solution(between, train, found)
        return solution.found

    def sensitivity(self, fitted: Floats) -> FilmSensitivity | None:
        """Compute the derivatives of the equilibria at these speeds.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            The derivatives by the parameters, not their fitted numbers; None where a film is too thin.
        """
        found = self.equilibria(fitted)
        if found is None:
            return None
        return film_sensitivity(self.own.changed(fitted), found)

    def slopes(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the films' own coefficients by their own fitted numbers.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (G, 8n, P) by the P own ones [SI].
        """
        return self._all_slopes(fitted).coefficients

    def by_load(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the films' own coefficients by the static loads of the document.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (G, 8n, 2m) by the components along x and y of each load [SI per N]; NaN where a film is too thin.
        """
        found, count = self.sensitivity(fitted), 2 * len(self.own.loads)
        if found is None:
            return np.full((self.nominal.speed.size, self.count, count), np.nan)
        first = len(PARAMETERS) * len(self.own.forms)
        rows = film_rows(
            self.nominal.train, found.stiffness[:, first : first + count], found.damping[:, first : first + count]
        )
        return np.moveaxis(rows, 1, -1)

    def motions(self, fitted: Floats) -> tuple[Floats, Floats]:
        """Compute the derivatives of the journals' positions and of the films' forces by the films' own fitted numbers.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives of positions (G, n, 2, P) [m] and of forces (G, n, 2, P) [N]; NaN where a film is too thin.
        """
        found = self._all_slopes(fitted)
        return found.position, found.force

    def _all_slopes(self, fitted: Floats) -> _Slopes:
        key, known = self.own.of(fitted).tobytes(), self._slopes
        if known[0] != key:
            known = self._slopes = key, self._differentiated(fitted)
        return known[1]

    def _differentiated(self, fitted: Floats) -> _Slopes:
        found, count = self.sensitivity(fitted), self.own.count
        speed = self.nominal.speed
        if found is None:
            journals = np.full((speed.size, len(self.own.forms), 2, count), np.nan)
            return _Slopes(np.full((speed.size, self.count, count), np.nan), journals, journals)
        position, force, coefficients = (
            self.own.by_fitted(np.moveaxis(one, 1, -1), speed=speed)
            for one in (found.position, found.force, film_rows(self.nominal.train, found.stiffness, found.damping))
        )
        self._last = replace(self._last, slopes=position)
        return _Slopes(coefficients, position, force)


def film_rows(train: FilmTrain, stiffness: Floats, damping: Floats) -> Floats:
    """Return the coefficients of those bearings of a train that are on films as rows.

    Args:
        train: The train, of b bearings of which n are on films.
        stiffness: Matrices (..., b, 2, 2) [N/m].
        damping: Matrices (..., b, 2, 2) [N s/m].

    Returns:
        Rows (..., 8n), film by film: first the stiffness [N/m], then the damping [N s/m].
    """
    on_films = list(train.journals)
    each = [one[..., on_films, :, :].reshape(*one.shape[:-3], len(on_films), 4) for one in (stiffness, damping)]
    return np.concatenate(each, axis=-1).reshape(*stiffness.shape[:-3], -1)
