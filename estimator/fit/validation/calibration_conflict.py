"""Contradiction between a run and the calibration that holds its fit.

If the calibration still holds, the least misfit together with the cost of the prior that it gives follows χ², with as many
degrees of freedom as the run has numbers, less the unknowns that no prior holds (check against the prior's prediction: Box,
J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063). The misfit alone hides what the held parameters were bent by; a single
chain that has changed hides in χ², too, and is looked for by itself. Where one is likely, but not enough to refuse the fit,
intervals leave its gain open; where the rest of χ² is still unlikely, they grow by the root of its ratio to the largest that
chance explains, after Birge (Phys. Rev. 40 (1932) 207, doi:10.1103/PhysRev.40.207).
"""

import numpy as np
import scipy
from msgspec import Struct

from estimator.fit.optimisation.nuisance_parameters import effective_number_of
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.changed_chain import ChangedChain, most_changed_chain

UNLIKELY = 0.05
"""Chance of a χ², or of a changed chain, as large beneath which intervals are widened [-]."""
SMALLEST_CHANCE = 1e-4
"""Chance of a χ² as large beneath which few degrees of freedom, or a changed chain, refuse a fit [-]."""
LEAST_CHANGE = 0.05
"""Part of a gain by which it must have changed to refuse a fit: intervals cover a smaller change [-]."""
LEAST_SCATTER = 1e-6
"""Least part of a held parameter's variance that a run must decide for its distance to mean anything [-]."""


class CalibrationConflict(Struct, frozen=True):
    """Misfit of a run with what its calibration holds.

    Attributes:
        chi_square: χ² of the run and of the parameters that the calibration holds [-].
        freedom: Its degrees of freedom.
        furthest: Name of the held parameter that the run moves furthest, and by how many standard errors [-].
        chain: The measuring chain that the run shows most changed; None where the calibration holds no gain that it shows.
    """

    chi_square: float
    freedom: int
    furthest: tuple[str, float]
    chain: ChangedChain | None = None

    @property
    def chance(self) -> float:
        """Return the chance of a χ² as large [-].

        Source: Box, J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063.
        """
        return float(scipy.special.chdtrc(self.freedom, self.chi_square))

    @property
    def chain_changed(self) -> bool:
        """Return whether a chain has changed by more than its interval has to cover, and by more than chance explains."""
        return self.chain is not None and self.chain.chance < SMALLEST_CHANCE and self.chain.change > LEAST_CHANGE

    @property
    def doubted(self) -> ChangedChain | None:
        """Return the chain that may have changed; None where chance explains what is seen of it."""
        return self.chain if self.chain is not None and self.chain.chance < UNLIKELY else None

    @property
    def inflation(self) -> float:
        """Return the factor on the covariance, 1 where chance explains the misfit apart from that of a doubted chain [-].

        Source: Birge, Phys. Rev. 40 (1932) 207, doi:10.1103/PhysRev.40.207.
        """
        chi_square, freedom = self.chi_square, self.freedom
        if self.doubted is not None:
            chi_square, freedom = chi_square - self.doubted.fall, max(1, freedom - 2)
        return max(1.0, chi_square / float(scipy.special.chdtri(freedom, UNLIKELY)))

    @property
    def words(self) -> str:
        """Return how large it is and where, in words."""
        name, away = self.furthest
        words = f"χ²/dof with it {self.chi_square / self.freedom:.3g}; {name} furthest from it, by {away:.1f} standard errors"
        return words if self.doubted is None else f"{words}; {self.doubted.words}"


def calibration_conflict(problem: FitProblem, found: FitResult) -> CalibrationConflict | None:
    """Compare a fit with the calibration that holds it (Box 1980, doi:10.2307/2982063).

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The comparison; None where no calibration holds the fit, or its noise is estimated from the same residuals.
    """
    coordinates = problem.coordinates
    held = np.array(coordinates.calibrated_places, dtype=np.intp)
    if not held.size or found.noise.estimated:
        return None
    moved = found.theta[held] - coordinates.prior.centre[held]
    precision = coordinates.prior.precision[np.ix_(held, held)]
    by_effect = coordinates.nuisance.copy()
    by_effect[held] = False
    numbers = 2 * int(np.count_nonzero(problem.measurement.usable & ~found.outlier))
    free = coordinates.size - held.size - int(np.count_nonzero(by_effect))
    freedom = max(1, numbers - free - round(effective_number_of(by_effect, problem, found)))
    before = coordinates.spread[held] ** 2
    after = np.diag(np.linalg.inv(found.information + coordinates.prior.precision))[held]
    scatter = np.sqrt(np.maximum(before - after, LEAST_SCATTER * before))
    worst = int(np.argmax(np.abs(moved) / scatter))
    name = coordinates.names[held[worst]].removesuffix(".real").removesuffix(".imaginary")
    return CalibrationConflict(
        found.chi_square + float(moved @ precision @ moved),
        freedom,
        (name, float(abs(moved[worst]) / scatter[worst])),
        most_changed_chain(problem, found),
    )
