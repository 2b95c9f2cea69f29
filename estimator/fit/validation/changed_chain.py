"""Measuring chain that has changed since the calibration that holds a fit.

A prior that holds many parameters leaves χ² with many degrees of freedom, in which a change of one channel's gain hides. So
each channel is asked by itself how far χ² would fall if its gain were free: the score test of Rao (Math. Proc. Camb. Phil.
Soc. 44 (1948) 50, doi:10.1017/S0305004100023987), with two degrees of freedom, and the chance that any of all channels shows
such a fall (Bonferroni).
"""

from collections.abc import Iterator

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Floats
from estimator.fit.problem.fit_problem import FitProblem, FitResult

LEAST_SHOWN = 1e-9
"""Least part of the prior's precision that a run must leave of a gain for a change of it to mean anything [-]."""


class ChangedChain(Struct, frozen=True, eq=False):
    """Measuring chain whose gain would better be free of the calibration.

    Attributes:
        channel: Name of the channel.
        factor: Complex factor on its calibrated gain that the run shows [-].
        fall: What χ² would fall by [-].
        chance: Chance that any channel shows a fall as large [-].
        left_open: What the fit's covariance (n, n) grows by if its gain is free: what the run leaves open of it, and the
            way that the estimates would move [-].
    """

    channel: str
    factor: complex
    fall: float
    chance: float
    left_open: Floats

    @property
    def change(self) -> float:
        """Return the part of its gain by which it changed [-]."""
        return abs(self.factor - 1.0)

    @property
    def words(self) -> str:
        """Return how it changed, in words."""
        turned = f"turned by {np.degrees(np.angle(self.factor)):+.1f}°"
        return f"the gain of {self.channel} fits best at {abs(self.factor):.3g} times its calibrated value, {turned}"


def most_changed_chain(problem: FitProblem, found: FitResult) -> ChangedChain | None:
    """Find the channel whose free gain would make a calibrated fit better by the most (Rao 1948).

    Source: score test of Rao, Math. Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The channel; None where the calibration holds no gain that the run shows.
    """
    return max(_chains(problem, found), key=lambda one: one.fall, default=None)


def _chains(problem: FitProblem, found: FitResult) -> Iterator[ChangedChain]:
    """Yield each channel whose gain the calibration holds and the run shows, by a change of it beside its calibrated value."""
    coordinates, channels = problem.coordinates, problem.train.channels
    precision, held = coordinates.prior.precision, set(coordinates.calibrated_places)
    covariance = np.linalg.inv(found.information + precision)
    moved = found.theta - coordinates.prior.centre
    for channel in channels:
        names = (f"probe.{channel}.gain.real", f"probe.{channel}.gain.imaginary")
        places = [place for place, name in enumerate(coordinates.names) if name in names]
        if len(places) < len(names) or not held.issuperset(places):
            continue
        column = precision[:, places]
        answer = covariance @ column
        curvature = column[places] - column.T @ answer
        if np.linalg.eigvalsh(curvature)[0] <= LEAST_SHOWN * np.linalg.eigvalsh(column[places])[0]:
            continue
        open_change, score = np.linalg.inv(curvature), column.T @ moved
        change = open_change @ score
        shift, fall = answer @ change, float(score @ change)
        gain = complex(coordinates.channels.gains(found.theta + shift)[channels.index(channel)])
        yield ChangedChain(
            channel,
            gain / (gain - complex(*(coordinates.unit[places] * change))),
            fall,
            min(1.0, len(channels) * float(scipy.special.chdtrc(len(places), fall))),
            answer @ open_change @ answer.T + np.outer(shift, shift),
        )
