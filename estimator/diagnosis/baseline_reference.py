"""Baseline of a machine from observations while it was healthy: what its quantities are, and around what they vary.

A run's quantities vary from run to run around the machine's, so that the likelihood of these is the run's with that variation
marginalised (Laird and Ware, Biometrics 38 (1982) 963, doi:10.2307/2529876).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.healthy_variation import run_variation, slow_variation, typical_amplitude
from estimator.diagnosis.hypotheses import Hypothesis, hypotheses
from estimator.diagnosis.observation import Observation, names_in_common
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns

GAIN_TOLERANCE = 0.05
"""Standard deviation of a channel's gain as believed before the baseline [-]."""
RUN_OUT_TOLERANCE = 0.5
"""Standard deviation of a channel's run-out as believed before the baseline, in units of its median amplitude [-]."""
ROTATING_TOLERANCE = {"rotating_offset": 3e-5, "rotating_angle": 3e-4}
"""Standard deviations of a coupling's run-outs of bore and face as believed before the baseline [m, rad]."""
UNKNOWN_PRECISION = 1e-6
"""Precision of all other parameters as believed before the baseline, in units of the healthy variation [-]: next to none."""


@dataclass(frozen=True)
class Reference:
    """Baseline of a machine, from all of its runs together, in units of the run-to-run variation.

    Attributes:
        names: Names of the N quantities.
        origin: Point (N,) from which everything is counted [SI, logarithms of direct terms].
        unit: Run-to-run standard deviations (N,) [SI, 1 for logarithms].
        centre: Mean of the baseline (N,) [-].
        doubt: Covariance (N, N) of the healthy machine around it: the mean's own error and the slow variation [-].
        hypotheses: Everything that can have happened.
        together: Run-to-run variations (N, t) in which quantities go together, besides each by itself [-].
        slow: Slow variations and errors of the mean (N, s) that a run by itself is allowed [-].
        carried: Function that returns a run's observation in the coordinates in which it is linear; None where it is.
        left_open: Standard errors of the logarithms of stiffnesses that single runs leave open by a large factor, by name [-].
    """

    names: tuple[str, ...]
    origin: Floats
    unit: Floats
    centre: Floats
    doubt: Floats
    hypotheses: tuple[Hypothesis, ...]
    together: Floats
    slow: Floats
    carried: Callable[[Observation], Observation] | None = None
    left_open: Mapping[str, float] = field(default_factory=dict)
    _likelihoods: dict[Observation, tuple[Floats, Floats]] = field(default_factory=dict, repr=False)

    def unit_of(self, names: Sequence[str]) -> Floats:
        """Return the run-to-run standard deviations of some quantities.

        Args:
            names: Names (k,) of the quantities.

        Returns:
            Standard deviations (k,) [SI, 1 for logarithms].
        """
        return np.asarray(self.unit[[self.names.index(name) for name in names]])

    def likelihood(self, one: Observation) -> tuple[Floats, Floats]:
        """Return the likelihood of the quantities around which a run varies.

        Args:
            one: Observation of the run.

        Returns:
            Precision (N, N) [-] and pull (N,) away from the mean [-].
        """
        if one not in self._likelihoods:
            linear = one if self.carried is None else self.carried(one)
            seen, drawn = through_variation(linear, self.origin, self.unit, self.together)
            self._likelihoods[one] = seen, drawn - seen @ self.centre
        return self._likelihoods[one]

    def alone(self, one: Observation) -> tuple[Floats, Floats]:
        """Return the likelihood of a run by itself, which is allowed the slow variations and the mean's own error.

        Source: standard result: what varies is marginalised, which leaves a Gaussian likelihood.

        Args:
            one: Observation of the run.

        Returns:
            Precision (N, N) [-] and pull (N,) away from the mean [-].
        """
        return _allowing(*self.likelihood(one), self.slow)

    @property
    def mean(self) -> Floats:
        """Return the baseline's mean (N,) [SI, logarithms of direct terms]."""
        return np.asarray(self.origin + self.unit * self.centre)


