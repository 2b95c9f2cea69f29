"""Fit of several mountings of a machine together, in each of which unbalances and run-outs differ a little.

What differs from mounting to mounting is Gaussian with a stated size, and enters the phasors linearly. At given coordinates it
is solved for and eliminated, mounting by mounting: χ² is that at the most likely differences with their own cost, and the
curvature is the Schur complement (mixed model: Henderson, Biometrics 31 (1975) 423, doi:10.2307/2529430; elimination of
linear unknowns: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036).
"""

from dataclasses import dataclass

import numpy as np
from msgspec import field
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.calibration.determinant_bound import DeterminantBound
from estimator.fit.optimisation.maximum_likelihood import BEND_PART, bend
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import Sensitivity, excitation_responses, sensitivity


@dataclass(frozen=True)
class MountedLinearisation:
    """Linearised problem of R real residuals (two per phasor), n coordinates and q differences in each of M mountings.

    Attributes:
        residual: Weighted residuals (R,) at the most likely differences [-].
        rows: Their derivatives (n, R) by the coordinates [-].
        own: Their derivatives (q, R) by the differences of the mounting that each belongs to, in units of their size [-].
        mounting: Mounting (R,) that each belongs to.
        inverse: Inverse (M, q, q) of the curvature by the differences of each mounting, with their prior [-].
        mixed: Curvature (M, n, q) by coordinates and differences [-].
        difference: Most likely differences (M, q) in units of their size [-].
    """

    residual: Floats
    rows: Floats
    own: Floats
    mounting: NDArray[np.intp]
    inverse: Floats
    mixed: Floats
    difference: Floats

    def explained(self) -> Floats:
        """Compute the curvature that the differences between mountings take away.

        Returns:
            Curvature (n, n) [-].
        """
        count = self.mixed.shape[1]
        solved = np.matmul(self.mixed, self.inverse).swapaxes(0, 1).reshape(count, -1)
        return np.asarray(solved @ self.mixed.swapaxes(0, 1).reshape(count, -1).T)

    def projected(self, residual: Floats, difference: Floats) -> Floats:
        """Project the residuals onto the derivatives, after removal of what differences between mountings explain.

        Args:
            residual: Weighted numbers (R,) in the form of the residuals [-].
            difference: Numbers (M, q) in the form of the differences, whose own cost counts as residuals do [-].

        Returns:
            Projection (n,) [-].
        """
        seen = difference.copy()
        np.add.at(seen, self.mounting, (self.own * residual).T)
        return np.asarray(self.rows @ residual - np.einsum("mnq,mqp,mp->n", self.mixed, self.inverse, seen))


