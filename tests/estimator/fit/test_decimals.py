"""Decimals of values beside their intervals."""

import pytest

from estimator.fit.decimals import decimals


@pytest.mark.parametrize(
    ("half", "number"), [(59.0, 0), (2.0, 0), (1.9, 1), (0.2, 1), (0.19, 2), (0.02, 2), (0.004, 3), (0.0001, 3), (0.0, 2)]
)
def test_two_digits_of_the_half_width_are_told(half: float, number: int) -> None:
    assert decimals(half) == number
