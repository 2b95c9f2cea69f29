"""Films at any speeds between those at which equilibria are solved.

Journals' positions follow splines over speed, coefficients are those of the films there: where a journal passes the centre of
curvature of a lobe, a film turns within a few hundredths of a clearance, which no spline of its coefficients over a few speeds
shows.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.statics.alike_bearings import covered, films_at
from estimator.statics.film_sensitivity import PARAMETERS, coefficient_slopes
from estimator.statics.solved_films import SolvedFilms, film_rows


@dataclass(frozen=True)
class _FilmsThere:
    """Positions (S, n, 2) [m], coefficients of either order (S, n, 2, 2) [SI], their derivatives by the positions
    (S, n, 2, 2, 2)."""

    position: Floats
    stiffness: Floats
    damping: Floats
    stiffness_slope: Floats
    damping_slope: Floats


class FilmsBetween:
    """Films at S speeds, remembered for the last fitted numbers."""

    def __init__(self, films: SolvedFilms, speed: Floats, weight: Floats) -> None:
        """Take the speeds.

        Args:
            films: The films at the G speeds at which they are solved.
            speed: Spin speeds (S,) within the model's range [rad/s].
            weight: Weights (S, G) by which values at the solved speeds make those at these speeds [-].
        """
        self._films = films
        self._speed = speed
        self._weight = weight
        # One object, so that a thread that reads it while another replaces it gets a pair that belongs together.
        self._last: tuple[bytes, _FilmsThere | None] = (b"", None)

    def coefficients(self, fitted: Floats) -> Floats:
        """Compute the films' own coefficients.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Coefficients (S, 8n) [SI]; NaN where a film is too thin.
        """
        there = self._there(fitted)
        if there is None:
            return np.full((self._speed.size, self._films.count), np.nan)
        return film_rows(self._films.nominal.train, there.stiffness, there.damping)

    def slopes(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the films' own coefficients by their own fitted numbers, at some of the speeds.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].
            block: The s speeds.

        Returns:
            Derivatives (s, 8n, P) by the P own ones [SI]; NaN where a film is too thin.
        """
        found = self._by_parameters(fitted, block)
        if found is None:
            return np.full((self._speed[block].size, self._films.count, self._films.own.count), np.nan)
        return self._films.own.by_fitted(found, speed=self._speed[block])

    def by_load(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the films' own coefficients by the static loads of the document.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, 8n, 2m) by the components along x and y of each load [SI per N]; NaN where a film is too thin.
        """
        found, count = self._by_parameters(fitted, slice(None)), 2 * len(self._films.own.loads)
        if found is None:
            return np.full((self._speed.size, self._films.count, count), np.nan)
        first = len(PARAMETERS) * len(self._films.own.forms)
        return found[..., first : first + count]

    def viscosity_trend(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the films' own coefficients by an exponent t of all viscosities, as `FilmCurves` does.

        A journal's place at a speed follows from the viscosity at that speed alone.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, 8n) [SI], at t = 0; NaN where a film is too thin.
        """
        thicker = np.log(self._films.nominal.speed).mean() - np.log(self._speed)
        by_viscosity = self.slopes(fitted, slice(None))[:, :, self._films.viscosities].sum(axis=2)
        return np.asarray(thicker[:, None] * by_viscosity)

    def _by_parameters(self, fitted: Floats, block: slice) -> Floats | None:
        """Return derivatives (s, 8n, P) by the parameters of `FilmSensitivity`; None where a film is too thin."""
        there, moved = self._there(fitted), self._films.sensitivity(fitted)
        if there is None or moved is None:
            return None
        position, place = np.tensordot(self._weight[block], moved.position, 1), there.position[block]
        stiffness, damping = (
            coefficient_slopes(value[block], slope[block], place=place, position=position)
            for value, slope in ((there.stiffness, there.stiffness_slope), (there.damping, there.damping_slope))
        )
        return np.moveaxis(film_rows(self._films.nominal.train, stiffness, damping), 1, -1)

    def _there(self, fitted: Floats) -> _FilmsThere | None:
        key, known = self._films.own.of(fitted).tobytes(), self._last
        if known[0] != key:
            known = self._last = key, self._found(fitted)
        return known[1]

    def _found(self, fitted: Floats) -> _FilmsThere | None:
        solved = self._films.equilibria(fitted)
        if solved is None:
            return None
        position = np.tensordot(self._weight, np.stack([one.position for one in solved]), 1)
        bearings = self._films.own.changed(fitted).bearings
        if not covered(bearings, position).all():
            return None
        films = films_at(bearings, position, speed=self._speed)
        parts = ("stiffness", "damping", "stiffness_slope", "damping_slope")
        return _FilmsThere(position, *(np.stack([getattr(one, name) for one in films], axis=1) for name in parts))
