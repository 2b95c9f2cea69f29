"""Coefficients of a train's films at given speeds, between those at which equilibria are solved, with their deviations."""

from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.terms import LATERAL
from estimator.statics.film_deviations import TERMS, FilmDeviations
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
        self._deviating = bool(deviations.parameters)
        self._weight = np.asarray(films.nominal.spline(np.log(speed)))
        self._by_number = deviations.per_number(speed)

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficients (S, 8n) [SI]; NaN where a film is too thin.
        """
        base = self._base(fitted)
        if self._deviating:
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
        base = self._base(fitted)[block]
        own = np.einsum("sg,gcp->scp", self._weight[block], self._films.slopes(fitted))
        if not self._deviating:
            return np.asarray(own)
        sizes, relative = self._sizes(base), self._relative(fitted)[block]
        first, second = self._beside
        growth = 0.5 * (own[:, first] / base[:, first, None] + own[:, second] / base[:, second, None])
        found = np.zeros((*base.shape, fitted.size))
        found[..., : own.shape[2]] = own + (sizes * relative)[..., None] * growth
        found[..., own.shape[2] :] = sizes[..., None] * self._by_number[block]
        return found

    def _base(self, fitted: Floats) -> Floats:
        """Return the films' own coefficients (S, 8n)."""
        return np.asarray(self._weight @ self._films.coefficients(fitted))

    def _sizes(self, base: Floats) -> Floats:
        """Return what a deviation of each coefficient is a part of (S, 8n): the direct terms beside it."""
        first, second = self._beside
        return np.asarray(np.sqrt(np.abs(base[:, first] * base[:, second])))

    @cached_property
    def _beside(self) -> tuple[list[int], list[int]]:
        pairs = [
            tuple(first + TERMS.index(name) for name in term.beside)
            for first in range(0, self._by_number.shape[1], len(TERMS))
            for term in LATERAL
        ]
        return [one[0] for one in pairs], [one[1] for one in pairs]

    def _relative(self, fitted: Floats) -> Floats:
        """Return the relative deviations (S, 8n) [-]."""
        return np.asarray(self._by_number @ fitted[fitted.size - self._by_number.shape[2] :])
