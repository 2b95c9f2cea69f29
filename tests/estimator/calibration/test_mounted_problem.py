"""The problem of several mountings: χ² and its derivatives agree with those of an explicit elimination."""

import numpy as np

from benchmarks.calibration.rotor_kit import kit
from estimator.calibration.mounted_problem import MountedProblem
from estimator.fit.optimisation.maximum_likelihood import bend
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.machine.rules import Noise
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import condense

STEP = 1e-5


def problem(size: float) -> MountedProblem:
    """Return the measured kit's problem with differences of a given size, relative to the usual one."""
    machine, measurement, conditions = kit()
    order = np.argsort(np.unique(conditions, return_inverse=True)[1], kind="stable")
    whole = measurement.pick(np.ones(order.size, dtype=bool))
    mounting = np.unique(conditions, return_inverse=True)[1]
    probes = tuple(one.model_copy(update={"gain_spread": 1.0, "run_out_spread": 1e-6}) for one in machine.probes)
    machine = machine.model_copy(update={"probes": probes})
    sorted_ = type(whole)(
        whole.speed[order],
        whole.direction[order],
        whole.phasor[order],
        whole.usable[order],
        np.full(whole.scatter.shape, 1e-7),
        None if whole.added is None else whole.added[order],
    )
    train = condense(machine, speed=sorted_.speed, direction=sorted_.direction)
    return MountedProblem(
        train,
        sorted_,
        Coordinates.of(train, unbalance_scale=1e-5),
        Noise(floor=0.0),
        np.zeros_like(sorted_.usable),
        robust=False,
        mounting=mounting[order],
        spread=size * np.r_[np.full(2, 3e-6), np.full(4, 3e-7)],
    )


def test_the_gradient_is_that_of_chi_square() -> None:
    whole = problem(1.0)
    rng = np.random.default_rng(0)
    theta = whole.coordinates.centre + 0.05 * rng.standard_normal(whole.coordinates.size)
    weight = whole.weight(whole.first_amplitude, 0.1)
    chi_square, gradient, curvature = whole.linearised(theta, weight)
    assert np.isclose(chi_square, whole.chi_square(theta, weight), rtol=1e-9)
    assert np.linalg.eigvalsh(curvature).min() > -1e-6 * np.linalg.eigvalsh(curvature).max()
    for place in (0, 5, 17, 20, 25, 33):
        step = STEP * np.eye(theta.size)[place]
        slope = (whole.chi_square(theta + step, weight) - whole.chi_square(theta - step, weight)) / (2.0 * STEP)
        assert np.isclose(gradient[place], -slope / 2.0, rtol=1e-3, atol=1e-5 * np.abs(gradient).max())


def test_without_differences_it_is_the_plain_problem() -> None:
    mounted = problem(1e-9)
    plain = FitProblem(mounted.train, mounted.measurement, mounted.coordinates, mounted.noise, mounted.outlier, robust=False)
    theta = mounted.coordinates.centre
    weight = mounted.weight(mounted.first_amplitude, 0.1)
    assert np.isclose(mounted.chi_square(theta, weight), plain.chi_square(theta, weight), rtol=1e-6)
    assert np.allclose(mounted.linearised(theta, weight)[2], plain.linearised(theta, weight)[2], rtol=1e-6)
    assert np.allclose(mounted.model(theta), plain.model(theta), rtol=1e-6)


def test_differences_explain_what_scatters_between_mountings() -> None:
    large, small = problem(1.0), problem(1e-9)
    theta, weight = large.coordinates.centre, large.weight(large.first_amplitude, 0.0)
    assert large.chi_square(theta, weight) < small.chi_square(theta, weight)
    error = error_size(large.noise, np.abs(large.measurement.phasor), large.measurement.scatter)
    assert np.all(error == 1e-7)


def test_bend_is_the_second_derivative_with_the_differences_that_are_likely_there() -> None:
    whole = problem(1.0)
    rng = np.random.default_rng(1)
    theta = whole.coordinates.centre + 0.05 * rng.standard_normal(whole.coordinates.size)
    step = 0.02 * rng.standard_normal(theta.size)
    weight = whole.weight(whole.first_amplitude, 0.1)
    here = whole.linearisation(theta, weight)
    (ahead, further), (behind, nearer) = (whole.residual(theta + sign * 0.02 * step, weight) for sign in (1.0, -1.0))
    expected = here.projected(
        (2.0 * here.residual - ahead - behind) / 0.02**2, (further + nearer - 2.0 * here.difference) / 0.02**2
    )
    found = bend(whole, theta, step, weight)
    np.testing.assert_allclose(found, expected, rtol=0.1, atol=0.05 * np.abs(expected).max())


def test_projected_derivatives_are_the_curvature() -> None:
    whole = problem(1.0)
    theta, weight = whole.coordinates.centre, whole.weight(whole.first_amplitude, 0.1)
    here = whole.linearisation(theta, weight)
    _, gradient, curvature = whole.linearised(theta, weight)
    step = np.random.default_rng(2).standard_normal(theta.size)
    assert np.allclose(here.projected(step @ here.rows, np.zeros_like(here.difference)), curvature @ step)
    assert np.allclose(here.projected(here.residual, -here.difference), gradient)


def test_best_excitations_of_mountings_leave_no_slope_along_them() -> None:
    whole = problem(1.0)
    theta = whole.coordinates.centre + 0.05 * np.random.default_rng(3).standard_normal(whole.coordinates.size)
    weight = whole.weight(whole.first_amplitude, 0.1)
    best = best_excitations(whole, theta, weight)
    free = whole.coordinates.excitation_place
    places = np.concatenate([free, free + 1])
    before, after = (whole.linearised(one, weight)[1] - whole.coordinates.prior.pull(one) for one in (theta, best))
    assert np.max(np.abs(after[places])) < 1e-8 * np.max(np.abs(before[places]))
    others = np.setdiff1d(np.arange(theta.size), places)
    assert np.array_equal(best[others], theta[others])
    assert np.allclose(best_excitations(whole, best, weight), best, rtol=1e-9, atol=1e-12), "a step of nothing moves nothing"
