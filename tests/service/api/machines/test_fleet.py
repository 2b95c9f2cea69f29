"""All machines at a glance: state, runs, alerts, and what happened since a time."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy.orm import Session

from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines
from storage.tables.findings import JobRow
from tests.api_in_process import Api, fields
from tests.plant import CHANNELS, SECOND, START, arrived, batch, identification, machine, store_identification, sweep_rpm
from tests.prompt_writer import PromptWriter


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over one machine in a run-up with two alerts, and one of which nothing is known."""
    PromptWriter(plant, Collector()).store([arrived(batch([*sweep_rpm(2990.0, 310.0), 250.0, *sweep_rpm(310.0, 1650.0)]))], [])
    with plant.transaction() as session:
        machines.create(session, machine(id="fan-2", name="Fan 2"))
        row = store_identification(session, identification(), run_id=100, measured_at=START)
        for element, severe in (("coupling.C1", False), ("bearing.B1", True)):
            finding = AlertFinding({}, row.id, START)
            alert = transitions.raise_alert(session, "pump-7", rule="misalignment", element=element, finding=finding)
            alert.severity = 2 if severe else 1
        transitions.acknowledge(session, alert, transitions.Person("anna"))
    return Api(plant)


def test_each_machine_at_a_glance(api: Api) -> None:
    fan, pump = api.value("/fleet")["machines"]
    assert (fan["id"], fan["name"], fan["state"], fan["last_run"], fan["speed_rpm"]) == (
        "fan-2",
        "Fan 2",
        "unknown",
        None,
        None,
    )
    assert fan["open_alerts"] == {"alert": 0, "danger": 0}
    assert (pump["state"], pump["plant"]) == ("run-up", "plant-1")
    assert pump["speed_rpm"] == pytest.approx(1650.0)
    assert pump["open_alerts"] == {"alert": 1, "danger": 1}
    assert pump["unacknowledged"] == 1
    assert fan["first_alert"] is None
    first = pump["first_alert"]
    assert (first["element"], first["severity"], first["state"]) == ("coupling.C1", "alert", "unacknowledged"), "it waits"
    assert pump["last_run"]["state"] == "open"
    state = api.value("/machines/pump-7/state")
    assert pump["open_run"] == state["run"]
    assert pump["open_run"]["progress"] == pytest.approx(0.5, abs=0.05)
    assert (pump["newest_sample_at"], pump["state_since"]) == (state["newest_sample_at"], state["since"])
    assert pump["last_identification"]["accepted"] is True


def test_an_identification_that_failed_is_reported_until_one_ends_well(plant: Database, api: Api) -> None:
    def failed() -> Any:
        return api.value("/fleet", since=next(times))["machines"][1]["failed_job"]

    times = iter(["2020-01-01T00:00:00Z", "2020-01-02T00:00:00Z", "2020-01-03T00:00:00Z"])  # asked anew, not kept from before
    assert failed() is None
    with plant.transaction() as session:
        for run, state, error in ((201, jobs.DONE, None), (202, jobs.FAILED, "NotEnoughData: 3 samples")):
            jobs.finish(_enqueued(session, run), state=state, error=error)
    assert failed()["error"] == "NotEnoughData: 3 samples"
    with plant.transaction() as session:
        jobs.finish(_enqueued(session, 203), state=jobs.DONE)
    assert failed() is None


def _enqueued(session: Session, run: int) -> JobRow:
    found = jobs.enqueue(session, "pump-7", scope="run", run_ids=[run])
    assert found is not None
    return found


def test_what_happened_since(api: Api) -> None:
    _, pump = api.value("/fleet")["machines"]
    assert pump["happened"] == {
        "runs": 0,
        "identifications": 1,
        "alert_events": 3,
        "revisions": 1,
        "timeline": 0,
        "refused": 0,
    }
    long_ago = api.value("/fleet", since="2020-01-01T00:00:00Z")
    assert long_ago["since"] == "2020-01-01T00:00:00Z"
    assert long_ago["machines"][1]["happened"]["runs"] == 2
    later = (datetime.now(UTC) + timedelta(hours=1)).isoformat()
    assert set(api.value("/fleet", since=later)["machines"][1]["happened"].values()) == {0}


def test_wrong_questions_are_refused(api: Api) -> None:
    assert fields(api.get("/fleet", since="yesterday")) == ["query.since"]
    assert fields(api.get("/fleet", limit=0)) == ["query.limit"]


def test_a_vibration_beyond_its_danger_limit_is_reported_until_it_runs_below_it(database: Database) -> None:
    limits = {"running_rpm": 1400.0, "vibration_danger": 6e-5}
    with database.transaction() as session:
        machines.create(session, machine(operation=limits))
    writer, told = PromptWriter(database, Collector()), Api(database)

    def newest(number: int) -> Any:
        since = f"2026-01-01T00:00:{number:02}Z"  # an address of its own: kept answers may be half a second old
        return told.value("/fleet", since=since)["machines"][0]["vibration_beyond_danger"]

    def send(sequence: int, um_pp: float, *, rpm: float = 1400.0, step_s: int = 1, status: str = "good") -> Any:
        amplitude, marks = [100.0] * len(CHANNELS), ["good"] * len(CHANNELS)
        amplitude[1], marks[1] = um_pp, status
        times = {"start": START + 30 * sequence * SECOND, "step": step_s * SECOND}
        sent = batch([rpm] * 3, sequence=3 * sequence, amplitude=[amplitude] * 3, status=[marks] * 3, **times)
        writer.store([arrived(sent)], [])
        return newest(sequence)

    assert send(0, 119.0) is None
    assert send(1, 150.0, status="bad") is None, "a value that its source calls bad is none"
    assert send(2, 150.0) == {
        "channel": CHANNELS[1],
        "amplitude_um_pp": pytest.approx(150.0),
        "danger_um_pp": pytest.approx(120.0),
        "speed_rpm": pytest.approx(1400.0),
        "first_at": "2023-11-14T22:14:20Z",
        "last_at": "2023-11-14T22:14:22Z",
    }
    assert send(3, 10.0, rpm=10.0) is not None, "it was stopped, and nobody has looked"
    assert send(4, 100.0) is not None, "it has run below for seconds only"
    assert send(5, 100.0, step_s=200) is None
    assert send(20, 150.0) is not None
    with database.transaction() as session:
        machines.revise(session, machine(operation=limits | {"vibration_danger": 9e-5}))
    assert newest(30) is None, "its limit is another one now"
