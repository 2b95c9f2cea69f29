"""Text of a field balancing: the intervals of its angles."""

import pytest

from service.balancing.balancing_text import _half


@pytest.mark.parametrize(
    ("half", "said"), [(0.0, "0.1"), (0.02, "0.1"), (0.3, "0.3"), (0.31, "0.4"), (9.96, "10.0"), (10.4, "10"), (95.0, "95")]
)
def test_an_angle_is_never_told_as_exact(half: float, said: str) -> None:
    assert _half(half) == said
