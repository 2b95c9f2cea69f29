"""Slow-roll vectors over the API: versions given or captured, one in force, what is shown without them, raw data kept."""

from typing import Any

import numpy as np
import pytest

from service.identification import job_options
from storage.database.engine import Database
from storage.findings import jobs
from tests.api_in_process import Api
from tests.plant import (
    CHANNELS,
    document,
)
from tests.slow_roll import PUMP, given


def moments(first: int, last: int) -> dict[str, str]:
    return {"from": f"2023-11-14T22:13:{20 + first:02}Z", "to": f"2023-11-14T22:13:{20 + last:02}Z"}


def test_without_vectors_there_are_no_versions(pump: Api) -> None:
    assert pump("GET", PUMP) == {"machine": "pump-7", "in_force": None, "versions": []}
    pump("GET", "/machines/pump-9/slow-roll", 404)
    assert "version 1" in pump("PUT", f"{PUMP}/in-force", 404, json={"version": 1})["detail"]


def test_given_vectors_are_versions_that_one_puts_in_force(pump: Api) -> None:
    first = pump("POST", PUMP, 201, json=given(comment="from the acceptance test"))
    assert (first["version"], first["origin"], first["in_force"], first["direction"]) == (1, "given", False, "positive")
    assert first["vectors"]["B2X"]["amplitude_um_pp"] == pytest.approx(40.0)
    assert first["vectors"]["B2X"]["phase_lag_deg"] == pytest.approx(30.0)
    assert first["vectors"]["B3Y"]["left_out"] == "it has no vector"
    assert pump("POST", PUMP, 201, json=given(direction="negative"))["version"] == 2
    found = pump("PUT", f"{PUMP}/in-force", json={"version": 2})
    assert (found["in_force"], [one["version"] for one in found["versions"]]) == (2, [2, 1])
    assert [one["in_force"] for one in found["versions"]] == [True, False]
    assert pump("PUT", f"{PUMP}/in-force", json={"version": None})["in_force"] is None


def test_vectors_are_captured_from_stored_samples_in_a_band(pump: Api) -> None:
    body = {"band_rpm": [200, 300], **moments(0, 30)}
    found = pump("POST", PUMP, 201, json=body)
    assert (found["origin"], found["speed_minimum_rpm"]) == ("captured", pytest.approx(200.0))
    assert found["speed_maximum_rpm"] == pytest.approx(290.0)
    for channel in CHANNELS:
        vector = found["vectors"][channel]
        assert vector["amplitude_um_pp"] == pytest.approx(100.0)
        assert vector["phase_lag_deg"] == pytest.approx(30.0)
        assert vector["standard_error_um_pp"] < 1e-6  # the samples are all the same
        assert vector["left_out"] is None
    (run,) = pump("GET", "/machines/pump-7/runs")
    assert pump("POST", PUMP, 201, json={"band_rpm": [300, 600], "run": run["id"]})["version"] == 2


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
def test_what_makes_no_vectors_is_refused_with_the_reason(pump: Api, body: dict[str, Any], words: str) -> None:
    answer = pump("POST", PUMP, 422, json=body)
    assert words in answer["detail"] + "".join(one["message"] for one in answer["errors"])
    assert pump("GET", PUMP)["versions"] == []


def test_vectors_of_an_unknown_run_or_anothers(pump: Api) -> None:
    pump("POST", PUMP, 404, json={"band_rpm": [200, 300], "run": 99})
    pump("POST", "/machines", 201, json=document(id="fan-2"))
    (run,) = pump("GET", "/machines/pump-7/runs")
    answer = pump("POST", "/machines/fan-2/slow-roll", 422, json={"band_rpm": [300, 600], "run": run["id"]})
    assert "one of machine 'pump-7'" in answer["detail"]


def test_phasors_are_raw_unless_asked_otherwise_and_say_so(pump: Api) -> None:
    pump("POST", PUMP, 201, json=given())
    pump("POST", PUMP, 201, json=given(direction="negative"))
    pump("PUT", f"{PUMP}/in-force", json={"version": 1})
    (run,) = pump("GET", "/machines/pump-7/runs")
    for path in (f"/runs/{run['id']}/phasors", "/machines/pump-7/samples"):
        raw = pump("GET", path)
        assert raw["slow_roll_version"] is None
        assert raw["amplitude_um_pp"][0] == pytest.approx([100.0] * len(raw["time"]))
        found = pump("GET", path, params={"slow_roll": "in_force"})
        assert found["slow_roll_version"] == 1
        assert found["amplitude_um_pp"][0] == pytest.approx([60.0] * len(raw["time"]))
        assert found["amplitude_um_pp"][1] == pytest.approx(raw["amplitude_um_pp"][1])
        assert found["slow_roll_left_out"] == dict.fromkeys(CHANNELS[1:], "it has no vector")
        # Given for the other sense of rotation it is conjugated: 100 at -30° less 40 at +30°.
        other = pump("GET", path, params={"slow_roll": "2"})
        size = abs(100 * np.exp(-1j * np.radians(30)) - 40 * np.exp(1j * np.radians(30)))
        assert other["amplitude_um_pp"][0] == pytest.approx([size] * len(raw["time"]))
        assert pump("GET", path) == raw
        pump("GET", path, 404, params={"slow_roll": "3"})
        pump("GET", path, 422, params={"slow_roll": "some"})


@pytest.mark.parametrize(("field", "value"), [("angle_deg", 45), ("sensitivity", 4000.0), ("station", 0.3), ("shaft", "S2")])
def test_a_revision_that_changes_a_probe_leaves_its_vector_out(pump: Api, field: str, value: Any) -> None:
    one = given()["vectors"]["B2X"]
    pump("POST", PUMP, 201, json={"vectors": {"B2X": one, "B2Y": one}})
    pump("PUT", f"{PUMP}/in-force", json={"version": 1})
    revised = document()
    revised["probes"][0][field] = value
    pump("PUT", "/machines/pump-7", json=revised)
    (version,) = pump("GET", PUMP)["versions"]
    assert f"its {field} was" in version["vectors"]["B2X"]["left_out"]
    assert version["vectors"]["B2Y"]["left_out"] is None
    # The run was stored under the older revision, to which the vector belongs.
    (run,) = pump("GET", "/machines/pump-7/runs")
    found = pump("GET", f"/runs/{run['id']}/phasors", params={"slow_roll": "in_force"})
    assert found["amplitude_um_pp"][0][0] == pytest.approx(60.0)


def test_a_job_subtracts_what_was_in_force_when_it_was_taken(pump: Api, plant: Database) -> None:
    pump("POST", PUMP, 201, json=given())
    pump("POST", PUMP, 201, json=given())
    pump("PUT", f"{PUMP}/in-force", json={"version": 1})
    with plant.transaction() as session:
        (row,) = jobs.claim_next(session, 1)
        assert row.options is None
        assert job_options.slow_roll_version(session, row) == 1
    pump("PUT", f"{PUMP}/in-force", json={"version": 2})
    with plant.transaction() as session:
        assert job_options.slow_roll_version(session, jobs.get(session, row.id)) == 1
