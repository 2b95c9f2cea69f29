"""Likelihood of a run in compliances of its couplings: what a run says of alignment is linear in these, not in stiffnesses.

A rigid coupling's stiffness is known from below only, and fits of single runs find it anywhere above that. What a train gives
way by is linear in the compliance, and next to nothing wherever the stiffness is large. In the logarithm of the stiffness, a
fit that found the coupling soft would be carried on in a straight line to where the other runs have it.
"""

from dataclasses import dataclass

import numpy as np

from estimator.alignment.run_likelihood import RunLikelihood
from estimator.arrays import Floats
from estimator.machine.parameter_description import describe, is_direct

NEAR = 1.0
"""Logarithm of the factor about the usual stiffness within which a stiffness counts by its logarithm [-]."""
FARTHEST = 6.0
"""Largest logarithm of such a factor that is reckoned with [-]."""


@dataclass(frozen=True)
class CompliantCouplings:
    """Couplings' stiffnesses among n coordinates, as they are near the usual ones and as compliances farther off.

    Attributes:
        places: Places (p,) of the logarithms of their direct stiffnesses.
        unit: Units (p,) of these coordinates [logarithms].
        usual: What they usually are (p,), less the prior's centre [-].
    """

    places: tuple[int, ...]
    unit: Floats
    usual: Floats

    def likelihood(self, one: RunLikelihood, found: Floats) -> RunLikelihood:
        """Return a run's likelihood with compliances in place of stiffnesses that lie far off (change of variables).

        Args:
            one: The likelihood.
            found: Coordinates (n,) that the run's fit has found, less the prior's centre [-].

        Returns:
            The likelihood of coordinates that are those of before near the usual stiffnesses.
        """
        at, slope = self.carried(found)
        left = one.vector - one.information @ found
        information = one.information * np.outer(slope, slope)
        return RunLikelihood(information, information @ at + slope * left)

    def carried(self, found: Floats) -> tuple[Floats, Floats]:
        """Return coordinates with compliances in place of stiffnesses that lie far off, and by how much they change.

        Args:
            found: Coordinates (n,) that a run's fit has found, less what the usual ones are counted from [-].

        Returns:
            The same (n,) counted by compliances, and the change (n,) of each of before per unit of it [-].
        """
        places = list(self.places)
        away = np.clip((found[places] - self.usual) * self.unit, -FARTHEST, FARTHEST)
        beyond = away - np.clip(away, -NEAR, NEAR)
        at, slope = found.copy(), np.ones(len(found))
        at[places] = self.usual + (np.clip(away, -NEAR, NEAR) + 1.0 - np.exp(-beyond)) / self.unit
        slope[places] = np.exp(beyond)
        return at, slope


def compliant_couplings(names: tuple[str, ...], unit: Floats, found: Floats) -> CompliantCouplings:
    """Find the couplings' stiffnesses among coordinates, and what several runs usually have of them (their median).

    Args:
        names: Names of the n coordinates.
        unit: Units (n,) of these [SI, 1 for logarithms].
        found: Coordinates (k, n) that the fits of k runs have found, less the prior's centre [-].

    Returns:
        The couplings.
    """
    places = [place for place, name in enumerate(names) if _is_coupling_stiffness(name)]
    return CompliantCouplings(tuple(places), unit[places], np.median(found[:, places], axis=0))


def _is_coupling_stiffness(name: str) -> bool:
    said = describe(name)
    return said.element_kind == "coupling" and said.term is not None and said.term.order == 0 and is_direct(name)
