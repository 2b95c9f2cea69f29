"""Runs identified again over the API: with other options, as variants, so many at a time, without their slow roll."""

import numpy as np
import pytest
from sqlalchemy import event

from estimator.machine.document import parse_machine
from estimator.machine.rules import QualityRules
from service.configuration.settings import Settings
from service.identification import job_options
from service.identification.job_options import quality_rules
from service.identification.job_quota import JobQuota, QuotaExceeded
from service.identification.scheduler import JobScheduler
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.findings import jobs
from storage.measurements import runs
from tests.api_in_process import PREFIX, Api, problem
from tests.plant import (
    KEY,
    SECOND,
    START,
    samples,
    wait_until,
)
from tests.slow_roll import PUMP, RUN_OUT, TRAIN, given


def test_only_closed_runs_are_identified_again(pump: Api, plant: Database) -> None:
    with plant.transaction() as session:
        opened = runs.open_run(session, "pump-7", revision=1, kind="run-up", direction=1, time_first=START - SECOND).id
    assert "is open" in pump("POST", f"/runs/{opened}/identifications", 409, json={})["detail"]
    pump("POST", "/runs/99/identifications", 404, json={})
    (run,) = [one for one in pump("GET", "/machines/pump-7/runs") if one["state"] == "closed"]
    path = f"/runs/{run['id']}/identifications"
    pump("POST", path, 404, json={"slow_roll": 7})
    for wrong in ({"slow_roll": "all"}, {"slow_roll": 0}, {"starts": 0}, {"seed": -1}, {"speed": 1}):
        pump("POST", path, 422, json=wrong)


def test_the_same_is_not_asked_twice_while_it_waits(pump: Api, plant: Database) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    first = pump("POST", path, 202, json={})
    assert (first["scope"], first["state"], first["runs"]) == ("run", "queued", [run["id"]])
    assert first["options"] == {"slow_roll_version": None}
    assert pump("POST", path, 202, json={"slow_roll": "none", "starts": 10})["id"] == first["id"]
    assert pump("POST", path, 202, json={"seed": 4})["id"] != first["id"]
    with plant.transaction() as session:
        jobs.finish(jobs.get(session, first["id"]), state=jobs.DONE)
    again = pump("POST", path, 202, json={})
    assert again["id"] != first["id"]
    assert again["scope"] == "run"


