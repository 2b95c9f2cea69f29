"""Field balancing over the API, on stored runs of the dense model: begun, tried, proposed, checked; what it refuses."""

from typing import Any, cast

import numpy as np
import pytest
from msgspec.structs import replace
from sqlalchemy.pool import QueuePool

from estimator.calibration.calibrated_document import calibrated_document
from estimator.machine.calibration import Calibration
from estimator.machine.document import parse_machine
from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from service.api.cache.model_process import ModelProcess
from service.api.machines import balancings
from service.balancing.stored_runs import balancing_run
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import machines, timeline
from storage.measurements import runs
from storage.operation import audit
from tests.api_in_process import Api
from tests.estimator.trains import dense_response, noisy
from tests.plant import KEY, SECOND, START, document, identification, samples, store_identification
from tests.service.api.findings.modelled import outcome

PATH = f"/machines/{KEY.machine}/balancings"
POINTS = 40
RPM = np.linspace(1400.0, 900.0, POINTS)
SPEED = RPM * np.pi / 30.0
TRIALS = {"D1": (800.0, 0.0), "D2": (800.0, 90.0)}
"""Trial weights [g mm, °]; pump-7 has the unbalances of its document, 1000 and 2000 g mm."""
WEIGHTS = {
    disc: [{"disc": disc, "amount": size, "unit": "g mm", "angle_deg": angle}] for disc, (size, angle) in TRIALS.items()
}


def phasors(weights: dict[str, tuple[float, float]], seed: int) -> Any:
    said = document()
    for disc in said["discs"]:
        size, angle = weights.get(disc["id"], (0.0, 0.0))
        own = disc["unbalance"]
        total = own["magnitude"] * np.exp(1j * np.radians(own["angle_deg"])) + 1e-6 * size * np.exp(1j * np.radians(angle))
        disc["unbalance"] = {"magnitude": float(abs(total)), "angle_deg": float(np.degrees(np.angle(total)))}
    return noisy(dense_response(parse_machine(said), SPEED, direction=1), seed=seed, relative=0.003)


def add_run(database: Database, weights: dict[str, tuple[float, float]], *, number: int, revision: int = 1) -> int:
    """A closed run with weights on [g mm, °]; its id."""
    begin = START + number * 3600 * SECOND
    held = replace(samples(POINTS, start=begin, rpm=RPM.tolist()), phasor=phasors(weights, number))
    with database.transaction() as session:
        row = runs.open_run(session, KEY.machine, revision=revision, kind="run-down", direction=1, time_first=begin)
        runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
        return row.id


@pytest.fixture
def store(database: Database) -> Database:
    with database.transaction() as session:
        machines.create(session, parse_machine(document(operation={"vibration_limit": 1e-4})))
    return database


@pytest.fixture
def api(store: Database, process: ModelProcess) -> Api:
    found = Api(store)
    found.app.state.model_process = process
    return found


@pytest.fixture
def begun(store: Database, api: Api) -> int:
    """A balancing with its trial runs; its id."""
    first = add_run(store, {}, number=1)
    found = api("POST", PATH, 201, json={"runs": [first], "by": "Ada", "comment": "after the overhaul"})
    for number, disc in enumerate(TRIALS, 2):
        run = add_run(store, {disc: TRIALS[disc]}, number=number)
        found = api("POST", f"{PATH}/{found['id']}/trials", json={"run": run, "weights": WEIGHTS[disc], "by": "Ada"})
    return int(found["id"])


