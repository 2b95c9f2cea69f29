"""What one identification says about a machine's parameters and about errors of its channels: a Gaussian likelihood.

log L(z) = gradientᵀ (z - reference) - ½ (z - reference)ᵀ information (z - reference), over the fit's coordinates and the
errors of its channels together. Directions that the data leave open have next to no information, so nothing needs to be left
out and nothing undetermined can look like a change.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from estimator.arrays import Floats
from estimator.fit.channel_sensitivity import ChannelEffects
from estimator.trends.parameter_vector import Point

if TYPE_CHECKING:
    from estimator.fit.identify import Identification


@dataclass(frozen=True, eq=False)
class Observation:
    """names: (N,) of the quantities z: logarithms of direct terms and scale factors, everything else in SI.

    coordinates: how many of them are the fit's own, the others are errors of channels. reference (N,), gradient (N,),
    information (N, N): the likelihood, see above. accepted, chi_square, degrees_of_freedom: of
    the fit, from so many samples. phasors: how many of each channel were used, outliers: how many were left out,
    amplitude: their median [m].
    """

    names: tuple[str, ...]
    coordinates: int
    reference: Floats
    gradient: Floats
    information: Floats
    accepted: bool
    chi_square: float
    degrees_of_freedom: int
    samples: int
    phasors: dict[str, int]
    outliers: dict[str, int]
    amplitude: dict[str, float]

    @property
    def point(self) -> Point:
        """The fit's own estimates, with their covariance when the channels are as the document has them."""
        own = slice(self.coordinates)
        return Point(self.names[own], self.reference[own], inverse(self.information[own, own]))

    def at(self, point: Point) -> "Observation":
        """The same with another estimate of the fit's own coordinates, such as one under other operating conditions."""
        own, rest = slice(self.coordinates), slice(self.coordinates, None)
        before, across = self.information[own, own], self.information[own, rest]
        bias = np.linalg.solve(before, across)
        after = inverse(point.covariance)
        among = self.information[rest, rest] + bias.T @ (after - before) @ bias
        information = np.block([[after, after @ bias], [(after @ bias).T, among]])
        return replace(self, reference=np.concatenate([point.value, self.reference[rest]]), information=information)


@dataclass(frozen=True, eq=False)
class ObservedFit:
    """The parts of an identification that say something of the machine, as `Identification` has them.

    effects: None where an older release identified, which says nothing of the channels.
    """

    coordinates: tuple[str, ...]
    point: Floats
    covariance: Floats
    effects: ChannelEffects | None
    accepted: bool
    chi_square: float
    degrees_of_freedom: int
    samples: int
    outliers: dict[str, int]


def observed(identification: "Identification", channels: tuple[str, ...]) -> Observation:
    """What an identification of a machine with these channels says."""
    fit = ObservedFit(
        coordinates=identification.coordinates,
        point=identification.point,
        covariance=identification.covariance,
        effects=identification.channel_effects,
        accepted=identification.accepted,
        chi_square=identification.chi_square,
        degrees_of_freedom=identification.degrees_of_freedom,
        samples=identification.samples,
        outliers=identification.outliers,
    )
    return observation(fit, channels)


def observation(fit: ObservedFit, channels: tuple[str, ...]) -> Observation:
    """What a fit says of a machine with these channels; without effects nothing of the channels."""
    coordinates, effects = fit.coordinates, fit.effects
    own = inverse(fit.covariance)
    names, information, gradient = coordinates, own, np.zeros(len(coordinates))
    phasors: dict[str, int] = {}
    amplitude: dict[str, float] = {}
    if effects is not None:
        names = (*coordinates, *effects.names)
        across = own @ effects.bias
        among = effects.information + effects.bias.T @ across
        information = np.block([[own, across], [across.T, among]])
        gradient = np.concatenate([gradient, effects.score])
        phasors = dict(zip(channels, effects.phasors, strict=True))
        amplitude = dict(zip(channels, effects.amplitude, strict=True))
    return Observation(
        names=names,
        coordinates=len(coordinates),
        reference=np.concatenate([fit.point, np.zeros(len(names) - len(fit.point))]),
        gradient=gradient,
        information=information,
        accepted=fit.accepted,
        chi_square=fit.chi_square,
        degrees_of_freedom=fit.degrees_of_freedom,
        samples=fit.samples,
        phasors=phasors,
        outliers=fit.outliers,
        amplitude=amplitude,
    )


def inverse(covariance: Floats) -> Floats:
    """Inverse of a covariance or an information matrix whose coordinates are of very different sizes."""
    size = np.sqrt(np.diag(covariance))
    inverse = np.linalg.inv(covariance / np.outer(size, size)) / np.outer(size, size)
    return np.asarray((inverse + inverse.T) / 2)
