"""Slow-roll vectors and repeated identifications over the API and in real workers: versions, raw data kept, what counts."""

from typing import Any

import numpy as np
import pytest
import yaml
from sqlalchemy import event

from estimator.fit.identify import Options
from estimator.machine.document import Machine, parse_machine
from estimator.machine.rules import QualityRules
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.slow_roll import SlowRoll
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from service.configuration.settings import Settings
from service.identification import computation, job_options
from service.identification.job_options import quality_rules
from service.identification.job_quota import JobQuota, QuotaExceeded
from service.identification.scheduler import JobScheduler
from service.identification.task import IdentificationTask
from service.monitoring import assessment_context
from service.monitoring.assess import compare
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.encoding.sample_blocks import Samples, encode
from storage.findings import identifications, jobs, trends
from storage.findings.identifications import ComparisonGroup
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import PREFIX, Api, problem
from tests.estimator.trains import ROOT
from tests.plant import (
    CHANNELS,
    KEY,
    SECOND,
    START,
    arrived,
    batch,
    document,
    identification,
    samples,
    store_identification,
    sweep_rpm,
    wait_until,
)
from tests.prompt_journal import PromptJournal

PUMP = "/machines/pump-7/slow-roll"
TRAIN = "thesis-chapter-3"
RUN_OUT = 2e-4 * np.exp(1j * np.arange(8))
"""Of each channel of the train [m]."""


@pytest.fixture
def api(plant: Database) -> Api:
    """Over a machine with a slow roll and a run-down: 100 µm peak-to-peak at 30° lag on all channels, always."""
    journal = PromptJournal(plant, Collector())
    slow = [*sweep_rpm(200.0, 290.0, 30), *sweep_rpm(2990.0, 310.0), *sweep_rpm(250.0, 100.0, 6)]
    # From slow roll to speed takes an hour: no shaft jumps.
    times = [START + i * SECOND for i in range(30)] + [START + (3600 + i) * SECOND for i in range(46)]
    journal.store([arrived(batch(slow, time_ns=times))], [])
    return Api(plant)


def given(**changes: Any) -> dict[str, Any]:
    one = {"amplitude_um_pp": 40.0, "phase_lag_deg": 30.0, "standard_error_um_pp": 1.0}
    return {"vectors": {"B2X": one}, **changes}


def moments(first: int, last: int) -> dict[str, str]:
    return {"from": f"2023-11-14T22:13:{20 + first:02}Z", "to": f"2023-11-14T22:13:{20 + last:02}Z"}


# --- versions -------------------------------------------------------------------------------------------------------


def test_without_vectors_there_are_no_versions(api: Api) -> None:
    assert api("GET", PUMP) == {"machine": "pump-7", "in_force": None, "versions": []}
    api("GET", "/machines/pump-9/slow-roll", 404)
    assert "version 1" in api("PUT", f"{PUMP}/in-force", 404, json={"version": 1})["detail"]


def test_given_vectors_are_versions_that_one_puts_in_force(api: Api) -> None:
    first = api("POST", PUMP, 201, json=given(comment="from the acceptance test"))
    assert (first["version"], first["origin"], first["in_force"], first["direction"]) == (1, "given", False, "positive")
    assert first["vectors"]["B2X"]["amplitude_um_pp"] == pytest.approx(40.0)
    assert first["vectors"]["B2X"]["phase_lag_deg"] == pytest.approx(30.0)
    assert first["vectors"]["B3Y"]["left_out"] == "it has no vector"
    assert api("POST", PUMP, 201, json=given(direction="negative"))["version"] == 2
    found = api("PUT", f"{PUMP}/in-force", json={"version": 2})
    assert (found["in_force"], [one["version"] for one in found["versions"]]) == (2, [2, 1])
    assert [one["in_force"] for one in found["versions"]] == [True, False]
    assert api("PUT", f"{PUMP}/in-force", json={"version": None})["in_force"] is None


