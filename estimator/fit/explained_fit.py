"""Refused fits that an error explains which their document does not have, and what they say of the machine."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.validation.channel_sensitivity import ChannelEffects


class ExplainedFit(Struct, frozen=True, eq=False):
    """Accepted fit with errors of a coupling or a channel, over the n coordinates of the refused fit without them.

    Attributes:
        point: Values (n,) of the coordinates [SI or 1].
        covariance: Covariance (n, n) of these, the errors being what they are [SI² or 1].
        effects: Effects of errors of channels and couplings, at those that were found.
        refused_chi_square: χ² of the phasors as the curvature says it is without the errors [-].
        degrees_of_freedom: Degrees of freedom of χ².
        outlier: True for phasors left out (S, m).
        words: What explains the data.
    """

    point: Floats
    covariance: Floats
    effects: ChannelEffects
    refused_chi_square: float
    degrees_of_freedom: int
    outlier: NDArray[np.bool_]
    words: str