def test_options_other_than_the_usual_make_a_variant(pump: Api) -> None:
    pump("POST", PUMP, 201, json=given())
    (run,) = pump("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    scopes = [pump("POST", path, 202, json=body)["scope"] for body in ({}, {"slow_roll": 1}, {"seed": 3})]
    assert scopes == ["run", "variant", "variant"]
    pump("PUT", f"{PUMP}/in-force", json={"version": 1})
    scopes = [pump("POST", path, 202, json={"slow_roll": one})["scope"] for one in ("in_force", 1, "none")]
    assert scopes == ["run", "run", "variant"]


def test_the_newest_runs_are_identified_again_when_a_version_is_put_in_force(pump: Api) -> None:
    pump("POST", PUMP, 201, json=given())
    pump("PUT", f"{PUMP}/in-force", json={"version": 1, "identify_again": 10})
    newest = pump("GET", "/machines/pump-7/jobs")[0]
    assert (newest["scope"], newest["options"]) == ("run", {"slow_roll_version": 1})


def test_of_what_people_ask_for_so_many_may_wait_and_the_rest_is_told_when_to_come_back(plant: Database, pump: Api) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    for quota, words in ((JobQuota(2, 9), "2 identifications that you asked for wait"), (JobQuota(9, 2), "machine 'pump-7'")):
        asking = Api(plant, job_quota=quota)
        first = [asking("POST", path, 202, json={"seed": seed})["id"] for seed in (1, 2)]
        refused = asking.ask("POST", f"{PREFIX}{path}", json={"seed": 3})
        assert words in problem(refused, 429)["detail"]
        assert int(refused.headers["retry-after"]) > 0
        assert asking("POST", path, 202, json={"seed": 2})["id"] == first[1]  # it waits already
        with plant.transaction() as session:
            for row in jobs.claim_next(session, 9):
                jobs.finish(row, state=jobs.DONE)
        asking("POST", path, 202, json={"seed": 3})
        with plant.transaction() as session:
            for row in jobs.claim_next(session, 9):
                assert row.asked_by == "open"
                jobs.finish(row, state=jobs.DONE)


def test_nothing_is_put_in_force_where_its_identifications_may_not_wait(plant: Database, pump: Api) -> None:
    pump("POST", PUMP, 201, json=given())
    (run,) = pump("GET", "/machines/pump-7/runs")
    asking = Api(plant, job_quota=JobQuota(1, 1))
    asking("POST", f"/runs/{run['id']}/identifications", 202, json={"seed": 1})
    again = {"version": 1, "identify_again": 10}
    assert "ask again" in asking("PUT", f"{PUMP}/in-force", 429, json=again)["detail"]
    assert asking("GET", PUMP)["in_force"] is None
    with plant.transaction() as session:
        later = runs.open_run(session, "pump-7", revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(later, samples=samples(40), state=runs.CLOSED, reason="as asked")
    assert "no more than 1 runs" in asking("PUT", f"{PUMP}/in-force", 422, json=again)["detail"]


def test_the_same_is_asked_for_a_hundred_times_in_few_questions_each(plant: Database, pump: Api) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    requester, wanted = job_options.Requester("anna"), job_options.Request(seed=4)
    numbers = []
    for _ in range(100):
        with plant.transaction() as session:
            row = job_options.request_identification(session, run["id"], wanted, requester)
            jobs.finish(row, state=jobs.DONE)
            numbers.append((row.options or {}).get("again", 0))
    assert numbers == list(range(100))
    questions: list[str] = []
    event.listen(plant.engine, "before_cursor_execute", lambda *args: questions.append(args[2]))
    with plant.transaction() as session:
        job_options.request_identification(session, run["id"], wanted, requester)
    assert len(questions) < 40


def test_who_sees_one_plant_asks_in_the_same_order_and_quota(plant: Database, pump: Api) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    with PlantScope(plant, frozenset({KEY.plant})).transaction() as session:
        requester = job_options.Requester("anna", JobQuota(1, 9))
        assert (
            job_options.request_identification(session, run["id"], job_options.Request(seed=4), requester).plant == KEY.plant
        )
        with pytest.raises(QuotaExceeded):
            job_options.request_identification(session, run["id"], job_options.Request(seed=5), requester)


def test_an_old_run_is_identified_again_without_its_slow_roll(train: tuple[Database, int]) -> None:
    database, run = train
    api = Api(database)
    vectors = {
        channel: {
            "amplitude_um_pp": 2e6 * abs(vector),
            "phase_lag_deg": -float(np.degrees(np.angle(vector))),
            "standard_error_um_pp": 1.0,
        }
        for channel, vector in zip(parse_machine(api("GET", f"/machines/{TRAIN}")["document"]).channels, RUN_OUT, strict=True)
    }
    api("POST", f"/machines/{TRAIN}/slow-roll", 201, json={"vectors": vectors})
    raw = api("GET", f"/runs/{run}/phasors")
    path = f"/runs/{run}/identifications"
    api("POST", path, 202, json={"slow_roll": 1, "starts": 2})
    work = JobScheduler(database, Settings(workers=1))
    work.start()
    try:
        wait_until(lambda: all(one["state"] == "done" for one in api("GET", f"/machines/{TRAIN}/jobs")), seconds=120.0)
        assert api("GET", f"/machines/{TRAIN}/trends", params={"parameter": "bearing.B1.kxx"})["series"][0]["value"] == []
        api("PUT", f"/machines/{TRAIN}/slow-roll/in-force", json={"version": 1})
        api("POST", path, 202, json={})
        wait_until(lambda: all(one["state"] == "done" for one in api("GET", f"/machines/{TRAIN}/jobs")), seconds=120.0)
    finally:
        work.stop()
    usual, variant = api("GET", f"/machines/{TRAIN}/identifications")
    assert [(one["scope"], one["slow_roll_version"]) for one in (variant, usual)] == [("variant", 1), ("run", 1)]
    assert variant["options"]["starts"] == 2
    assert variant["options"]["slow_roll_left_out"] == {}
    assert variant["accepted"]
    assert usual["accepted"]
    (trend,) = api("GET", f"/machines/{TRAIN}/trends", params={"parameter": "bearing.B1.kxx"})["series"]
    assert trend["identification"] == [usual["id"]]
    names = [one["parameter"] for one in api("GET", f"/identifications/{usual['id']}")["estimates"]]
    assert "probe.B1X.run_out" in names  # what the vector's error leaves
    assert api("GET", f"/runs/{run}/phasors") == raw  # nothing stored has changed


def test_other_rules_of_quality_make_a_variant_that_keeps_to_them(pump: Api) -> None:
    (run,) = pump("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    asked = pump("POST", path, 202, json={"accepted_rpm": [600, 2000], "half_power": True})
    assert asked["scope"] == "variant"
    with pump.app.state.database.transaction() as session:
        row = jobs.get(session, asked["id"])
        rules = quality_rules(row, QualityRules(sweep_rate=False))
    assert rules == QualityRules(sweep_rate=False, half_power=True, accepted_rpm=(600.0, 2000.0))
    usual = pump("POST", path, 202, json={"half_power": False})
    assert usual["scope"] == "run"
    assert "the lower speed first" in str(pump("POST", path, 422, json={"accepted_rpm": [2000, 600]})["errors"])
