"""A database that is away, or takes questions and answers none: what looks after the service is told so, and in time."""

import time
from pathlib import Path

import httpx
import pytest

from service.configuration.settings import Settings
from service.doctor.checks import examine
from tests.end_to_end.processes import Service, rundown, until
from tests.faults.storage_faults import own_server
from tests.plant import document

SOON_S = 15.0
"""Two bounded waits, for the key and for the database, on a machine that is busy with other tests."""
RECOVERED_S = 20.0


def answer(service: Service, path: str, key: str) -> httpx.Response:
    """Return the service's answer, which has to come soon."""
    began = time.monotonic()
    url = f"http://127.0.0.1:{service.port}{path}"
    found = httpx.get(url, headers={"Authorization": f"Bearer {key}"}, timeout=2 * SOON_S)
    assert time.monotonic() - began < SOON_S, path
    return found


@pytest.mark.parametrize("how", ["away", pytest.param("frozen", marks=pytest.mark.long)])
def test_a_database_that_does_not_answer_is_reported_in_time(tmp_path: Path, how: str) -> None:
    with own_server() as (server, database):
        key = rundown("key", "create", "prometheus", "--role", "admin", "--database", database).stdout.strip()
        service = Service(tmp_path, database=database)
        service.client.headers["Authorization"] = f"Bearer {key}"
        with service.running():
            assert service.client.post("/machines", json=document()).status_code == 201
            before = answer(service, "/metrics", key)
            assert "rundown_database_answers 1" in before.text
            with server.away() if how == "away" else server.frozen():
                for _ in range(3):
                    ready = answer(service, "/api/v1/ready", key)
                    assert ready.status_code == 503, ready.text
                    assert "answer" in ready.json()["parts"]["database"]
                assert answer(service, "/api/v1/alive", key).json() == {"alive": True}
                figures = answer(service, "/metrics", key)
                assert figures.status_code == 200
                assert "rundown_database_answers 0" in figures.text
                began = time.monotonic()
                settings = Settings(database=database, port=service.port, zenoh_listen=[service.endpoint])
                told = {one.what: one.level for one in examine(settings, api_key=key)}
                assert told["database"] == told["machines"] == "wrong"
                assert told["zenoh"] == "ok"
                assert time.monotonic() - began < 60.0
            until(lambda: answer(service, "/api/v1/ready", key).status_code == 200, within_s=RECOVERED_S, what="it recovers")
            assert "rundown_database_answers 1" in answer(service, "/metrics", key).text
        service.client.close()
