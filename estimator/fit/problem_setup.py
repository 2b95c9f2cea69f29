"""Problems of fits set up from a machine and its measurement, and what is expected there before and after a fit."""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.fit.fit_samples import NotEnoughData, most_samples, require_usable, thinned, without_empty_samples
from estimator.fit.optimisation.maximum_likelihood import STAGE_MISFITS
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense

SCALE_PASSES = 10
"""Most searches for the unbalances' scale; each can find one a thousand times larger."""


def fit_problem(machine: Machine, measurement: Measurement, *, robust: bool) -> FitProblem:
    """Build the problem of a fit, without solving it.

    Args:
        machine: The machine.
        measurement: Its measured phasors, each sample with a usable one.
        robust: Whether phasors that cannot be noise are left out.

    Returns:
        The problem.

    Raises:
        NotEnoughData: No phasor is usable, or every usable one is zero.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    measurement = thinned(measurement, most=most_samples(machine))
    require_usable(machine, measurement)
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    return condensed_problem(train, measurement, machine.noise, robust=robust)


def condensed_problem(train: CondensedTrain, measurement: Measurement, noise: Noise, *, robust: bool) -> FitProblem:
    """Build the fit problem of a condensed train, with the unbalances' scale taken from the data at the nominal coefficients.

    Args:
        train: The train, condensed at the speeds of the measurement.
        measurement: Its measured phasors.
        noise: Noise model.
        robust: Whether phasors that cannot be noise are left out.

    Returns:
        The problem.

    Raises:
        NotEnoughData: Every usable phasor is zero.
    """
    # Unusable phasors become zero, so that arithmetic on whole arrays stays finite.
    silenced = replace(measurement, phasor=np.where(measurement.usable, measurement.phasor, 0.0))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    problem = FitProblem(train, silenced, coordinates, noise, np.zeros_like(measurement.usable), robust)
    amplitude = problem.first_amplitude
    if not np.any(amplitude > 0.0):
        raise NotEnoughData("every usable phasor is zero: there is no response to identify from")
    scale = 1.0
    for _ in range(SCALE_PASSES):
        # The prior of a first scale that is far too small holds the unbalances back, so look again.
        theta = best_excitations(problem, coordinates.centre, problem.weight(amplitude, STAGE_MISFITS[0]))
        before = scale
        scale = float(np.max(np.abs(coordinates.excitations(theta)[: len(train.unknowns.unbalances)]), initial=0.0)) or 1.0
        coordinates = Coordinates.of(train, unbalance_scale=scale)
        problem = replace(problem, coordinates=coordinates)
        if scale < 2.0 * before:
            break
    return problem


def expected_point(machine: Machine, measurement: Measurement) -> tuple[tuple[str, ...], Floats]:
    """Return all coordinates before any fit: the document's values, with the excitations that explain the data best.

    Args:
        machine: The machine.
        measurement: Its measured phasors.

    Returns:
        Names of the N coordinates and their values (N,) [SI or 1].

    Raises:
        NotEnoughData: No phasor is usable, or every usable one is zero.
        SingularCondensation: The train cannot be condensed at a speed.
        ValueError: The channels are not the machine's.
    """
    problem = fit_problem(machine, without_empty_samples(measurement), robust=False)
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    coordinates = problem.coordinates
    return coordinates.names, coordinates.point(best_excitations(problem, coordinates.centre, weight))


def expected_phasors(machine: Machine, measurement: Measurement, point: Floats) -> Complexes:
    """Compute the phasors that the channels should show in the samples of a measurement.

    They are those of each sample's sense of rotation, with trial weights, and through the channels' gains with their run-outs.

    Args:
        machine: The machine.
        measurement: S samples of m channels.
        point: The `point` (N,) of an identification [SI or 1].

    Returns:
        Phasors (S, m) [m].
    """
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    problem = FitProblem(train, measurement, coordinates, machine.noise, np.zeros_like(measurement.usable))
    return problem.model(coordinates.theta(point))
