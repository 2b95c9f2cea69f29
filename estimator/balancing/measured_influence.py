"""Influence coefficients measured by trial runs: linear regression of the vectors on the unbalances that were added.

V = V0 + A w at every measuring point, for any number of runs, repeats and planes; with one trial a plane these are the
classical influence coefficients (Goodman, J. Eng. Ind. 86 (1964) 273, doi:10.1115/1.3670532). All points share the runs,
so that ordinary least squares are the best estimate whatever the correlation between points (Zellner, J. Am. Stat. Assoc.
57 (1962) 348, doi:10.1080/01621459.1962.10480664). The scatter of the runs about the regression is estimated where there
are more runs than unknowns, correlations between points included: a rotor that settles anew at each start moves all of
them together. With as many runs as unknowns the expected errors of the vectors stand in for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.special

from estimator.arrays import Complexes, Floats
from estimator.balancing.trial_runs import TrialRuns, TrialsUnusable, require_usable
from estimator.fit.estimates import CONFIDENCE_95
from estimator.updated_model.uncertainty import PhasorBand, phasor_band

EVERY_POSSIBLE_SIZE = 1e3
"""Largest factor on the standard error of an interval [-]; beyond it nothing is known anyway."""
LEAST_FREEDOM = 0.5
"""Fewest complex degrees of freedom from which a scatter is estimated [-]."""


@dataclass(frozen=True)
class MeasuredInfluence:
    """Influence coefficients of Q planes at K measuring points, and the vibration without added weights.

    Attributes:
        planes: Ids of the Q planes.
        points: Names of the K measuring points.
        influence: Coefficients A (K, Q) [m/(kg m)].
        offset: Vibration V0 (K,) without added weights [m].
        spread: Covariance (K, Q + 1, Q + 1) of offset and coefficients of each point, E[e eᴴ] [m², m/(kg m)].
        scatter: Covariance (K, K) of the vectors of one run, E[e eᴴ] [m²].
        freedom: Real degrees of freedom of the scatter [-]; infinite where it is the expected one.
        shares: What each of R runs adds to the scatter (R, K), whose squares are summed in it [m], NaN where it shows nothing;
            None where the scatter is the expected one.
    """

    planes: tuple[str, ...]
    points: tuple[str, ...]
    influence: Complexes
    offset: Complexes
    spread: Complexes
    scatter: Complexes
    freedom: float
    shares: Complexes | None = None

    @property
    def widening(self) -> float:
        """Return by how much intervals are wider than those of a known scatter (Student's t over the normal quantile) [-].

        Source: standard result: quantile of Student's t over that of the normal distribution.
        """
        if not np.isfinite(self.freedom):
            return 1.0
        return min(float(scipy.special.stdtrit(self.freedom, 0.975)) / CONFIDENCE_95, EVERY_POSSIBLE_SIZE)

    def predicted(self, weight: Complexes) -> PhasorBand:
        """Predict the vectors of a further run.

        Args:
            weight: Weights (Q,) added to the state without trial weights [kg m].

        Returns:
            Band (K,) of the vectors, the run's own scatter included [m].
        """
        variance = self.error_of(weight) + np.real(np.diag(self.scatter))
        return circular_band(self.offset + self.influence @ weight, variance, widening=self.widening)

    def error_of(self, weight: Complexes) -> Floats:
        """Return the variance of the predicted mean vectors.

        Args:
            weight: Weights (Q,) [kg m].

        Returns:
            Variances (K,) of the complex error [m²].
        """
        one = np.concatenate([[1.0], weight])
        return np.asarray(np.maximum(np.real(np.einsum("i,kij,j->k", one, self.spread, np.conj(one))), 0.0))

    def pick(self, planes: Sequence[str]) -> "MeasuredInfluence":
        """Return the coefficients of some planes.

        Args:
            planes: Ids of the planes wanted, in their order.

        Returns:
            These coefficients.
        """
        columns = [self.planes.index(plane) for plane in planes]
        unknowns = [0, *(1 + column for column in columns)]
        return replace(
            self,
            planes=tuple(planes),
            influence=self.influence[:, columns],
            spread=self.spread[:, unknowns][:, :, unknowns],
        )

    def from_state(self, vector: Complexes, weight: Complexes) -> "MeasuredInfluence":
        """Return the same coefficients; the vibration without weights follows from a run with known weights.

        Args:
            vector: Vectors (K,) of the run; points with NaN are left out [m].
            weight: Weights (Q,) that were on [kg m].

        Returns:
            The coefficients at the points that the run shows.
        """
        shown = np.isfinite(vector)
        turn = np.eye(weight.size + 1, dtype=complex)
        turn[0] = np.concatenate([[0.0], -weight])
        spread = turn @ self.spread[shown] @ np.conj(turn).T
        spread[:, 0, 0] += np.real(np.diag(self.scatter))[shown]
        return replace(
            self,
            points=tuple(np.array(self.points)[shown].tolist()),
            influence=self.influence[shown],
            offset=(vector - self.influence @ weight)[shown],
            spread=spread,
            scatter=self.scatter[np.ix_(shown, shown)],
            shares=None if self.shares is None else self.shares[:, shown],
        )

    def coefficient_error(self) -> Floats:
        """Return the rms of the complex error of each coefficient.

        Returns:
            Errors (K, Q) [m/(kg m)].
        """
        variance = np.real(np.diagonal(self.spread, axis1=1, axis2=2))[:, 1:]
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    def correlation(self) -> Complexes:
        """Return the correlation between the errors of the points.

        Returns:
            Correlations (K, K) [-].
        """
        size = np.sqrt(np.maximum(np.real(np.diag(self.scatter)), 0.0))
        unit = np.where(size > 0.0, size, 1.0)
        return np.asarray(self.scatter / np.outer(unit, unit))


def measure_influence(runs: TrialRuns) -> MeasuredInfluence:
    """Compute influence coefficients by least squares (Goodman 1964, doi:10.1115/1.3670532; Zellner 1962).

    Args:
        runs: The initial run and trial runs, in any order, at points that they determine.

    Returns:
        The coefficients, with their covariance.

    Raises:
        TrialsUnusable: The runs cannot determine the coefficients of every plane.
    """
    require_usable(runs)
    count, planes = runs.added.shape
    size = np.max(np.abs(runs.added), axis=0)
    unit = np.concatenate([[1.0], 1.0 / size])
    design = np.concatenate([np.ones((count, 1)), runs.added / size], axis=1)
    solution = np.zeros((len(runs.points), planes + 1), dtype=complex)
    factor = np.zeros((len(runs.points), planes + 1, planes + 1), dtype=complex)
    left = np.full(runs.vector.shape, complex(np.nan, np.nan))
    for point, shown in enumerate(np.isfinite(runs.vector).T):
        own, seen = design[shown], runs.vector[shown, point]
        if np.linalg.matrix_rank(own) <= planes:
            raise TrialsUnusable(f"the runs that show {runs.points[point]} do not determine every plane")
        # The estimate's error is (XᴴX)⁻¹Xᴴ e; E[e eᴴ] of it, in the order of a prediction's row times its unknowns.
        factor[point] = np.linalg.inv(np.conj(own).T @ own) * np.outer(unit, unit)
        scaled = np.linalg.lstsq(own, seen, rcond=None)[0]
        left[shown, point] = seen - own @ scaled
        solution[point] = scaled * unit
    scatter, freedom, shares = estimate_scatter(runs, left, spent=planes + 1.0)
    return MeasuredInfluence(
        planes=runs.planes,
        points=runs.points,
        influence=solution[:, 1:],
        offset=solution[:, 0],
        spread=(np.real(np.diag(scatter))[:, None, None] * factor).astype(complex),
        scatter=scatter,
        freedom=freedom,
        shares=shares,
    )


def estimate_scatter(runs: TrialRuns, left: Complexes, *, spent: float) -> tuple[Complexes, float, Complexes | None]:
    """Estimate the covariance of a run's vectors from the residuals of a fit, no smaller than the expected errors.

    Args:
        runs: The runs, for their expected errors.
        left: Residuals (R, K), NaN where a run shows nothing [m].
        spent: Unknowns that the fit has spent at each point [-].

    Returns:
        Covariance (K, K) [m²], its real degrees of freedom [-], infinite where it is the expected one, and what each run adds
        to it (R, K) [m].
    """
    square = expected_variance(runs)
    freedom = np.count_nonzero(np.isfinite(left), axis=0) - spent
    least = float(np.min(freedom))
    if least < LEAST_FREEDOM:
        return np.diag(square).astype(complex), float("inf"), None
    shares = left / np.sqrt(freedom)
    filled = np.where(np.isfinite(left), shares, 0.0)
    found = filled.T @ np.conj(filled)
    # Few runs may agree by chance to better than a single vector is known.
    short = np.maximum(np.where(np.isfinite(square), square, 0.0) - np.real(np.diag(found)), 0.0)
    return np.asarray(found + np.diag(short)), 2.0 * least, shares


def expected_variance(runs: TrialRuns) -> Floats:
    """Return the mean expected variance of the vectors that the runs show.

    Args:
        runs: The runs.

    Returns:
        Variances (K,) of the complex errors, NaN where nothing is known of them [m²].
    """
    known = np.isfinite(runs.vector) & np.isfinite(runs.error)
    count = np.count_nonzero(known, axis=0)
    total = np.sum(np.where(known, runs.error**2, 0.0), axis=0)
    return np.asarray(np.divide(total, count, out=np.full(count.size, np.nan), where=count > 0))


def circular_band(value: Complexes, variance: Floats, *, widening: float = 1.0) -> PhasorBand:
    """Compute the band of phasors whose errors are alike in every direction.

    Args:
        value: Phasors (K,) [any unit].
        variance: Variances (K,) of their complex errors [unit²].
        widening: Factor on the standard errors [-].

    Returns:
        Band (K,) [unit of the phasors].
    """
    size = widening * np.sqrt(variance / 2.0)
    return phasor_band(value, np.stack([size, 1j * size], axis=-1).astype(complex), np.eye(2))
