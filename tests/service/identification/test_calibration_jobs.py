"""Calibrations asked for over the API: computed in a real worker process, kept, put in force, and held to by later fits."""

from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from sqlalchemy import update
from sqlalchemy.pool import QueuePool

from estimator.arrays import Complexes
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.slow_roll import SlowRoll
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors
from estimator.units import rpm_to_rad_per_s
from service.identification import calibration_jobs
from service.identification.job_quota import JobQuota
from service.workers.executors import LocalExecutor
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import machines, model_calibrations, slow_roll, timeline
from storage.machines.slow_roll import GIVEN, Provenance
from storage.measurements import runs
from storage.tables.findings import JobRow
from storage.tables.measurements import RunRow
from tests.api_in_process import Api
from tests.identification import counts, forward_samples, identifying
from tests.plant import SECOND, START, document, wait_until

GAIN, RUN_OUT = 1.3 * np.exp(0.4j), 2e-6 - 1e-6j
WEIGHT = 1e-3
"""Trial weight [kg m]."""
POINTS = 60


class MiscalibratedPump:
    """A pump whose probes read too much and see a run-out, of which the store holds runs."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.machine: Machine = parse_machine(document(operation={}))
        self.rng = np.random.default_rng(3)
        self.truth: Truth = draw_truth(self.machine, self.rng)
        self.count = 0
        with database.transaction() as session:
            machines.create(session, self.machine)

    def run(self, added: Complexes, *, revision: int = 1) -> int:
        """Store a closed run with a known unbalance (P,) [kg m]; its id."""
        self.count += 1
        speed = np.linspace(rpm_to_rad_per_s(2900.0), rpm_to_rad_per_s(400.0), POINTS)
        loaded = replace(self.truth, unbalances=self.truth.unbalances + added)
        phasor = GAIN * measured_phasors(self.machine, loaded, speed, self.rng) + RUN_OUT
        begin = START + self.count * 3600 * SECOND
        held = forward_samples(np.linspace(begin, begin + (POINTS - 1) * SECOND, POINTS), speed, phasor)
        with self.database.transaction() as session:
            row = runs.open_run(
                session, self.machine.id, revision=revision, kind="run-down", direction=1, time_first=int(held.time[0])
            )
            runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
            return row.id

    def added(self, disc: int, angle_deg: float) -> Complexes:
        found = np.zeros(len(self.machine.discs), dtype=complex)
        found[disc] = WEIGHT * np.exp(1j * np.radians(angle_deg))
        return found


def asked(rig: MiscalibratedPump) -> list[dict[str, object]]:
    """The machine as it is, and a run with a weight on each disc."""
    found: list[dict[str, object]] = [{"run": rig.run(0.0 * rig.added(0, 0.0)), "weights": []}]
    for place, disc in enumerate(rig.machine.discs):
        weight = {"disc": disc.id, "amount": WEIGHT, "unit": "kg m", "angle_deg": 90.0 * place}
        found.append({"run": rig.run(rig.added(place, 90.0 * place)), "weights": [weight]})
    return found


@pytest.mark.parametrize("with_slow_roll", [pytest.param(False, marks=pytest.mark.long), True])
def test_a_calibration_is_computed_kept_and_put_in_force(
    database: Database, api: Api, executor: LocalExecutor, *, with_slow_roll: bool
) -> None:
    rig = MiscalibratedPump(database)
    path = f"/machines/{rig.machine.id}/model-calibrations"
    told = api("POST", path, 202, json={"runs": asked(rig), "by": "Ada", "comment": "after the overhaul"})
    assert (told["state"], told["accepted"], told["in_force"]) == ("queued", None, False)
    assert "not computed yet" in api("POST", f"{path}/{told['id']}/in-force", 409, json={"by": "Ada"})["detail"]
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1}, seconds=300.0)
        found = api("GET", f"{path}/{told['id']}")
        assert (found["state"], found["accepted"], found["by"]) == ("done", True, "Ada"), found
        assert found["code_version"]
        calibration = found["document"]["calibration"]
        assert [len(one["sha256"]) for one in calibration["runs"]] == [64] * 3
        place = calibration["parameters"].index("probe.B3X.run_out.real")
        error = calibration["covariance"][place][place] ** 0.5
        assert calibration["values"][place] == pytest.approx(RUN_OUT.real, abs=4.0 * error)
        assert api("GET", f"/machines/{rig.machine.id}")["revision"] == 1, "nothing is in force by itself"
        assert api("POST", f"{path}/{told['id']}/in-force", json={"by": "Ben"})["revision_in_force"] == 2
        assert [one["in_force"] for one in api("GET", path)] == [True]
        assert api("GET", f"/machines/{rig.machine.id}")["document"]["calibration"]["gain_drift"] == 0.0
        if with_slow_roll:
            _subtract_run_outs(rig)
        added = rig.added(0, 30.0)
        later = rig.run(added, revision=2)
        with database.transaction() as session:
            jobs.enqueue(session, rig.machine.id, scope=jobs.RUN, run_ids=[later])
        wait_until(lambda: counts(database) == {"done": 2}, seconds=300.0)
    with database.reading() as session:
        (row,) = identifications.of_machine(session, rig.machine.id, limit=10)
        assert row.accepted, row.verdict
        (one,) = [one for one in identifications.estimates(session, row.id) if one.parameter == "disc.D1.unbalance"]
        assert one.value is not None
        assert one.imaginary is not None
        true = rig.truth.unbalances[0] + added[0]
        assert abs(complex(one.value, one.imaginary) - true) < 0.03 * abs(true), "without calibration the gain is in it"
        number = row.id
        notes = [one.text for one in timeline.of_machine(session, rig.machine.id, limit=10)]
        assert any("calibration 1 of the model is in force, as revision 2" in text for text in notes)
    gained = api("GET", f"/identifications/{number}/model/unbalance-gained")
    assert (gained["accepted"], len(gained["calibration_runs"])) == (True, 3)
    first, second = gained["discs"]
    assert (first["disc"], first["clear"], second["clear"]) == ("D1", True, False)
    assert abs(first["g_mm"] - 1e6 * WEIGHT) < 2.0 * first["half_width_g_mm"], (
        "the weight put on since, not the whole unbalance"
    )
    assert first["half_width_g_mm"] < 0.2e6 * WEIGHT
    assert abs(first["angle_deg"] - 30.0) < 2.0 * first["half_width_deg"] < 25.0
    assert second["g_mm"] < 2.0 * second["half_width_g_mm"]
    drifting = api("POST", f"{path}/{told['id']}/in-force", json={"by": "Ben", "gain_drift": 0.02})
    assert (drifting["revision_in_force"], drifting["in_force"]) == (3, True)
    assert api("GET", f"/machines/{rig.machine.id}")["document"]["calibration"]["gain_drift"] == 0.02
    api("POST", f"{path}/{told['id']}/in-force", 422, json={"by": "Ben", "gain_drift": 0.7})


def _subtract_run_outs(rig: MiscalibratedPump) -> None:
    """Put slow-roll vectors in force that are the run-outs themselves, and a little more."""
    count = len(rig.machine.channels)
    vectors = SlowRoll(1, np.full(count, RUN_OUT + 1e-6), np.zeros(count))
    with rig.database.transaction() as session:
        row = slow_roll.add(session, machines.document(session, rig.machine.id), vectors, Provenance(GIVEN))
        machines.get(session, rig.machine.id).slow_roll_version = row.version


def test_a_calibration_that_was_not_accepted_or_is_of_another_train_is_not_put_in_force(database: Database, api: Api) -> None:
    rig = MiscalibratedPump(database)
    path = f"/machines/{rig.machine.id}/model-calibrations"
    told = api("POST", path, 202, json={"runs": asked(rig), "by": "Ada"})
    computed: dict[str, Any] = {
        "verdict": "the model does not fit",
        "result": {},
        "document": rig.machine.model_dump(mode="json"),
    }
    with database.transaction() as session:
        row = model_calibrations.get(session, rig.machine.id, told["id"])
        model_calibrations.record(row, accepted=False, code_version="1", **computed)
    detail = api("POST", f"{path}/{told['id']}/in-force", 409, json={"by": "Ada"})["detail"]
    assert detail == "calibration 1 cannot be put in force: it was not accepted: the model does not fit"
    with database.transaction() as session:
        row = model_calibrations.get(session, rig.machine.id, told["id"])
        model_calibrations.record(row, accepted=True, code_version="1", **computed)
    other = document(operation={})
    other["discs"][0]["mass"] *= 1.5
    api("PUT", f"/machines/{rig.machine.id}", json=other)
    detail = api("POST", f"{path}/{told['id']}/in-force", 409, json={"by": "Ada"})["detail"]
    assert "describes another train: calibrate that one" in detail
    asked_again = [{"run": one["run"], "weights": one["weights"]} for one in told["runs"]]
    detail = api("POST", path, 422, json={"runs": [one | {"weights": []} for one in asked_again], "by": "Ada"})["detail"]
    assert "which describes another train than the one in force" in detail


def test_what_is_asked_for_wrongly_is_said_before_it_costs_a_fit(database: Database, api: Api) -> None:
    rig = MiscalibratedPump(database)
    path = f"/machines/{rig.machine.id}/model-calibrations"
    right = asked(rig)
    first, second = right[0], right[1]

    def told(*listed: object) -> str:
        return str(api("POST", path, 422, json={"runs": listed, "by": "Ada"})["detail"])

    weight = {"disc": "D1", "amount": 48.0, "unit": "kg m", "angle_deg": 0.0}
    assert "48 g mm is likely, so `unit: g mm`" in told(first, second | {"weights": [weight]})
    assert "no run has a trial weight" in told(first, second | {"weights": []})
    assert "all runs have the same trial weights" in told(first | {"weights": second["weights"]}, second)
    assert "run 1 stands twice" in told(first, first)
    assert "there is no disc D7; the discs are D1, D2" in told(first, second | {"weights": [weight | {"disc": "D7"}]})
    assert "a calibration needs runs" in str(api("POST", path, 422, json={"by": "Ada"}))
    assert "runs[1].weights" in str(api("POST", path, 422, json={"runs": [first, {"run": 2}], "by": "Ada"})["errors"])
    for said in ("none", weight):
        answer = api("POST", path, 422, json={"runs": [first, second | {"weights": said}], "by": "Ada"})
        assert "weights are a list such as" in answer["errors"][0]["message"]
    [fault] = api("POST", path, 422, json={"runs": [first, second | {"weights": [weight | {"unit": "gmm"}]}], "by": "Ada"})[
        "errors"
    ]
    assert fault["field"] == "runs[1].weights[0].unit"
    assert "'g mm'" in fault["message"]
    assert "no run 99" in api("POST", path, 404, json={"runs": [{"run": 99, "weights": []}], "by": "Ada"})["detail"]
    with database.transaction() as session:
        open_run = runs.open_run(
            session, rig.machine.id, revision=1, kind="run-up", direction=1, time_first=START + 10**6 * SECOND
        ).id
    assert "only closed runs calibrate" in told(first, {"run": open_run, "weights": []})
    assert counts(database) == {}
    assert api("GET", path) == []


def test_runs_and_weights_of_a_balancing_calibrate(database: Database, api: Api) -> None:
    rig = MiscalibratedPump(database)
    said = asked(rig)
    begun = api("POST", f"/machines/{rig.machine.id}/balancings", 201, json={"runs": [said[0]["run"]], "by": "Ada"})
    path = f"/machines/{rig.machine.id}/model-calibrations"
    body = {"balancing": begun["id"], "by": "Ada"}
    assert "has no trial run yet" in api("POST", path, 422, json=body)["detail"]
    for one in said[1:]:
        trial = {**one, "by": "Ada"}
        api("POST", f"/machines/{rig.machine.id}/balancings/{begun['id']}/trials", json=trial)
    told = api("POST", path, 202, json=body)
    assert [one["run"] for one in told["runs"]] == [one["run"] for one in said]
    assert [len(one["weights"]) for one in told["runs"]] == [0, 1, 1]


def test_runs_are_checked_in_another_process_and_in_no_transaction_and_not_at_all_beyond_the_quota(
    database: Database, api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = MiscalibratedPump(database)
    path, said = f"/machines/{rig.machine.id}/model-calibrations", {"runs": asked(rig), "by": "Ada"}
    process, seen = api.app.state.model_process, []
    compute = process.compute

    def noting(work: Any, *given: Any) -> Any:
        seen.append((work.__name__, database._turn._lock.locked(), cast(QueuePool, database.engine.pool).checkedout()))
        return compute(work, *given)

    monkeypatch.setattr(process, "compute", noting)
    monkeypatch.setattr(api.app.state, "job_quota", JobQuota(per_principal=2, per_machine=2))
    for seed in range(2):  # of the same runs they are checked once
        api("POST", path, 202, json=said | {"seed": seed})
    assert seen == [("check_runs", False, 0)]
    monkeypatch.setattr(calibration_jobs, "read_runs", None)
    assert "ask again when some are done" in api("POST", path, 429, json=said | {"runs": said["runs"][:2]})["detail"]


def test_one_asked_for_again_when_samples_are_gone_is_refused_with_the_reason(database: Database, api: Api) -> None:
    """The check of its runs is known by then."""
    rig = MiscalibratedPump(database)
    path, calibrating = f"/machines/{rig.machine.id}/model-calibrations", asked(rig)
    said = {"runs": calibrating, "by": "Ada"}
    first = api("POST", path, 202, json=said)
    with database.transaction() as session:
        session.execute(update(JobRow).values(state=jobs.DONE))
        session.execute(update(RunRow).values(data=None, released_at=START))
    again = api("POST", path, 410, json=said)
    assert f"the samples of run {calibrating[0]['run']} were deleted" in again["detail"]
    assert [one["id"] for one in api("GET", path)] == [first["id"]]


def test_a_document_that_changes_while_runs_are_checked_is_reported(
    database: Database, api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = MiscalibratedPump(database)
    process = api.app.state.model_process
    compute = process.compute

    def meanwhile(work: Any, *given: Any) -> Any:
        with database.transaction() as session:
            machines.revise(session, parse_machine(document(name="Another name", operation={})))
        return compute(work, *given)

    monkeypatch.setattr(process, "compute", meanwhile)
    path = f"/machines/{rig.machine.id}/model-calibrations"
    assert "was changed meanwhile" in api("POST", path, 409, json={"runs": asked(rig), "by": "Ada"})["detail"]
    assert api("GET", path) == []
