"""Words for single estimates, and angles whose interval is never told as zero."""

import pytest

from estimator.fit.estimates import Estimate
from rotorundown.summaries.estimate_words import angle_half_words, estimate_words


@pytest.mark.parametrize(
    ("half", "said"), [(0.0, "0.1"), (0.004, "0.1"), (0.11, "0.2"), (0.3, "0.3"), (12.0, "12.0"), (179.96, "180.0")]
)
def test_half_widths_of_angles_are_rounded_up_to_their_tenths(half: float, said: str) -> None:
    assert angle_half_words(half) == said


def test_an_unbalance_known_well_has_an_angle_with_an_error() -> None:
    one = Estimate("disc.D1.unbalance", "disc.D1", "unbalance", "kg m", 1e-3, 1e-8, 1e-3, 1e-3, 0.0, 1e-8)
    assert estimate_words(one) == "1000 ± 0.01 g mm at 0.0 ± 0.1°"
