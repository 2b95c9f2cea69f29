"""Contradiction between a run and the calibration that holds its fit.

If the calibration still holds, the least misfit together with the cost of the prior that it gives follows χ², with as many
degrees of freedom as the run has numbers, less the unknowns that no prior holds (check against the prior's prediction: Box,
J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063). The misfit alone hides what the held parameters were bent by. Where χ²
is unlikely, but not enough to refuse the fit, intervals grow by Birge's ratio √(χ²/dof) (Phys. Rev. 40 (1932) 207,
doi:10.1103/PhysRev.40.207).
"""

import numpy as np
import scipy
from msgspec import Struct

from estimator.fit.optimisation.nuisance_parameters import effective_number_of
from estimator.fit.problem.fit_problem import FitProblem, FitResult

UNLIKELY = 0.05
"""Chance of a χ² as large beneath which intervals are widened [-]."""
SMALLEST_CHANCE = 1e-4
"""Chance of a χ² as large beneath which few degrees of freedom refuse a fit [-]."""
LEAST_SCATTER = 1e-6
"""Least part of a held parameter's variance that a run must decide for its distance to mean anything [-]."""


class CalibrationConflict(Struct, frozen=True):
    """Misfit of a run with what its calibration holds.

    Attributes:
        chi_square: χ² of the run and of the parameters that the calibration holds [-].
        freedom: Its degrees of freedom.
        furthest: Name of the held parameter that the run moves furthest, and by how many standard errors [-].
    """

    chi_square: float
    freedom: int
    furthest: tuple[str, float]

    @property
    def chance(self) -> float:
        """Return the chance of a χ² as large [-]."""
        return float(scipy.special.chdtrc(self.freedom, self.chi_square))

    @property
    def inflation(self) -> float:
        """Return the factor on the fit's covariance, 1 where chance explains the misfit [-]."""
        if self.chance >= UNLIKELY:
            return 1.0
        return max(1.0, self.chi_square / self.freedom)

    @property
    def words(self) -> str:
        """Return how large it is and where, in words."""
        name, away = self.furthest
        return f"χ²/dof with it {self.chi_square / self.freedom:.3g}; {name} furthest from it, by {away:.1f} standard errors"


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
        found.chi_square + float(moved @ precision @ moved), freedom, (name, float(abs(moved[worst]) / scatter[worst]))
    )
