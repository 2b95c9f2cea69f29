"""Eigenvalues of symmetric matrices: as numpy has them, and of one with which its method fails on some processors."""

import numpy as np
import pytest

from estimator.symmetric_eigen import condition_number, symmetric_eigen
from tests.paths import DATA


def test_a_covariance_with_which_divide_and_conquer_fails_is_decomposed() -> None:
    triangle = np.load(DATA / "covariance-152.npy")
    upper = np.zeros((152, 152))
    upper[np.triu_indices(152)] = triangle
    covariance = upper + np.triu(upper, 1).T
    values, vectors = symmetric_eigen(covariance)
    assert np.all(np.diff(values) >= 0.0)
    np.testing.assert_allclose(vectors @ np.diag(values) @ vectors.T, covariance, atol=1e-12 * values[-1])
    np.testing.assert_allclose(vectors.T @ vectors, np.eye(152), atol=1e-12)


def test_a_usual_matrix_is_decomposed_as_numpy_has_it() -> None:
    root = np.random.default_rng(1).standard_normal((7, 7))
    np.testing.assert_array_equal(symmetric_eigen(root @ root.T)[0], np.linalg.eigh(root @ root.T)[0])


def test_condition_numbers_are_those_of_singular_values() -> None:
    root = np.random.default_rng(2).standard_normal((6, 6))
    indefinite = root + root.T
    assert condition_number(indefinite) == pytest.approx(np.linalg.cond(indefinite), rel=1e-9)
    assert condition_number(np.diag([2.0, 0.0])) == np.inf