class MountedProblem(FitProblem, frozen=True, eq=False):
    """Fit problem in which unbalances and run-outs differ from mounting to mounting.

    The samples are in the order of their mountings. Each difference is complex; there are P of discs and m of channels.

    Attributes:
        mounting: Mounting (S,) of each sample, ascending from 0.
        spread: Rms (P + m,) of the difference of each disc's unbalance [kg m] and of each channel's run-out [m].
        bound: What counts beside χ²; None for nothing.
    """

    mounting: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    spread: Floats = field(default_factory=lambda: np.zeros(0))
    bound: DeterminantBound | None = None

    @property
    def planes(self) -> int:
        """Return the number of discs P."""
        return len(self.train.unknowns.unbalances)

    def model(self, theta: Floats) -> Complexes:
        """Compute the phasors that the channels should show at θ, with the most likely differences.

        Source: mixed model of Henderson, Biometrics 31 (1975) 423, doi:10.2307/2529430.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Phasors (S, m) [m].
        """
        weight = np.where(self.used, self.weight(self.first_amplitude, 0.0), 0.0)
        phasor, by_difference = self._effects(theta, self.scaled_train(theta))
        difference = self._differences(phasor, by_difference, weight)[1]
        return np.asarray(phasor + np.einsum("sq,qsc->sc", difference[self.mounting], by_difference))

    def unexplained_part(self, theta: Floats) -> float:
        """Compute the ratio of the differences between mountings to the effects of the known unbalances.

        Source: mixed model of Henderson, Biometrics 31 (1975) 423, doi:10.2307/2529430.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Rms of the effects of the differences over that of the effects of added unbalances [-].
        """
        bare = replace(self, measurement=replace(self.measurement, added=None))
        with_added, without = (one._effects(theta, one.scaled_train(theta))[0] for one in (self, bare))
        differences, trials = self.model(theta) - with_added, with_added - without
        return float(np.linalg.norm(differences[self.used]) / np.linalg.norm(trials[self.used]))

    def linearised(self, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
        """Linearise the problem at θ, without the differences between mountings.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² of the data with the cost of the differences and the bound [-], -½ of its gradient (n,) [-] and ½ of its
            curvature (n, n) [-].
        """
        found = self.linearisation(theta, weight)
        chi_square = float(found.residual @ found.residual + np.sum(found.difference**2))
        curvature = found.rows @ found.rows.T
        curvature -= found.explained()
        gradient = found.rows @ found.residual
        if self.bound is None:
            return chi_square, gradient, curvature
        slope, bend_of_bound = self.bound.derivatives(theta)
        return chi_square + self.bound.value(theta), gradient - slope / 2.0, curvature + bend_of_bound / 2.0

    def chi_square(self, theta: Floats, weight: Floats) -> float:
        """Compute χ² at the most likely differences between mountings, with their cost.

        Source: mixed model of Henderson, Biometrics 31 (1975) 423, doi:10.2307/2529430.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            χ² [-].
        """
        weight = np.where(self.used, weight, 0.0)
        phasor, by_difference = self._effects(theta, self.scaled_train(theta))
        lowered = self._differences(phasor, by_difference, weight)[2]
        residual = (self.measurement.phasor - phasor) * weight
        return float(np.vdot(residual, residual).real) - lowered + (0.0 if self.bound is None else self.bound.value(theta))

    def residual(self, theta: Floats, weight: Floats) -> tuple[Floats, Floats]:
        """Compute what is left at the most likely differences between mountings.

        Source: mixed model of Henderson, Biometrics 31 (1975) 423, doi:10.2307/2529430.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m], zero where a phasor does not count.

        Returns:
            Weighted residuals (R,) and these differences (M, q) in units of their size [-].
        """
        phasor, by_difference = self._effects(theta, self.scaled_train(theta))
        difference = self._differences(phasor, by_difference, weight)[1]
        whole = phasor + np.einsum("sq,qsc->sc", difference[self.mounting], by_difference)
        return _real_parts((self.measurement.phasor - whole) * weight), difference

    def linearisation(self, theta: Floats, weight: Floats) -> MountedLinearisation:
        """Linearise the problem at θ and at the differences between mountings that are most likely there.

        Source: Schur complement; Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036.

        Args:
            theta: Fit coordinates θ (n,) [-].
            weight: Weights (S, m) [1/m].

        Returns:
            The linearised problem.
        """
        weight = np.where(self.used, weight, 0.0)
        train = self.scaled_train(theta)
        phasor, by_difference = self._effects(theta, train)
        inverse, difference, _ = self._differences(phasor, by_difference, weight)
        moved = self.excitations(theta)
        moved = np.tile(moved, (self.mounting.size, 1)) if moved.ndim == 1 else moved.copy()
        unbalances = (difference[:, : 2 * self.planes : 2] + 1j * difference[:, 1 : 2 * self.planes : 2]) * self._sizes
        moved[:, : self.planes] += unbalances[self.mounting]
        coefficients = self.coordinates.coefficients(theta)
        rows, residual = [], []
        for block in train.blocks():
            found = self._sensitivity(train, block, coefficients, moved)
            direction = self.measurement.direction[block]
            modelled = self.coordinates.channels.as_measured(theta, found.phasor, direction)
            run_out = np.einsum(
                "sq,qsc->sc", difference[self.mounting[block], 2 * self.planes :], by_difference[2 * self.planes :, block]
            )
            slope = phasor_jacobian(
                self.coordinates, theta, found, coefficients=coefficients, direction=direction, block=block
            )
            residual.append(_real_parts((self.measurement.phasor[block] - modelled - run_out) * weight[block]))
            rows.append(_real_parts(slope * weight[block]))
        whole, own = np.concatenate(rows, axis=-1), _real_parts(by_difference * weight)
        mounting = np.repeat(self.mounting, 2 * weight.shape[1])
        edges = np.searchsorted(mounting, np.arange(len(inverse) + 1))
        pieces = [slice(first, last) for first, last in zip(edges, edges[1:], strict=False)]
        mixed = np.stack([whole[:, one] @ own[:, one].T for one in pieces])
        return MountedLinearisation(np.concatenate(residual, axis=-1), whole, own, mounting, inverse, mixed, difference)

    @property
    def _sizes(self) -> Floats:
        """Return the size of one unit of a disc's difference (P,) in each of its real parts [kg m]."""
        return np.asarray(self.spread[: self.planes] / np.sqrt(2.0))

    def _sensitivity(self, train: CondensedTrain, block: slice, coefficients: Floats, excitations: Complexes) -> Sensitivity:
        return sensitivity(
            train.pick(block),
            coefficients=coefficients if coefficients.ndim == 1 else coefficients[block],
            excitations=excitations if excitations.ndim == 1 else excitations[block],
        )

    def _effects(self, theta: Floats, train: CondensedTrain) -> tuple[Complexes, Complexes]:
        """Compute phasors (S, m) without differences, and their derivatives (q, S, m) by those in units of their size [m]."""
        coefficients, excitations = self.coordinates.coefficients(theta), self.excitations(theta)
        gains, direction = self.coordinates.channels.gains(theta), self.measurement.direction
        samples, channels = self.measurement.phasor.shape
        each = excitation_responses(train, coefficients=coefficients)
        parts = np.stack([excitations.real, excitations.imag], axis=-1).reshape(*excitations.shape[:-1], -1)
        shown = np.einsum("esm,e->sm" if parts.ndim == 1 else "esm,se->sm", each, parts)
        phasor = self.coordinates.channels.as_measured(theta, shown, direction)
        own = np.zeros((2 * (self.planes + channels), samples, channels), dtype=complex)
        own[: 2 * self.planes] = each[: 2 * self.planes] * gains * np.repeat(self._sizes, 2)[:, None, None]
        size = self.spread[self.planes :] / np.sqrt(2.0)
        for channel in range(channels):
            first = 2 * (self.planes + channel)
            own[first, :, channel] = size[channel]
            own[first + 1, :, channel] = 1j * size[channel] * direction
        return phasor, own

    def _differences(self, phasor: Complexes, by_difference: Complexes, weight: Floats) -> tuple[Floats, Floats, float]:
        """Return inverse curvature (M, q, q), most likely differences (M, q), and by how much these lower χ²."""
        residual = (self.measurement.phasor - phasor) * weight
        slope = by_difference * weight
        count, size = int(self.mounting.max()) + 1, len(by_difference)
        edges = np.searchsorted(self.mounting, np.arange(count + 1))
        curvature, gradient = np.empty((count, size, size)), np.empty((count, size))
        for one, (first, last) in enumerate(zip(edges, edges[1:], strict=False)):
            rows = _real_parts(slope[:, first:last])
            curvature[one] = rows @ rows.T + np.eye(size)
            gradient[one] = rows @ _real_parts(residual[first:last])
        inverse: Floats = np.asarray(np.linalg.inv(curvature), dtype=float)
        difference: Floats = np.asarray(np.einsum("mqp,mp->mq", inverse, gradient))
        return inverse, difference, float(np.sum(difference * gradient))


@bend.register
def mounted_bend(problem: MountedProblem, theta: Floats, step: Floats, weight: Floats) -> Floats:
    """Compute the second derivative of the weighted phasors along a step, with the differences that are most likely there.

    Projected on the derivatives of the problem without differences (variable projection; Golub and Pereyra 1973,
    doi:10.1137/0710036).

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        step: Step (n,) [-].
        weight: Weights (S, m) [1/m].

    Returns:
        Projection (n,) [-]; not finite where there is no model so far along the step.
    """
    weight = np.where(problem.used, weight, 0.0)
    here = problem.linearisation(theta, weight)
    residual, difference = problem.residual(theta + BEND_PART * step, weight)
    sloping = -np.einsum("mqp,mnp,n->mq", here.inverse, here.mixed, step)
    slope = step @ here.rows + np.einsum("rq,qr->r", sloping[here.mounting], here.own)
    second = 2.0 / BEND_PART
    return here.projected(
        second * ((here.residual - residual) / BEND_PART - slope),
        second * ((difference - here.difference) / BEND_PART - sloping),
    )


@best_excitations.register
def mounted_excitations(problem: MountedProblem, theta: Floats, weight: Floats) -> Floats:
    """Solve for the excitations that fit best, with the differences that are most likely there, while everything else stays.

    Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        weight: Weights (S, m) [1/m].

    Returns:
        θ (n,) with these unbalances, bows and loads [-]; as it was where there is no model.
    """
    first = problem.coordinates.excitation_place[problem.coordinates.excitation_place >= 0]
    free = np.concatenate([first, first + 1])
    _, slope, curvature = problem.linearised(theta, weight)
    if free.size == 0 or not np.isfinite(curvature).all():
        return theta  # where a film is too thin
    prior = problem.coordinates.prior
    found = theta.copy()
    # The model is linear in excitations and differences: one Newton step is the answer.
    block = (curvature + prior.precision)[np.ix_(free, free)]
    found[free] += np.linalg.solve(block, (slope - prior.pull(theta))[free])
    return found


def _real_parts(values: Complexes) -> Floats:
    """Return the last two axes (s, m) as one of real and imaginary parts (2sm,), behind those before."""
    flat = np.ascontiguousarray(values).reshape(*values.shape[:-2], -1)
    return np.asarray(flat.view(float))
