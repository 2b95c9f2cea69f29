"""Tests what a machine does, stored with the samples and told by the API: states, open run, history; noise, restarts,
silence."""

from typing import Any

import numpy as np
import pytest

from service.runs.collection_state import state_of
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api
from tests.databases import NewDatabase
from tests.plant import KEY, SECOND, START, arrived, batch, machine, sweep_rpm
from tests.prompt_writer import PromptWriter

CYCLE = [
    *[0.0] * 30,
    *[100.0] * 30,
    *sweep_rpm(100.0, 2900.0, 280),
    *[2900.0] * 300,
    *sweep_rpm(2900.0, 0.0, 290),
    *[0.0] * 30,
]
"""A whole cycle, a sample a second: standstill, slow roll, run-up from 60, at speed, run-down from 640, standstill."""
WHOLE = ["stopped", "slow roll", "run-up", "at speed", "run-down", "slow roll", "stopped"]


def send(writer: PromptWriter, rpm: list[float], first: int, last: int) -> None:
    for start in range(first, last, 50):
        stop = min(start + 50, last)
        one = batch(rpm[start:stop], sequence=start, start=START + start * SECOND)
        writer.store([arrived(one)], [])


@pytest.fixture
def api(plant: Database) -> Api:
    return Api(plant)


def state(api: Api) -> dict[str, Any]:
    answer = api.get("/machines/pump-7/state")
    assert answer.status_code == 200
    found: dict[str, Any] = answer.json()
    return found


def history(api: Api, **query: Any) -> list[dict[str, Any]]:
    """Oldest first."""
    found: list[dict[str, Any]] = api.get("/machines/pump-7/states", **query).json()
    return found[::-1]


