"""Options of an identification, and its outcome."""

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.fit.estimates import Estimate
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.machine.rules import Noise


class Options(Struct, frozen=True):
    """Options of an identification.

    Attributes:
        starts: Most starts tried before a misfit is reported.
        seed: Seed of the random starts.
        robust: Whether phasors that cannot be noise are left out.
        explain: Whether a refused fit is done again with errors of channels and couplings that may explain it.
        open_errors: Errors such as `probe.B1L.gain` that a diagnosis has named: estimates on oil films leave them open.
    """

    starts: int = 10
    seed: int = 0
    robust: bool = True
    explain: bool = True
    open_errors: tuple[str, ...] = ()


class Identification(Struct, frozen=True, eq=False):
    """Outcome of one fit, over N coordinates.

    Attributes:
        estimates: One estimate per parameter name.
        coordinates: Names of the real fit coordinates.
        covariance: Covariance (N, N) of the coordinates, direct terms as logarithms [SI² or 1].
        point: Values (N,) of the coordinates, also of those that are not estimable: for computing on, never for showing [SI or
            1].
        chi_square: χ² of the data [-].
        degrees_of_freedom: Degrees of freedom of χ².
        accepted: Whether the fit passed the χ² test.
        verdict: The verdict in words.
        condition_number: Condition number of the correlation form of the information matrix [-].
        starts: Number of starts tried.
        iterations: Number of steps tried.
        samples: Number of samples used in the fit.
        speed_minimum: Lowest speed used [rad/s].
        speed_maximum: Highest speed used [rad/s].
        noise: Noise model as stated or estimated.
        outliers: Number of phasors left out because no noise explains them, by channel.
        channel_effects: Effects of errors of single channels on the fit; None where several fits are combined.
        doubted_forces: Forces called exact that the residuals doubt: the covariance holds what they do to the coordinates.
    """

    estimates: tuple[Estimate, ...]
    coordinates: tuple[str, ...]
    covariance: Floats
    point: Floats
    chi_square: float
    degrees_of_freedom: int
    accepted: bool
    verdict: str
    condition_number: float
    starts: int
    iterations: int
    samples: int
    speed_minimum: float
    speed_maximum: float
    noise: Noise
    outliers: dict[str, int]
    channel_effects: ChannelEffects | None = None
    doubted_forces: tuple[DoubtedForce, ...] = ()

    @property
    def correlation(self) -> Floats:
        """Return the correlation coefficients (N, N) between the errors of the coordinates [-]."""
        size = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(size, size))

    def estimate(self, name: str) -> Estimate:
        """Return the estimate of a name.

        Args:
            name: Name of the parameter.

        Returns:
            Its estimate.

        Raises:
            KeyError: There is no estimate of that name.
        """
        for one in self.estimates:
            if one.name == name:
                return one
        raise KeyError(name)
