"""Phasors with derivatives that a fit remembers, beside those computed anew; excitations and bends against differences."""

import numpy as np
from msgspec.structs import replace

from estimator.fit.optimisation.maximum_likelihood import bend
from estimator.fit.problem.channel_errors import with_every_channel
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.fit.problem.linear_phasors import PhasorMemory
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from tests.estimator.trains import Floats, chapter_3, dense_response, noisy

SPEED: Floats = np.linspace(20.0, 280.0, 40)


def problem_of() -> FitProblem:
    machine = chapter_3()
    measurement = Measurement.of(speed=SPEED, phasor=noisy(dense_response(machine, SPEED, direction=1), seed=0))
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    return FitProblem(train, measurement, coordinates, Noise(relative=0.01, floor=0.0), np.zeros((40, 8), dtype=bool))


def near(problem: FitProblem, seed: int) -> Floats:
    return problem.coordinates.centre + 0.05 * np.random.default_rng(seed).standard_normal(problem.coordinates.size)


def test_what_is_remembered_is_what_is_computed_again() -> None:
    problem, theta = problem_of(), near(problem_of(), 1)
    weight = problem.weight(problem.first_amplitude, 0.05)
    problem.linearised(near(problem, 2), weight)
    whole = problem.linearised(theta, weight)
    fewer = replace(problem, outlier=np.arange(320).reshape(40, 8) % 7 == 0)
    for one, fresh in ((problem, problem_of()), (fewer, replace(problem_of(), outlier=fewer.outlier))):
        for again, anew in zip(one.linearised(theta, 2.0 * weight), fresh.linearised(theta, 2.0 * weight), strict=True):
            np.testing.assert_allclose(np.asarray(again), np.asarray(anew), rtol=1e-12)
        np.testing.assert_allclose(one.model(theta), replace(fresh, _memory=PhasorMemory()).model(theta), rtol=1e-10)
    assert whole[0] != problem.linearised(near(problem, 2), weight)[0]


def test_other_coordinates_or_samples_are_not_taken_for_those_remembered() -> None:
    problem, theta = problem_of(), near(problem_of(), 1)
    before = problem.model(theta)
    wider = replace(problem, coordinates=Coordinates.of(problem.train, unbalance_scale=2e-3))
    assert np.max(np.abs(wider.model(theta) / before - 2.0)) < 1e-9


def test_channels_behind_the_coordinates_have_the_derivatives_that_differences_show() -> None:
    problem, theta = problem_of(), near(problem_of(), 1)
    problem.linearised(theta, problem.weight(problem.first_amplitude, 0.0))
    coordinates = with_every_channel(problem.coordinates, problem.train.channels)
    whole = np.concatenate([theta, np.zeros(coordinates.size - theta.size)])
    (found,) = problem.with_channels(coordinates, theta).linear_phasors(whole)
    fresh = replace(problem, coordinates=coordinates, _memory=PhasorMemory())
    assert coordinates.size == theta.size + 4 * len(problem.train.channels)
    for place in (3, theta.size, theta.size + 1, theta.size + 17, coordinates.size - 1):
        ahead, behind = (fresh.model(whole + sign * 1e-4 * np.eye(whole.size)[place]) for sign in (1, -1))
        difference = (ahead - behind) / 2e-4
        np.testing.assert_allclose(found.jacobian[place], difference, atol=1e-6 * np.abs(difference).max())


def test_best_excitations_leave_no_slope_along_them() -> None:
    problem, theta = problem_of(), near(problem_of(), 1)
    weight = problem.weight(problem.first_amplitude, 0.5)
    best = best_excitations(problem, theta, weight)
    free = problem.coordinates.excitation_place
    places = np.concatenate([free, free + 1])
    _, before, _ = problem.linearised(theta, weight)
    _, after, _ = problem.linearised(best, weight)
    held = (best - problem.coordinates.centre) / problem.coordinates.spread**2
    assert np.max(np.abs((after - held)[places])) < 1e-8 * np.max(np.abs(before[places]))
    others = np.setdiff1d(np.arange(theta.size), places)
    assert np.array_equal(best[others], theta[others])


def test_bend_is_the_second_derivative_along_the_step() -> None:
    problem, theta = problem_of(), near(problem_of(), 1)
    step = 0.02 * np.random.default_rng(4).standard_normal(theta.size)
    weight = problem.weight(problem.first_amplitude, 0.05)
    second = (problem.model(theta + 1e-2 * step) - 2.0 * problem.model(theta) + problem.model(theta - 1e-2 * step)) / 1e-4
    (linear,) = problem.linear_phasors(theta)
    expected = np.einsum("nsm,sm->n", (linear.jacobian * weight).conj(), second * weight).real
    np.testing.assert_allclose(bend(problem, theta, step, weight), expected, rtol=0.05, atol=0.02 * np.abs(expected).max())