def test_the_steps_of_a_balancing(store: Database, api: Api, begun: int) -> None:
    tried = api("GET", f"{PATH}/{begun}")
    assert (tried["state"], tried["by"], tried["comment"], len(tried["trials"])) == ("tried", "Ada", "after the overhaul", 2)
    found = api("POST", f"{PATH}/{begun}/correction", json={"grade": 6.3, "by": "Ada"})
    assert found["state"] == "proposed"
    correction = found["correction"]
    assert correction["planes"][0]["g_mm"] == pytest.approx(1000.0, rel=0.05)
    assert correction["planes"][0]["angle_deg"] == pytest.approx(210.0, abs=3.0)
    assert correction["planes"][1]["angle_deg"] == pytest.approx(20.0, abs=3.0)
    # B2X gives no phasors, and B2Y shows less than the noise's floor.
    assert [one["channel"] for one in correction["channels"]] == ["B2Y", "B3X", "B3Y"]
    assert all(one["upper_um_pp"] < 0.25 * one["before_um_pp"] for one in correction["channels"][1:])
    assert (correction["limit_um_pp"], correction["limit_verdict"]) == (pytest.approx(200.0), "met")
    assert {one["bearing"] for one in correction["residual"]} == {"B1", "B2", "B3", "B4"}
    assert all(one["before"]["verdict"] == "not met" for one in correction["residual"])
    assert len(correction["vectors"][0]["runs"]) == 3
    put_on = {one["disc"]: (one["g_mm"], one["angle_deg"]) for one in correction["planes"]}
    run = add_run(store, put_on, number=9)
    checked = api("POST", f"{PATH}/{begun}/check", json={"run": run, "by": "Ben"})
    assert checked["state"] == "checked"
    assert all(one["kept"] for one in checked["check"]["channels"])
    assert checked["check"]["limit_met"] is True
    assert checked["check"]["trim_is_noise"] is True
    assert checked["check"]["trim"] == [], "the run is as promised: what is left is noise"
    assert api("GET", f"{PATH}/{begun}") == checked, "it is stored"
    assert [one["id"] for one in api("GET", PATH)] == [begun]


def test_a_check_run_without_the_weights_shows_more_than_was_promised(store: Database, api: Api, begun: int) -> None:
    api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})
    run = add_run(store, {}, number=9)
    checked = api("POST", f"{PATH}/{begun}/check", json={"run": run, "by": "Ada"})
    assert [one["kept"] for one in checked["check"]["channels"]][1:] == [False, False]
    assert checked["check"]["other_weights"] is False
    promised = {one["channel"]: one["upper_um_pp"] for one in checked["correction"]["channels"]}
    assert {one["channel"]: one["upper_um_pp"] for one in checked["check"]["channels"]} == pytest.approx(promised)
    again = api("POST", f"{PATH}/{begun}/check", json={"run": run, "weights": [], "by": "Ada"})["check"]
    assert all(one["kept"] for one in again["channels"]), "said rightly, it is as predicted"
    assert again["other_weights"] is True
    assert all(one["upper_um_pp"] > one["check_um_pp"] for one in again["channels"])


def test_no_masses_are_proposed_while_an_alert_says_that_something_else_is_wrong(
    store: Database, api: Api, begun: int
) -> None:
    with store.transaction() as session:
        row = store_identification(session, identification({"coupling.C1.kxx": 1.0}), run_id=1)
        finding = AlertFinding({"sigma": 6.1}, row.id, START, latching=False)
        unbalanced = AlertFinding({"sigma": 6.1}, row.id, START, latching=False)
        drifting = AlertFinding({"rate_per_cent_per_week": 3.0}, row.id, START, latching=False)
        transitions.raise_alert(session, KEY.machine, rule="unbalance", element="disc.D1", finding=unbalanced)
        transitions.raise_alert(session, KEY.machine, rule="rate_of_change", element="disc.D1", finding=drifting)
    assert api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})["state"] == "proposed"
    with store.transaction() as session:
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
    told = api("POST", f"{PATH}/{begun}/correction", 409, json={"by": "Ada"})["detail"]
    assert told.startswith("mend C1 first, no masses are proposed while something else is wrong: alert ")
    assert told.endswith("alert 3: misalignment of coupling C1")


@pytest.mark.parametrize("latching", [False, True])
def test_an_alert_whose_cause_is_gone_holds_no_masses_back(store: Database, api: Api, begun: int, latching: bool) -> None:
    with store.transaction() as session:
        row = store_identification(session, identification({"coupling.C1.kxx": 1.0}), run_id=1)
        finding = AlertFinding({"sigma": 6.1}, row.id, START, latching=latching)
        alert = transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        transitions.acknowledge(session, alert, Person("Ben"))
    assert "mend C1 first" in api("POST", f"{PATH}/{begun}/correction", 409, json={"by": "Ada"})["detail"]
    with store.transaction() as session:
        (alert,) = alerts.open_alerts(session, KEY.machine)
        transitions.clear_alert(session, alert)
        assert alert.condition == ("latched_acknowledged" if latching else "normal")
    assert api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})["state"] == "proposed"


