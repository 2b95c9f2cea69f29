"""Stability that has fallen below its limit: a fault of a train on oil films that no single change of a number has.

A film is less stable with colder oil, which a year brings and takes: a run is compared with the margin that the baseline's
machine would have with the viscosities of that run.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.alignment.stability_margin import LEAST_DECREMENT, StabilityMargin, stability_margin
from estimator.diagnosis.data_faults import CERTAIN, DataFault
from estimator.diagnosis.observation import Observation
from estimator.machine.parameter_description import describe
from estimator.rotor.identity_cache import cached_by_identity
from estimator.updated_model.model import UpdatedModel

LEFT = 0.5
"""Most of the baseline's margin that is left of one that has fallen [-]; one that was as low is the machine's design."""
OIL = ("viscosity", "viscosity_factor", "viscosity_ratio")
"""Quantities that follow the oil and its temperature."""
TINY = 1e-9
"""Least error of a margin [-]."""


def low_stability(baseline: Sequence[Observation], window: Sequence[Observation]) -> Iterator[DataFault]:
    """Find a train on oil films whose stability margin at running speed has fallen below its limit (API 617).

    Args:
        baseline: Observations of the baseline.
        window: Observations of the newest runs.

    Yields:
        A fault where in each run the margin is, with some certainty, below LEAST_DECREMENT and below half of what the
        baseline's machine would have with this oil.
    """
    lacking: list[float] = []
    for one in reversed(window):  # mostly the newest alone, as solving for films takes time
        model = one.model() if one.accepted and one.model is not None else None
        margin = None if model is None else _margin(model)
        if model is None or margin is None or _lacking(margin, LEAST_DECREMENT) <= CERTAIN:
            return
        usual = _usual_margin(model, baseline)
        least = 0.0 if usual is None else min(LEAST_DECREMENT, LEFT * usual.log_decrement)
        lacking.insert(0, _lacking(margin, least))
        if lacking[0] <= CERTAIN:
            return
    yield DataFault("machine", tuple(0.5 * size**2 for size in lacking))


@cached_by_identity
def _margin(model: UpdatedModel) -> StabilityMargin | None:
    """Return the margin of a run, remembered for the last few: several windows of runs end with the same one."""
    return stability_margin(model)


@cached_by_identity
def _usual_margin(now: UpdatedModel, baseline: Sequence[Observation]) -> StabilityMargin | None:
    """Return the margin that the baseline's machine would have under the conditions of a run."""
    return stability_margin(_with_conditions_of(now, [one.model() for one in baseline if one.model is not None]))


def _lacking(margin: StabilityMargin, least: float) -> float:
    """Return by how many of its errors a margin is below a limit [-]."""
    return (least - margin.log_decrement) / max(margin.error, TINY)


def _with_conditions_of(now: UpdatedModel, baseline: Sequence[UpdatedModel]) -> UpdatedModel:
    """Return the mean of a baseline's models under the conditions of a run: with its oil, and forces as it scales them."""
    own = now.coordinates_at(np.ones(1))
    then = np.mean([one.coordinates_at(np.ones(1)).theta(one.values) for one in baseline], axis=0)
    oil = np.array([describe(name).quantity in OIL for name in now.coordinates])
    return replace(now, values=own.point(np.where(oil, own.theta(now.values), then)))
