"""Tests the health of the service and its sources."""

from datetime import UTC, datetime, timedelta

import pytest

from tests.api_in_process import Api
from tests.plant import (
    SECOND,
    START,
)

MOMENT = datetime.fromtimestamp(START // SECOND, UTC)


@pytest.mark.parametrize(
    ("part", "state", "health", "ready"),
    [("ingest", "ok", 200, 200), ("ingest", "its thread has ended", 503, 503), ("stream", "no router answers", 200, 503)],
)
def test_health_and_readiness(api: Api, part: str, state: str, health: int, ready: int) -> None:
    api.parts[part] = state
    for path, status in (("/health", health), ("/ready", ready)):
        answer = api.get(path)
        assert answer.status_code == status
        body = answer.json()
        assert body["parts"] == {**api.parts, "database": "ok"}
        assert body["healthy"] == (health == 200)
        assert body["ready"] == (ready == 200)
        assert body["version"]


@pytest.mark.parametrize(("state", "alive"), [("ok", True), ("the database is locked", True), ("its thread has ended", False)])
def test_only_what_a_new_start_mends_is_a_reason_for_one(api: Api, state: str, alive: bool) -> None:
    api.parts["ingest"] = state
    answer = api.get("/alive")
    assert (answer.status_code, answer.json()) == (200 if alive else 503, {"alive": alive})


def test_health_counts_jobs(filled: Api) -> None:
    assert filled.value("/health")["jobs"] == {"queued": 1, "done": 4, "failed": 1}


def test_sources(filled: Api) -> None:
    (one,) = filled.value("/sources")
    assert (one["machine"], one["source"], one["epoch"]) == ("pump-7", "monitor", 1)
    assert (one["next_sequence"], one["received"], one["duplicates"], one["lost"]) == (84, 81, 0, 3)
    assert datetime.fromisoformat(one["newest_sample_at"]) == MOMENT + timedelta(seconds=80)


def test_quarantine(filled: Api) -> None:
    body = filled.value("/quarantine")
    assert body["counts"] == {"bad_frame": 1}
    (entry,) = body["entries"]
    assert (entry["reason"], entry["machine"], entry["size"]) == ("bad_frame", "pump-7", 7)
    assert "noise" in entry["payload"]
    assert filled.value("/quarantine", reason="bad_frame", machine="pump-7", limit=1)["entries"] == [entry]
    assert filled.value("/quarantine", reason="too_large")["entries"] == []
    assert filled.value("/quarantine", machine="pump-8")["entries"] == []
