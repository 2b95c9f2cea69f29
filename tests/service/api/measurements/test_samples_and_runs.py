"""Samples and runs as they are read."""

import csv
import io
import re
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest

from service.api.measurements import corrections
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.measurements import samples as sample_store
from tests.api_in_process import Api, problem
from tests.plant import (
    SECOND,
    START,
    document,
    samples,
)

MOMENT = datetime.fromtimestamp(START // SECOND, UTC)


def test_newest_samples(filled: Api) -> None:
    body = filled.value("/machines/pump-7/samples", limit=2)
    assert body["machine"] == "pump-7"
    assert body["channels"] == ["B2X", "B2Y", "B3X", "B3Y"]
    assert body["speed_rpm"][-1] == pytest.approx(1500.0)
    assert body["direction"] == ["positive"] * 2
    assert [len(column) for column in body["amplitude_um_pp"]] == [2] * 4
    assert body["amplitude_um_pp"][0] == pytest.approx([100.0] * 2)
    assert body["phase_lag_deg"][0] == pytest.approx([30.0] * 2)
    assert datetime.fromisoformat(body["time"][-1]) == MOMENT + timedelta(seconds=80)


def test_samples_as_a_table_have_a_row_for_each_sample_and_channel(plant: Database, api: Api) -> None:
    held = samples(6)
    held.phasor[:, 1] *= np.arange(1.0, 7.0)
    with plant.transaction() as session:
        key = SourceKey("pump-7", "monitor", 1)
        sample_store.add_block(session, key, revision=1, first_sequence=0, samples=held)
    told = api.value("/machines/pump-7/samples")
    answer = api.get("/machines/pump-7/samples", format="csv")
    assert answer.headers["content-type"].startswith("text/csv")
    rows = list(csv.DictReader(io.StringIO(answer.content.decode("utf-8-sig"))))
    assert len(rows) == 6 * 4
    for number, row in enumerate(rows):
        sample, channel = divmod(number, 4)
        assert row["channel"] == told["channels"][channel]
        assert datetime.fromisoformat(row["time"]) == datetime.fromisoformat(told["time"][sample])
        assert float(row["speed_rpm"]) == pytest.approx(told["speed_rpm"][sample])
        for name in ("amplitude_um_pp", "phase_lag_deg"):
            assert (float(row[name]) if row[name] else None) == told[name][channel][sample]


def test_more_values_than_an_answer_may_have_are_refused_with_how_many_may_be_asked_for(
    filled: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten thousand samples of 120 channels with all that sources send were 132 MB, and twelve readers 2.7 GB of memory."""
    monkeypatch.setattr(corrections, "MOST_VALUES", 100)
    assert len(filled.value("/machines/pump-7/samples", limit=12)["time"]) == 12
    for said in ({}, {"include": "2x"}, {"include": "2x,scatter", "units": "mil_pp"}):
        refused = problem(filled.get("/machines/pump-7/samples", limit=13, **said), 422)
        most = int(re.search(r"ask for (\d+) samples", refused["detail"])[1])  # type: ignore[index]
        assert len(filled.value("/machines/pump-7/samples", limit=most, **said)["time"]) == most
        problem(filled.get("/machines/pump-7/samples", limit=most + 1, **said), 422)


def test_samples_before_those_that_were_read(filled: Api) -> None:
    whole = filled.value("/machines/pump-7/samples", limit=10_000)["time"]
    newest = filled.value("/machines/pump-7/samples", limit=5)["time"]
    before = datetime.fromisoformat(newest[0]) - timedelta(microseconds=1)
    older = filled.value("/machines/pump-7/samples", limit=7, to=before.isoformat())["time"]
    assert older + newest == whole[-12:]
    asked = {"from": whole[3], "to": whole[8]}
    assert filled.value("/machines/pump-7/samples", **asked)["time"] == whole[3:9]


def test_samples_are_read_through_revisions_that_describe_the_same_machine(changing: Api) -> None:
    before = changing.value("/machines/pump-7/samples")
    assert before["revisions"] == [1]
    changing("PUT", "/machines/pump-7", json=document(name="New"))
    after = changing.value("/machines/pump-7/samples")
    assert after["revisions"] == [1, 2]
    assert len(after["time"]) > 0
    assert after | {"revisions": [1]} == before
    other = document(name="New")
    other["bearings"][0]["kxx"] = 1.23e6
    changing("PUT", "/machines/pump-7", json=other)
    none = changing.value("/machines/pump-7/samples")
    assert (none["time"], none["revisions"]) == ([], [3])
    assert changing.value("/machines/pump-7/samples", revision=2)["time"] == before["time"]
    detail = problem(changing.get("/machines/pump-7/samples", revision=9), 404)["detail"]
    assert detail == "no revision 9 of machine 'pump-7': GET /api/v1/machines/<id>/revisions lists them"
    assert "no machine nobody: " in problem(changing.get("/machines/nobody/samples", revision=1), 404)["detail"]


def test_what_a_source_sends_beside_the_1x_is_shown_where_it_is_asked_for(plant: Database, api: Api) -> None:
    held = samples(2)
    held.scatter[:, 1] = 1e-6
    held.second[:, 2] = 2e-6 * np.exp(-1j * np.radians(40.0))
    held.gap[:, 3] = -4e-5
    held.overall[:, 2] = 6e-5
    with plant.transaction() as session:
        key = SourceKey("pump-7", "monitor", 1)
        sample_store.add_block(session, key, revision=1, first_sequence=0, samples=held)
    plain = api.value("/machines/pump-7/samples")
    assert (plain["gap_um"], plain["overall_um_pp"]) == (None, None)
    centreline = api.value("/machines/pump-7/samples", include="gap", units="mil_pp")
    assert centreline["gap_um"] == [*[[None] * 2] * 3, [pytest.approx(-40.0)] * 2]
    assert centreline["in_units"]["gap"] == [*[[None] * 2] * 3, [pytest.approx(-40.0 / 25.4)] * 2]
    levels = api.value("/machines/pump-7/samples", include="overall", units="mil_pp")
    assert levels["overall_um_pp"] == [[None] * 2, [None] * 2, [pytest.approx(120.0)] * 2, [None] * 2]
    assert levels["in_units"]["overall"][2] == [pytest.approx(120.0 / 25.4)] * 2
    assert [plain[name] for name in ("amplitude_2x_um_pp", "phase_2x_lag_deg", "scatter_um_pp", "status")] == [None] * 4
    whole = api.value("/machines/pump-7/samples", include=["2x", "scatter", "status"])
    assert whole["status"] == [["not_available"] * 2, *[["good"] * 2] * 3]
    assert whole["scatter_um_pp"] == [[None] * 2, [pytest.approx(2.0)] * 2, [None] * 2, [None] * 2]
    assert whole["amplitude_2x_um_pp"] == [[None] * 2, [None] * 2, [pytest.approx(4.0)] * 2, [None] * 2]
    assert whole["phase_2x_lag_deg"][2] == pytest.approx([40.0] * 2)
    for commas in ("2x,scatter,status", ["2x,scatter", "status"]):
        assert api.value("/machines/pump-7/samples", include=commas) == whole
    for wrong in ("3x", "2x,3x", "2x,", "2x,scatter,status,gap,overall,2x"):
        problem(api.get("/machines/pump-7/samples", include=wrong), 422)


def test_of_a_machine_without_samples_there_are_none(api: Api) -> None:
    body = api.value("/machines/pump-7/samples")
    assert (body["time"], body["speed_rpm"]) == ([], [])
    assert body["amplitude_um_pp"] == [[], [], [], []]


def test_runs_are_listed_newest_first(filled: Api) -> None:
    up, down = filled.value("/machines/pump-7/runs")
    assert (down["kind"], down["state"], down["samples"]) == ("run-down", "closed", 40)
    assert down["speed_maximum_rpm"] == pytest.approx(2990.0)
    assert (up["kind"], up["state"], up["ended_at"], up["samples"]) == ("run-up", "open", None, None)
    assert datetime.fromisoformat(down["started_at"]) == MOMENT
    assert filled.value(f"/runs/{down['id']}") == down


@pytest.mark.parametrize(
    ("limits", "kinds"),
    [
        ({}, ["run-up", "run-down"]),
        ({"limit": 1}, ["run-up"]),
        ({"from": MOMENT + timedelta(seconds=1)}, ["run-up"]),
        ({"to": MOMENT}, ["run-down"]),
        ({"to": MOMENT.replace(tzinfo=None)}, ["run-down"]),
        ({"to": MOMENT.astimezone(UTC) - timedelta(microseconds=1)}, []),
        ({"from": datetime(1, 1, 1, tzinfo=UTC), "to": datetime(9999, 12, 31, tzinfo=UTC)}, ["run-up", "run-down"]),
    ],
)
def test_runs_of_a_time_range(filled: Api, limits: dict[str, Any], kinds: list[str]) -> None:
    asked = {name: value.isoformat() if isinstance(value, datetime) else value for name, value in limits.items()}
    assert [one["kind"] for one in filled.value("/machines/pump-7/runs", **asked)] == kinds


def test_phasors_of_a_closed_and_of_an_open_run(filled: Api) -> None:
    up, down = filled.value("/machines/pump-7/runs")
    closed, opened = filled.value(f"/runs/{down['id']}/phasors"), filled.value(f"/runs/{up['id']}/phasors")
    assert len(closed["time"]) == 40
    assert closed["amplitude_um_pp"][1][0] is None
    assert closed["phase_lag_deg"][1][0] is None
    assert closed["amplitude_um_pp"][0][0] == pytest.approx(100.0)
    assert len(opened["time"]) == 40
    assert opened["speed_rpm"][0] == pytest.approx(310.0)
