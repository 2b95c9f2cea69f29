"""Health stage by stage."""

from typing import Any

from storage.alerts import deliveries
from storage.findings import jobs
from tests.api_in_process import Api
from tests.plant import KEY, START, identification, store_identification


def stages(api: Api) -> dict[str, dict[str, Any]]:
    found = api.value("/health/stages")["stages"]
    assert [one["stage"] for one in found] == [
        "data_acquisition",
        "data_manipulation",
        "state_detection",
        "health_assessment",
        "prognostic_assessment",
        "advisory_generation",
    ]
    return {one["stage"]: one for one in found}


def test_each_stage_says_how_it_is_doing(furnished: Api) -> None:
    found = stages(furnished)
    assert found["data_acquisition"]["state"] == "idle"
    assert found["data_acquisition"]["figures"]["machines_now"] == 1
    assert (found["state_detection"]["state"], found["state_detection"]["figures"]) == (
        "ok",
        {"identifications": 7, "accepted": 7},
    )
    assert found["health_assessment"]["state"] == "idle"
    assert found["prognostic_assessment"]["state"] == "idle"
    assert found["advisory_generation"]["figures"]["open_alerts_now"] == 1
    furnished.parts["identifying"] = "its thread has ended"
    found = stages(furnished)
    for stage in ("data_manipulation", "state_detection", "health_assessment"):
        assert found[stage]["state"] == "failed"
        assert "its thread has ended" in found[stage]["words"]


def test_what_is_not_all_right_is_degraded(furnished: Api) -> None:
    with furnished.database.transaction() as session:
        store_identification(session, identification(accepted=False), run_id=77)
        job = jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[78])
        assert job is not None
        jobs.finish(job, state=jobs.FAILED, error="NotEnoughData")
        waiting = deliveries.of_subscription(session, 1, limit=1)
        for delivery in waiting:
            delivery.next_try_at = START
    furnished.parts["stream"] = "no router answers"
    found = stages(furnished)
    assert {name: one["state"] for name, one in found.items()} == {
        "data_acquisition": "degraded",
        "data_manipulation": "degraded",
        "state_detection": "degraded",
        "health_assessment": "idle",
        "prognostic_assessment": "idle",
        "advisory_generation": "degraded" if waiting else "ok",
    }
