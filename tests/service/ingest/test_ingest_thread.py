"""The thread of the ingest: silence, its end, a database that refuses, and how far it came."""

import json
from typing import Any

import pytest
import zenoh
from sqlalchemy import text

from formats.wire import ALL_SAMPLES, Key, encode_batch
from service.ingest import ingest_thread as ingest_module
from service.ingest.ingest_thread import Ingest
from storage.database.engine import Database
from storage.measurements import runs
from tests.plant import KEY, batch, sweep_rpm, wait_until
from tests.service.ingest.plant_network import PublishingEdge, counts, heard, ingesting, put, put_batch, received


def test_silence_closes_a_run(router: zenoh.Session, plant: Database, client: zenoh.Session) -> None:
    with ingesting(router, plant, silence_s=0.3):
        wait_until(lambda: heard(client))
        put(client, encode_batch(batch(sweep_rpm(2990.0, 1000.0))))

        def closed() -> bool:
            with plant.reading() as session:
                return [run.reason for run in runs.of_machine(session, KEY.machine)] == ["the source fell silent"]

        wait_until(closed)


def test_what_is_queued_is_stored_before_the_service_stops(
    router: zenoh.Session, plant: Database, client: zenoh.Session
) -> None:
    arrived: list[zenoh.Sample] = []
    witness = router.declare_subscriber(ALL_SAMPLES, arrived.append)
    with ingesting(router, plant) as ingest:
        wait_until(lambda: heard(client))
        for number in range(200):
            put_batch(client, number, number + 1)
        wait_until(lambda: len(arrived) == 200)
    assert not ingest.alive
    assert received(plant) == 200
    witness.undeclare()


def test_a_database_that_refuses_is_tried_again(
    plant: Database, ingest: Ingest, client: zenoh.Session, edge: PublishingEdge, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ingest_module, "RETRY_S", 0.05)
    wait_until(lambda: heard(client))
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE sample_blocks RENAME TO away"))
    edge.publish(5, 5)
    wait_until(lambda: ingest.trouble is not None)
    assert "sample_blocks" in (ingest.trouble or "")
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE away RENAME TO sample_blocks"))
    wait_until(lambda: received(plant) == 10)
    wait_until(lambda: ingest.trouble is None)
    assert counts(plant) == (10, 10, 0)


def asked_how_far(client: zenoh.Session, key: str) -> list[dict[str, Any]]:
    """The answers to the question how far a machine's sources are durable."""
    return [json.loads(reply.ok.payload.to_bytes()) for reply in client.get(key, timeout=5.0) if reply.ok is not None]


@pytest.mark.usefixtures("ingest")
def test_a_source_can_ask_how_far_it_was_received(client: zenoh.Session, plant: Database) -> None:
    wait_until(lambda: heard(client))
    assert asked_how_far(client, KEY.received) == [{"plant": KEY.plant, "machine": KEY.machine, "sources": []}]
    put_batch(client, 0, 5)
    put_batch(client, 8, 10)
    wait_until(lambda: received(plant) == 7)
    (answer,) = asked_how_far(client, KEY.received)
    assert answer["sources"] == [
        {"source": "monitor", "epoch": 1, "next_sequence": 10, "received": 7, "duplicates": 0, "lost": 3}
    ]
    assert asked_how_far(client, Key("plant-1", "pump-8").received) == []
    assert asked_how_far(client, Key("plant-2", KEY.machine).received) == []