def at(second: int) -> str:
    """Time of a sample as the API tells it."""
    return str(np.datetime64(START // SECOND + second, "s")) + "Z"


def test_before_the_first_sample_nothing_is_known(api: Api) -> None:
    found = state(api)
    assert (found["state"], found["since"], found["run"], found["speed_rpm"]) == ("unknown", None, None, None)
    assert history(api) == []


def test_an_unknown_machine_is_not_found(api: Api) -> None:
    assert api.get("/machines/nobody/state").status_code == 404
    assert api.get("/machines/nobody/states").status_code == 404


def test_a_run_in_progress_is_reported_with_how_far_it_has_come(writer: PromptWriter, api: Api) -> None:
    send(writer, CYCLE, 0, 200)
    found = state(api)
    assert (found["machine"], found["state"], found["direction"]) == ("pump-7", "run-up", "positive")
    assert found["newest_sample_at"] == at(199)
    assert found["speed_rpm"] == pytest.approx(CYCLE[199])
    assert found["run"]["kind"] == "run-up"
    assert found["run"]["progress"] == pytest.approx((CYCLE[198] - 300) / 2700, abs=1e-6)
    assert found["since"] == found["run"]["started_at"]
    send(writer, CYCLE, 200, 800)
    found = state(api)
    assert (found["state"], found["run"]["kind"]) == ("run-down", "run-down")
    assert found["run"]["progress"] == pytest.approx((3000 - CYCLE[798]) / 2700, abs=1e-6)


def test_the_history_tells_every_state_in_turn(writer: PromptWriter, api: Api) -> None:
    send(writer, CYCLE, 0, len(CYCLE))
    found = history(api)
    assert [one["state"] for one in found] == WHOLE
    assert found[0]["since"] == at(0)
    assert [one["since"] for one in found] == sorted(one["since"] for one in found)
    assert state(api)["state"] == "stopped"
    assert state(api)["run"] is None
    assert [one["state"] for one in history(api, **{"from": at(100), "to": at(660)})] == ["at speed", "run-down"]
    assert [one["state"] for one in history(api, limit=2)] == WHOLE[-2:]


@pytest.mark.parametrize("every", [1, 7, 333])
def test_a_restart_at_any_message_changes_neither_states_nor_runs(
    plant: Database, new_database: NewDatabase, plant_template: str, every: int
) -> None:
    one_service = new_database(plant_template)
    send(PromptWriter(one_service, Collector()), CYCLE, 0, len(CYCLE))
    step = max(every, 50)
    for first in range(0, len(CYCLE), step):
        send(PromptWriter(plant, Collector()), CYCLE, first, min(first + step, len(CYCLE)))
    told = []
    for database in (one_service, plant):
        with database.reading() as session:
            states = [(row.since, row.mode, row.speed) for row in runs.states(session, KEY.machine)]
            found = [
                (row.kind, row.state, row.time_first, row.time_last, row.count, row.coverage)
                for row in runs.of_machine(session, KEY.machine)
            ]
            now = state_of(session, KEY.machine)
            assert now is not None
            told.append((states, found, now.stored()))
    assert told[0] == told[1]


def test_after_silence_the_state_is_unknown(writer: PromptWriter, api: Api) -> None:
    send(writer, CYCLE, 0, 700)
    writer.settle(silence_s=0.0)
    found = state(api)
    assert (found["state"], found["run"], found["since"]) == ("unknown", None, at(699))
    assert [one["state"] for one in history(api)][-2:] == ["run-down", "unknown"]
    send(writer, CYCLE, 700, len(CYCLE))
    assert state(api)["state"] == "stopped"


def test_a_trip_is_called_one_and_stays_a_run_down_as_a_run(plant: Database, writer: PromptWriter, api: Api) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(operation={"controlled_deceleration_rpm_per_s": 5}))
    send(writer, CYCLE, 0, 700)
    assert state(api)["state"] == "trip"
    assert state(api)["run"]["kind"] == "run-down"
    send(writer, CYCLE, 700, len(CYCLE))
    assert [one["state"] for one in history(api)] == [*WHOLE[:5], "trip", *WHOLE[5:]]


@pytest.mark.parametrize("seed", range(4))
def test_one_per_cent_of_speed_noise_changes_nothing(plant: Database, writer: PromptWriter, api: Api, seed: int) -> None:
    rng = np.random.default_rng(seed)
    noisy = [speed * (1.0 + 0.01 * float(rng.standard_normal())) for speed in CYCLE]
    send(writer, noisy, 0, len(noisy))
    assert [one["state"] for one in history(api)] == WHOLE
    with plant.reading() as session:
        found = list(reversed(runs.of_machine(session, KEY.machine)))
        rejected = session.connection().exec_driver_sql("SELECT COUNT(*) FROM quarantine").scalar()
    assert [(run.kind, run.state) for run in found] == [("run-up", runs.CLOSED), ("run-down", runs.CLOSED)]
    assert all(run.count is not None and run.count > 230 for run in found)
    assert rejected == 0


def test_a_run_tells_its_coverage(writer: PromptWriter, api: Api) -> None:
    send(writer, CYCLE, 0, len(CYCLE))
    for run in api.get("/machines/pump-7/runs").json():
        assert run["reopened_at"] is None
        assert run["coverage"]["part"] == pytest.approx(0.96, abs=0.01)
        assert run["coverage"]["largest_hole_rpm"] < 11
        assert run["coverage"]["usable"] == {"B2X": 1.0, "B2Y": 1.0, "B3X": 1.0, "B3Y": 1.0}
        assert run["coverage"]["duration_s"] == pytest.approx(260, abs=10)


def test_what_came_late_and_is_not_sorted_in_yet_is_reported(writer: PromptWriter, api: Api) -> None:
    send(writer, CYCLE, 0, 700)
    send(writer, CYCLE, 720, len(CYCLE))
    assert state(api)["late_samples_waiting"] == 0
    send(writer, CYCLE, 700, 720)
    assert state(api)["late_samples_waiting"] == 20


def test_a_machine_that_turns_and_never_enters_its_speed_range_is_reported(writer: PromptWriter, api: Api) -> None:
    """Speeds in Hz that were sent as r/min: no run ever begins, and the state says why."""
    sent = [rpm / 60.0 for rpm in sweep_rpm(2900.0, 1900.0, 300)]
    send(writer, sent, 0, len(sent))
    found = state(api)
    assert (found["state"], found["run"]) == ("slow roll", None)
    assert found["outside_speed_range"].startswith("it turns at 31.")
    assert "never enters the document's speed range, 300 to 3000 r/min: " in found["outside_speed_range"]
    assert "speeds in Hz that were sent as r/min" in found["outside_speed_range"]
    send(writer, sent + CYCLE, len(sent), len(sent) + 300)
    assert state(api)["outside_speed_range"] is None


def test_a_machine_that_covered_too_little_for_a_run_is_reported_until_it_has_one(writer: PromptWriter, api: Api) -> None:
    """Speeds in rad/s that were sent as r/min: they come just into the range, and no run ever begins."""
    sent = [0.1047 * rpm for rpm in sweep_rpm(1000.0, 3000.0, 300)]
    send(writer, sent, 0, len(sent))
    found = state(api)
    assert found["run"] is None
    assert api.value("/fleet")["machines"][0]["outside_speed_range"] == found["outside_speed_range"]
    assert found["outside_speed_range"].startswith("it turned at 104.7 to 313.4 r/min, 0 % of 300 to 3000 r/min: ")
    assert "speeds in rad/s that were sent as r/min" in found["outside_speed_range"]
