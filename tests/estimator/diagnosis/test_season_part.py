"""The part of a season between two times: that of a sine over the year, and all of it after a quarter."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.diagnosis.season_part import SEASON, SLOW, WEEKS_A_YEAR, season_part, variation_within
from estimator.machine.alignment_rules import HealthyVariation


@given(st.floats(0.0, SEASON))
def test_it_is_the_root_mean_square_of_a_sine_between_such_times(weeks: float) -> None:
    times = np.linspace(0.0, WEEKS_A_YEAR, 1000, endpoint=False)
    year = np.sin(2.0 * np.pi * times / WEEKS_A_YEAR)
    later = np.sin(2.0 * np.pi * (times + weeks) / WEEKS_A_YEAR)
    of_any_two = np.sqrt(2.0 * np.var(year))
    assert season_part(weeks) == pytest.approx(np.sqrt(np.mean((later - year) ** 2)) / of_any_two, abs=1e-9)


@given(st.floats(SEASON, 1e6))
def test_after_a_quarter_of_a_year_it_is_all_of_it(weeks: float) -> None:
    assert season_part(weeks) == pytest.approx(1.0)


def test_only_what_is_slow_is_less() -> None:
    stated = HealthyVariation()
    within = variation_within(stated, weeks=4.0)
    changed = {name for name in HealthyVariation.model_fields if getattr(within, name) != getattr(stated, name)}
    assert changed == set(SLOW) == {name for name in HealthyVariation.model_fields if name.startswith("slow_")}
    assert within.slow_elevation == pytest.approx(season_part(4.0) * stated.slow_elevation)
