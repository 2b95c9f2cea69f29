"""Numbers in what is said to people."""

import pytest

from service.monitoring.finding_rules import rounded


@pytest.mark.parametrize(
    ("value", "digits", "said"),
    [
        (7974.0, 3, "7970"),
        (13_002.0, 3, "13000"),
        (999.6, 3, "1000"),
        (12.345, 3, "12.3"),
        (0.012345, 3, "0.0123"),
        (-45.6, 2, "-46"),
        (123.0, 2, "120"),
        (0.0, 3, "0"),
    ],
)
def test_numbers_are_written_out(value: float, digits: int, said: str) -> None:
    assert rounded(value, digits) == said
