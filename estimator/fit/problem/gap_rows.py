"""Gaps of a run as rows of a fit: where the shaft stands over speed, each probe's zero and its drift marginalised.

A gap is g = u + z + d τ + ε: u the place of the shaft that follows from the films, z a zero of the probe in that run, d τ its
drift over the run's time, ε noise. With z of any size, d of a stated one and ε independent the errors have the covariance V =
σ² 1 + U Uᵀ, and rows V^-½ (g - u) count as residuals of unit size: nothing more need be fitted (marginal likelihood of a model
that is linear in its nuisances; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.7). A film's
force that deviates by some part moves the journals as that part of its viscosity would; U holds that, too, as the Gaussian
process over speed by which the document says that films deviate (derived here).
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.machine.rules import Centreline
from estimator.phasors.measurement import MeasuredGaps

if TYPE_CHECKING:
    from estimator.statics.film_model import FilmModel
    from estimator.statics.shaft_centreline import ShaftCentreline

ANY_ZERO = 1e-2
"""Prior standard deviation of a probe's zero: it may be anywhere [m]."""
FEWEST_SAMPLES = 8
"""Least number of gaps of a channel in a run: fewer say nothing of its noise."""
FORCE_PART = 0.4
"""Deviation of a film's force over that of its coefficients, which are its derivatives: solvers agree to 2 % in loads [-]."""
NORMAL_MEDIAN = 0.6745
"""Median of the size of a normal number of unit variance [-]."""


class ChannelGaps(Struct, frozen=True, eq=False):
    """Gaps of one channel in one run, s samples.

    Attributes:
        channel: Number of the channel.
        run: Number of the run.
        samples: Indices (s,) of the samples, in order of time.
        place: Measured places of the shaft (s,) [m].
        noise: Rms error of each [m].
        common: Orthonormal shapes (s, k) of errors that the samples share [-].
        shrunk: Part (k,) of each shape that whitening takes away [-].
    """

    channel: int
    run: int
    samples: NDArray[np.intp]
    place: Floats
    noise: float
    common: Floats
    shrunk: Floats

    @classmethod
    def of(
        cls, channel: int, run: int, samples: NDArray[np.intp], place: Floats, *, noise: float, errors: Floats
    ) -> "ChannelGaps":
        """Take the gaps of a channel with the errors that its samples share.

        Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 2.7.

        Args:
            channel: Number of the channel.
            run: Number of the run.
            samples: Indices (s,) of the samples.
            place: Measured places of the shaft (s,) [m].
            noise: Rms error of each [m].
            errors: Errors (s, r) that the samples share, each with a factor of unit variance [m].

        Returns:
            The gaps.
        """
        shapes, size, _ = np.linalg.svd(errors, full_matrices=False)
        return cls(channel, run, samples, place, noise, shapes, 1.0 - 1.0 / np.hypot(1.0, size / noise))

    @property
    def freedom(self) -> int:
        """Return the number of independent errors: the zero may be anything."""
        return int(self.samples.size) - 1

    def whitened(self, values: Floats) -> Floats:
        """Return values at the gaps' samples whitened: their errors become independent, of unit size.

        Args:
            values: Values at all samples of the fit (S, ...) [m].

        Returns:
            Values (s, ...) [-].
        """
        return self._white(values[self.samples])

    @property
    def measured(self) -> Floats:
        """Return the measured places, whitened (s,) [-]."""
        return self._white(self.place)

    def _white(self, values: Floats) -> Floats:
        parts = np.tensordot(self.common.T, values, 1)
        return np.asarray((values - np.tensordot(self.common * self.shrunk, parts, 1)) / self.noise)


