"""Linear least squares with column scaling, as the thesis solves its regression equations (Eq. 2.14-2.18, Appendix D).

Scaling the columns changes the condition number, what a regularisation means, and what a pseudo-inverse cuts off. It does
not change the least-squares solution; not even the rounding of the inverse in Eq. 2.16 takes much notice of it.
Columns of equal norm come near the smallest condition number that scaling can reach (van der Sluis 1969,
doi:10.1007/BF02165096).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.tikhonov import SpectralProblem, choose_parameter, filter_factors

Scaling = Literal["none", "thesis", "norm"]
RegressionMethod = Literal["orthogonal", "inverse", "pseudo-inverse"]


@dataclass(frozen=True)
class Regression:
    """Equations A x = b in real numbers.

    Attributes:
        matrix: A (R, C) [SI].
        target: b (R,) [SI].
        names: Names of the C unknowns.
        thesis_scale: Factor (C,) by which the thesis multiplies each column, 1 / mean spin speed for some [s/rad], 1 for the
            others.
    """

    matrix: Floats
    target: Floats
    names: tuple[str, ...]
    thesis_scale: Floats

    def __post_init__(self) -> None:
        rows, columns = self.matrix.shape
        shapes = {"target": (self.target.shape, (rows,)), "thesis_scale": (self.thesis_scale.shape, (columns,))}
        shapes["names"] = ((len(self.names),), (columns,))
        for name, (found, wanted) in shapes.items():
            if found != wanted:
                raise ValueError(f"{name} has shape {found}, should have {wanted} for a matrix of shape {self.matrix.shape}")
        if not (np.all(np.isfinite(self.matrix)) and np.all(np.isfinite(self.target))):
            raise ValueError("a regression needs finite numbers: leave out the equations of unusable phasors")


@dataclass(frozen=True)
class Solution:
    """A least-squares solution.

    Attributes:
        values: Unknowns (C,) in their own units [SI].
        residual: A x - b (R,) [SI].
        condition_number_before: Largest over smallest singular value of A [-]; that of the normal equations is its square.
        condition_number_after: The same after column scaling [-].
        scale: Factor on each column (C,) [SI].
        parameter: λ of the regularisation on the scaled problem, 0 without [-].
    """

    values: Floats
    residual: Floats
    condition_number_before: float
    condition_number_after: float
    scale: Floats
    parameter: float


def real_rows(equations: Complexes) -> Floats:
    """Separate complex equations into real ones: the real parts first, then the imaginary parts (thesis Eq. 2.14).

    Args:
        equations: Complex equations (R, ...) [any unit].

    Returns:
        Real equations (2R, ...) [unit of the argument].
    """
    return np.concatenate([equations.real, equations.imag], axis=0)


def column_scale(regression: Regression, scaling: Scaling) -> Floats:
    """Compute the factor on each column: none, the thesis's, or one over the column's norm (van der Sluis 1969).

    Source: thesis Eq. 2.14-2.18; van der Sluis (1969, doi:10.1007/BF02165096).

    Args:
        regression: The equations.
        scaling: Kind of the scaling.

    Returns:
        Factors (C,) [SI].

    Raises:
        ValueError: A column is zero, so that no equation contains its unknown.
    """
    norm = np.linalg.norm(regression.matrix, axis=0)
    if not np.all(norm > 0.0):
        missing = [name for name, size in zip(regression.names, norm, strict=True) if size == 0.0]
        raise ValueError(f"no equation contains {', '.join(missing)}: leave these unknowns out")
    if scaling == "none":
        return np.ones_like(norm)
    return regression.thesis_scale if scaling == "thesis" else 1.0 / norm


def condition_number(matrix: Floats) -> float:
    """Compute the condition number in the 2-norm.

    Source: standard result: largest over smallest singular value.

    Args:
        matrix: Matrix (R, C) [any unit].

    Returns:
        Condition number [-]; infinite for a singular matrix.
    """
    singular_values = np.linalg.svd(matrix, compute_uv=False)
    return float(singular_values[0] / singular_values[-1]) if singular_values[-1] > 0.0 else float("inf")


def solve(
    regression: Regression,
    *,
    scaling: Scaling = "norm",
    method: RegressionMethod = "orthogonal",
    tikhonov: RegularisationRule | None = None,
    expected: Floats | None = None,
) -> Solution:
    """Solve a regression by least squares (thesis Eq. 2.14-2.18, Appendix D).

    "orthogonal" solves by the singular values of A; "inverse" literally as Eq. 2.16, (AᵀA)⁻¹Aᵀb; "pseudo-inverse" the same
    with a pseudo-inverse that cuts off singular values of AᵀA below its size times the machine's precision. It lets
    numpy.linalg.LinAlgError through where AᵀA is exactly singular.

    Args:
        regression: The equations.
        scaling: Scaling of the columns.
        method: Method of solution.
        tikhonov: Rule that chooses the regularisation's parameter on the scaled problem; None for none.
        expected: Values (C,) that the regularisation draws the unknowns towards [SI]; None for zero. Not used without a rule.

    Returns:
        The solution.

    Raises:
        ValueError: The equations are fewer than the unknowns, no equation contains an unknown, or a regularisation is asked
            for with another method than the orthogonal.
    """
    rows, columns = regression.matrix.shape
    if rows < columns:
        raise ValueError(f"{rows} equations cannot determine {columns} unknowns: more speeds are needed")
    if tikhonov is not None and method != "orthogonal":
        raise ValueError("regularisation goes with the orthogonal method only")
    scale = column_scale(regression, scaling)
    matrix = regression.matrix * scale
    parameter = 0.0
    if method == "inverse":
        scaled = np.linalg.inv(matrix.T @ matrix) @ (matrix.T @ regression.target)
    elif method == "pseudo-inverse":
        cut = columns * np.finfo(float).eps
        scaled = np.linalg.pinv(matrix.T @ matrix, rcond=cut) @ (matrix.T @ regression.target)
    else:
        centre = np.zeros(columns) if expected is None or tikhonov is None else expected / scale
        step, parameter = _orthogonal(matrix, regression.target - matrix @ centre, tikhonov)
        scaled = centre + step
    values = scale * scaled
    return Solution(
        values=values,
        residual=regression.matrix @ values - regression.target,
        condition_number_before=condition_number(regression.matrix),
        condition_number_after=condition_number(matrix),
        scale=scale,
        parameter=parameter,
    )


def _orthogonal(matrix: Floats, target: Floats, rule: RegularisationRule | None) -> tuple[Floats, float]:
    left, singular_values, right = np.linalg.svd(matrix, full_matrices=False)
    if singular_values[-1] == 0.0:
        raise ValueError("the equations do not determine the unknowns: the matrix is singular")
    components = left.T @ target
    parameter = 0.0
    if rule is not None:
        parameter = choose_parameter(SpectralProblem.of(left, singular_values, target), rule)
        components = components * filter_factors(singular_values, parameter)
    return right.T @ (components / singular_values), parameter
