"""Observation: the likelihood of a machine's parameters and of errors of its channels that one identification gives.

log L(z) = gradientᵀ (z - reference) - ½ (z - reference)ᵀ information (z - reference), over the fit's coordinates and the
errors of its channels together. Directions that the data leave open have next to no information, so nothing needs to be left
out and nothing undetermined can look like a change.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from estimator.arrays import Floats
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.trends.parameter_vector import Point

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from estimator.alignment.film_loads import FilmLoads
    from estimator.fit.identification import Identification
    from estimator.updated_model.model import UpdatedModel


@dataclass(frozen=True, eq=False)
class Observation:
    """Gaussian likelihood of N quantities z from one fit.

    Attributes:
        names: Names of the quantities z.
        coordinates: Number of them that are the fit's own; the others are errors of channels.
        reference: Reference point (N,) of the likelihood [SI, logarithms of direct terms and scale factors].
        gradient: Gradient (N,) of log L there [1/unit].
        information: Information (N, N) [1/unit²].
        accepted: Whether the fit was accepted.
        chi_square: χ² of the fit [-].
        degrees_of_freedom: Its degrees of freedom.
        samples: Number of samples.
        phasors: Number of phasors used, by channel.
        outliers: Number of phasors left out, by channel.
        amplitude: Median amplitude of the used phasors, by channel [m].
        believed: Precision (N,) that the fit took from what was believed beforehand, and that the information lacks [1/unit²];
            None for none.
        loads: Loads on oil films; None of other trains.
        model: Function that returns the model of a train on oil films that the fit led to; None of other trains.
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
    believed: Floats | None = None
    loads: "FilmLoads | None" = None
    model: "Callable[[], UpdatedModel] | None" = None

    @property
    def fitted(self) -> Floats:
        """Return the information (N, N) of the fit, with what was believed beforehand [1/unit²]."""
        return self.information if self.believed is None else self.information + np.diag(self.believed)

    @property
    def point(self) -> Point:
        """Return the fit's own estimates, with their covariance when the channels are as the document has them."""
        own = slice(self.coordinates)
        return Point(self.names[own], self.reference[own], inverse(self.fitted[own, own]))

    def with_errors_of(self, names: "Sequence[str]") -> "Observation":
        """Return the observation without the errors that others do not have: an older release's fits state fewer of them.

        Args:
            names: Names of the quantities wanted, the fit's own among them.

        Returns:
            The observation with these, in its own order; itself where it has no others or lacks some.
        """
        wanted = set(names)
        kept = [place for place, name in enumerate(self.names) if name in wanted]
        if (
            len(kept) in (len(self.names), 0)
            or len(kept) < len(wanted)
            or kept[: self.coordinates] != [*range(self.coordinates)]
        ):
            return self
        gone = [place for place in range(len(self.names)) if self.names[place] not in wanted]
        return replace(
            self,
            names=tuple(self.names[place] for place in kept),
            reference=self.reference[kept],
            gradient=self.gradient[kept] + self.information[np.ix_(kept, gone)] @ self.reference[gone],
            information=self.information[np.ix_(kept, kept)],
            believed=None if self.believed is None else self.believed[kept],
        )

    def at(self, point: Point) -> "Observation":
        """Return the observation with another estimate of the fit's own coordinates.

        Such an estimate is one under other operating conditions.

        Source: own derivation: the likelihood's second-order expansion, in the module's docstring, about another point.

        Args:
            point: The other estimate.

        Returns:
            The observation.
        """
        own, rest = slice(self.coordinates), slice(self.coordinates, None)
        before, across = self.information[own, own], self.information[own, rest]
        bias = np.linalg.solve(before, across)
        after = inverse(point.covariance)
        among = self.information[rest, rest] + bias.T @ (after - before) @ bias
        information = np.block([[after, after @ bias], [(after @ bias).T, among]])
        return replace(self, reference=np.concatenate([point.value, self.reference[rest]]), information=information)