class GapRows(Struct, frozen=True, eq=False):
    """Gaps of a fit with the centreline that the films give.

    Attributes:
        centreline: The centreline at the fit's S speeds.
        places: Places (P,) of what the films follow from among the coordinates.
        channels: Gaps of each channel and run.
    """

    centreline: "ShaftCentreline"
    places: NDArray[np.intp]
    channels: tuple[ChannelGaps, ...]

    @property
    def freedom(self) -> int:
        """Return the number of independent errors of all gaps."""
        return sum(one.freedom for one in self.channels)

    def cost(self, theta: Floats) -> float:
        """Compute χ² of the gaps.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            χ² [-].
        """
        places = self.centreline.values(theta[self.places])
        return float(sum(np.sum(self._residual(one, places) ** 2) for one in self.channels))

    def linearised(self, theta: Floats) -> tuple[float, Floats, Floats]:
        """Linearise χ² of the gaps.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            χ² [-], -½ of its gradient (n,) [-] and its Gauss-Newton curvature (n, n) [-].
        """
        own = theta[self.places]
        places, slopes = self.centreline.values(own), self.centreline.derivatives(own)
        cost, gradient, curvature = 0.0, np.zeros(theta.size), np.zeros((theta.size, theta.size))
        for one in self.channels:
            residual, rows = self._residual(one, places), one.whitened(slopes[:, one.channel])
            cost += float(residual @ residual)
            gradient[self.places] += rows.T @ residual
            curvature[np.ix_(self.places, self.places)] += rows.T @ rows
        return cost, gradient, curvature

    def without(self, left_out: Sequence[ChannelGaps]) -> "GapRows | None":
        """Return the rows without the gaps of some channels in some runs; None where none are left.

        Args:
            left_out: Gaps to leave out.

        Returns:
            The others.
        """
        kept = tuple(one for one in self.channels if not any(one is other for other in left_out))
        return replace(self, channels=kept) if kept else None

    def _residual(self, one: ChannelGaps, places: Floats) -> Floats:
        return one.measured - one.whitened(places[:, one.channel])


def gap_rows(
    model: "FilmModel",
    centreline: "ShaftCentreline",
    gaps: MeasuredGaps,
    *,
    rules: Centreline,
    speed: Floats,
    places: NDArray[np.intp],
    fitted: Floats,
) -> GapRows:
    """Make the rows of measured gaps (marginal likelihood; module's docstring).

    Args:
        model: The films' model.
        centreline: Its centreline at the probes and the fit's S speeds.
        gaps: The gaps.
        rules: What the document expects of them.
        speed: Spin speeds (S,), without sign [rad/s].
        places: Places (P,) of the films' numbers among the coordinates.
        fitted: The films' fitted numbers at which deviations are looked at (...) [-].

    Returns:
        The rows.
    """
    moved = _by_deviations(model, centreline, speed, fitted)
    found = []
    for run in np.unique(gaps.run).tolist():
        for channel in range(gaps.place.shape[1]):
            own = np.flatnonzero((gaps.run == run) & np.isfinite(gaps.place[:, channel]))
            if own.size < FEWEST_SAMPLES:
                continue
            own = own[np.argsort(gaps.time[own], kind="stable")]
            place, elapsed = gaps.place[own, channel], gaps.time[own] - gaps.time[own].mean()
            span = float(np.ptp(elapsed)) or 1.0
            errors = np.column_stack([np.full(own.size, ANY_ZERO), rules.drift * elapsed / span, moved[own, channel]])
            noise = max(rules.noise, seen_noise(place))
            found.append(ChannelGaps.of(channel, run, own, place, noise=noise, errors=errors))
    return GapRows(centreline, places[: model.own.count], tuple(found))


def seen_noise(place: Floats) -> float:
    """Estimate the noise of gaps from their second differences, which a smooth motion leaves small.

    Args:
        place: Measured places (s,) in order of time [m].

    Returns:
        Rms error of each [m].
    """
    return float(np.median(np.abs(np.diff(place, 2)))) / NORMAL_MEDIAN / math.sqrt(6.0)


def _by_deviations(model: "FilmModel", centreline: "ShaftCentreline", speed: Floats, fitted: Floats) -> Floats:
    """Return what deviations of the films' forces move at the probes (S, m, r), each with a factor of unit variance [m]."""
    nominal = model.nominal
    shapes = DeviationShapes(nominal.slowest, nominal.fastest).at(np.clip(speed, nominal.slowest, nominal.fastest))
    moved = centreline.by_viscosities(fitted) * [
        0.0 if one is None else FORCE_PART * one.discrepancy for one in model.own.forms
    ]
    return np.asarray((moved[..., None] * shapes[:, None, None, :]).reshape(*moved.shape[:2], -1))


def gap_cost(gaps: GapRows | None, theta: Floats) -> float:
    """Compute χ² of gaps.

    Args:
        gaps: The gaps; None for none.
        theta: Fit coordinates θ (n,) [-].

    Returns:
        χ² [-]; 0 without gaps.
    """
    return 0.0 if gaps is None else gaps.cost(theta)


def linearised_gaps(gaps: GapRows | None, theta: Floats) -> tuple[float, Floats, Floats]:
    """Linearise χ² of gaps.

    Args:
        gaps: The gaps; None for none.
        theta: Fit coordinates θ (n,) [-].

    Returns:
        χ² [-], -½ of its gradient (n,) [-] and its Gauss-Newton curvature (n, n) [-]; zeros without gaps.
    """
    if gaps is None:
        return 0.0, np.zeros(theta.size), np.zeros((theta.size, theta.size))
    return gaps.linearised(theta)
