"""Decimals of values beside their intervals."""

import pytest

from estimator.fit.decimals import decimals, signed_with_half


@pytest.mark.parametrize(
    ("half", "number"), [(59.0, 0), (2.0, 0), (1.9, 1), (0.2, 1), (0.19, 2), (0.02, 2), (0.004, 3), (0.0001, 3), (0.0, 2)]
)
def test_two_digits_of_the_half_width_are_reported(half: float, number: int) -> None:
    assert decimals(half) == number


@pytest.mark.parametrize(
    ("value", "half", "told"),
    [(-118.4, 18.0, ("-118", "18")), (420.3, 1.25, ("+420.3", "1.2")), (-0.2, 10.0, ("+0", "10"))],
)
def test_a_change_has_a_sign_and_the_decimals_of_its_half_width(value: float, half: float, told: tuple[str, str]) -> None:
    assert signed_with_half(value, half) == told
