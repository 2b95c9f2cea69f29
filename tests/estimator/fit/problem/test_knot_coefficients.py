"""Coefficients at knots evaluated together: values and derivatives are those of each by itself, tied ones included."""

import numpy as np

from estimator.bearings.mixed_coefficient import MixedCoefficient
from estimator.bearings.model import ModelParameter
from estimator.fit.problem.knot_coefficients import gathered

SPEEDS, OUTPUTS, COORDINATES = 7, 3, 8


def parameter(*, positive: bool, scale: float) -> ModelParameter:
    return ModelParameter("bearing.B1.kxx", "stiffness", "N/m", positive, scale, scale, 1.0)


def test_values_and_derivatives_are_those_of_each_by_itself() -> None:
    rng = np.random.default_rng(1)
    two, three = rng.uniform(size=(SPEEDS, 2)), rng.uniform(size=(SPEEDS, 3))
    each = [
        (4, range(0, 2), MixedCoefficient(parameter(positive=True, scale=3e6), two)),
        (1, range(2, 4), MixedCoefficient(parameter(positive=False, scale=2e5), two)),
        (3, range(5, 8), MixedCoefficient(parameter(positive=True, scale=7e3), three)),
        (0, range(0, 2), MixedCoefficient(parameter(positive=True, scale=3e6), two)),  # tied to the first
    ]
    found = gathered(each)
    assert [one.coefficients.tolist() for one in found] == [[4, 1, 0], [3]]
    assert [one.shared for one in found] == [True, False]
    theta = rng.standard_normal(COORDINATES)
    block = slice(2, 6)
    outputs = rng.standard_normal((5, 4, OUTPUTS)) + 1j * rng.standard_normal((5, 4, OUTPUTS))
    whole, due = np.zeros((2, COORDINATES, 4, OUTPUTS), dtype=complex)
    for one in found:
        one.add_derivatives(whole, theta, block, outputs)
    for index, places, curve in each:
        group = next(one for one in found if index in one.coefficients)
        column = group.coefficients.tolist().index(index)
        np.testing.assert_allclose(group.values(theta)[:, column], curve.values(theta[list(places)])[:, 0], rtol=1e-13)
        along = curve.derivatives(theta[list(places)], block)
        due[list(places)] += np.einsum("scp,csm->psm", along, outputs[[index]])
    np.testing.assert_allclose(whole, due, rtol=1e-12)
