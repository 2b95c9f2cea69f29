"""Likelihood of one run of a train on oil films: its fit less what was believed beforehand.

Priors on clearances, viscosities, elevations and deviations are alike in all fits of one machine. Runs that are taken together
must count them once, so that they are taken off each fit: of the logarithm of a posterior's density, that of the prior.
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.symmetric_eigen import symmetric_eigen
from estimator.updated_model.model import UpdatedModel

WIDENED_ALONE = 0.1
"""Most directions that are widened by themselves, as a part of all [-]: one for each omitted force or kind of deviation."""
ROUNDING = 1e-6
"""Part by which a direction may seem wider than the prior [-]."""


@dataclass(frozen=True)
class RunLikelihood:
    """Gaussian likelihood of the n coordinates θ of a run, less the centre of their prior.

    Attributes:
        information: Information (n, n) [-].
        vector: Information times the likeliest place (n,) [-].
    """

    information: Floats
    vector: Floats

    def marginalised(self, varying: Floats) -> "RunLikelihood":
        """Return the remaining likelihood of coordinates about which the run's own lie with some covariance.

        Source: standard result: a Gaussian likelihood of coordinates that vary has (1 + Λ V)⁻¹ Λ for its information Λ.

        Args:
            varying: The covariance (n, n) [-].

        Returns:
            The likelihood of these coordinates.
        """
        size = len(self.vector)
        through = np.linalg.solve(np.eye(size) + self.information @ varying, np.column_stack([self.information, self.vector]))
        return RunLikelihood(np.asarray((through[:, :-1] + through[:, :-1].T) / 2), np.asarray(through[:, -1], dtype=float))


def run_likelihood(model: UpdatedModel) -> RunLikelihood:
    """Compute the likelihood of a run from its fit (derived here: a posterior over its prior).

    A fit whose covariance was widened has had its prior widened with it (`contained_prior`).

    Args:
        model: The model that the fit led to.

    Returns:
        The likelihood, in the model's own coordinates: viscosities over those of its own temperatures.
    """
    coordinates: Coordinates = model.coordinates_at(np.ones(1))
    covariance = model.covariance / np.outer(coordinates.unit, coordinates.unit)
    posterior = scaled_inverse(covariance)
    away = coordinates.theta(model.values) - coordinates.centre
    precision, pulling = contained_prior(covariance, coordinates.prior.precision)
    information = posterior - precision
    return RunLikelihood(information, np.asarray((information + pulling) @ away))


def contained_prior(covariance: Floats, precision: Floats) -> tuple[Floats, Floats]:
    """Compute the precision of the prior that a fit's covariance contains, widened as this was (derived here).

    Data never widen a prior, so a covariance beyond it was widened. Residuals that are alike widen all directions by one
    factor, which is seen where the prior alone holds; an omitted force or a sharp deviation widens a few directions. So the
    factor is what more than WIDENED_ALONE of the directions reach, and a direction beyond it was widened by itself: of that
    one the fit says nothing, not even its own estimate.

    Source: own derivation: the prior is what the covariance holds beyond the data, in the summary above.

    Args:
        covariance: Covariance (n, n) of the fit [unit²].
        precision: Precision (n, n) of the prior [1/unit²].

    Returns:
        Precision (n, n), and the part (n, n) of it by which the prior pulls the fit's estimate: without the directions that
        were widened beyond it [1/unit²].
    """
    root = np.linalg.cholesky(precision)
    size, directions = symmetric_eigen(root.T @ covariance @ root)
    factor = max(1.0, float(size[-1 - int(WIDENED_ALONE * size.size)]))
    alone = size > (1.0 + ROUNDING) * factor
    size, columns = size[alone], (root @ directions)[:, alone]
    pulling = precision / factor - columns / factor @ columns.T
    return np.asarray(pulling + columns / size @ columns.T), np.asarray(pulling)


def scaled_inverse(covariance: Floats) -> Floats:
    """Compute the inverse of a covariance whose coordinates are of very different sizes.

    Source: own derivation: both sides are divided by the standard deviations first, so that sizes do not count.

    Args:
        covariance: Matrix (n, n), symmetric and positive definite [unit²].

    Returns:
        Inverse (n, n) [1/unit²].
    """
    scale = np.sqrt(np.diag(covariance))
    return np.asarray(np.linalg.inv(covariance / np.outer(scale, scale)) / np.outer(scale, scale))
