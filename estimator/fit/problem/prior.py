"""Prior on the coordinates of a fit: independent, or jointly Gaussian where a calibration gave it.

A calibration holds values with their joint covariance; coordinates that it does not hold keep a spread of their own (Gaussian
prior: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.1).
"""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.calibration import Calibration


class Prior(Struct, frozen=True, eq=False):
    """Gaussian prior on the n coordinates of a fit.

    Attributes:
        centre: Mean (n,) [-].
        precision: Inverse (n, n) of the covariance [-].
    """

    centre: Floats
    precision: Floats

    def pull(self, theta: Floats) -> Floats:
        """Compute half the derivative of the prior's cost.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Half the derivative (n,) of (θ - centre)ᵀ precision (θ - centre) [-].
        """
        return np.asarray(self.precision @ (theta - self.centre))

    def cost(self, theta: Floats) -> float:
        """Compute the prior's part of a fit's cost.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            (θ - centre)ᵀ precision (θ - centre) [-].
        """
        return float((theta - self.centre) @ self.pull(theta))


class CalibratedPrior(Struct, frozen=True, eq=False):
    """Prior of k coordinates that a calibration holds.

    Attributes:
        places: Indices (k,) of the coordinates.
        centre: Mean (k,) [-].
        covariance: Covariance (k, k) [-].
        between_runs: Part (k,) of their variances by which coefficients vary from run to run [-].
    """

    places: NDArray[np.intp]
    centre: Floats
    covariance: Floats
    between_runs: Floats

    @property
    def precision(self) -> Floats:
        """Return the inverse of the covariance (k, k) [-].

        Source: Gaussian prior, Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.1.
        """
        size = np.sqrt(np.diag(self.covariance))
        return np.asarray(np.linalg.inv(self.covariance / np.outer(size, size)) / np.outer(size, size))


def calibrated_prior(
    calibration: Calibration,
    *,
    names: tuple[str, ...],
    origin: Floats,
    unit: Floats,
    between_runs: Floats,
    variation: HealthyVariation,
) -> CalibratedPrior | None:
    """Return the prior that a calibration gives.

    The machine has been mounted anew since: its unbalances are found anew, and run-outs may have moved. Of what varies from
    run to run a calibration says what its runs have in common.

    Args:
        calibration: The calibration.
        names: Names of the n coordinates.
        origin: Offset (n,) of the physical values [SI, logarithms of positive ones].
        unit: Unit (n,) of the coordinates [SI, 1 for logarithms].
        between_runs: Variance (n,) of each parameter of a model from run to run [-].
        variation: Variation of the healthy machine, which its coefficients follow.

    Returns:
        The prior; None where the calibration holds none of these coordinates.
    """
    index = {name: place for place, name in enumerate(names) if name not in calibration.unbalances}
    rows = [row for row, name in enumerate(calibration.parameters) if name in index]
    if not rows:
        return None
    places = np.array([index[calibration.parameters[row]] for row in rows], dtype=np.intp)
    whole = np.array(calibration.covariance) + np.diag(calibration.moved_since(variation))
    covariance = whole[np.ix_(rows, rows)] / np.outer(unit[places], unit[places]) + np.diag(between_runs[places])
    centre = (np.array(calibration.values)[rows] - origin[places]) / unit[places]
    varying = between_runs[places] + calibration.between_runs(variation)[rows] / unit[places] ** 2
    return CalibratedPrior(places, centre, covariance, varying)


def variance_between_runs(parameters: Sequence[ModelParameter], size: int) -> Floats:
    """Return by how much coordinates vary from run to run beside what is believed of the machine.

    Args:
        parameters: Parameters of all models, which are the first coordinates.
        size: Number n of the coordinates.

    Returns:
        Variances (n,) [-].
    """
    found = np.zeros(size)
    found[: len(parameters)] = [one.between_runs**2 for one in parameters]
    return found
