"""Secrets of webhooks from an older release's store to a restored backup: sealed, used, lost and found with their key."""

import json
import shutil
import stat
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from standardwebhooks.webhooks import Webhook

from service.delivery.signing import new_secret
from storage.alerts import deliveries
from storage.database.engine import Database
from tests.conftest import Stores
from tests.end_to_end.processes import Service, rundown, until
from tests.plant import sqlite_url
from tests.service.delivery.receivers import LOOPBACK, Receiver, receiver

ALLOWED = {"RUNDOWN_DELIVERY_NETWORKS": json.dumps(LOOPBACK)}


@pytest.fixture(scope="module")
def http() -> Iterator[Receiver]:
    with receiver() as one:
        yield one


def sent(service: Service, number: int, http: Receiver, secret: str) -> None:
    """A test message arrives, signed with this secret."""
    before = len(http.received)
    told = service.client.post(f"/subscriptions/{number}/test").json()
    assert told["result"] == "delivered", told
    Webhook(secret).verify(http.received[before].body, http.received[before].headers)


@pytest.mark.long
def test_secrets_are_sealed_at_an_upgrade_and_a_backup_needs_the_key(stores: Stores, tmp_path: Path, http: Receiver) -> None:
    folder, elsewhere = tmp_path / "old", tmp_path / "new"
    for one in (folder, elsewhere):
        one.mkdir()
    path, plain = folder / "rundown.db", new_secret()
    stores.databases("sqlite").copy(stores.empty("sqlite"), path)
    with closing(Database(sqlite_url(path))) as database, database.transaction() as session:
        old = deliveries.subscribe(session, kind="webhook", name="old", target=http.url("/ok"), secret=plain).id
    assert "is stored unencrypted" in rundown("doctor", RUNDOWN_DATABASE=sqlite_url(path), RUNDOWN_PORT="1").stdout
    service = Service(folder, **ALLOWED)
    with service.running():
        sent(service, old, http, plain)
        made = service.client.post("/subscriptions", json={"kind": "webhook", "name": "new", "target": http.url("/ok")}).json()
        sent(service, made["id"], http, made["secret"])
        assert service.get("/subscriptions")[0]["secret_kept"] == "sealed"
        backup = rundown("backup", str(tmp_path / "backup"), "--database", service.database)
        assert backup.returncode == 0, backup.stderr
        for file in [*folder.iterdir(), tmp_path / "backup"]:
            assert not any(secret.encode() in file.read_bytes() for secret in (plain, made["secret"])), file
    key = folder / "rundown.db.key"
    assert stat.S_IMODE(key.stat().st_mode) == 0o600

    restored = Service(elsewhere, RUNDOWN_WEBHOOK_SECRET_OTHER=plain, **ALLOWED)
    assert rundown("restore", str(tmp_path / "backup"), "--database", restored.database).returncode == 0
    with restored.running():
        until(lambda: len(restored.get("/health")["warnings"]) >= 2, within_s=15, what="it is stated")
        assert "put back the one" in restored.get(f"/subscriptions/{old}")["trouble"]
        told = restored.client.post(f"/subscriptions/{old}/test").json()
        assert (told["result"], "sealed" in told["answer"]) == ("failed", True)
        assert "rundown_webhooks_unsigned 2.0" in restored.client.get("../../metrics").text
        said = {"kind": "webhook", "name": "other", "target": http.url("/ok")}
        assert restored.client.post("/subscriptions", json=said).status_code == 409
        other = restored.client.post("/subscriptions", json=said | {"secret_env": "RUNDOWN_WEBHOOK_SECRET_OTHER"}).json()
        sent(restored, other["id"], http, plain)
        assert "told nothing" in rundown("doctor", RUNDOWN_DATABASE=restored.database, RUNDOWN_PORT=str(restored.port)).stdout
    assert "told nothing" in rundown("doctor", RUNDOWN_DATABASE=restored.database, RUNDOWN_PORT="1").stdout
    shutil.copy(key, elsewhere / "rundown.db.key")
    with restored.running():
        sent(restored, old, http, plain)
        sent(restored, made["id"], http, made["secret"])
    for each in (service, restored):
        each.client.close()
        assert plain not in each.log.read_text()
