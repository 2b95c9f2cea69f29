"""Sizes of what scatters in a calibration, from the calibration itself: noise of channels, differences between mountings.

Each is the sum of squares over the number of independent values in it, those that the fit has used up taken off: MacKay's
re-estimation (Neural Computation 4 (1992) 415, doi:10.1162/neco.1992.4.3.415), whose fixed point is restricted maximum
likelihood (Patterson and Thompson, Biometrika 58 (1971) 545, doi:10.1093/biomet/58.3.545). A stated size counts as a part of
one observation, so that a few mountings do not make it zero.
"""

from dataclasses import dataclass, replace

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.calibration.like_sizes import STATED_WEIGHT, shrunk_sizes
from estimator.calibration.mounted_problem import MountedLinearisation, MountedProblem

SHARED_WEIGHT = 0.5
"""Number of observations that the run-outs' size common to all channels counts for [-]."""
SETTLED = 0.03
"""Relative change of the noise and of run-outs up to which they count as unchanged [-]."""
SETTLED_ECCENTRICITY = 0.005
"""Relative change of the eccentricity up to which it counts as unchanged [-]: a factor on it is one on all gains."""
LARGEST_LEAD = 5.0
"""Most times that the eccentricity moves by what a pass asks for [-]."""


@dataclass(frozen=True)
class ScatterSizes:
    """Sizes of scatter in a calibration of P discs and m channels, with G groups of phasors that scatter alike.

    Attributes:
        noise: Rms of each group's complex errors over that of `MountedProblem`'s base (G,) [-].
        eccentricity: Rms difference of the eccentricity of all discs from mounting to mounting [m].
        run_out: Rms difference of each channel's run-out from mounting to mounting (m,) [m].
    """

    noise: Floats
    eccentricity: float
    run_out: Floats

    def is_near(self, other: "ScatterSizes") -> bool:
        """Check whether all sizes are those of another.

        Args:
            other: The other sizes.

        Returns:
            Whether they are.
        """
        mine, theirs = (np.r_[one.noise, one.run_out] for one in (self, other))
        near = abs(self.eccentricity - other.eccentricity) <= SETTLED_ECCENTRICITY * other.eccentricity
        return bool(near and np.all(np.abs(mine - theirs) <= SETTLED * theirs))

    def ahead(self, used: "ScatterSizes", before: "tuple[ScatterSizes, ScatterSizes] | None") -> "ScatterSizes":
        """Move the eccentricity to where it no longer changes, by the secant through two passes.

        Gains and eccentricity that change together hardly change the likelihood, so each pass goes a part of the way only.

        Source: Steffensen, Skand. Aktuarietidskr. 16 (1933) 64 (secant of a fixed point's iteration).

        Args:
            used: The sizes from which these were estimated.
            before: The sizes of the pass before, and those estimated from them; None in the first.

        Returns:
            These sizes with that eccentricity.
        """
        if before is None or before[0].eccentricity == used.eccentricity:
            return self
        asked, asked_before = (np.log(new.eccentricity / old.eccentricity) for old, new in ((used, self), before))
        change = (asked_before - asked) / np.log(used.eccentricity / before[0].eccentricity)
        lead = float(np.clip(1.0 / change, 1.0, LARGEST_LEAD)) if change > 0.0 else 1.0
        return replace(self, eccentricity=float(used.eccentricity * np.exp(lead * asked)))


@dataclass(frozen=True)
class _Shown:
    """Evidence of a fit's end on P discs and m channels, and of G groups of phasors, in units of the present sizes.

    squares, known: sums of squared differences between mountings (P + m,), and how many of them the data determine, complex.
    residual, freedom: the same of the residuals of each group (G,).
    """

    squares: Floats
    known: Floats
    residual: Floats
    freedom: Floats