def test_vectors_are_captured_from_stored_samples_in_a_band(api: Api) -> None:
    body = {"band_rpm": [200, 300], **moments(0, 30)}
    found = api("POST", PUMP, 201, json=body)
    assert (found["origin"], found["speed_minimum_rpm"]) == ("captured", pytest.approx(200.0))
    assert found["speed_maximum_rpm"] == pytest.approx(290.0)
    for channel in CHANNELS:
        vector = found["vectors"][channel]
        assert vector["amplitude_um_pp"] == pytest.approx(100.0)
        assert vector["phase_lag_deg"] == pytest.approx(30.0)
        assert vector["standard_error_um_pp"] < 1e-6  # the samples are all the same
        assert vector["left_out"] is None
    (run,) = api("GET", "/machines/pump-7/runs")
    assert api("POST", PUMP, 201, json={"band_rpm": [300, 600], "run": run["id"]})["version"] == 2


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({}, "give either vectors, or band_rpm"),
        (given(band_rpm=[200, 300]), "give either vectors, or band_rpm"),
        (given(run=1), "goes with band_rpm"),
        ({"band_rpm": [200, 300]}, "either a run, or both from and to"),
        ({"band_rpm": [300, 200], "run": 1}, "the lower one first"),
        ({"band_rpm": [200, 300], "run": 1, "direction": "positive"}, "samples know theirs"),
        ({"vectors": {"B9X": {"amplitude_um_pp": 1, "phase_lag_deg": 0}}}, "no channel B9X; it has B2X"),
        ({"vectors": {"B2X": {"amplitude_um_pp": -1, "phase_lag_deg": 0}}}, "greater than or equal to 0"),
        ({"vectors": {}}, "at least 1"),
        ({"band_rpm": [900, 1000], "from": "2023-11-14T22:13:20Z", "to": "2023-11-14T22:14:20Z"}, "0 good samples"),
        ({"band_rpm": [200, 300], "from": "2023-11-14T00:00:00Z", "to": "2023-12-14T00:00:00Z"}, "at most 7 days"),
        ({"band_rpm": [200, 300], "from": "2023-11-15T00:00:00Z", "to": "2023-11-14T00:00:00Z"}, "from must be before to"),
    ],
)
def test_what_makes_no_vectors_is_refused_with_the_reason(api: Api, body: dict[str, Any], words: str) -> None:
    answer = api("POST", PUMP, 422, json=body)
    assert words in answer["detail"] + "".join(one["message"] for one in answer["errors"])
    assert api("GET", PUMP)["versions"] == []


def test_vectors_of_an_unknown_run_or_anothers(api: Api) -> None:
    api("POST", PUMP, 404, json={"band_rpm": [200, 300], "run": 99})
    api("POST", "/machines", 201, json=document(id="fan-2"))
    (run,) = api("GET", "/machines/pump-7/runs")
    answer = api("POST", "/machines/fan-2/slow-roll", 422, json={"band_rpm": [300, 600], "run": run["id"]})
    assert "one of machine 'pump-7'" in answer["detail"]


def test_phasors_are_raw_unless_asked_otherwise_and_say_so(api: Api) -> None:
    api("POST", PUMP, 201, json=given())
    api("POST", PUMP, 201, json=given(direction="negative"))
    api("PUT", f"{PUMP}/in-force", json={"version": 1})
    (run,) = api("GET", "/machines/pump-7/runs")
    for path in (f"/runs/{run['id']}/phasors", "/machines/pump-7/samples"):
        raw = api("GET", path)
        assert raw["slow_roll_version"] is None
        assert raw["amplitude_um_pp"][0] == pytest.approx([100.0] * len(raw["time"]))
        found = api("GET", path, params={"slow_roll": "in_force"})
        assert found["slow_roll_version"] == 1
        assert found["amplitude_um_pp"][0] == pytest.approx([60.0] * len(raw["time"]))
        assert found["amplitude_um_pp"][1] == pytest.approx(raw["amplitude_um_pp"][1])
        assert found["slow_roll_left_out"] == dict.fromkeys(CHANNELS[1:], "it has no vector")
        # Given for the other sense of rotation it is conjugated: 100 at -30° less 40 at +30°.
        other = api("GET", path, params={"slow_roll": "2"})
        size = abs(100 * np.exp(-1j * np.radians(30)) - 40 * np.exp(1j * np.radians(30)))
        assert other["amplitude_um_pp"][0] == pytest.approx([size] * len(raw["time"]))
        assert api("GET", path) == raw
        api("GET", path, 404, params={"slow_roll": "3"})
        api("GET", path, 422, params={"slow_roll": "some"})


