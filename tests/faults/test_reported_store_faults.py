"""A store that cannot be used: callers are told why, and only the log, administrators and doctor where its file lies."""

import builtins
from pathlib import Path

import httpx
import pytest
from sqlalchemy.exc import OperationalError, TimeoutError

from formats.wire import JSON, encode_body
from storage.database.claim import DatabaseUnusable
from storage.database.errors import error_outline
from tests.end_to_end.processes import Service, rundown, until
from tests.faults.measured import measured
from tests.plant import KEY, document, sqlite_url

CAUSE = "was deleted or replaced"


def key(service: Service, name: str, role: str) -> dict[str, str]:
    """Make a key; returns the header that carries it."""
    made = rundown("key", "create", name, "--role", role, "--database", service.database)
    return {"authorization": f"Bearer {made.stdout.strip()}"}


def test_the_files_place_is_reported_to_administrators_only(tmp_path: Path) -> None:
    service = Service(tmp_path, database=sqlite_url(tmp_path / "rundown.db"))
    admin, viewer, source = (key(service, role, role) for role in ("admin", "viewer", "source"))
    wrong = {"authorization": f"{admin['authorization'][:-4]}0000"}
    with service.running(), httpx.Client(base_url=service.client.base_url, timeout=20.0, trust_env=False) as client:
        assert client.post("/machines", json=document(), headers=admin).status_code == 201
        for who in (viewer, source):
            client.get("/me", headers=who)  # known from now on, whatever becomes of the database
        (tmp_path / "rundown.db-wal").unlink()
        until(lambda: client.get("/ready").status_code == 503, within_s=5.0, what="it is noticed")
        samples, body = f"/machines/{KEY.machine}/samples", encode_body(measured(0), JSON)
        source["content-type"] = JSON
        until(
            lambda: CAUSE in client.post(samples, content=body, headers=source).json()["detail"],
            within_s=5.0,
            what="a source is told the cause",
        )
        refused = [client.get("/machines", headers=who) for who in ({}, wrong, viewer, admin)]
        refused += [client.get("/health", headers=who) for who in ({}, viewer)]
        refused += [client.post(samples, content=body, headers=source), client.get("/metrics", headers=viewer)]
        for answer in refused:
            assert str(tmp_path) not in answer.text, answer.text
        told = [answer for answer in refused if CAUSE in answer.text]
        assert {answer.status_code for answer in told} == {503}
        assert len(told) >= 4, [answer.text for answer in refused]
        assert f"{tmp_path / 'rundown.db-wal'} {CAUSE}" in client.get("/health", headers=admin).json()["parts"]["database"]
    assert f"{tmp_path / 'rundown.db-wal'} {CAUSE}" in service.log.read_text()
    service.client.close()


@pytest.mark.parametrize(
    ("error", "outline"),
    [
        (
            OperationalError("", {}, ConnectionError('connection to server at "10.1.2.3", port 5432 failed')),
            "ConnectionError of PostgreSQL",
        ),
        (DatabaseUnusable("database /var/lib/x cannot be used"), "the service's log says why"),
        (TimeoutError("no connection is free"), "no connection is free"),
        (
            OperationalError("", {}, builtins.TimeoutError("database is locked: another thread has written for 15 s")),
            "database is locked: another thread has written for 15 s",
        ),
    ],
)
def test_an_outline_names_no_place(error: Exception, outline: str) -> None:
    assert error_outline(error) == outline
