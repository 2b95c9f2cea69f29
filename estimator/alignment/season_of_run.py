"""Season of a run: what follows its temperature is as far from a baseline's as the oil is.

In another season the oil of all films is warmer or colder together, by as much as the runs themselves show. Bearings differ
by a part of that: one's film is not quite as warm as another's, its clearance not quite as wide. A run of the baseline's
season has none of these differences, one whose oil is farther off than a season brings has larger ones.
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.machine.alignment_rules import HealthyVariation
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.placed_films import placed_films

FOLLOWING = ("slow_viscosity", "slow_clearance")
"""Numbers of the variation over the seasons that are stated for one whose oil is as far off as `slow_oil`."""


def season_of_run(
    variation: HealthyVariation, baseline: Sequence[UpdatedModel], later: UpdatedModel, *, shift: float, error: float
) -> HealthyVariation:
    """Return the variation between a baseline and a run whose oil is known to be thicker or thinner (derived here).

    Args:
        variation: Variation of the machine.
        baseline: Models of the baseline's runs, at least one.
        later: Model of the later run.
        shift: Change of the logarithm of all viscosities together, over that of the oil's temperature where this is measured
            [-].
        error: Standard error of that [-].

    Returns:
        The variation: of the oil no less than it has changed, of what follows it in proportion.
    """
    stated = later.machine.operation.healthy_variation.slow_oil
    measured = _thickness(later) - float(np.mean([_thickness(one) for one in baseline]))
    if stated == 0.0:
        return variation
    part = float(np.hypot(measured + shift, error)) / stated
    update = {name: part * getattr(variation, name) for name in FOLLOWING}
    return variation.model_copy(update=update | {"slow_oil": max(variation.slow_oil, float(np.hypot(shift, error)))})


def _thickness(model: UpdatedModel) -> float:
    """Return the mean logarithm of the viscosities that a machine is believed to have under its conditions [-]."""
    found = placed_films(model.coordinates_at(np.ones(1)))
    if found is None:
        raise ValueError("only films of a train have viscosities")
    thickness: Floats = np.array([one.oil.value for one in found[1].own.train.journals.values()])
    return float(np.mean(np.log(thickness)))