@pytest.mark.parametrize(("field", "value"), [("angle_deg", 45), ("sensitivity", 4000.0), ("station", 0.3), ("shaft", "S2")])
def test_a_revision_that_changes_a_probe_leaves_its_vector_out(api: Api, field: str, value: Any) -> None:
    one = given()["vectors"]["B2X"]
    api("POST", PUMP, 201, json={"vectors": {"B2X": one, "B2Y": one}})
    api("PUT", f"{PUMP}/in-force", json={"version": 1})
    revised = document()
    revised["probes"][0][field] = value
    api("PUT", "/machines/pump-7", json=revised)
    (version,) = api("GET", PUMP)["versions"]
    assert f"its {field} was" in version["vectors"]["B2X"]["left_out"]
    assert version["vectors"]["B2Y"]["left_out"] is None
    # The run was stored under the older revision, to which the vector belongs.
    (run,) = api("GET", "/machines/pump-7/runs")
    found = api("GET", f"/runs/{run['id']}/phasors", params={"slow_roll": "in_force"})
    assert found["amplitude_um_pp"][0][0] == pytest.approx(60.0)


# --- identify again -------------------------------------------------------------------------------------------------


def test_only_closed_runs_are_identified_again(api: Api, plant: Database) -> None:
    with plant.transaction() as session:
        opened = runs.open_run(session, "pump-7", revision=1, kind="run-up", direction=1, time_first=START - SECOND).id
    assert "is open" in api("POST", f"/runs/{opened}/identifications", 409, json={})["detail"]
    api("POST", "/runs/99/identifications", 404, json={})
    (run,) = [one for one in api("GET", "/machines/pump-7/runs") if one["state"] == "closed"]
    path = f"/runs/{run['id']}/identifications"
    api("POST", path, 404, json={"slow_roll": 7})
    for wrong in ({"slow_roll": "all"}, {"slow_roll": 0}, {"starts": 0}, {"seed": -1}, {"speed": 1}):
        api("POST", path, 422, json=wrong)


def test_the_same_is_not_asked_twice_while_it_waits(api: Api, plant: Database) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    first = api("POST", path, 202, json={})
    assert (first["scope"], first["state"], first["runs"]) == ("run", "queued", [run["id"]])
    assert first["options"] == {"slow_roll_version": None}
    assert api("POST", path, 202, json={"slow_roll": "none", "starts": 10})["id"] == first["id"]
    assert api("POST", path, 202, json={"seed": 4})["id"] != first["id"]
    with plant.transaction() as session:
        jobs.finish(jobs.get(session, first["id"]), state=jobs.DONE)
    again = api("POST", path, 202, json={})
    assert again["id"] != first["id"]
    assert again["scope"] == "run"


