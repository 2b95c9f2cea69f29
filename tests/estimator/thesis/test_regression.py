"""Least squares with column scaling: exact solutions, condition numbers, what scaling does and does not change."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimator.arrays import Complexes, Floats
from estimator.thesis.regression import Regression, RegressionMethod, Scaling, condition_number, real_rows, solve

SCALINGS: tuple[Scaling, ...] = ("none", "thesis", "norm")


def problem(
    seed: int, *, rows: int = 20, columns: int = 6, spread: float = 3.0, noise: float = 0.0
) -> tuple[Regression, Floats]:
    """A random regression with columns of very different size, and the values that solve it."""
    rows, columns = 20, 6
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((rows, columns)) * 10.0 ** rng.uniform(-spread, spread, columns)
    values = rng.standard_normal(columns) * 10.0 ** rng.uniform(-spread, spread, columns)
    target = matrix @ values
    target = target + noise * np.abs(target).max() * rng.standard_normal(rows)
    names = tuple(f"p{column}" for column in range(columns))
    return Regression(matrix, target, names, 10.0 ** rng.uniform(-spread, spread, columns)), values


def test_real_rows_hold_real_parts_then_imaginary_parts() -> None:
    matrix = np.array([[1 + 2j, 3 + 4j], [5 + 6j, 7 + 8j]])
    assert np.array_equal(real_rows(matrix), [[1, 3], [5, 7], [2, 4], [6, 8]])
    assert np.array_equal(real_rows(matrix[:, 0]), [1, 5, 2, 6])


def test_real_rows_solve_complex_equations_for_real_unknowns() -> None:
    rng = np.random.default_rng(3)
    matrix: Complexes = rng.standard_normal((5, 8)) + 1j * rng.standard_normal((5, 8))
    values = rng.standard_normal(8)
    found = solve(Regression(real_rows(matrix), real_rows(matrix @ values), tuple("abcdefgh"), np.ones(8)))
    assert found.values == pytest.approx(values, rel=1e-10)


def test_straight_line_through_three_points_by_hand() -> None:
    """y = a + b t through (0, 1), (1, 2), (2, 4): a = 5/6, b = 3/2, residuals -1/6, 1/3, -1/6."""
    line = Regression(np.array([[1.0, 0], [1, 1], [1, 2]]), np.array([1.0, 2, 4]), ("a", "b"), np.array([1.0, 0.5]))
    for scaling in SCALINGS:
        found = solve(line, scaling=scaling)
        assert found.values == pytest.approx([5 / 6, 3 / 2], rel=1e-13)
        assert found.residual == pytest.approx([-1 / 6, 1 / 3, -1 / 6], rel=1e-12)
        assert found.parameter == 0.0
    assert solve(line, method="inverse").values == pytest.approx([5 / 6, 3 / 2], rel=1e-13)
    assert solve(line, method="pseudo-inverse").values == pytest.approx([5 / 6, 3 / 2], rel=1e-13)


def test_condition_number_is_the_ratio_of_singular_values() -> None:
    assert condition_number(np.diag([8.0, -2.0, 4.0])) == pytest.approx(4.0)
    assert condition_number(np.array([[1.0, 1.0], [1.0, 1.0]])) > 1e15
    assert condition_number(np.zeros((2, 2))) == float("inf")


def test_condition_numbers_before_and_after_scaling_of_orthogonal_columns() -> None:
    columns = Regression(np.diag([1.0, 1e3, 1e-3]), np.ones(3), ("a", "b", "c"), np.array([1.0, 1e-3, 1.0]))
    assert solve(columns, scaling="none").condition_number_after == pytest.approx(1e6)
    assert solve(columns, scaling="thesis").condition_number_after == pytest.approx(1e3)
    assert solve(columns, scaling="norm").condition_number_after == pytest.approx(1.0)
    assert solve(columns, scaling="norm").condition_number_before == pytest.approx(1e6)
    assert solve(columns, scaling="norm").scale == pytest.approx([1.0, 1e-3, 1e3])


@given(seed=st.integers(0, 10_000), scaling=st.sampled_from(SCALINGS))
@settings(max_examples=40, deadline=None)
def test_scaling_does_not_change_the_exact_solution(seed: int, scaling: Scaling) -> None:
    regression, values = problem(seed)
    found = solve(regression, scaling=scaling)
    # Rounding grows with the condition number, relative to the largest contribution of any unknown.
    contribution = np.abs(regression.matrix).max(axis=0)
    error = np.abs(found.values - values) * contribution
    assert error.max() <= 1e-14 * found.condition_number_after * (np.abs(values) * contribution).max()


@given(seed=st.integers(0, 10_000))
@settings(max_examples=25, deadline=None)
def test_scaling_does_not_change_the_least_squares_solution_of_noisy_equations(seed: int) -> None:
    regression, _ = problem(seed, spread=1.0, noise=0.1)
    plain = solve(regression, scaling="none").values
    assert solve(regression, scaling="norm").values == pytest.approx(plain, rel=1e-7, abs=1e-9 * np.abs(plain).max())


def test_scaling_matters_for_a_pseudo_inverse_and_not_for_an_inverse() -> None:
    """AᵀA of a condition number beyond double precision: elimination copes, a pseudo-inverse cuts unknowns off."""
    matrix = np.random.default_rng(5).standard_normal((20, 6)) * 10.0 ** np.linspace(-5, 5, 6)
    values = 10.0 ** -np.linspace(-5, 5, 6)
    regression = Regression(matrix, matrix @ values, tuple("abcdef"), np.ones(6))
    assert solve(regression, scaling="none").condition_number_after > 1e9

    def error(scaling: Scaling, method: RegressionMethod) -> float:
        return float(np.max(np.abs(solve(regression, scaling=scaling, method=method).values / values - 1.0)))

    assert error("none", "inverse") < 1e-3
    assert error("none", "pseudo-inverse") > 0.5
    assert error("norm", "pseudo-inverse") < 1e-3


def test_regularisation_towards_expected_values_keeps_them_where_nothing_is_measured_well() -> None:
    rng = np.random.default_rng(1)
    matrix = rng.standard_normal((30, 4))
    matrix[:, 3] = matrix[:, 2] + 1e-7 * rng.standard_normal(30)
    values = np.array([1.0, 2.0, 3.0, 4.0])
    target = matrix @ values + 1e-3 * rng.standard_normal(30)
    regression = Regression(matrix, target, tuple("abcd"), np.ones(4))
    plain = solve(regression).values
    drawn = solve(regression, tikhonov="generalised cross-validation", expected=np.array([1.1, 1.8, 3.1, 4.1]))
    assert abs(plain[3] - 4.0) > 10
    assert drawn.values == pytest.approx(values, abs=0.2)
    assert drawn.parameter > 0.0


def test_regularisation_of_good_equations_changes_next_to_nothing() -> None:
    regression, _ = problem(8, spread=0.5, noise=1e-6)
    plain = solve(regression).values
    found = solve(regression, tikhonov="generalised cross-validation").values
    assert found == pytest.approx(plain, rel=1e-2)


def test_too_few_equations() -> None:
    with pytest.raises(ValueError, match="2 equations cannot determine 3 unknowns"):
        solve(Regression(np.ones((2, 3)), np.ones(2), ("a", "b", "c"), np.ones(3)))


def test_unknown_in_no_equation_is_named() -> None:
    matrix = np.array([[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]])
    with pytest.raises(ValueError, match="no equation contains b"):
        solve(Regression(matrix, np.ones(3), ("a", "b"), np.ones(2)))


def test_singular_equations_are_refused() -> None:
    with pytest.raises(ValueError, match="do not determine"):
        solve(Regression(np.ones((3, 2)) * [[1.0], [0.0], [0.0]], np.ones(3), ("a", "b"), np.ones(2)), scaling="none")


def test_regularised_inverse_is_refused() -> None:
    regression, _ = problem(1)
    with pytest.raises(ValueError, match="orthogonal method only"):
        solve(regression, method="inverse", tikhonov="L-curve")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"target": np.ones(3)}, "target has shape"),
        ({"names": ("a",)}, "names has shape"),
        ({"thesis_scale": np.ones(3)}, "thesis_scale has shape"),
        ({"target": np.array([1.0, np.nan])}, "finite"),
    ],
)
def test_wrong_regressions_are_refused(change: dict[str, Any], message: str) -> None:
    parts: dict[str, Any] = {"matrix": np.eye(2), "target": np.ones(2), "names": ("a", "b"), "thesis_scale": np.ones(2)}
    with pytest.raises(ValueError, match=message):
        Regression(**{**parts, **change})
