"""Fits that come nowhere at the pace of their steps end early, and those that still may do not."""

import math

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.fit.optimisation.maximum_likelihood import STALLED_PROMISE, STALLED_STEPS, _leads_nowhere
from estimator.machine.document import parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant
from tests.film_plant.wrong_documents import soft_pedestal

FAR = 2.0 * STALLED_PROMISE
"""Decrease that a step promises of a fit that is far from its end [-]."""


def falling(pace: float) -> list[float]:
    """Costs that fall from 1000 at a pace."""
    return [1000.0 - pace * step for step in range(STALLED_STEPS + 1)]


@pytest.mark.parametrize(
    ("costs", "promise", "left", "nowhere"),
    [
        (falling(1.0), FAR, 20, True),
        (falling(50.0), FAR, 20, False),
        (falling(1.0)[1:], FAR, 20, False),
        (falling(1.0), STALLED_PROMISE, 20, False),
        ([one - 800.0 for one in falling(1.0)], FAR, 20, False),
    ],
    ids=["slow", "fast enough", "too few steps", "close to its end", "below it already"],
)
def test_only_slow_steps_far_from_their_end_and_above_the_limit_lead_nowhere(
    costs: list[float], promise: float, left: int, nowhere: bool
) -> None:
    assert _leads_nowhere(costs, promise, left, 300.0) is nowhere
    assert not _leads_nowhere(costs, promise, left, math.inf)


def test_a_soft_pedestal_that_is_said_to_be_rigid_is_refused_in_few_steps() -> None:
    plant = random_plant(3000, alter=soft_pedestal, discrepancy=DiscrepancySize())
    found = identify(parse_machine(film_document(plant)), measured(plant, seed=3000), Options(starts=10))
    assert not found.accepted
    assert found.starts == 2
    assert found.iterations < 200  # 400 before such fits were given up
    assert np.isfinite(found.point).all()
