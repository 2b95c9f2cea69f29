"""Nothing that arrives can stop the ingest: what can be taken is stored once, what cannot is kept apart."""

from typing import Any

import pytest
import zenoh

from formats.wire import LARGEST_MESSAGE, encode_batch
from service.ingest.ingest_thread import Ingest
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import quarantine
from tests.failing_writes import refuse
from tests.plant import KEY, batch, machine, wait_until
from tests.service.ingest.plant_network import counts, heard, put, put_batch, received, rejected, rows, stored_times


@pytest.mark.usefixtures("ingest")
def test_without_a_log_a_gap_is_lost_and_the_rest_is_stored(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5)
    put_batch(client, 8, 10)
    put_batch(client, 10, 12)
    wait_until(lambda: received(plant) == 9)
    assert counts(plant) == (12, 9, 3)
    assert stored_times(plant) == [*range(5), *range(8, 12)]


@pytest.mark.usefixtures("ingest")
def test_what_comes_twice_is_stored_once(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    for first, last in ((0, 5), (0, 5), (3, 8)):
        put_batch(client, first, last)
    wait_until(lambda: received(plant) == 8)
    assert stored_times(plant) == list(range(8))
    assert rows(plant)[0].duplicates == 7


GOOD = encode_batch(batch())
BAD: dict[str, tuple[str, dict[str, Any]]] = {
    "noise": ("bad_frame", {"payload": b"\x00\xff" * 50}),
    "nothing": ("bad_frame", {"payload": b""}),
    "damaged": ("bad_frame", {"payload": GOOD[:-1]}),
    "oversized": ("too_large", {"payload": bytes(LARGEST_MESSAGE + 100)}),
    "another format": ("undecodable", {"payload": GOOD, "encoding": "application/json"}),
    "unknown machine": (
        "unknown_machine",
        {"payload": encode_batch(batch(machine="x")), "key": "rundown/v1/plant-1/x/samples"},
    ),
    "another plant": ("unknown_machine", {"payload": encode_batch(batch(plant="p")), "key": "rundown/v1/p/pump-7/samples"}),
    "another machine's key": ("key_mismatch", {"payload": GOOD, "key": "rundown/v1/plant-1/pump-8/samples"}),
    "a key with odd letters": ("key_mismatch", {"payload": GOOD, "key": "rundown/v1/plant-1/pümp 7/samples"}),
    "unknown channel": ("unknown_channel", {"payload": encode_batch(batch(epoch=2, channels=["a", "b", "c", "d"]))}),
    "unknown condition": ("unknown_condition", {"payload": encode_batch(batch(epoch=4, conditions={"humidity": [40.0]}))}),
    "unknown unit": ("wrong_unit", {"payload": encode_batch(batch(epoch=3, speed_unit="RPM"))}),
    "newer schema": ("future_schema", {"payload": encode_batch(batch(schema=2))}),
}


def test_what_cannot_be_taken_is_kept_apart_and_stops_nothing(plant: Database, ingest: Ingest, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    expected: dict[str, int] = {}
    for reason, arguments in BAD.values():
        put(client, **arguments)
        expected[reason] = expected.get(reason, 0) + 1
    put_batch(client, 0, 5, source="good")
    wait_until(lambda: received(plant) == 5)
    assert rejected(plant) == expected
    assert ingest.alive
    assert ingest.trouble is None


def test_what_the_database_cannot_hold_is_put_aside_and_stops_nothing(
    plant: Database, ingest: Ingest, client: zenoh.Session
) -> None:
    with plant.transaction() as session:
        refuse(session, "sample_blocks", write="INSERT", when="NEW.source = 'poison'")
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5, source="poison")
    put_batch(client, 0, 5, source="good")
    put_batch(client, 5, 10, source="good")
    wait_until(lambda: received(plant) == 10)
    wait_until(lambda: rejected(plant) == {"undecodable": 1})
    assert {row.source for row in rows(plant)} == {"good"}
    assert ingest.trouble is None


@pytest.mark.usefixtures("ingest")
def test_an_oversized_message_is_reported_with_its_size(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    size = LARGEST_MESSAGE + 5000
    put(client, bytes(size))
    wait_until(lambda: rejected(plant) == {"too_large": 1})
    with plant.reading() as session:
        (row,) = quarantine.newest(session, reason=None, machine_id=KEY.machine, limit=9)
    assert str(size) in row.detail
    assert row.size == size
    assert len(row.payload) == quarantine.KEPT_BYTES


@pytest.mark.usefixtures("ingest")
def test_a_machine_made_known_later_is_taken_from_then_on(plant: Database, client: zenoh.Session) -> None:
    wait_until(lambda: heard(client))
    put_batch(client, 0, 5, machine="pump-8")
    wait_until(lambda: rejected(plant) == {"unknown_machine": 1})
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    put_batch(client, 5, 10, machine="pump-8")
    wait_until(lambda: received(plant) == 5)
