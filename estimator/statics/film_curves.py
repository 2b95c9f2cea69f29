"""Coefficients of a train's films at given speeds, between those at which equilibria are solved, with their deviations."""

from functools import cached_property

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.bearings.terms import LATERAL
from estimator.statics.equilibrium import FilmEquilibrium
from estimator.statics.film_deviations import TERMS, FilmDeviations
from estimator.statics.films_between import FilmsBetween
from estimator.statics.solved_films import SolvedFilms


class FilmCurves:
    """Coefficients of n films at S speeds."""

    def __init__(self, films: SolvedFilms, deviations: FilmDeviations, speed: Floats) -> None:
        """Prepare the interpolation.

        Args:
            films: The films at the speeds at which they are solved.
            deviations: Their deviations.
            speed: Spin speeds (S,) within the model's range [rad/s].
        """
        self._films = films
        self._speed = speed
        self._weight = np.asarray(films.nominal.spline(np.log(speed)))
        turning = any(one.turns_sharply for one in films.nominal.train.journals.values())
        self._between = FilmsBetween(films, speed, self._weight) if turning else None
        self._deviations = deviations.at(speed)

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficients (S, 8n) [SI]; NaN where a film is too thin.
        """
        base = self._base(fitted)
        if self._deviations.count:
            base = base + self._sizes(base) * self._relative(fitted)
        return base

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficients by the fitted numbers, at some of the speeds.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, 8n, P) [SI].
        """
        own, sizes = self._own_derivatives(fitted, block)
        return np.concatenate([own, sizes[..., None] * self._deviations.per_number[block]], axis=2)

    def chained(self, fitted: Floats, block: slice, by_coefficient: Complexes) -> Complexes:
        """Compute the derivatives of outputs by the fitted numbers from those by the coefficients.

        As the product with `derivatives`, which are zero but for each deviation's own coefficient.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.
            by_coefficient: Derivatives (8n, s, m) of m outputs by the coefficients [any unit].

        Returns:
            Derivatives (P, s, m) [that unit].
        """
        own, sizes = self._own_derivatives(fitted, block)
        along = (own.swapaxes(1, 2) @ by_coefficient.swapaxes(0, 1)).swapaxes(0, 1)
        return np.concatenate([along, self._deviations.chained(by_coefficient * sizes.T[:, :, None], block)])

    def viscosity_trend(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the coefficients by an exponent t of all viscosities: in proportion to (speed)⁻ᵗ.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Derivatives (S, 8n) [SI], at t = 0; the viscosity stays at the geometric mean of the lowest and the highest speed.
        """
        if self._between is not None:
            return self._between.viscosity_trend(fitted)
        place = np.log(self._films.nominal.speed)
        by_viscosity = self._films.slopes(fitted)[:, :, self._films.viscosities].sum(axis=2)
        return np.asarray(self._weight @ ((place.mean() - place)[:, None] * by_viscosity))

    def by_load(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the coefficients by the static loads of the document.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Derivatives (S, 8n, 2m) by the components along x and y of each load [SI per N].
        """
        if self._between is not None:
            return self._between.by_load(fitted)
        return np.asarray(np.tensordot(self._weight, self._films.by_load(fitted), 1))

    def tilted(self, fitted: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria at the speeds, with the pads that tilt in them.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            The equilibria; None where no pad tilts, or a film is too thin.
        """
        if all(one.described.pads is None for one in self._films.nominal.train.journals.values()):
            return None
        return self._films.equilibria_at(fitted, self._speed)

    def _own_derivatives(self, fitted: Floats, block: slice) -> tuple[Floats, Floats]:
        """Return the derivatives (s, 8n, P) by the P own parameters, and what deviations are a part of (s, 8n)."""
        base = self._base(fitted)[block]
        if self._between is None:
            own = np.tensordot(self._weight[block], self._films.slopes(fitted), 1)
        else:
            own = self._between.slopes(fitted, block)
        sizes = self._sizes(base)
        if self._deviations.count:
            first, second = self._beside
            growth = 0.5 * (own[:, first] / base[:, first, None] + own[:, second] / base[:, second, None])
            own = own + (sizes * self._relative(fitted)[block])[..., None] * growth
        return own, sizes

    def _base(self, fitted: Floats) -> Floats:
        """Return the films' own coefficients (S, 8n)."""
        if self._between is None:
            return np.asarray(self._weight @ self._films.coefficients(fitted))
        return self._between.coefficients(fitted)

    def _sizes(self, base: Floats) -> Floats:
        """Return what a deviation of each coefficient is a part of (S, 8n): the direct terms beside it."""
        first, second = self._beside
        return np.asarray(np.sqrt(np.abs(base[:, first] * base[:, second])))

    @cached_property
    def _beside(self) -> tuple[list[int], list[int]]:
        pairs = [
            tuple(first + TERMS.index(name) for name in term.beside)
            for first in range(0, self._films.count, len(TERMS))
            for term in LATERAL
        ]
        return [one[0] for one in pairs], [one[1] for one in pairs]

    def _relative(self, fitted: Floats) -> Floats:
        """Return the relative deviations (S, 8n) [-]."""
        return self._deviations.relative(fitted[fitted.size - self._deviations.count :])
