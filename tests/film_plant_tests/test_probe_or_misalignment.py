"""A gain and a misalignment that explain runs about as well: the probe is named, and the coupling as what it may be besides.

A small train of other make than the estimator, whose soft coupling's offset a run knows to some 30 µm only (1 σ).
"""

from functools import cache

import numpy as np
import pytest
from msgspec import structs

from estimator.diagnosis.observation import observed_fit
from estimator.fit.identification import Identification
from estimator.identification.quality_gate import identify_gated
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.recorded_run import RecordedRun
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import WEEK, AssessedRun, AssessmentBasis, AssessmentContext
from service.monitoring.rules.limits import Limits
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.misalignment import ONE_SUPPLY
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Priors, random_plant
from tests.film_plant.scatter import run_of

SEED, BASELINE = 16, 6
WIDE = Priors(elevation=150e-6, rigid_elevation=150e-6)


@cache
def plant() -> Plant:
    return random_plant(SEED, priors=ONE_SUPPLY, discrepancy=DiscrepancySize())


@cache
def machine() -> Machine:
    return parse_machine(film_document(plant(), priors=WIDE))


def run(number: int, *, seed: int, gain: float, first: Identification | None) -> tuple[AssessedRun, Identification]:
    """Identify a run in which probe B2X reads by a factor too much."""
    measurement = measured(run_of(plant(), np.random.default_rng([SEED, seed])), seed=seed)
    reads = np.where(np.array(machine().channels) == "B2X", gain, 1.0)
    measurement = structs.replace(measurement, phasor=measurement.phasor * reads)
    status = np.full(measurement.phasor.shape, ChannelStatus.GOOD, np.uint8)
    recorded = RecordedRun(None, measurement.speed, measurement.phasor, status, measurement.scatter, machine().channels)
    begin = None if first is None else first.point
    found = identify_gated(machine(), [recorded], [measurement], beginning=begin).identification
    assert found is not None
    return AssessedRun(number, number * WEEK, {}, observed_fit(found)), found


@cache
def baseline() -> tuple[tuple[AssessedRun, ...], Identification]:
    one, first = run(0, seed=0, gain=1.0, first=None)
    return (one, *(run(number, seed=number, gain=1.0, first=first)[0] for number in range(1, BASELINE))), first


@pytest.mark.parametrize("draw", range(4))
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
