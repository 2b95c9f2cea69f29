"""A probe that a diagnosis has named: histories, comparisons and tables then allow for it as the diagnosis does."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from estimator.machine.document import Machine, parse_machine
from service.identification.stored_model import identified
from storage.database.engine import Database
from storage.findings import diagnoses, identifications, jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.findings import IdentificationRow
from tests.api_in_process import Api
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plant import Plant
from tests.film_plant.plants import random_plant
from tests.identification import counts, forward_samples, identifying, working
from tests.plant import SECOND, START, wait_until

BASELINE = 5
NAMED = BASELINE + 1
WEEK = 7 * 86_400 * SECOND
CHANNEL, GAIN = 7, 1.04
PATIENCE_S = 240.0
TOLD = "estimates leave open what a diagnosis has named: "


@pytest.fixture(scope="module")
def train() -> Plant:
    return random_plant(2, discrepancy=DiscrepancySize())


def close(database: Database, plant: Plant, machine: Machine, *, weeks: Sequence[int], gain: float) -> None:
    """Store a run-down per week as the collector would, with its job. gain: of one probe."""
    for week in weeks:
        found = measured(plant, seed=100 + week)
        phasor = found.phasor.copy()
        phasor[:, CHANNEL] *= gain
        order = np.argsort(-found.speed)
        seconds = np.linspace(0.0, 300.0, found.speed.size)
        held = forward_samples(np.asarray(START + week * WEEK + seconds * 1e9), found.speed[order], phasor[order])
        with database.transaction() as session:
            row = runs.open_run(session, machine.id, revision=1, kind="run-down", direction=1, time_first=int(held.time[0]))
            runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
            jobs.enqueue(session, machine.id, scope=jobs.RUN, run_ids=[row.id])


def of_run(database: Database, machine: Machine, week: int) -> list[IdentificationRow]:
    with database.reading() as session:
        found = identifications.of_machine(session, machine.id)
        return sorted(
            (one for one in found if one.measured_at // WEEK == (START + week * WEEK) // WEEK), key=lambda one: one.id
        )


def test_a_run_is_identified_again_beside_the_probe_that_its_diagnosis_names(database: Database, train: Plant) -> None:
    machine = parse_machine(film_document(train))
    probe = f"probe.{machine.channels[CHANNEL]}"
    with database.transaction() as session:
        machines.create(session, machine)
    with working(2) as executor, identifying(database, executor, baseline_runs=BASELINE):
        close(database, train, machine, weeks=range(BASELINE), gain=1.0)
        wait_until(lambda: counts(database) == {"done": BASELINE}, seconds=PATIENCE_S)
        close(database, train, machine, weeks=[BASELINE], gain=GAIN)
        wait_until(lambda: counts(database) == {"done": BASELINE + 1}, seconds=PATIENCE_S)  # else the later one may come first
        close(database, train, machine, weeks=[NAMED], gain=GAIN)
        wait_until(lambda: counts(database) == {"done": BASELINE + 3}, seconds=PATIENCE_S)  # it names the probe: twice
        close(database, train, machine, weeks=[NAMED + 1], gain=GAIN)
        wait_until(lambda: counts(database) == {"done": BASELINE + 4}, seconds=PATIENCE_S)
    plain, again = of_run(database, machine, NAMED)
    (later,) = of_run(database, machine, NAMED + 1)
    with database.reading() as session:
        for one in (plain, again, later):
            assert diagnoses.named_causes(diagnoses.of_identification(session, one.id)) == (("sensor", probe),)
    assert "open_errors" not in plain.options
    assert TOLD not in plain.verdict
    for one in (again, later):
        assert one.options["open_errors"] == [f"{probe}.gain"]
        assert one.verdict.endswith(f"{TOLD}{probe}.gain")
    api, parameter = Api(database), "bearing.B4.clearance"
    with database.reading() as session:
        found = identified(session, again.id)
    beside = found.model_beside((("sensor", probe),))
    np.testing.assert_allclose(found.model.values, beside.values, rtol=1e-7)
    np.testing.assert_allclose(np.diag(found.model.covariance), np.diag(beside.covariance), rtol=1e-5)
    (history,) = api.value(f"/machines/{machine.id}/trends?parameter={parameter}")["series"]
    points = dict(zip(history["identification"], history["value"], strict=True))
    assert plain.id not in points
    assert points[again.id] == pytest.approx(math.exp(beside.values[beside.coordinates.index(parameter)]), rel=1e-7)
    compared = api.value(f"/identifications/compare?first={again.id}&second={later.id}")["changes"]
    told = {one["parameter"]: one for one in compared}
    assert (told[parameter]["first"], told[parameter]["second"]) == pytest.approx((points[again.id], points[later.id]))
    assert max(abs(one["sigma"]) for one in compared if one["sigma"] is not None) < 4.0
