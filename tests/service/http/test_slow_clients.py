"""A client of the event stream that never reads, over a real socket: it is let go, cut off, and misses nothing afterwards."""

import re
import socket
import tracemalloc
from collections.abc import Iterator
from itertools import count

import psutil
from sqlalchemy import insert

from benchmarks.serving import serving
from service.api.alerts.event_stream import QUEUE_SIZE, Broadcaster
from service.api.application import application
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.alerting import AlertEventRow
from tests.plant import KEY, START, identification, store_identification, wait_until

EVENT_BYTES = 4000
AT_ONCE = 100
EVENTS = 5000
"""20 MB: far more than the sockets' buffers, 4 MB at most, and a client's queue hold together."""
PATIENCE_S = 8.0
LARGEST_GROWTH = 8e6
"""[bytes]: the client's queue, a page of events, a batch of new ones; without a bound it would be 20 MB and more."""


def opened(database: Database) -> tuple[int, int]:
    """An alert without events, and its identification."""
    with database.transaction() as session:
        found = store_identification(session, identification(), run_id=1).id
        row = alerts.add(
            session,
            KEY.machine,
            rule="misalignment",
            element="coupling.C1",
            evidence={},
            identification_id=found,
            measured_at=START,
            latching=False,
        )
        return row.id, found


def told(database: Database, alert: int, found: int, numbers: Iterator[int]) -> None:
    """Some long events."""
    common = {"alert_id": alert, "machine_id": KEY.machine, "rule": "misalignment", "element": "coupling.C1"}
    common |= {"at": START, "kind": "commented", "state_before": "unacknowledged", "state": "unacknowledged", "severity": 1}
    common |= {"message": "m" * EVENT_BYTES, "by": "anna", "comment": "", "opened_at": START, "identification_id": found}
    with database.transaction() as session:
        session.execute(insert(AlertEventRow), [common | {"number": next(numbers)} for _ in range(AT_ONCE)])


def connected(url: str, *, after: int | None = None, window: int | None = None) -> socket.socket:
    """A client that has read the answer's head and nothing else. window: bytes that may come before it reads."""
    host, _, port = url.removeprefix("http://").split("/")[0].partition(":")
    client = socket.socket()
    if window is not None:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, window)
    client.settimeout(10.0)
    client.connect((host, int(port)))
    again = "" if after is None else f"Last-Event-ID: {after}\r\n"
    client.sendall(f"GET /api/v1/alert-events/stream HTTP/1.1\r\nHost: {host}\r\n{again}\r\n".encode())
    head = b""
    while not head.endswith(b"\r\n\r\n"):
        byte = client.recv(1)
        assert byte, head
        head += byte
    assert head.startswith(b"HTTP/1.1 200")
    return client


def read(client: socket.socket, *, last: int | None = None) -> list[int]:
    """Numbers of the whole events that come, to the one asked for or until the connection ends."""
    whole = b""
    ids: list[int] = []
    while last is None or last not in ids[-1:]:
        try:
            part = client.recv(2**20)
        except ConnectionResetError:
            break
        if not part:
            break
        whole += part
        ids += [int(one) for one in re.findall(rb"id: (\d+)\nevent: alert\ndata: .*\n\n", whole)]
        whole = whole[whole.rfind(b"\n\n") + 2 :] if b"\n\n" in whole else whole
    return ids


def held(url: str) -> int:
    """Connections that the server has."""
    port = int(url.removeprefix("http://").split("/")[0].partition(":")[2])
    every = psutil.Process().net_connections(kind="tcp")
    return sum(one.laddr.port == port and one.status == psutil.CONN_ESTABLISHED for one in every)


def test_a_client_that_never_reads_is_let_go_and_comes_back(plant: Database) -> None:
    alert, found = opened(plant)
    app = application(plant, dict)
    broadcaster: Broadcaster = app.state.broadcaster
    numbers = count(1)
    with serving(app, patience_s=PATIENCE_S) as url, connected(url, window=4096) as client:
        wait_until(lambda: (broadcaster.clients, held(url)) == (1, 1))
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(EVENTS // AT_ONCE):
            told(plant, alert, found, numbers)
        wait_until(lambda: broadcaster.clients == 0)
        growth = tracemalloc.get_traced_memory()[1] - before
        tracemalloc.stop()
        assert held(url) == 1  # it was let go because its queue was full, not because its connection had ended
        assert growth < LARGEST_GROWTH
        wait_until(lambda: held(url) == 0)
        first = read(client)
        assert first == list(range(1, len(first) + 1))
        assert len(first) < EVENTS - QUEUE_SIZE
        with connected(url, after=len(first)) as again:
            rest = read(again, last=EVENTS)
        assert first + rest == list(range(1, EVENTS + 1))
