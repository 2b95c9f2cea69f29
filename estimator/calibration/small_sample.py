"""Widening of a calibration's intervals because its sizes of scatter were themselves estimated from few mountings.

Variance of the machine's own unbalance is the sum of what each kind of scatter makes of it. Its effective degrees of freedom
follow Satterthwaite (Biometrics Bull. 2 (1946) 110, doi:10.2307/3002019), as Kenward and Roger have it for restricted maximum
likelihood (Biometrics 53 (1997) 983, doi:10.2307/2533558); intervals are wider by Student's t over the normal quantile.
"""

from dataclasses import replace

import numpy as np
import scipy.special
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.calibration.mounted_problem import MountedProblem
from estimator.calibration.scatter_likelihood import information_of_means
from estimator.calibration.variance_components import ScatterModel, ScatterSizes
from estimator.fit.estimates import CONFIDENCE_95

STEP = 0.05
"""Relative step of a size by which its share of a variance is found [-]."""
LEAST_FREEDOM = 2.0
"""Fewest real degrees of freedom that are believed [-]: a few mountings hold no less beside what is stated beforehand."""


def widened(problem: MountedProblem, scatter: ScatterModel, theta: Floats, sizes: ScatterSizes) -> ScatterSizes:
    """Return sizes of scatter widened by how little the runs show of them (Kenward and Roger 1997, doi:10.2307/2533558).

    Args:
        problem: The problem.
        scatter: What scatters alike in it.
        theta: The fit's end θ (n,) [-].
        sizes: Sizes of scatter that the runs showed.

    Returns:
        The sizes with which normal intervals hold as often as they say.
    """
    factor = float(scipy.special.stdtrit(_effective_freedom(problem, scatter, theta, sizes), 0.975)) / CONFIDENCE_95
    return _scaled(sizes, scatter.pool, np.full(4, factor))


def _effective_freedom(problem: MountedProblem, scatter: ScatterModel, theta: Floats, sizes: ScatterSizes) -> float:
    """Return the degrees of freedom of the variance of the machine's own unbalance in a further mounting [-]."""
    freedom = scatter.freedom(scatter.applied(problem, sizes), theta)
    variance = _variance(problem, scatter, theta, sizes)
    shares = []
    for kind in range(freedom.size):
        factor = np.ones(freedom.size)
        factor[kind] += STEP
        moved = _variance(problem, scatter, theta, _scaled(sizes, scatter.pool, factor))
        shares.append(np.log(moved / variance) / (2.0 * np.log1p(STEP)))
    return max(LEAST_FREEDOM, float(1.0 / max(np.sum(np.square(shares) / freedom), 1e-12)))


def _variance(problem: MountedProblem, scatter: ScatterModel, theta: Floats, sizes: ScatterSizes) -> float:
    """Return the variance of the discs' unbalance over their mass in a further mounting, summed [m²]."""
    now = scatter.applied(problem, sizes)
    coordinates = now.coordinates
    information = information_of_means(now, theta)
    covariance = np.linalg.inv(information + coordinates.prior.precision) * np.outer(coordinates.unit, coordinates.unit)
    masses = {one.name: mass for one, mass in zip(now.train.unknowns.unbalances, scatter.mass, strict=True)}
    parts = {f"{name}.{part}": mass for name, mass in masses.items() for part in ("real", "imaginary")}
    of_unbalance = [covariance[place, place] / parts[one] ** 2 for place, one in enumerate(coordinates.names) if one in parts]
    return float(np.sum(of_unbalance)) + scatter.mass.size * sizes.eccentricity**2


def _scaled(sizes: ScatterSizes, pool: NDArray[np.intp], factor: Floats) -> ScatterSizes:
    """Return sizes with factors (4,) on noise of dwells and of sweeps, eccentricity and run-outs."""
    return replace(
        sizes,
        noise=sizes.noise * factor[pool],
        eccentricity=float(sizes.eccentricity * factor[2]),
        run_out=sizes.run_out * factor[3],
    )
