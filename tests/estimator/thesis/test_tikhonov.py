"""Tikhonov regularisation: filter factors, criteria against brute force, and the rules on a classic ill-posed problem."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.regression import Regression, solve
from estimator.thesis.tikhonov import (
    SpectralProblem,
    choose_parameter,
    damped_parts,
    filter_factors,
    generalised_cross_validation,
    l_curve_curvature,
)

RULES: tuple[RegularisationRule, ...] = ("generalised cross-validation", "L-curve")


def blurred(noise: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth function seen through a Gaussian blur: matrix (48, 32), target, truth."""
    at, seen = np.linspace(0, 1, 32), np.linspace(0, 1, 48)
    matrix = np.exp(-(((seen[:, None] - at) / 0.1) ** 2)) / 32
    truth = np.exp(-(((at - 0.4) / 0.15) ** 2)) + 0.5 * np.exp(-(((at - 0.75) / 0.1) ** 2))
    target = matrix @ truth
    return matrix, target + noise * np.abs(target).max() * np.random.default_rng(seed).standard_normal(48), truth


def spectral(matrix: np.ndarray, target: np.ndarray) -> SpectralProblem:
    left, singular_values, _ = np.linalg.svd(matrix, full_matrices=False)
    return SpectralProblem.of(left, singular_values, target)


def solution(matrix: np.ndarray, target: np.ndarray, parameter: float) -> np.ndarray:
    """Tikhonov's solution from the stacked equations (A; λ I) x = (b; 0), without singular values."""
    columns = matrix.shape[1]
    stacked = np.vstack([matrix, parameter * np.eye(columns)])
    return np.asarray(np.linalg.lstsq(stacked, np.concatenate([target, np.zeros(columns)]), rcond=None)[0])


def test_filter_factors() -> None:
    assert filter_factors(np.array([3.0, 1.0]), 1.0) == pytest.approx([0.9, 0.5])
    assert filter_factors(np.array([3.0, 1.0]), 0.0) == pytest.approx([1.0, 1.0])


@given(seed=st.integers(0, 1000), logarithm=st.floats(-6, 1))
@settings(max_examples=30, deadline=None)
def test_norms_and_criterion_agree_with_the_stacked_equations(seed: int, logarithm: float) -> None:
    rng = np.random.default_rng(seed)
    matrix, target, parameter = rng.standard_normal((12, 5)), rng.standard_normal(12), 10.0**logarithm
    problem = spectral(matrix, target)
    x = solution(matrix, target, parameter)
    residual = matrix @ x - target
    assert problem.solution_square(parameter) == pytest.approx(x @ x, rel=1e-9)
    assert problem.residual_square(parameter) == pytest.approx(residual @ residual, rel=1e-9)
    influence = matrix @ np.linalg.solve(matrix.T @ matrix + parameter**2 * np.eye(5), matrix.T)
    expected = residual @ residual / np.trace(np.eye(12) - influence) ** 2
    assert generalised_cross_validation(problem, parameter) == pytest.approx(expected, rel=1e-9)


@given(seed=st.integers(0, 200), noise=st.sampled_from([1e-4, 1e-3, 1e-2, 1e-1]))
@settings(max_examples=15, deadline=None)
def test_cross_validation_finds_the_brute_force_minimum(seed: int, noise: float) -> None:
    matrix, target, _ = blurred(noise, seed)
    problem = spectral(matrix, target)
    found = generalised_cross_validation(problem, choose_parameter(problem, "generalised cross-validation"))
    brute = min(generalised_cross_validation(problem, parameter) for parameter in np.geomspace(1e-10, 0.5, 4000))
    assert found <= brute * (1 + 1e-4)


def test_curvature_agrees_with_finite_differences() -> None:
    matrix, target, _ = blurred(1e-2)
    problem = spectral(matrix, target)
    step = 1e-3
    for parameter in np.geomspace(1e-4, 1e-1, 9):
        near = parameter * np.exp(step * np.arange(-1, 2))
        x = np.array([0.5 * np.log(problem.residual_square(one)) for one in near])
        y = np.array([0.5 * np.log(problem.solution_square(one)) for one in near])
        dx, dy = (x[2] - x[0]) / (2 * step), (y[2] - y[0]) / (2 * step)
        ddx, ddy = (x[2] - 2 * x[1] + x[0]) / step**2, (y[2] - 2 * y[1] + y[0]) / step**2
        expected = (dx * ddy - ddx * dy) / (dx**2 + dy**2) ** 1.5
        assert l_curve_curvature(problem, parameter) == pytest.approx(expected, rel=1e-3, abs=1e-3)


@pytest.mark.parametrize(("rule", "factor"), [("generalised cross-validation", 3), ("L-curve", 15)])
@pytest.mark.parametrize("noise", [1e-3, 1e-2])
def test_rules_come_near_the_best_parameter_of_an_ill_posed_problem(
    rule: RegularisationRule, factor: float, noise: float
) -> None:
    """The L-curve is known to regularise smooth problems too little."""
    matrix, target, truth = blurred(noise)
    parameter = choose_parameter(spectral(matrix, target), rule)

    def error(one: float) -> float:
        return float(np.linalg.norm(solution(matrix, target, one) - truth) / np.linalg.norm(truth))

    best = min(error(one) for one in np.geomspace(1e-6, 1.0, 200))
    assert error(parameter) < factor * best
    assert error(parameter) < 0.01 * error(1e-12)


@pytest.mark.parametrize("rule", RULES)
def test_solve_gives_the_stacked_solution_on_the_scaled_columns(rule: RegularisationRule) -> None:
    matrix, target, _ = blurred(1e-2)
    size = 10.0 ** np.linspace(-2, 2, 32)
    names = tuple(f"p{column}" for column in range(32))
    found = solve(Regression(matrix * size, target, names, np.ones(32)), scaling="norm", tikhonov=rule)
    expected = found.scale * solution(matrix * size * found.scale, target, found.parameter)
    assert found.values == pytest.approx(expected, rel=1e-6)


def test_damped_parts_of_a_tiny_parameter_do_not_cancel() -> None:
    assert damped_parts(np.array([1.0, 1e-3]), 1e-12) == pytest.approx([1e-24, 1e-18], rel=1e-9)


@pytest.mark.parametrize("rule", RULES)
def test_as_many_equations_as_unknowns(rule: RegularisationRule) -> None:
    """No residual is left without regularisation; the criteria stay finite."""
    rng = np.random.default_rng(6)
    problem = spectral(rng.standard_normal((6, 6)), rng.standard_normal(6))
    parameter = choose_parameter(problem, rule)
    assert 0.0 < parameter <= problem.singular_values[0] * 1.01
    assert np.isfinite(generalised_cross_validation(problem, 1e-9))


def test_noiseless_equations_are_left_alone() -> None:
    """A problem without noise has nothing to regularise: the solution stays the exact one."""
    rng = np.random.default_rng(2)
    matrix, values = rng.standard_normal((20, 5)), rng.standard_normal(5)
    found = solve(Regression(matrix, matrix @ values, tuple("abcde"), np.ones(5)), tikhonov="generalised cross-validation")
    assert found.values == pytest.approx(values, rel=1e-5)