def reference(machine: Machine, baseline: Sequence[Observation]) -> Reference:
    """Build the baseline from observations of a healthy machine.

    Source: standard result: Gaussian likelihoods of independent runs are added up, what varies marginalised.

    Args:
        machine: The machine.
        baseline: Its observations.

    Returns:
        The baseline.

    Raises:
        ValueError: There are no observations, or they are of different quantities.
    """
    names = names_in_common(baseline)
    unknown = unknowns(machine, assemble_rotor(machine))
    origin = np.median([one.reference for one in baseline], axis=0)
    unit = run_variation(baseline)
    nothing = np.zeros((len(names), 0))
    precision = np.diag(UNKNOWN_PRECISION + unit**2 * np.array([channel_precision(name, baseline) for name in names]))
    pull = np.zeros(len(names))
    for one in baseline:
        seen, drawn = through_variation(one, origin, unit, nothing)
        precision += seen
        pull += drawn
    error = np.linalg.inv(precision)
    doubt = error + slow_variation(unknown, names, origin) / np.outer(unit, unit)
    amplitude = {probe.id: typical_amplitude(probe.id, baseline) for probe in machine.probes}
    found = hypotheses(machine, unknown, names, typical=origin, amplitude=amplitude)
    return Reference(names, origin, unit, error @ pull, (doubt + doubt.T) / 2, found, nothing, nothing)


def through_variation(one: Observation, origin: Floats, unit: Floats, together: Floats) -> tuple[Floats, Floats]:
    """Compute the likelihood of the point around which a run's quantities vary, in units of the variation.

    Source: standard result: what varies is marginalised, which leaves a Gaussian likelihood.

    Args:
        one: Observation of the run.
        origin: Point (N,) from which everything is counted [SI, logarithms of direct terms].
        unit: Run-to-run standard deviations (N,) of each quantity by itself [SI, 1 for logarithms].
        together: Variations (N, t) in which quantities go together [-].

    Returns:
        Precision (N, N) [-] and pull (N,) [-].
    """
    information = one.information * np.outer(unit, unit)
    pull = unit * (one.gradient + one.information @ (one.reference - origin))
    reach = np.linalg.inv(np.eye(len(origin)) + information)
    return _allowing(symmetric(np.eye(len(origin)) - reach), np.asarray(reach @ pull), together)


def _allowing(seen: Floats, drawn: Floats, columns: Floats) -> tuple[Floats, Floats]:
    """Return a precision and a pull with variations (N, t) allowed for."""
    if not columns.size:
        return seen, drawn
    reach = seen @ columns
    gain = reach @ np.linalg.inv(np.eye(columns.shape[1]) + columns.T @ reach)
    return symmetric(seen - gain @ reach.T), np.asarray(drawn - gain @ (columns.T @ drawn))


def symmetric(matrix: Floats) -> Floats:
    """Return the symmetric part of a matrix, which rounding has made a little unsymmetric.

    Source: standard result: (M + Mᵀ) / 2.

    Args:
        matrix: The matrix (n, n) [any unit].

    Returns:
        Its symmetric part (n, n) [that unit].
    """
    return np.asarray((matrix + matrix.T) / 2)


def channel_precision(name: str, baseline: Sequence[Observation]) -> float:
    """Return the precision of an error of a channel or a coupling as believed before the baseline.

    Args:
        name: Name of the quantity.
        baseline: Observations of the baseline.

    Returns:
        Precision [1/unit²]; 0 for everything that is no such error.
    """
    described = describe(name)
    if described.quantity in ROTATING_TOLERANCE:
        return 1.0 / ROTATING_TOLERANCE[described.quantity] ** 2
    if described.channel is None:
        return 0.0
    if described.quantity == "gain":
        return 1.0 / GAIN_TOLERANCE**2
    return 1.0 / (RUN_OUT_TOLERANCE * typical_amplitude(described.channel, baseline)) ** 2