def test_the_model_of_an_identification_is_used_where_it_predicts_better(store: Database, api: Api, begun: int) -> None:
    asked = {"identification": 1, "by": "Ada"}
    assert "no identification 1" in api("POST", f"{PATH}/{begun}/correction", 404, json=asked)["detail"]
    with store.transaction() as session:
        store_identification(session, outcome(), run_id=1)
    for number, disc in enumerate(TRIALS, 20):
        again = (TRIALS[disc][0], TRIALS[disc][1] + 120.0)
        weights = [WEIGHTS[disc][0] | {"angle_deg": again[1]}]
        body = {"run": add_run(store, {disc: again}, number=number), "weights": weights, "by": "Ada"}
        api("POST", f"{PATH}/{begun}/trials", json=body)
    correction = api("POST", f"{PATH}/{begun}/correction", json=asked)["correction"]
    assert "scaled model" in correction["influence"]
    assert correction["planes"][1]["angle_deg"] == pytest.approx(20.0, abs=3.0)


def test_steps_in_a_wrong_order_and_runs_that_do_not_belong_are_refused(store: Database, api: Api) -> None:
    run = add_run(store, {}, number=1)
    assert "no run 77" in api("POST", PATH, 404, json={"runs": [77], "by": "Ada"})["detail"]
    found = api("POST", PATH, 201, json={"runs": [run], "by": "Ada"})
    here = f"{PATH}/{found['id']}"
    assert "has no trial run yet" in api("POST", f"{here}/correction", 409, json={"by": "Ada"})["detail"]
    assert "has no correction yet" in api("POST", f"{here}/check", 409, json={"run": run, "by": "Ada"})["detail"]
    again = {"run": run, "weights": WEIGHTS["D1"], "by": "Ada"}
    assert "part of this balancing already" in api("POST", f"{here}/trials", 422, json=again)["detail"]
    other = add_run(store, {"D1": TRIALS["D1"]}, number=2)
    unknown = {"run": other, "weights": [WEIGHTS["D1"][0] | {"disc": "D9"}], "by": "Ada"}
    assert "there is no disc D9; the discs are D1, D2" in api("POST", f"{here}/trials", 422, json=unknown)["detail"]
    api("GET", f"{PATH}/77", 404)


@pytest.mark.parametrize(
    ("weight", "words"),
    [
        ({"amount": 0}, "a weight of zero is none: leave it out"),
        ({"amount": -5}, "a weight is above zero; on the opposite side its angle differs by 180°"),
        ({"unit": "g"}, "a mass (kg, g, oz) needs its radius_mm"),
        ({"radius_mm": 30}, "an unbalance (g mm, kg mm, g in, oz in, kg m) has none"),
        ({"unit": "lb"}, "Input should be"),
    ],
)
def test_a_trial_weight_that_is_none_is_refused(api: Api, weight: dict[str, Any], words: str, begun: int) -> None:
    body = {"run": 1, "weights": [WEIGHTS["D1"][0] | weight], "by": "Ada"}
    answer = api("POST", f"{PATH}/{begun}/trials", 422, json=body)
    assert any(words in one["message"] for one in answer["errors"])


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ([], "a balancing begins with a run of the machine as it is, before any trial weight, such as [41]"),
        ([3, 1, 3], "run 3 stands twice among the initial runs: each counts once"),
    ],
)
def test_initial_runs_that_are_none_or_stand_twice_are_refused(api: Api, runs: list[int], words: str) -> None:
    ((where, told),) = [
        (one["field"], one["message"]) for one in api("POST", PATH, 422, json={"runs": runs, "by": "Ada"})["errors"]
    ]
    assert (where, told) == ("runs", words)


def test_a_correction_in_no_disc_is_told_what_it_takes(api: Api, begun: int) -> None:
    (told,) = api("POST", f"{PATH}/{begun}/correction", 422, json={"discs": [], "by": "Ada"})["errors"]
    assert told["message"] == "a correction needs a disc; without `discs` it takes all that had a trial weight"


def test_a_weight_in_a_wrong_unit_is_named_before_the_next_run_is_made(store: Database, api: Api) -> None:
    first, second = add_run(store, {}, number=1), add_run(store, {"D1": TRIALS["D1"]}, number=2)
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [first], 'by': 'Ada'})['id']}"
    heavy = [WEIGHTS["D1"][0] | {"unit": "kg m"}]
    told = api("POST", f"{here}/trials", 422, json={"run": second, "weights": heavy, "by": "Ada"})["detail"]
    assert "would move the centre of mass" in told
    assert "is it in another unit? 800 g mm are 0.0008 kg m" in told
    assert api("GET", here)["trials"] == []


