"""Overall levels of simulated machines: those of the 1× that is sent, with the 2× beside it and a rest, and no more."""

import numpy as np

from estimator.simulation.simulated_overall import REST, simulated_overall

SECOND_PART = 0.1


def test_a_level_is_that_of_its_1x_with_a_2x_beside() -> None:
    phasors = np.full((200, 3), 50e-6 * np.exp(0.7j)) * np.array([1.0, 2.0, 4.0])
    second = SECOND_PART * phasors * np.exp(0.4j)
    level = simulated_overall(phasors, second, np.random.default_rng(1))
    over = level / np.abs(phasors)
    assert level.shape == phasors.shape
    # Half of the largest less the smallest value of cos x + a cos(2 x + p) lies between 1 and 1 + a; the rest adds a few rms.
    assert np.all(over >= 1.0)
    assert np.all(level <= (1.0 + SECOND_PART) * np.abs(phasors) + 5.0 * REST)
    assert np.ptp(over[:, 2]) < np.ptp(over[:, 0]), "the rest is the same however large the 1× is"


def test_a_shaft_that_hardly_moves_shows_the_rest() -> None:
    level = simulated_overall(np.zeros((500, 1), dtype=complex), np.zeros((500, 1), dtype=complex), np.random.default_rng(2))
    assert 2.0 * REST < level.mean() < 4.0 * REST


def test_levels_draw_nothing_that_changes_the_runs_of_a_seed() -> None:
    one, other = np.random.default_rng(3), np.random.default_rng(3)
    simulated_overall(np.ones((4, 2), dtype=complex), np.ones((4, 2), dtype=complex), one.spawn(1)[0])
    assert one.random() == other.random()