def test_options_other_than_the_usual_make_a_variant(api: Api) -> None:
    api("POST", PUMP, 201, json=given())
    (run,) = api("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    scopes = [api("POST", path, 202, json=body)["scope"] for body in ({}, {"slow_roll": 1}, {"seed": 3})]
    assert scopes == ["run", "variant", "variant"]
    api("PUT", f"{PUMP}/in-force", json={"version": 1})
    scopes = [api("POST", path, 202, json={"slow_roll": one})["scope"] for one in ("in_force", 1, "none")]
    assert scopes == ["run", "run", "variant"]


def test_the_newest_runs_are_identified_again_when_a_version_is_put_in_force(api: Api) -> None:
    api("POST", PUMP, 201, json=given())
    api("PUT", f"{PUMP}/in-force", json={"version": 1, "identify_again": 10})
    newest = api("GET", "/machines/pump-7/jobs")[0]
    assert (newest["scope"], newest["options"]) == ("run", {"slow_roll_version": 1})


def test_of_what_people_ask_for_so_many_may_wait_and_the_rest_is_told_when_to_come_back(plant: Database, api: Api) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    for quota, words in ((JobQuota(2, 9), "2 identifications that you asked for wait"), (JobQuota(9, 2), "machine 'pump-7'")):
        asking = Api(plant, job_quota=quota)
        first = [asking("POST", path, 202, json={"seed": seed})["id"] for seed in (1, 2)]
        refused = asking.ask("POST", f"{PREFIX}{path}", json={"seed": 3})
        assert words in problem(refused, 429)["detail"]
        assert int(refused.headers["retry-after"]) > 0
        assert asking("POST", path, 202, json={"seed": 2})["id"] == first[1]  # it waits already
        with plant.transaction() as session:
            for row in jobs.take(session, 9):
                jobs.finish(row, state=jobs.DONE)
        asking("POST", path, 202, json={"seed": 3})
        with plant.transaction() as session:
            for row in jobs.take(session, 9):
                assert row.asked_by == "open"
                jobs.finish(row, state=jobs.DONE)


def test_nothing_is_put_in_force_where_its_identifications_may_not_wait(plant: Database, api: Api) -> None:
    api("POST", PUMP, 201, json=given())
    (run,) = api("GET", "/machines/pump-7/runs")
    asking = Api(plant, job_quota=JobQuota(1, 1))
    asking("POST", f"/runs/{run['id']}/identifications", 202, json={"seed": 1})
    again = {"version": 1, "identify_again": 10}
    assert "ask again" in asking("PUT", f"{PUMP}/in-force", 429, json=again)["detail"]
    assert asking("GET", PUMP)["in_force"] is None
    with plant.transaction() as session:
        later = runs.open_run(session, "pump-7", revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(later, samples=samples(40), state=runs.CLOSED, reason="as asked")
    assert "no more than 1 runs" in asking("PUT", f"{PUMP}/in-force", 422, json=again)["detail"]


def test_the_same_is_asked_for_a_hundred_times_in_few_questions_each(plant: Database, api: Api) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    asker, wanted = job_options.Requester("anna"), job_options.Request(seed=4)
    numbers = []
    for _ in range(100):
        with plant.transaction() as session:
            row = job_options.request_identification(session, run["id"], wanted, asker)
            jobs.finish(row, state=jobs.DONE)
            numbers.append((row.options or {}).get("again", 0))
    assert numbers == list(range(100))
    questions: list[str] = []
    event.listen(plant.engine, "before_cursor_execute", lambda *args: questions.append(args[2]))
    with plant.transaction() as session:
        job_options.request_identification(session, run["id"], wanted, asker)
    assert len(questions) < 40


def test_who_sees_one_plant_asks_in_the_same_order_and_quota(plant: Database, api: Api) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    with PlantScope(plant, frozenset({KEY.plant})).transaction() as session:
        asker = job_options.Requester("anna", JobQuota(1, 9))
        assert job_options.request_identification(session, run["id"], job_options.Request(seed=4), asker).plant == KEY.plant
        with pytest.raises(QuotaExceeded):
            job_options.request_identification(session, run["id"], job_options.Request(seed=5), asker)


@pytest.fixture
def train(database: Database) -> tuple[Database, int]:
    """The Chapter 3 train with one run-down whose channels all have a large run-out; the run's number."""
    described = yaml.safe_load((ROOT / "examples" / f"{TRAIN}.yaml").read_text())
    described["noise"] = {"relative": 0.01, "floor": 1e-6}
    machine = parse_machine(described)
    with database.transaction() as session:
        machines.create(session, machine)
        return database, stored_run(session, machine)


def stored_run(session: Any, machine: Machine) -> int:
    rng = np.random.default_rng(1)
    seconds, speed = speed_law(machine, "run-down", duration=300.0, samples=100)
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng) + RUN_OUT
    held = Samples(
        time=(START + seconds * 1e9).astype(np.int64),
        speed=speed,
        direction=np.ones(speed.size, np.int8),
        phasor=phasor,
        status=np.full(phasor.shape, ChannelStatus.GOOD, np.uint8),
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
    )
    row = runs.open_run(session, machine.id, revision=1, kind="run-down", direction=1, time_first=START)
    runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
    return row.id


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


def test_the_newest_accepted_identification_of_a_run_counts(plant: Database) -> None:
    like = ComparisonGroup(revisions=(1,), run_kind="run-down")
    with plant.transaction() as session:
        first = store_identification(session, identification({"coupling.C1.kxx": 1.1}), run_id=1).id
        other = store_identification(session, identification(), run_id=2, measured_at=START + 1).id

        def again(accepted: bool, scope: str = jobs.RUN) -> int:
            job = jobs.enqueue(session, "pump-7", scope=scope, run_ids=[1], options={"again": len(made), "scope": scope})
            assert job is not None
            origin = identifications.Origin("pump-7", 1, job.id, scope, "run-down", [1], START, {"starts": 10}, "0.1.0")
            made.append(identifications.add(session, origin, identification(accepted=accepted)).id)
            return made[-1]

        made: list[int] = []

        def counted() -> tuple[list[int], list[int]]:
            history = trends.histories(session, "pump-7", ["coupling.C1.kxx"], scope=jobs.RUN)["coupling.C1.kxx"]
            accepted = identifications.first_accepted(session, "pump-7", like, limit=10)
            newest = identifications.newest(session, "pump-7", like, limit=10)
            assert [row.id for row in newest] == [row.id for row in reversed(accepted)]
            return history.identification.tolist(), [row.id for row in accepted]

        assert counted() == ([first, other], [first, other])
        again(accepted=False)  # a refused one takes nobody's place
        assert counted() == ([first, other], [first, other])
        again(accepted=True, scope=jobs.VARIANT)
        assert counted() == ([first, other], [first, other])
        second = again(accepted=True)
        assert counted() == ([second, other], [second, other])
        pinned = identifications.accepted_among(session, "pump-7", like, [first])
        assert [row.id for row in pinned] == [second]  # a baseline of named identifications follows
        assert identifications.get(session, first).accepted  # the older ones stay readable
        assert len(identifications.of_machine(session, "pump-7")) == 5


def test_of_a_run_that_was_never_accepted_the_newest_identification_shows(plant: Database) -> None:
    with plant.transaction() as session:
        store_identification(session, identification(accepted=False), run_id=1)
        job = jobs.enqueue(session, "pump-7", scope=jobs.RUN, run_ids=[1], options={"reopened": True})
        assert job is not None
        origin = identifications.Origin("pump-7", 1, job.id, jobs.RUN, "run-down", [1], START, {}, "0.1.0")
        newest = identifications.add(session, origin, identification(accepted=False)).id
        history = trends.histories(session, "pump-7", ["coupling.C1.kxx"], scope=jobs.RUN)["coupling.C1.kxx"]
        assert history.identification.tolist() == [newest]


def test_baselines_hold_identifications_of_one_slow_roll_version(plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(7):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number)
        context = assessment_context.load_context(session, row, baseline_runs=5)
        assert context is not None
        found = compare(context)
        assert found is not None
        assert len(found.after) == 2
        row.slow_roll_version = 1
        session.flush()
        context = assessment_context.load_context(session, row, baseline_runs=5)
        assert context is not None
        assert compare(context) is None


def test_a_job_subtracts_what_was_in_force_when_it_was_taken(api: Api, plant: Database) -> None:
    api("POST", PUMP, 201, json=given())
    api("POST", PUMP, 201, json=given())
    api("PUT", f"{PUMP}/in-force", json={"version": 1})
    with plant.transaction() as session:
        (row,) = jobs.take(session, 1)
        assert row.options is None
        assert job_options.slow_roll_version(session, row) == 1
    api("PUT", f"{PUMP}/in-force", json={"version": 2})
    with plant.transaction() as session:
        assert job_options.slow_roll_version(session, jobs.get(session, row.id)) == 1


# --- orbits ---------------------------------------------------------------------------------------------------------


def test_orbits_of_a_run_without_its_slow_roll(train: tuple[Database, int]) -> None:
    database, run = train
    api = Api(database)
    body = api("GET", f"/runs/{run}/orbits", params={"rpm": 900})
    assert [one["channels"] for one in body["orbits"]] == [[f"B{i}X", f"B{i}Y"] for i in range(1, 5)]
    assert body["findings"] == []  # a run-out does not grow with the speed
    one = body["orbits"][0]
    raw = api("GET", f"/runs/{run}/phasors")
    sample = int(np.argmin(np.abs(np.array(raw["speed_rpm"]) - 900)))
    assert one["speed_rpm"] == pytest.approx(raw["speed_rpm"][sample])
    assert 2 * np.hypot(one["x"]["real_um"], one["x"]["imaginary_um"]) == pytest.approx(raw["amplitude_um_pp"][0][sample])
    assert 0 < one["semi_major_error_um"] < 0.05 * one["semi_major_um"]
    assert one["angles_condition"] == pytest.approx(1.0)
    assert api("GET", f"/runs/{run}/orbits", 422)["errors"][0]["field"] == "query.rpm"
    api("GET", f"/runs/{run}/orbits", 404, params={"rpm": 900, "slow_roll": "1"})


def test_orbits_show_swapped_channels(train: tuple[Database, int]) -> None:
    database, run = train
    api = Api(database)
    with database.transaction() as session:
        held = runs.samples(session, run)
        assert held is not None
        phasor = held.phasor.copy()
        phasor[:, [2, 3]] = phasor[:, [3, 2]]
        swapped = Samples(held.time, held.speed, held.direction, phasor, held.status, held.scatter, held.second)
        runs.close(runs.get(session, run), samples=swapped, state=runs.CLOSED, reason="swapped")
    (finding,) = api("GET", f"/runs/{run}/orbits", params={"rpm": 500})["findings"]
    assert (finding["code"], finding["channels"]) == ("swapped_channels", ["B2X", "B2Y"])


def test_orbits_need_both_axes(api: Api) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    body = api("GET", f"/runs/{run['id']}/orbits", params={"rpm": 1000})
    assert len(body["orbits"]) == 2
    # All channels show the same: a straight line.
    assert {one["sense"] for one in body["orbits"]} == {"undecided"}
    assert {one["code"] for one in body["findings"]} == {"orbit_sense_undetectable"}


def test_the_quality_of_a_run_tells_of_swapped_channels_and_its_fit_is_without_the_slow_roll() -> None:
    described = yaml.safe_load((ROOT / "examples" / f"{TRAIN}.yaml").read_text())
    machine = parse_machine(described)
    rng = np.random.default_rng(1)
    _, speed = speed_law(machine, "run-down", duration=3000.0, samples=80)
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng) + RUN_OUT
    held = Samples(
        time=START + SECOND * np.arange(80, dtype=np.int64) * 40,
        speed=speed,
        direction=np.ones(80, np.int8),
        phasor=phasor[:, [0, 1, 3, 2, 4, 5, 6, 7]],
        status=np.full(phasor.shape, ChannelStatus.GOOD, np.uint8),
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
    )
    vectors = SlowRoll(1, RUN_OUT, np.full(8, 1e-6))
    task = IdentificationTask(described, [encode(held)], Options(starts=1), 60.0, slow_roll=vectors)
    outcome = computation.compute(task)
    assert any("the orbit at B2X and B2Y turns backward" in words for words in outcome.qualities[0].findings)
    assert outcome.identification is not None
    assert "probe.B1X.run_out.real" in outcome.identification.coordinates