@pytest.mark.parametrize("said", [{}, {"weights": None}, {"weights": []}, {"weights": "none"}])
def test_a_trial_without_its_weight_is_told_what_to_state(api: Api, begun: int, said: dict[str, Any]) -> None:
    answer = api("POST", f"{PATH}/{begun}/trials", 422, json={"run": 1, "by": "Ada"} | said)
    ((where, told),) = [(one["field"], one["message"]) for one in answer["errors"]]
    assert where == "weights"
    assert "a trial run needs the weights that were on, a list such as [{" in told
    misspelt = api("POST", f"{PATH}/{begun}/trials", 422, json={"run": 1, "by": "Ada", "weight": WEIGHTS["D1"]})
    assert any("weights" in one["message"] and one["field"] == "weight" for one in misspelt["errors"])


def test_a_trial_that_can_tell_nothing_is_refused_before_the_next_run_is_made(store: Database, api: Api, begun: int) -> None:
    """Otherwise the balancing could not go on before the trial is taken back."""
    opposite = [WEIGHTS["D1"][0], WEIGHTS["D1"][0] | {"angle_deg": 180.0}]
    body = {"run": add_run(store, {}, number=8), "weights": opposite, "by": "Ada"}
    assert "its weights cancel each other" in api("POST", f"{PATH}/{begun}/trials", 422, json=body)["detail"]
    copy = {"run": add_run(store, {"D1": TRIALS["D1"]}, number=2), "weights": WEIGHTS["D1"], "by": "Ada"}
    told = api("POST", f"{PATH}/{begun}/trials", 422, json=copy)["detail"]
    assert "hold the same vectors: one is a copy of the other" in told
    assert len(api("GET", f"{PATH}/{begun}")["trials"]) == 2


def test_a_check_with_the_weights_of_another_unit_or_with_a_run_that_came_before_is_refused(
    store: Database, api: Api, begun: int
) -> None:
    proposed = api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})
    heavy = [WEIGHTS["D1"][0] | {"unit": "kg m"}]
    body = {"run": add_run(store, {}, number=9), "weights": heavy, "by": "Ada"}
    assert "is it in another unit?" in api("POST", f"{PATH}/{begun}/check", 422, json=body)["detail"]
    body = {"run": proposed["initial"][0], "by": "Ada"}
    assert "is part of this balancing already" in api("POST", f"{PATH}/{begun}/check", 422, json=body)["detail"]
    assert api("GET", f"{PATH}/{begun}") == proposed


def test_a_trial_with_a_wrong_weight_is_taken_back_and_added_again(store: Database, api: Api, begun: int) -> None:
    run = add_run(store, {"D1": (500.0, 90.0)}, number=8)
    wrong = [WEIGHTS["D1"][0] | {"amount": 500.0, "angle_deg": 70.0}]  # it was at 90°
    trial = {"run": run, "weights": wrong, "by": "Ada"}
    api("POST", f"{PATH}/{begun}/trials", json=trial)
    wrong_way = api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})["correction"]["planes"]
    asked = {"run": run, "comment": "the weight was at 90°", "by": "Ben"}
    told = api("POST", f"{PATH}/{begun}/withdrawals", 409, json=asked)["detail"]
    assert f"masses were proposed by Ada from the trials with run {run}: withdraw it with `with_correction: true`" in told
    assert api("GET", f"{PATH}/{begun}")["state"] == "proposed"
    left = api("POST", f"{PATH}/{begun}/withdrawals", json=asked | {"with_correction": True})
    assert (left["state"], left["correction"], len(left["trials"])) == ("tried", None, 2)
    [gone] = left["withdrawn"]
    assert (gone["run"], gone["by"], gone["withdrawn_by"], gone["comment"]) == (run, "Ada", "Ben", "the weight was at 90°")
    assert gone["weights"][0]["scale_deg"] == pytest.approx(70.0)
    assert [one["g_mm"] for one in gone["given_up"]] == [one["g_mm"] for one in wrong_way]
    again = api("POST", f"{PATH}/{begun}/trials", json=trial | {"weights": [wrong[0] | {"angle_deg": 90.0}]})
    assert [one["run"] for one in again["trials"]][2:] == [run]
    plane = api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})["correction"]["planes"][0]
    assert plane["g_mm"] == pytest.approx(1000.0, rel=0.05)
    assert abs(wrong_way[0]["g_mm"] - 1000.0) > 60.0
    assert api("GET", f"{PATH}/{begun}")["withdrawn"] == left["withdrawn"], "it stays on record"
    with store.reading() as session:
        assert "withdraw_balancing_trial" in [one.operation for one in audit.newest(session, limit=5)]


