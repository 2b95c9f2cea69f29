"""Eigenvalues, eigenvectors and condition of symmetric matrices, also of those with which LAPACK's quickest method fails."""

import numpy as np
import scipy

from estimator.arrays import Floats


def symmetric_eigen(matrix: Floats) -> tuple[Floats, Floats]:
    """Compute the eigenvalues and eigenvectors of a symmetric matrix.

    By divide and conquer (LAPACK's syevd) and, where that does not converge, by QR, which is slower: of a covariance of 184
    quantities, all finite, OpenBLAS 0.3.31 found no eigenvalues, and an assessment ended with an error.

    Source: LAPACK Users' Guide, SIAM, 3rd ed. 1999, sec. 2.3.4.

    Args:
        matrix: Matrix (n, n) [any unit].

    Returns:
        Eigenvalues (n,), ascending [that unit], and the eigenvectors (n, n), one a column [-].
    """
    try:
        values, vectors = np.linalg.eigh(matrix)
    except np.linalg.LinAlgError:
        values, vectors = scipy.linalg.eigh(matrix, driver="ev")
    return np.asarray(values), np.asarray(vectors)


def condition_number(matrix: Floats) -> float:
    """Compute the condition number of a symmetric matrix from its eigenvalues.

    Source: standard result: the singular values of a symmetric matrix are the sizes of its eigenvalues.

    Args:
        matrix: Matrix (n, n) [any unit].

    Returns:
        Largest size of an eigenvalue over the smallest, infinite where that is zero [-].
    """
    sizes = np.abs(symmetric_eigen(matrix)[0])
    return float(sizes.max() / sizes.min()) if sizes.min() > 0.0 else np.inf
