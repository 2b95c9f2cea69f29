"""A rig that is held at some speeds is calibrated over the API: from runs too short for sweeps, and from named times."""

from dataclasses import replace
from typing import Any

import numpy as np

from estimator.machine.document import Machine, parse_machine
from estimator.simulation.simulated_plant import draw_truth, measured_phasors
from estimator.units import rpm_to_rad_per_s
from service.runs.closing import Closing
from service.runs.collector import Collector
from service.workers.executors import LocalExecutor
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api
from tests.identification import counts, identifying
from tests.plant import SECOND, START, arrived, batch, document, wait_until

GAIN = 1.3 * np.exp(0.4j)
WEIGHT = 1e-3
"""Trial weight [kg m]."""
SPEEDS = (1000.0, 1150.0, 1300.0, 1450.0)
"""Speeds of the dwells [r/min], 17 % of the speed range."""
DWELL_S, RAMP_S = 20, 3
"""Length of a dwell, and of the way to the next [s]."""


class HeldPump:
    """A pump that is held at some speeds with each set of weights; its samples come from a source, second by second."""

    def __init__(self, database: Database) -> None:
        self.machine: Machine = parse_machine(document(operation={}))
        self.rng = np.random.default_rng(3)
        self.truth = draw_truth(self.machine, self.rng)
        self.collector = Collector(late_s=0.0)
        self.writer = SampleWriter(database, self.collector)
        self.database, self.count = database, 0
        with database.transaction() as session:
            machines.create(session, self.machine)

    def hold(self, speeds: tuple[float, ...], disc: int | None = None) -> tuple[int, int]:
        """Send the samples of dwells with a weight on a disc, and return their first and last time [ns]."""
        rpm: list[float] = []
        for place, speed in enumerate(speeds):
            if place:
                rpm += np.linspace(speeds[place - 1], speed, RAMP_S + 2)[1:-1].tolist()
            rpm += (speed + self.rng.normal(0.0, 0.2, DWELL_S)).tolist()
        added = np.zeros(len(self.machine.discs), dtype=complex)
        if disc is not None:
            added[disc] = WEIGHT * np.exp(0.5j * np.pi * disc)
        turning = np.array([rpm_to_rad_per_s(one) for one in rpm])
        loaded = replace(self.truth, unbalances=self.truth.unbalances + added)
        phasor = GAIN * measured_phasors(self.machine, loaded, turning, self.rng)
        start = START + self.count * 86_400 * SECOND
        said = batch(rpm, sequence=1000 * self.count, start=start)
        said.amplitude = (2e6 * np.abs(phasor)).tolist()
        said.phase = (-np.degrees(np.angle(phasor))).tolist()
        self.writer.store([arrived(said, received_at=START + 10**8 * SECOND)], [])
        self.count += 1
        return start, start + (len(rpm) - 1) * SECOND

    def close(self) -> None:
        """End what is under way, as when the source falls silent, and close it."""
        with self.collector.lock, self.database.transaction() as session:
            self.collector.end_silent(session, self.machine.id)
        Closing(self.database, self.collector).close_ended()


def weights(rig: HeldPump, disc: int | None) -> list[dict[str, Any]]:
    if disc is None:
        return []
    return [{"disc": rig.machine.discs[disc].id, "amount": WEIGHT, "unit": "kg m", "angle_deg": 90.0 * disc}]


def time(moment: int) -> str:
    return f"{np.datetime64(moment, 'ns')}Z"


def test_runs_discarded_as_sweeps_calibrate_as_dwells_and_others_are_refused_by_name(
    database: Database, api: Api, executor: LocalExecutor
) -> None:
    rig = HeldPump(database)
    cases = (None, *range(len(rig.machine.discs)))
    for disc in cases:
        rig.hold(SPEEDS, disc)
        rig.close()
    listed = api("GET", f"/machines/{rig.machine.id}/runs")[::-1]
    assert [one["state"] for one in listed] == ["discarded"] * 3, listed
    assert "of the speed range, 20 % are needed" in listed[0]["reason"]
    path = f"/machines/{rig.machine.id}/model-calibrations"
    asked = [{"run": one["id"], "weights": weights(rig, disc)} for one, disc in zip(listed, cases, strict=True)]
    detail = api("POST", path, 422, json={"runs": asked, "by": "Ada"})["detail"]
    assert detail.startswith(f"run {listed[0]['id']} is discarded (")
    assert detail.endswith("where its samples are dwells at constant speed, say so: `steady: true`")
    steady = [one | {"steady": True} for one in asked]
    told = api("POST", path, 202, json={"runs": steady, "by": "Ada"})
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1}, seconds=300.0)
    found = api("GET", f"{path}/{told['id']}")
    assert (found["state"], found["accepted"]) == ("done", True), found
    held = found["document"]["calibration"]
    assert {round(one["rpm"], -1) for one in held["scatter"] if one["rpm"]} == set(SPEEDS), "no sample of a ramp"


def test_a_run_is_made_of_dwells_that_no_sweep_shows(database: Database, api: Api) -> None:
    rig = HeldPump(database)
    spans = [rig.hold((1300.0,), disc) for disc in (None, 0, 1)]
    rig.close()
    path = f"/machines/{rig.machine.id}"
    assert api("GET", f"{path}/runs") == []
    made = [
        api("POST", f"{path}/runs", 201, json={"from": time(first), "to": time(last), "by": "Ada"}) for first, last in spans
    ]
    assert [(one["kind"], one["samples"], one["state"]) for one in made] == [("dwells", DWELL_S, "discarded")] * 3
    assert made[0]["reason"] == (
        "made by Ada; identified on request only: dwells at constant speed are for calibrations and balancings"
    )
    assert [one["id"] for one in api("GET", f"{path}/runs")] == [one["id"] for one in made][::-1]
    asked = [
        {"run": one["id"], "weights": weights(rig, disc), "steady": True} for one, disc in zip(made, (None, 0, 1), strict=True)
    ]
    told = api("POST", f"{path}/model-calibrations", 202, json={"runs": asked, "by": "Ada"})
    assert [one["steady"] for one in told["runs"]] == [True] * 3
    begun = api("POST", f"{path}/balancings", 201, json={"runs": [made[0]["id"]], "by": "Ada"})
    trial = {"run": made[1]["id"], "weights": weights(rig, 0), "by": "Ada"}
    api("POST", f"{path}/balancings/{begun['id']}/trials", json=trial)
    taken = api("POST", f"{path}/model-calibrations", 202, json={"balancing": begun["id"], "by": "Ada"})
    assert [one["steady"] for one in taken["runs"]] == [True, True]


def test_a_time_without_dwells_makes_no_run(database: Database, api: Api) -> None:
    rig = HeldPump(database)
    first, last = rig.hold((1300.0, 1400.0))
    path = f"/machines/{rig.machine.id}/runs"
    before = {"from": time(first - 100 * SECOND), "to": time(first - SECOND), "by": "Ada"}
    detail = api("POST", path, 422, json=before)["detail"]
    assert "has no samples in that time within its speed range of 300 to 3000 r/min: none is stored at all" in detail
    api("POST", path, 422, json={"from": time(last), "to": time(first), "by": "Ada"})
    with database.reading() as session:
        assert runs.of_machine(session, rig.machine.id, limit=5) == []
