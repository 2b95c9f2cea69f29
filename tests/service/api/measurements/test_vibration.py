"""Vibration at the probes: newest values, and the trend at running speed with its acceptance regions."""

from typing import Any

import numpy as np
import pytest

from estimator.units import rad_per_s_to_rpm
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.machines import baselines, machines
from storage.measurements import runs
from storage.measurements import samples as sample_store
from tests.api_in_process import Api, fields, problem
from tests.plant import SECOND, START, machine, samples

HOUR = 3600 * SECOND
RUNNING_RPM = 2000.0
BASELINE_RUNS = 6


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a machine that knows its running speed, with a short baseline."""
    operation = {"running_rpm": RUNNING_RPM, "vibration_limit": 2.5e-5, "vibration_alert": 4e-5, "vibration_danger": 6e-5}
    with plant.transaction() as session:
        machines.revise(session, machine(operation=operation))
    return Api(plant, baseline_runs=BASELINE_RUNS)


def add_run(database: Database, number: int, phasor: complex, second: complex = complex(np.nan, np.nan)) -> int:
    """A closed run-up to running speed, whose channel B3X has these vectors there."""
    held: Samples = samples(40, start=START + number * HOUR, rpm=np.linspace(1000.0, RUNNING_RPM, 40).tolist())
    held.phasor[:, 2], held.second[:, 2] = phasor, second
    with database.transaction() as session:
        row = runs.open_run(session, "pump-7", revision=2, kind="run-up", direction=1, time_first=int(held.time[0]))
        runs.close(row, samples=held, state=runs.CLOSED, reason="over")
        return int(row.id)


def trend_of(api: Api, channel: str, **asked: Any) -> dict[str, Any]:
    (found,) = [one for one in api.value("/machines/pump-7/vibration/trend", **asked)["probes"] if one["channel"] == channel]
    return dict(found)


def test_newest_values_stand_beside_the_limits(api: Api, plant: Database) -> None:
    held = samples(3)
    held.second[2, 2] = 2e-6 * np.exp(-1j * np.radians(40.0))
    held.status[2, 3] = held.status[0, 0]  # the newest of that channel is not usable: the one before is shown
    with plant.transaction() as session:
        key = SourceKey("pump-7", "monitor", 1)
        sample_store.add_block(session, key, revision=2, first_sequence=0, samples=held)
    found = api.value("/machines/pump-7/vibration")
    assert found["limits"].pop("severity_zones") is None
    assert found["limits"] == pytest.approx({"balanced_um_pp": 50.0, "alert_um_pp": 80.0, "danger_um_pp": 120.0})
    none, _, third, fourth = found["probes"]
    assert (none["channel"], none["time"], none["first"]) == ("B2X", None, None)
    assert third["first"] == pytest.approx({"amplitude_um_pp": 100.0, "phase_lag_deg": 30.0})
    assert third["second"] == pytest.approx({"amplitude_um_pp": 4.0, "phase_lag_deg": 40.0})
    assert third["speed_rpm"] == pytest.approx(2000.0)
    assert (third["overall_um_pp"], third["zone"], third["gap_um"]) == (None, None, None)
    assert fourth["speed_rpm"] == pytest.approx(1500.0)
    assert fourth["second"] is None


ZONES = {"source": "contract 7, annex B", "a_b": 3e-5, "b_c": 5e-5, "c_d": 8e-5}


def name_zones(database: Database) -> None:
    with database.transaction() as session:
        machines.revise(session, machine(operation={"running_rpm": RUNNING_RPM, "severity_zones": ZONES}))


def test_overall_levels_have_a_zone_at_running_speed_and_gaps_stand_beside_them(api: Api, plant: Database) -> None:
    name_zones(plant)
    held = samples(3)
    held.status[2, 3] = held.status[0, 0]  # its newest good value is at 1500 rpm, where zones do not hold
    held.overall[:, 1:] = [2e-5, 5e-5, 6e-5]
    held.gap[:, 2] = -4e-5
    with plant.transaction() as session:
        sample_store.add_block(session, SourceKey("pump-7", "monitor", 1), revision=3, first_sequence=0, samples=held)
    found = api.value("/machines/pump-7/vibration")
    zones = found["limits"]["severity_zones"]
    assert zones.pop("source") == "contract 7, annex B"
    assert zones == pytest.approx({"a_b_um_pp": 60.0, "b_c_um_pp": 100.0, "c_d_um_pp": 160.0})
    _, second, third, fourth = found["probes"]
    assert second["overall_um_pp"] == pytest.approx(40.0)
    assert [one["zone"] for one in (second, third, fourth)] == ["A", "B", None], "a boundary belongs to the better zone"
    assert fourth["overall_um_pp"] == pytest.approx(120.0)
    assert [one["gap_um"] for one in (second, third)] == [None, pytest.approx(-40.0)]


def test_overall_levels_and_gaps_have_a_trend(api: Api, plant: Database) -> None:
    name_zones(plant)
    for number, level in enumerate((2e-5, 9e-5)):
        held = samples(40, start=START + number * HOUR, rpm=np.linspace(1000.0, RUNNING_RPM, 40).tolist())
        held.overall[:, 2], held.gap[:, 2] = level, 1e-5 * number
        held.overall[0, 2] = 1.0  # far from running speed
        with plant.transaction() as session:
            row = runs.open_run(session, "pump-7", revision=3, kind="run-up", direction=1, time_first=int(held.time[0]))
            runs.close(row, samples=held, state=runs.CLOSED, reason="over")
    found = trend_of(api, "B3X")
    assert found["overall_um_pp"] == pytest.approx([40.0, 180.0])
    assert found["zone"] == ["A", "D"]
    assert found["gap_um"] == pytest.approx([0.0, 10.0])
    assert trend_of(api, "B2Y")["overall_um_pp"] == [None, None]


def test_a_machine_without_samples_has_no_values(api: Api) -> None:
    assert {one["first"] for one in api.value("/machines/pump-7/vibration")["probes"]} == {None}
    nothing = api.value("/machines/pump-7/vibration/trend")
    assert nothing["running_rpm"] == pytest.approx(RUNNING_RPM)
    assert nothing["probes"][0]["run"] == []
    problem(api.get("/machines/nobody/vibration"), 404)
    problem(api.get("/machines/nobody/vibration/trend"), 404)
    assert fields(api.get("/machines/pump-7/vibration/trend", limit=0)) == ["query.limit"]


def test_the_trend_says_which_run_lies_outside_the_region(api: Api, plant: Database) -> None:
    generator = np.random.default_rng(5)
    usual = 5e-5 * np.exp(-0.5j)
    scatter = 5e-7 * (generator.normal(size=10) + 1j * generator.normal(size=10))
    numbers = [add_run(plant, i, usual + scatter[i], 5e-6) for i in range(8)]
    numbers.append(add_run(plant, 9, usual * np.exp(0.5j), 2e-5))
    found = trend_of(api, "B3X")
    assert found["run"] == numbers
    assert found["within"] == [True] * 8 + [False], "it turned by 29° and is as large as before"
    assert found["amplitude_um_pp"][-1] == pytest.approx(100.0)
    assert found["phase_lag_deg"][-1] == pytest.approx(0.0, abs=1e-6) or found["phase_lag_deg"][-1] == pytest.approx(360.0)
    assert found["second_over_first"][-1] == pytest.approx(0.4)
    (region,) = found["regions"]
    assert (region["run_kind"], region["runs"]) == ("run-up", BASELINE_RUNS)
    assert trend_of(api, "B2X")["regions"] == [], "the probe has no good value"
    assert len(trend_of(api, "B3X", limit=2)["run"]) == 2


def test_a_new_baseline_begins_a_new_region(api: Api, plant: Database) -> None:
    for number in range(BASELINE_RUNS):
        add_run(plant, number, 5e-5 + 1e-7 * number**2)
    assert len(trend_of(api, "B3X")["regions"]) == 1
    with plant.transaction() as session:
        since = START + BASELINE_RUNS * HOUR
        baselines.begin(session, "pump-7", since=since, identification_ids=None, reason="balanced", by="anna")
    found = trend_of(api, "B3X")
    assert found["regions"] == []
    assert set(found["within"]) == {None}


def test_without_a_named_speed_runs_are_compared_where_all_of_them_came(plant: Database) -> None:
    api = Api(plant, baseline_runs=BASELINE_RUNS)
    assert api.value("/machines/pump-7/vibration/trend")["running_rpm"] is None
    for number, highest in enumerate((2000.0, 1900.0)):
        held = samples(40, start=START + number * HOUR, rpm=np.linspace(1000.0, highest, 40).tolist())
        with plant.transaction() as session:
            row = runs.open_run(session, "pump-7", revision=1, kind="run-up", direction=1, time_first=int(held.time[0]))
            runs.close(row, samples=held, state=runs.CLOSED, reason="over")
    found = api.value("/machines/pump-7/vibration/trend")
    assert found["running_rpm"] == pytest.approx(1900.0)
    assert found["running_speed_named"] is False
    assert found["probes"][1]["speed_rpm"] == pytest.approx([1900.0, 1900.0], rel=0.02)
    assert rad_per_s_to_rpm(1.0) == pytest.approx(9.5493, rel=1e-4)