@dataclass(frozen=True, eq=False)
class ObservedFit:
    """Parts of an identification that concern the machine, as `Identification` has them.

    Attributes:
        coordinates: Names of the n coordinates.
        point: Values (n,), those that the effects are about [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of these [SI²].
        effects: Effects of errors of channels; None where an older release identified, which states nothing of the channels.
        accepted: Whether the fit was accepted.
        chi_square: χ² of the fit [-].
        degrees_of_freedom: Its degrees of freedom.
        samples: Number of samples.
        outliers: Number of phasors left out, by channel.
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


def observation_of(identification: "Identification", channels: tuple[str, ...]) -> Observation:
    """Return the observation of an identification.

    Args:
        identification: The identification.
        channels: Ids of the machine's channels.

    Returns:
        The observation.
    """
    return fit_observation(observed_fit(identification), channels)


def observed_fit(identification: "Identification") -> ObservedFit:
    """Return what an observation is made of.

    Args:
        identification: The identification.

    Returns:
        Its fit.
    """
    effects, point, covariance = identification.channel_effects, identification.point, identification.covariance
    if effects is not None:
        point, covariance = effects.estimate(point, covariance)
    return ObservedFit(
        coordinates=identification.coordinates,
        point=point,
        covariance=covariance,
        effects=effects,
        accepted=identification.accepted,
        chi_square=identification.chi_square,
        degrees_of_freedom=identification.degrees_of_freedom,
        samples=identification.samples,
        outliers=identification.outliers,
    )


def fit_observation(fit: ObservedFit, channels: tuple[str, ...]) -> Observation:
    """Build the observation of a fit.

    Args:
        fit: The fit; without effects the observation contains no errors of channels.
        channels: Ids of the machine's channels.

    Returns:
        The observation.
    """
    coordinates, effects = fit.coordinates, fit.effects
    own = inverse(fit.covariance)
    names, information, gradient = coordinates, own, np.zeros(len(coordinates))
    phasors: dict[str, int] = {}
    amplitude: dict[str, float] = {}
    errors = np.zeros(0)
    if effects is not None:
        names = (*coordinates, *effects.names)
        across = own @ effects.bias
        among = effects.information + effects.bias.T @ across
        information = np.block([[own, across], [across.T, among]])
        gradient = np.concatenate([gradient, effects.score])
        errors = effects.errors
        phasors = dict(zip(channels, effects.phasors, strict=True))
        amplitude = dict(zip(channels, effects.amplitude, strict=True))
    return Observation(
        names=names,
        coordinates=len(coordinates),
        reference=np.concatenate([fit.point, errors]),
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


def with_common_errors(observations: "Sequence[Observation]") -> "tuple[Observation, ...]":
    """Return observations with the errors that all of them have: an older release's fits state fewer of them.

    Args:
        observations: The observations.

    Returns:
        The same, limited.
    """
    fewest = min((one.names for one in observations), key=len, default=())
    return tuple(one.with_errors_of(fewest) for one in observations)


def names_in_common(baseline: "Sequence[Observation]") -> tuple[str, ...]:
    """Return the names of the quantities that all observations of a baseline have.

    Args:
        baseline: The observations.

    Returns:
        Their names.

    Raises:
        ValueError: There are no observations, or they are of different quantities.
    """
    if not baseline:
        raise ValueError("a baseline needs at least one identification")
    names = baseline[0].names
    if any(one.names != names for one in baseline):
        raise ValueError("the baseline's identifications are of different quantities")
    return names


def inverse(covariance: Floats) -> Floats:
    """Compute the inverse of a covariance or an information matrix whose coordinates are of very different sizes.

    Source: own derivation: both sides are divided by the standard deviations first, so that sizes do not count.

    Args:
        covariance: Matrix (n, n), symmetric and positive definite [unit²].

    Returns:
        Inverse (n, n) [1/unit²].
    """
    size = np.sqrt(np.diag(covariance))
    inverse = np.linalg.inv(covariance / np.outer(size, size)) / np.outer(size, size)
    return np.asarray((inverse + inverse.T) / 2)
