"""Probes, planes of probes or trial weights that may be exchanged with each other in the runs of a calibration.

Gains and phases are free, so that a calibration may be accepted although two leads are exchanged; then the scatter is larger
than it need be. Each exchange is undone on all runs. Those that leave the least misfit at given coefficients, with the gains
that known weights show there (`chain_start`), are calibrated in full. What decides is the marginal likelihood with sizes of
scatter that are estimated anew each time (Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998).
"""

import itertools
import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.chain_start import best_chains
from estimator.calibration.mounted_problem import MountedProblem
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.probe_axes import probe_stations

CLEAR = 15.0
"""Logarithm of the ratio of likelihoods from which on an exchange is named [-]: far beyond chance, by a factor of 10⁶."""
EQUALLY_WELL = 3.0
"""Logarithm of the ratio of likelihoods up to which exchanges cannot be told apart [-]."""
PROMISING = 1.5
"""Most times the misfit of the runs as stated, at the same coefficients, with which an exchange is calibrated in full [-]."""
LIKELIEST = 3
"""Exchanges of each kind that are calibrated in full."""
MANY_TIMES = 1000.0
"""Factor beyond which a larger one says no more [-]."""


class Exchange(Struct, frozen=True):
    """Exchange of probes or of trial weights.

    Attributes:
        words: What is exchanged, in words that follow "the runs fit better with".
        channels: Column that each channel is in (m,).
        discs: Disc that the weights of each one were on (P,).
    """

    words: str
    channels: tuple[int, ...]
    discs: tuple[int, ...]

    def measurement(self, measurement: Measurement) -> Measurement:
        """Return a measurement without the exchange.

        Args:
            measurement: The measurement as it was stated.

        Returns:
            The measurement with each channel's own phasors and each disc's own weights.
        """
        columns, discs = list(self.channels), list(self.discs)
        return replace(
            measurement,
            phasor=measurement.phasor[:, columns],
            usable=measurement.usable[:, columns],
            scatter=measurement.scatter[:, columns],
            added=None if measurement.added is None else measurement.added[:, discs],
        )

    def runs(self, runs: Sequence[CalibrationRun]) -> list[CalibrationRun]:
        """Return runs without the exchange.

        Args:
            runs: The runs as they were stated.

        Returns:
            The runs.
        """
        return [replace(one, measurement=self.measurement(one.measurement)) for one in runs]


def likely_exchanges(machine: Machine, problem: MountedProblem, theta: Floats) -> list[Exchange]:
    """List the exchanges that fit hardly worse at given coefficients than no exchange, or better.

    Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036, for the gains at each.

    Args:
        machine: The machine.
        problem: Problem of its calibration, with sizes of scatter.
        theta: Its fit's end θ (n,) [-].

    Returns:
        Some exchanges of each kind, the likeliest first.
    """
    stated = _misfit(problem, problem.measurement, theta)
    found: list[Exchange] = []
    for kind in (_of_probes(machine), _of_planes(machine), _of_weights(machine, problem.measurement)):
        misfits = [_misfit(problem, one.measurement(problem.measurement), theta) for one in kind]
        promising = [place for place in np.argsort(misfits) if misfits[place] <= PROMISING * stated]
        found += [kind[place] for place in promising[:LIKELIEST]]
    return found


def log_likelihood(problem: MountedProblem, theta: Floats) -> float:
    """Compute the logarithm of the likelihood of all samples, without what differs between mountings and the coordinates.

    Source: Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998.

    Args:
        problem: Problem of a calibration, with sizes of scatter.
        theta: Its fit's end θ (n,) [-].

    Returns:
        The logarithm, but for a constant [-].
    """
    weight = problem.weight(np.abs(problem.measurement.phasor), 0.0)
    found = problem.linearisation(theta, weight)
    prior = problem.coordinates.prior
    cost = float(found.residual @ found.residual + np.sum(found.difference**2)) + prior.cost(theta)
    curvature = found.rows @ found.rows.T - found.explained() + prior.precision
    sizes = 4.0 * float(np.sum(np.log(weight[problem.used]))) + float(np.sum(np.linalg.slogdet(found.inverse)[1]))
    return 0.5 * (sizes - cost - float(np.linalg.slogdet(curvature)[1]))


def exchange_text(better: Sequence[tuple[Exchange, float]], phasors: int) -> str:
    """Name the exchanges with which runs fit far better than as they are stated.

    Args:
        better: Exchanges that were tried, each with the logarithm of its likelihood over that of the runs as stated [-].
        phasors: Number of phasors.

    Returns:
        A sentence; empty where none is far better.
    """
    clear = sorted((one for one in better if one[1] >= CLEAR), key=lambda one: -one[1])
    if not clear:
        return ""
    largest = clear[0][1]
    # Of Gaussian errors whose size is estimated, the mean logarithm of the squared size.
    mean = largest / max(phasors, 1)
    shown = (
        f"over {MANY_TIMES:.0f}" if mean >= math.log(MANY_TIMES) else f"{math.exp(mean):.{0 if mean > math.log(10.0) else 1}f}"
    )
    named = " or ".join(one.words for one, gain in clear if gain >= largest - EQUALLY_WELL)
    return f"the runs fit {shown} times better with {named} exchanged: are leads, discs and columns the right ones?"


def _misfit(problem: MountedProblem, measurement: Measurement, theta: Floats) -> float:
    """Return χ² of other samples with the gains, run-outs and unbalances that fit best at the other coordinates (n,)."""
    other = replace(problem, measurement=measurement)
    weight = other.weight(np.abs(measurement.phasor), 0.0)
    found = other.chi_square(best_chains(other, theta, weight), weight)
    return found if math.isfinite(found) else math.inf


def _of_probes(machine: Machine) -> list[Exchange]:
    count = len(machine.channels)
    return [
        Exchange(
            f"{machine.channels[first]} and {machine.channels[second]}", _swapped(count, [(first, second)]), _kept(machine)
        )
        for first, second in itertools.combinations(range(count), 2)
    ]


def _of_planes(machine: Machine) -> list[Exchange]:
    """Return the exchanges of all probes of one station with those of another."""
    found = []
    for one, other in itertools.combinations(probe_stations(machine), 2):
        if len(one.columns) == len(other.columns) > 1:
            names = (", ".join(machine.channels[column] for column in place.columns) for place in (one, other))
            pairs = list(zip(one.columns, other.columns, strict=True))
            found.append(Exchange(" and ".join(names), _swapped(len(machine.channels), pairs), _kept(machine)))
    return found


def _of_weights(machine: Machine, measurement: Measurement) -> list[Exchange]:
    """Return the exchanges of the weights of two discs, unless these always had the same ones."""
    added, count = measurement.added, len(machine.discs)
    channels = tuple(range(len(machine.channels)))
    return [
        Exchange(
            f"the weights of {machine.discs[first].id} and {machine.discs[second].id}",
            channels,
            _swapped(count, [(first, second)]),
        )
        for first, second in itertools.combinations(range(count), 2)
        if added is not None and np.any(added[:, first] != added[:, second])
    ]


def _kept(machine: Machine) -> tuple[int, ...]:
    return tuple(range(len(machine.discs)))


def _swapped(count: int, pairs: Sequence[tuple[int, int]]) -> tuple[int, ...]:
    order = list(range(count))
    for first, second in pairs:
        order[first], order[second] = second, first
    return tuple(order)