def test_a_trial_whose_masses_were_checked_is_taken_back_only_with_them(store: Database, api: Api, begun: int) -> None:
    api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})
    check = add_run(store, {}, number=9)
    checked = api("POST", f"{PATH}/{begun}/check", json={"run": check, "weights": [], "by": "Ada"})
    first, second = (one["run"] for one in checked["trials"])
    asked = {"run": first, "comment": "it fell off", "by": "Ben"}
    assert f"run {check} has checked it" in api("POST", f"{PATH}/{begun}/withdrawals", 409, json=asked)["detail"]
    left = api("POST", f"{PATH}/{begun}/withdrawals", json=asked | {"with_correction": True})
    assert (left["state"], left["check"], [one["run"] for one in left["trials"]]) == ("tried", None, [second])
    told = api("POST", f"{PATH}/{begun}/withdrawals", 422, json=asked)["detail"]
    assert told == f"run {first} is no trial run of balancing {begun}; its trial runs are: {second}"
    last = api("POST", f"{PATH}/{begun}/withdrawals", json=asked | {"run": second})
    assert (last["state"], last["trials"], len(last["withdrawn"])) == ("begun", [], 2)
    assert "has no trial run yet" in api("POST", f"{PATH}/{begun}/correction", 409, json={"by": "Ada"})["detail"]
    why = api("POST", f"{PATH}/{begun}/withdrawals", 422, json={"run": second, "comment": " ", "by": "Ben"})["errors"]
    assert [one["field"] for one in why] == ["comment"]


def test_a_service_speed_outside_of_the_documents_range_is_named(api: Api, begun: int) -> None:
    asked = {"service_rpm": 30000.0, "by": "Ada"}
    told = api("POST", f"{PATH}/{begun}/correction", 422, json=asked)["detail"]
    limits = document()["speed_range"]
    assert told == (
        f"the service speed 30000 r/min lies outside the document's range, {limits['minimum_rpm']:g} to "
        f"{limits['maximum_rpm']:g} r/min"
    )
    proposed = api("POST", f"{PATH}/{begun}/correction", json=asked | {"service_rpm": limits["maximum_rpm"]})
    assert proposed["correction"]["service_rpm"] == pytest.approx(limits["maximum_rpm"])


def test_planes_that_cannot_be_told_apart_are_named_and_one_of_them_is_left_out(store: Database, api: Api) -> None:
    """Darlow's second case: what a weight on one plane does is what another one on the other plane does."""
    alike = np.exp(0.2j) * 0.9
    unbalances = {"initial": 0.0, "D1": TRIALS["D1"][0], "D2": TRIALS["D2"][0] * alike}
    made = {}
    for number, (name, size) in enumerate(unbalances.items(), 1):
        on_one = {"D1": (abs(size), float(np.degrees(np.angle(size))))}
        made[name] = add_run(store, on_one, number=number)
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [made['initial']], 'by': 'Ada'})['id']}"
    for disc in TRIALS:
        body = {"run": made[disc], "weights": [WEIGHTS[disc][0] | {"angle_deg": 0.0}], "by": "Ada"}
        api("POST", f"{here}/trials", json=body)
    correction = api("POST", f"{here}/correction", json={"by": "Ada"})["correction"]
    assert len(correction["planes"]) == 1
    assert any("cannot be told apart from" in one and "is left out" in one for one in correction["notes"])