@dataclass(frozen=True)
class ScatterModel:
    """Model of what scatters alike in a calibration.

    Attributes:
        base: Rms error (S, m) of each phasor for a size of one [m].
        group: Group (S, m) of each phasor.
        pool: Number (G,) of the kind of each group; sizes of one kind are expected to be in proportion to those stated.
        mass: Mass (P,) of each disc [kg].
        stated: Sizes believed beforehand.
    """

    base: Floats
    group: NDArray[np.intp]
    pool: NDArray[np.intp]
    mass: Floats
    stated: ScatterSizes

    def applied(self, problem: MountedProblem, sizes: ScatterSizes) -> MountedProblem:
        """Return a problem with some sizes of scatter.

        Args:
            problem: The problem.
            sizes: The sizes.

        Returns:
            The problem with them.
        """
        measurement = structs.replace(problem.measurement, scatter=self.base * sizes.noise[self.group])
        return structs.replace(problem, measurement=measurement, spread=np.r_[sizes.eccentricity * self.mass, sizes.run_out])

    def estimated(self, problem: MountedProblem, theta: Floats, sizes: ScatterSizes) -> ScatterSizes:
        """Estimate the sizes anew at the end of a fit (MacKay 1992, doi:10.1162/neco.1992.4.3.415).

        Args:
            problem: The problem with the present sizes.
            theta: The fit's end θ (n,) [-].
            sizes: The present sizes.

        Returns:
            The new sizes.
        """
        shown = self._shown(problem, theta)
        noise, squares, known = self._noise(shown, sizes), shown.squares, shown.known
        planes, stated = problem.planes, self.stated
        of_discs = sizes.eccentricity**2 * squares[:planes].sum() + STATED_WEIGHT * stated.eccentricity**2
        eccentricity = float(np.sqrt(of_discs / (known[:planes].sum() + STATED_WEIGHT)))
        squares, known = squares[planes:] * sizes.run_out**2, known[planes:]
        shared = (squares.sum() + STATED_WEIGHT * stated.run_out**2) / (known.sum() + STATED_WEIGHT)
        run_out = np.sqrt((squares + SHARED_WEIGHT * shared) / (known + SHARED_WEIGHT))
        return ScatterSizes(noise, eccentricity, run_out)

    def freedom(self, problem: MountedProblem, theta: Floats) -> Floats:
        """Compute how many independent real values each kind of scatter rests on, beside what the fit has used up.

        Source: MacKay, Neural Computation 4 (1992) 415, doi:10.1162/neco.1992.4.3.415.

        Args:
            problem: The problem with the sizes of scatter.
            theta: The fit's end θ (n,) [-].

        Returns:
            Real degrees of freedom of the noise of dwells, that of sweeps, eccentricity and run-outs (4,) [-].
        """
        shown, planes = self._shown(problem, theta), problem.planes
        noise = np.bincount(self.group[problem.used], minlength=self.pool.size) > 0
        noise_freedom = np.bincount(self.pool[noise], weights=shown.freedom[noise], minlength=2)
        known = np.array([shown.known[:planes].sum(), shown.known[planes:].sum()])
        return np.asarray(2.0 * (np.r_[noise_freedom, known] + STATED_WEIGHT))

    def _shown(self, problem: MountedProblem, theta: Floats) -> "_Shown":
        """Return what a fit's end shows of the sizes, in units of the present ones."""
        found = problem.linearisation(theta, problem.weight(np.abs(problem.measurement.phasor), 0.0))
        curvature = found.rows @ found.rows.T + problem.coordinates.prior.precision
        curvature -= found.explained()
        covariance: Floats = np.asarray(np.linalg.inv(curvature), dtype=float)
        # Squares of the differences in units of their size, and how much of each the data determine.
        across = np.einsum("mqp,mnp->mqn", found.inverse, found.mixed)
        open_part = np.einsum("mqq->mq", found.inverse) + np.einsum(
            "mqn,nk,mqk->mq", across, covariance, across, optimize=True
        )
        squares = np.sum(found.difference**2, axis=0).reshape(-1, 2).sum(axis=1) / 2.0
        known = np.sum(np.maximum(0.0, 1.0 - open_part), axis=0).reshape(-1, 2).sum(axis=1) / 2.0
        used = np.repeat(problem.used.reshape(-1), 2)
        group = np.repeat(self.group.reshape(-1), 2)
        spent = _spent(found, covariance)
        count = self.pool.size
        residual = np.bincount(group, weights=np.where(used, found.residual**2, 0.0), minlength=count) / 2.0
        freedom = np.bincount(group, weights=np.where(used, np.maximum(0.0, 1.0 - spent), 0.0), minlength=count) / 2.0
        return _Shown(squares, known, residual, freedom)

    def _noise(self, shown: "_Shown", sizes: ScatterSizes) -> Floats:
        """Return the noise of each group (G,) from its residuals and the part of them that the fit has used up."""
        stated = self.stated.noise
        squares = shown.residual * (sizes.noise / stated) ** 2
        found = np.empty(stated.size)
        for kind in np.unique(self.pool):
            which = self.pool == kind
            found[which] = stated[which] * shrunk_sizes(squares[which], shown.freedom[which])
        return found


def _spent(found: MountedLinearisation, covariance: Floats) -> Floats:
    """Return the part of each residual (R,) that the fit has used up."""
    spent = np.empty(found.residual.size)
    for one in range(len(found.inverse)):
        which = found.mounting == one
        own = found.own[:, which]
        solved = found.inverse[one] @ own
        rest = found.rows[:, which] - found.mixed[one] @ solved
        spent[which] = np.sum(own * solved, axis=0) + np.sum(rest * (covariance @ rest), axis=0)
    return spent