def test_other_rules_of_quality_make_a_variant_that_keeps_to_them(api: Api) -> None:
    (run,) = api("GET", "/machines/pump-7/runs")
    path = f"/runs/{run['id']}/identifications"
    asked = api("POST", path, 202, json={"accepted_rpm": [600, 2000], "half_power": True})
    assert asked["scope"] == "variant"
    with api.app.state.database.transaction() as session:
        row = jobs.get(session, asked["id"])
        rules = quality_rules(row, QualityRules(sweep_rate=False))
    assert rules == QualityRules(sweep_rate=False, half_power=True, accepted_rpm=(600.0, 2000.0))
    usual = api("POST", path, 202, json={"half_power": False})
    assert usual["scope"] == "run"
    assert "the lower speed first" in str(api("POST", path, 422, json={"accepted_rpm": [2000, 600]})["errors"])


def test_orbits_name_the_channels_that_they_leave_as_measured(api: Api) -> None:
    api("POST", PUMP, 201, json=given())
    (run,) = api("GET", "/machines/pump-7/runs")
    raw, without = (
        api("GET", f"/runs/{run['id']}/orbits", params={"rpm": 900, "slow_roll": choice}) for choice in ("none", "1")
    )
    assert (raw["slow_roll_version"], raw["slow_roll_left_out"]) == (None, {})
    assert (without["slow_roll_version"], without["slow_roll_left_out"]) == (
        1,
        dict.fromkeys(CHANNELS[1:], "it has no vector"),
    )