def test_a_calibration_put_in_force_amid_a_balancing_makes_no_other_train(store: Database, api: Api) -> None:
    first = add_run(store, {}, number=1)
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [first], 'by': 'Ada'})['id']}"
    with store.transaction() as session:
        machine = machines.document(session, KEY.machine)
        free = tuple(probe.model_copy(update={"gain_spread": 3.0}) for probe in machine.probes)
        held = Calibration(parameters=("probe.B3X.gain.real",), values=(0.1,), covariance=((0.01,),))
        machines.revise(session, calibrated_document(machine, machine.model_copy(update={"probes": free}), held))
        assert machines.get(session, KEY.machine).revision == 2
    for number, disc in enumerate(TRIALS, 2):
        run = add_run(store, {disc: TRIALS[disc]}, number=number, revision=2)
        api("POST", f"{here}/trials", json={"run": run, "weights": WEIGHTS[disc], "by": "Ada"})
    assert api("POST", f"{here}/correction", json={"by": "Ada"})["state"] == "proposed"
    api("POST", PATH, 201, json={"runs": [first], "by": "Ada"})


def test_each_step_is_in_the_audit_trail_and_nothing_else_is_changed(store: Database, api: Api, begun: int) -> None:
    with store.reading() as session:
        done = [one.operation for one in audit.newest(session, limit=10)]
        assert done == ["add_balancing_trial", "add_balancing_trial", "begin_balancing"]
        assert list(timeline.of_machine(session, KEY.machine, limit=10)) == []
        assert machines.get(session, KEY.machine).revision == 1
    assert api("GET", f"{PATH}/{begun}")["revision"] == 1


def test_angles_are_on_the_discs_scale_where_one_is_said(store: Database, api: Api) -> None:
    first = add_run(store, {}, number=1)
    scale = {"counted": "against-rotation", "zero_deg": 90.0}
    found = api("POST", PATH, 201, json={"runs": [first], "disc_scale": scale, "by": "Ada"})
    run = add_run(store, {"D1": TRIALS["D1"]}, number=2)
    weight = {"disc": "D1", "amount": 800.0, "unit": "g mm", "angle_deg": 90.0}
    told = api("POST", f"{PATH}/{found['id']}/trials", json={"run": run, "weights": [weight], "by": "Ada"})
    [said] = told["trials"][0]["weights"]
    assert said["angle_deg"] == pytest.approx(0.0, abs=1e-9)
    assert said["scale_deg"] == pytest.approx(90.0)
    assert told["disc_scale"] == scale


def test_runs_are_read_while_others_may_write_and_a_balancing_has_only_so_many_trials(
    store: Database, api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    held: list[bool] = []

    def noting(*given: Any) -> Any:
        held.append(store._turn._lock.locked())
        return balancing_run(*given)

    monkeypatch.setattr(balancings, "balancing_run", noting)
    monkeypatch.setattr(balancings, "MOST_TRIALS", 1)
    first, second, third = (add_run(store, {"D1": TRIALS["D1"]} if number > 1 else {}, number=number) for number in (1, 2, 3))
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [first], 'by': 'Ada'})['id']}"
    trial = {"run": second, "weights": WEIGHTS["D1"], "by": "Ada"}
    api("POST", f"{here}/trials", json=trial)
    told = api("POST", f"{here}/trials", 409, json=trial | {"run": third})["detail"]
    assert "has 1 trial runs, as many as may be" in told
    assert held == [False, False, False]


def test_a_correction_is_stored_in_its_turn_and_not_beside_an_alert_that_came_meanwhile(
    store: Database, api: Api, begun: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    places, process, held = api.app.state.changing_places, api.app.state.model_process, []
    unmoved, compute = balancings._unmoved, process.compute

    def noting(*given: Any) -> Any:
        held.append(places._held.total())
        return unmoved(*given)

    def slow(work: Any, *given: Any) -> Any:
        found = compute(work, *given)
        with store.transaction() as session:
            row = store_identification(session, identification({"coupling.C1.kxx": 1.0}), run_id=1)
            finding = AlertFinding({"sigma": 6.1}, row.id, START, latching=False)
            transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        return found

    monkeypatch.setattr(balancings, "_unmoved", noting)
    api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})
    assert held == [1]
    monkeypatch.setattr(process, "compute", slow)
    refused = api("POST", f"{PATH}/{begun}/correction", 409, json={"by": "Bea", "criterion": "min-max"})["detail"]
    assert "C1" in refused
    assert places._held.total() == 0


