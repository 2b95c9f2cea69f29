"""Simulated operating conditions: their size and season, and what they do to a machine's bearings."""

import numpy as np
import pytest

from estimator.machine.rules import Condition
from estimator.simulation.simulated_plant import YEAR_S, draw_truth, drawn_conditions, truth_under_conditions
from tests.estimator.trains import chapter_3

MACHINE = chapter_3().model_copy(
    update={"conditions": (Condition(name="oil", unit="degC"), Condition(name="flow", unit="l/min", usual_change=4.0))}
)


def test_conditions_swing_by_their_usual_change_over_a_year() -> None:
    rng = np.random.default_rng(1)
    times = np.linspace(0.0, YEAR_S, 400, endpoint=False)
    drawn = np.array([drawn_conditions(MACHINE, float(time), rng) for time in times]) / [10.0, 4.0]
    assert drawn.mean(axis=0) == pytest.approx(5.0, abs=0.08)
    assert np.ptp(drawn[:, 0]) > 2.0
    season = drawn.T @ np.sin(2 * np.pi * times / YEAR_S) / 200
    assert season == pytest.approx(1.0, abs=0.1)


def test_a_usual_change_softens_every_bearing_by_a_hundredth_and_nothing_else() -> None:
    truth = draw_truth(MACHINE, np.random.default_rng(2))
    factor = truth_under_conditions(truth, MACHINE, np.array([60.0, 20.0])).coefficients / truth.coefficients
    of_bearing = np.array([one.element.startswith("bearing.") for one in truth.unknowns.coefficients])
    assert factor[of_bearing] == pytest.approx(np.exp(-0.01))
    assert np.all(factor[~of_bearing] == 1.0)


def test_a_machine_without_conditions_stays_as_it_is() -> None:
    rng = np.random.default_rng(3)
    before = rng.bit_generator.state
    truth = draw_truth(chapter_3(), np.random.default_rng(2))
    conditions = drawn_conditions(chapter_3(), 0.0, rng)
    assert conditions.shape == (0,)
    assert np.all(truth_under_conditions(truth, chapter_3(), conditions).coefficients == truth.coefficients)
    assert rng.bit_generator.state == before
