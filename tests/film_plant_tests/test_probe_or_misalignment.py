"""A gain and a misalignment that explain runs about as well: the probe is named, and the coupling as what it may be besides.

A small train of other make than the estimator, whose soft coupling's offset a run knows to some 30 µm only (1 σ).
"""

from functools import cache

import numpy as np
import pytest

from estimator.fit.identification import Identification
from estimator.machine.document import Machine, parse_machine
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import AssessedRun, AssessmentBasis, AssessmentContext
from service.monitoring.rules.limits import Limits
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document
from tests.film_plant.misalignment import ONE_SUPPLY
from tests.film_plant.plant import Plant
from tests.film_plant.plants import random_plant
from tests.film_plant.scatter import run_of
from tests.film_plant_tests.test_film_diagnosis import WIDE, assessed, gated

SEED, BASELINE = 16, 6


@cache
def plant() -> Plant:
    return random_plant(SEED, priors=ONE_SUPPLY, discrepancy=DiscrepancySize())


@cache
def machine() -> Machine:
    return parse_machine(film_document(plant(), priors=WIDE))


def run(number: int, *, seed: int, gain: float, first: Identification | None) -> tuple[AssessedRun, Identification]:
    """Identify a run in which probe B2X reads by a factor too much."""
    varied = run_of(plant(), np.random.default_rng([SEED, seed]))
    found = gated(varied, seed, first, gains={"B2X": gain}, of=machine())
    return assessed(number, found), found


@cache
def baseline() -> tuple[tuple[AssessedRun, ...], Identification]:
    one, first = run(0, seed=0, gain=1.0, first=None)
    return (one, *(run(number, seed=number, gain=1.0, first=first)[0] for number in range(1, BASELINE))), first


@pytest.mark.parametrize("draw", [0, *(pytest.param(one, marks=pytest.mark.long) for one in (1, 2, 3))])
def test_a_probe_that_reads_10_per_cent_too_much_is_no_misalignment(draw: int) -> None:
    before, first = baseline()
    after = [run(BASELINE + number, seed=100 * (1 + draw) + number, gain=1.1, first=first)[0] for number in range(3)]
    for runs in (2, 3):
        context = AssessmentContext(
            machine=machine(),
            limits=Limits(),
            basis=AssessmentBasis(None, None),
            baseline=before,
            after=tuple(after[:runs]),
            open_causes=(),
            history=None,
            open_rates={},
        )
        found = assess(context).diagnosis
        assert found is not None
        named = {(one.cause.kind, one.cause.element) for one in found.causes}
        assert named <= {("sensor", "probe.B2X")}