def test_a_correction_is_computed_in_another_process_and_in_no_transaction(
    store: Database, api: Api, begun: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Words refuse what cannot be computed."""
    process, found = api.app.state.model_process, []
    compute = process.compute

    def noting(work: Any, *given: Any) -> Any:
        found.append((work.__name__, store._turn._lock.locked(), cast(QueuePool, store.engine.pool).checkedout()))
        return compute(work, *given)

    monkeypatch.setattr(process, "compute", noting)
    api("POST", f"{PATH}/{begun}/correction", json={"by": "Ada"})
    run = add_run(store, {}, number=9)
    api("POST", f"{PATH}/{begun}/check", json={"run": run, "by": "Ada"})
    bare = api("POST", f"{PATH}/{begun}/correction", 422, json={"discs": ["D9"], "by": "Ada"})["detail"]
    assert "there is no disc D9" in bare
    assert found == [("compute_correction", False, 0), ("compute_check", False, 0)]


def test_residual_unbalance_of_a_rotor_without_a_trial_run_is_not_known(store: Database, api: Api) -> None:
    first, second = add_run(store, {}, number=1), add_run(store, {"D1": TRIALS["D1"]}, number=2)
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [first], 'by': 'Ada'})['id']}"
    api("POST", f"{here}/trials", json={"run": second, "weights": WEIGHTS["D1"], "by": "Ada"})
    found = api("POST", f"{here}/correction", json={"grade": 1000, "by": "Ada"})["correction"]["residual"]
    untold = {"g_mm": None, "upper_g_mm": None, "reached_grade": None, "verdict": "not known"}
    other = {one["bearing"]: one["after"] for one in found if one["shaft"] == "S2"}
    assert other["B3"] == other["B4"] == untold | {"untold": "plane D2 had no trial run"}
    assert {one["after"]["verdict"] for one in found if one["shaft"] == "S1"} == {"open"}


def test_a_correction_at_chosen_speeds(api: Api, begun: int) -> None:
    """As the command's `--rpm`."""
    asked = {"speeds_rpm": [1200.0, 1000.0, 1000.2], "by": "Ada"}
    correction = api("POST", f"{PATH}/{begun}/correction", json=asked)["correction"]
    assert correction["speeds_rpm"] == pytest.approx([1000.0, 1200.0])
    assert {one["point"].partition(" at ")[2] for one in correction["vectors"]} == {"1000 r/min", "1200 r/min"}
    assert correction["planes"][0]["g_mm"] == pytest.approx(1000.0, rel=0.1)


@pytest.mark.parametrize(
    ("speeds", "words"),
    [
        ([1000.0, 9000.0], "9000 r/min lies outside the document's range, 300 to 3000 r/min"),
        ([2500.0], "2500 r/min was not recorded by two runs, within 1 %: run 1 has 900 to 1400 r/min; run 2 has 900 to 1400"),
    ],
)
def test_speeds_that_nobody_measured_are_named(api: Api, begun: int, speeds: list[float], words: str) -> None:
    told = api("POST", f"{PATH}/{begun}/correction", 422, json={"speeds_rpm": speeds, "by": "Ada"})["detail"]
    assert words in told


@pytest.mark.parametrize("speeds", [[], [0.0], [-1000.0], "1000", [1000.0] * 101])
def test_speeds_that_are_none_are_refused(api: Api, begun: int, speeds: Any) -> None:
    errors = api("POST", f"{PATH}/{begun}/correction", 422, json={"speeds_rpm": speeds, "by": "Ada"})["errors"]
    assert all(one["field"].startswith("speeds_rpm") for one in errors)


def test_a_check_with_a_weight_on_an_untried_disc_is_told_as_far_as_it_can_be(store: Database, api: Api) -> None:
    first, second = add_run(store, {}, number=1), add_run(store, {"D1": TRIALS["D1"]}, number=2)
    here = f"{PATH}/{api('POST', PATH, 201, json={'runs': [first], 'by': 'Ada'})['id']}"
    api("POST", f"{here}/trials", json={"run": second, "weights": WEIGHTS["D1"], "by": "Ada"})
    api("POST", f"{here}/correction", json={"by": "Ada"})
    run = add_run(store, {"D2": TRIALS["D2"]}, number=9)
    check = api("POST", f"{here}/check", json={"run": run, "weights": WEIGHTS["D2"], "by": "Ada"})["check"]
    assert (check["unpredicted"], check["other_weights"], check["points_kept"]) == (["D2"], True, 0)
    assert {one["kept"] for one in check["channels"]} == {None}
    (trim,) = check["trim"]
    assert trim["lower_g_mm"] < trim["g_mm"] < trim["upper_g_mm"]
