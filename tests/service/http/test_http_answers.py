"""Tests what HTTP asks of every answer: HEAD, compression, where things are, errors that say what to do, streams that end."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from functools import partial

import httpx
import pytest
import uvicorn

from service.api.application import application, end_waiting
from service.http.protocol import HttpProtocol
from service.http.server import Server
from storage.database.engine import Database
from storage.measurements import runs
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.end_to_end.processes import until
from tests.plant import KEY, SECOND, START, identification, samples, store_identification

GRACE_S = 30
"""Time within which the server lets what it answers end."""
CALIBRATIONS = f"{PREFIX}/machines/{KEY.machine}/calibrations"
CALIBRATED = {"channel": "B2X", "at": "2026-03-01T09:00:00Z", "certificate": "No. 4711: 7.87 mV/µm ± 1 %", "by": "anna"}


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a machine with a closed run and its identification."""
    with plant.transaction() as session:
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        runs.close(run, samples=samples(40), state=runs.CLOSED, reason="the speed left the speed range")
        store_identification(session, identification(), run_id=run.id, measured_at=START + SECOND)
    return Api(plant)


@pytest.mark.parametrize("path", ["/machines", "/machines/pump-7", "/health", "/fleet", "/runs/1/phasors"])
def test_head_is_answered_like_get_without_a_body(api: Api, path: str) -> None:
    whole, head = api.get(path), api.ask("HEAD", PREFIX + path)
    assert (head.status_code, head.content) == (200, b"")
    assert dict(head.headers) == dict(whole.headers)


def test_head_of_what_is_not_there(api: Api) -> None:
    assert api.ask("HEAD", f"{PREFIX}/machines/none").status_code == 404
    assert api.ask("HEAD", f"{PREFIX}/alerts/1/acknowledge").status_code == 405


def test_head_of_the_event_stream_ends(api: Api) -> None:
    answer = api.ask("HEAD", f"{PREFIX}/alert-events/stream")
    assert (answer.status_code, answer.content) == (200, b"")
    assert answer.headers["content-type"].startswith("text/event-stream")


@pytest.mark.parametrize("path", ["/openapi.json", "/runs/1/phasors"])
def test_what_is_large_is_compressed_for_who_takes_it(api: Api, path: str) -> None:
    small = api.ask("GET", PREFIX + path, headers={"accept-encoding": "gzip"})
    whole = api.ask("GET", PREFIX + path, headers={"accept-encoding": "identity"})
    assert "content-encoding" not in whole.headers
    assert small.headers["content-encoding"] == "gzip"
    assert "Accept-Encoding" in small.headers["vary"]
    assert int(small.headers["content-length"]) < int(whole.headers["content-length"])
    assert small.content == whole.content  # decompressed by the client


def test_what_is_small_is_sent_as_it_is(api: Api) -> None:
    answer = api.get("/fleet")
    assert len(answer.content) < 1000
    assert "content-encoding" not in answer.headers


def test_what_has_a_tag_is_sent_as_it_is(api: Api) -> None:
    answer = api.get(f"/machines/{KEY.machine}")
    assert len(answer.content) > 1000
    assert answer.headers["etag"]
    assert "content-encoding" not in answer.headers


def test_an_address_without_anything_says_where_to_look(api: Api) -> None:
    assert f"{PREFIX}/docs" in problem(api.get("/machine"), 404)["detail"]
    for path, way in (
        ("/machines/none", "GET /api/v1/machines"),
        ("/runs/99", "/runs"),
        ("/identifications/99", "/identifications"),
        ("/jobs/99", "/jobs"),
        ("/alerts/99", "/alerts"),
        ("/suppressions/99", "/suppressions"),
    ):
        assert way in problem(api.get(path), 404)["detail"]


def test_a_job_is_found_where_its_answer_says(api: Api) -> None:
    asked = api.ask("POST", f"{PREFIX}/runs/1/identifications", json={})
    assert asked.status_code == 202
    found = api.ask("GET", asked.headers["location"])
    assert found.json() == asked.json()
    assert found.json()["state"] == "queued"


