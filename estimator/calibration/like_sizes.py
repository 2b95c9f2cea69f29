"""Sizes of scatter that are expected to be alike, each drawn towards the common one by as much as all of them show it to be.

Empirical Bayes of Smyth (Stat. Appl. Genet. Mol. Biol. 3 (2004) 3, doi:10.2202/1544-6115.1027): variances with few degrees of
freedom differ by chance; how much more they differ tells how many observations the common one is worth beside each. That
difference is the weighted moment of DerSimonian and Laird (Control. Clin. Trials 7 (1986) 177,
doi:10.1016/0197-2456(86)90046-2): sizes that are barely shown do not decide it.
"""

import numpy as np
import scipy
from scipy.special import digamma, polygamma

from estimator.arrays import Floats

STATED_WEIGHT = 0.2
"""Number of observations that a stated size counts for [-]."""
LEAST_WEIGHT, MOST_WEIGHT = 0.25, 100.0
"""Bounds on the number of observations that the common size counts for [-]."""
FEW_WEIGHT = 0.5
"""Number of observations that the common size counts for where too few sizes are shown to compare them [-]."""
LEAST_SHOWN = 0.2
"""Complex degrees of freedom from which on a size counts as shown [-]."""
FEWEST = 3
"""Fewest sizes whose differences say anything."""


def shrunk_sizes(squares: Floats, freedom: Floats) -> Floats:
    """Estimate sizes that are expected to be one (Smyth 2004, doi:10.2202/1544-6115.1027).

    Args:
        squares: Sums (G,) of squared complex values, in units of what is stated [-].
        freedom: Number (G,) of independent complex values in each [-].

    Returns:
        Rms (G,) in units of what is stated [-].
    """
    common = (squares.sum() + STATED_WEIGHT) / (freedom.sum() + STATED_WEIGHT)
    weight = _weight_of_the_common(squares, freedom)
    return np.asarray(np.sqrt((squares + weight * common) / (freedom + weight)))


def _weight_of_the_common(squares: Floats, freedom: Floats) -> float:
    """Return how many observations the common size counts for, by how far they differ beyond chance (section 6.2)."""
    shown = (freedom > LEAST_SHOWN) & (squares > 0.0)
    if np.count_nonzero(shown) < FEWEST:
        return FEW_WEIGHT
    chance = polygamma(1, freedom[shown])
    logarithm = np.log(squares[shown] / freedom[shown]) - digamma(freedom[shown]) + np.log(freedom[shown])
    weights = 1.0 / chance
    mean = np.sum(weights * logarithm) / weights.sum()
    differing = np.sum(weights * (logarithm - mean) ** 2) - (logarithm.size - 1)
    beyond = float(differing / (weights.sum() - np.sum(weights**2) / weights.sum()))
    if beyond <= polygamma(1, MOST_WEIGHT):
        return MOST_WEIGHT
    if beyond >= polygamma(1, LEAST_WEIGHT):
        return LEAST_WEIGHT
    return float(scipy.optimize.brentq(lambda weight: polygamma(1, weight) - beyond, LEAST_WEIGHT, MOST_WEIGHT))
