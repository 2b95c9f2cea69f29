"""Comparison of alignment with a baseline: how often a healthy machine is said to have changed, what cannot be compared."""

import numpy as np
import pytest

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.alignment_comparison import AlignmentComparison, compared_alignment
from estimator.alignment.run_change import run_change
from estimator.alignment.tolerance import tolerated_changes
from estimator.arrays import Floats
from estimator.diagnosis.compared_identifications import compared_identifications
from estimator.fit.identification import Identification
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.films import StaticLoad
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted
from tests.estimator.diagnosis.test_film_reference import effects
from tests.estimator.models import rich_model
from tests.plant import identification

TRIALS = 60
FORCE = "static_load.gear.force_y"


def healthy(seed: int) -> AlignmentComparison:
    """Comparison of a run of a healthy machine with another one as its baseline."""
    rng = np.random.default_rng(seed)
    machine = drawn_machine(rng)
    before, after = (fitted(drawn_run(machine, HealthyVariation(), rng), rng) for _ in range(2))
    change = run_change([before], after)
    assert change is not None
    return AlignmentComparison("C1", tolerated_changes(MODEL.machine, changed_alignment(change)), ())


def test_a_healthy_machine_is_seldom_said_to_have_changed_although_four_numbers_are_looked_at() -> None:
    found = [healthy(seed) for seed in range(TRIALS)]
    alone = [any(abs(one.value or 0.0) > one.half for one in each.changes) for each in found]
    told = ["has changed" in each.verdict for each in found]
    assert sum(told) <= 0.12 * TRIALS
    assert sum(alone) > 0.15 * TRIALS, "each number by itself at 95 % would have been told too often"


@pytest.mark.parametrize("wear", [0.0, 0.3])
def test_a_load_that_both_fits_doubt_moves_the_loads_on_films_with_it(wear: float) -> None:
    """Beside a bearing that is named as worn, too. wear: growth of the logarithm of its clearance [-]."""
    load = StaticLoad.model_validate({"id": "gear", "shaft": "S1", "station": 0.5, "force_y": 100.0})
    machine = MODEL.machine.model_copy(update={"static_loads": (load,)})
    names, covariance = COORDINATES.names, np.diag((0.1 * COORDINATES.unit * COORDINATES.spread) ** 2)

    worn = wear * np.array([name == "bearing.B2.clearance" for name in names])

    def fit(*forces: DoubtedForce, wear: Floats | float = 0.0) -> Identification:
        return identification(
            estimates=(),
            coordinates=names,
            point=MODEL.values + wear,
            covariance=covariance,
            channel_effects=effects(len(names)),
            doubted_forces=forces,
        )

    doubted = DoubtedForce(FORCE, 200.0, np.zeros(len(names)))
    plain, open_load = (
        compared_identifications(machine, fit(*forces), fit(*forces, wear=worn), "C1") for forces in ((), (doubted,))
    )
    assert plain.others == open_load.others == ((("wear", "bearing.B2"),) if wear else ())
    wider = [more.error / less.error for more, less in zip(open_load.loads, plain.loads, strict=True)]
    assert max(wider) > 1.05


def test_models_that_cannot_be_compared_say_why() -> None:
    with pytest.raises(ValueError, match=r"none of '.*' is identified: describe all of its bearings by geometry and oil"):
        compared_alignment([rich_model()], rich_model(), "C1")
    with pytest.raises(ValueError, match="of the same machine"):
        compared_alignment([rich_model()], MODEL, "C1")