def test_calibrations_are_kept_and_stand_on_the_timeline(api: Api) -> None:
    made = api.ask("POST", CALIBRATIONS, json=CALIBRATED)
    assert made.status_code == 201
    assert made.json() == {**made.json(), **CALIBRATED, "machine": KEY.machine}
    api("POST", CALIBRATIONS.removeprefix(PREFIX), 201, json=CALIBRATED | {"channel": "B2Y", "at": "2026-02-01T09:00:00Z"})
    path = CALIBRATIONS.removeprefix(PREFIX)
    assert [one["channel"] for one in api.value(path)] == ["B2X", "B2Y"]
    assert [one["channel"] for one in api.value(path, channel="B2Y")] == ["B2Y"]
    assert [one["channel"] for one in api.value(path, **{"from": "2026-02-15T00:00:00Z"})] == ["B2X"]
    (newest, _) = api.value(f"/machines/{KEY.machine}/timeline")
    assert (newest["kind"], newest["text"]) == ("calibration", "B2X: No. 4711: 7.87 mV/µm ± 1 %")


def test_a_calibration_is_of_a_channel_that_is_there(api: Api) -> None:
    assert "B2X" in problem(api.ask("POST", CALIBRATIONS, json=CALIBRATED | {"channel": "X9"}), 422)["detail"]
    assert fields(api.ask("POST", CALIBRATIONS, json=CALIBRATED | {"at": "2026-03-01T09:00:00"})) == ["at"]
    assert fields(api.ask("POST", CALIBRATIONS, json=CALIBRATED | {"certificate": ""})) == ["certificate"]
    planned = CALIBRATED | {"at": "2096-03-01T09:00:00Z"}
    assert "not in the future" in problem(api.ask("POST", CALIBRATIONS, json=planned), 422)["detail"]
    problem(api.ask("POST", CALIBRATIONS.replace(KEY.machine, "none"), json=CALIBRATED), 404)


@pytest.fixture
def served(plant: Database) -> Iterator[tuple[Server, int]]:
    """A server that runs as in the service, and its port."""
    app = application(plant, dict)
    config = uvicorn.Config(app, http=HttpProtocol, log_config=None, timeout_graceful_shutdown=GRACE_S)
    listener = socket.create_server(("127.0.0.1", 0))
    server = Server(config, partial(end_waiting, app))
    thread = threading.Thread(target=lambda: asyncio.run(server.serve(sockets=[listener])))
    thread.start()
    try:
        until(lambda: server.started, within_s=10, what="the server listens")
        yield server, listener.getsockname()[1]
    finally:
        server.should_exit = True
        thread.join()
        listener.close()


def test_streams_end_when_the_server_stops(served: tuple[Server, int]) -> None:
    server, port = served
    with httpx.stream("GET", f"http://127.0.0.1:{port}{PREFIX}/alert-events/stream", timeout=10) as answer:
        lines = answer.iter_lines()
        assert next(lines).startswith(":")
        began = time.monotonic()
        server.should_exit = True
        assert not any(line.startswith("data") for line in lines)
    assert time.monotonic() - began < GRACE_S / 2


def test_a_body_that_is_not_called_json_is_told_what_to_be_called(api: Api) -> None:
    labelled = {"content-type": "application/x-www-form-urlencoded"}
    said = problem(api.ask("POST", f"{PREFIX}/machines", content=b"{}", headers=labelled), 415)
    assert "Content-Type: application/json" in said["detail"]


@pytest.mark.parametrize("body", [b'{"by": "\xff"}', b"[" * 100_000])
def test_a_body_that_cannot_be_read_is_told_what_is_wrong(body: bytes, api: Api) -> None:
    said = problem(api.ask("POST", f"{PREFIX}/machines", content=body, headers={"content-type": "application/json"}), 400)
    assert "JSON in UTF-8" in said["detail"]


def test_a_blank_for_a_plus_is_explained(api: Api) -> None:
    answer = api.get(f"/machines/{KEY.machine}/runs?from=2026-01-01T00:00:00+02:00")
    assert answer.status_code == 422
    assert "%2B" in answer.json()["errors"][0]["message"]
