"""Check of fitted numbers against what was believed of them: whether the prior predicts them.

Estimates over the size that each is believed to have scatter with the covariance I - C, C being that which the data leave
(Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.2), so that their squares over it follow χ²
(Box, J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063). Directions of which the data say next to nothing are left out.
"""

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Floats
from estimator.symmetric_eigen import symmetric_eigen

DETERMINED = 0.1
"""Part of a direction's prior variance from which on the data say something of it [-]."""


class PriorCheck(Struct, frozen=True, eq=False):
    """Comparison of k numbers with a standard-normal prior.

    Attributes:
        chance: Probability that they are as large as those of the s directions that the data determine [-].
        size: Their rms over what is expected of it [-].
        misplaced: Rms distance of the prior's centre from where the data want it in these directions [-].
        directions: These directions (k, s) [-].
    """

    chance: float
    size: float
    misplaced: float
    directions: Floats


def prior_check(numbers: Floats, covariance: Floats) -> PriorCheck:
    """Compare fitted numbers with their prior.

    Source: Box, J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063.

    Args:
        numbers: Estimates (k,) less their prior means, over their prior standard deviations [-].
        covariance: Their covariance (k, k) as the fit leaves it, in the same units [-].

    Returns:
        The comparison; a chance of 1 where the data determine none.
    """
    scatter = np.eye(numbers.size) - covariance
    variance, directions = symmetric_eigen((scatter + scatter.T) / 2)
    seen = variance > DETERMINED
    if not seen.any():
        return PriorCheck(1.0, 0.0, 0.0, directions[:, seen])
    along = directions[:, seen].T @ numbers
    squares = along**2 / variance[seen]
    return PriorCheck(
        chance=float(scipy.special.chdtrc(squares.size, squares.sum())),
        size=float(np.sqrt(squares.mean())),
        misplaced=float(np.sqrt(np.mean((along / variance[seen]) ** 2))),
        directions=directions[:, seen],
    )
