"""Many clients of the event stream, of which some never read: what it costs the service, and that nobody misses any event."""

import asyncio
import contextlib
import itertools
import re
import resource
import socket
import time
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from storage.database.engine import Database
from tests.end_to_end.processes import Service
from tests.plant import document
from tests.service.http.test_slow_clients import AT_ONCE, opened, told

CONNECTS_PER_S = 80.0
"""The service lets one person ask a hundred times a second in the long run."""
EVENT = re.compile(rb"id: (\d+)\nevent: alert\ndata: .*\n\n")
PIECE = 2**18
SMALL = 4096
"""Bytes that one that does not read takes in before [its socket's buffer]."""
PATIENCE_S = 600.0


@dataclass
class StreamClient:
    """Reads every event, coming back behind the last one that it has."""

    port: int
    ids: list[int] = field(default_factory=list)
    connections: int = 0

    async def connect(self, *, buffer: int | None = None) -> tuple[asyncio.StreamReader, asyncio.StreamWriter] | None:
        """A stream that has answered; None where there was none to be had now. buffer: of the socket [bytes]."""
        one = socket.socket()
        if buffer is not None:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        one.setblocking(False)
        try:
            await asyncio.get_running_loop().sock_connect(one, ("127.0.0.1", self.port))
            limit = buffer or PIECE
            reader, writer = await asyncio.open_connection(sock=one, limit=limit)
            last = f"Last-Event-ID: {self.ids[-1] if self.ids else 0}\r\n"
            writer.write(f"GET /api/v1/alert-events/stream HTTP/1.1\r\nHost: 127.0.0.1\r\n{last}\r\n".encode())
            head = await reader.readuntil(b"\r\n\r\n")
        except (OSError, asyncio.IncompleteReadError):
            one.close()
            return None
        if not head.startswith(b"HTTP/1.1 200"):
            writer.close()
            return None
        self.connections += 1
        return reader, writer

    async def read(self, last: int) -> None:
        """Read until this event has come, over as many connections as that takes."""
        while last not in self.ids[-1:]:
            found = await self.connect()
            if found is None:
                await asyncio.sleep(0.5)
                continue
            await self.take(*found, last=last)

    async def take(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, last: int) -> None:
        """Return what comes over one connection, until it ends or this event has come."""
        whole = b""
        with contextlib.suppress(OSError):  # cut off
            while last not in self.ids[-1:] and (piece := await reader.read(PIECE)):
                whole += piece
                self.ids += [int(number) for number in EVENT.findall(whole)]
                whole = whole[whole.rfind(b"\n\n") + 2 :] if b"\n\n" in whole else whole
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()


@dataclass(frozen=True)
class Followed:
    """Cost of the clients. growth_mb: of the service's memory at most. again: connections beyond one a client."""

    clients: int
    stuck: int
    events: int
    growth_mb: float
    again: int
    seconds: float

    def __str__(self) -> str:
        return (
            f"{self.clients} clients of which {self.stuck} never read, {self.events} events of 4 kB: memory at most "
            f"+{self.growth_mb:.0f} MB, {self.again} came back, all have all events, in order, once; {self.seconds:.0f} s"
        )


def followed(folder: Path, *, clients: int, stuck: int, events: int) -> Followed:
    """Events happen while they listen; in the end each client has every one of them."""
    _allow_files(2 * clients + 200)
    service = Service(folder, RUNDOWN_CONNECTIONS_PER_ADDRESS=str(clients + 50))
    with service.running() as serving:
        assert service.client.post("/machines", json=document()).status_code == 201
        database = Database(service.database)
        try:
            found = asyncio.run(_followed(service, serving.pid, database, clients=clients, stuck=stuck, events=events))
        finally:
            database.close()
    service.client.close()
    assert "Traceback" not in service.log.read_text()
    return found


async def _followed(service: Service, pid: int, database: Database, *, clients: int, stuck: int, events: int) -> Followed:
    alert, identification = opened(database)
    numbers = itertools.count(1)
    everybody = [StreamClient(service.port) for _ in range(clients)]
    sitting, reading = everybody[:stuck], everybody[stuck:]
    process = psutil.Process(pid)
    before = largest = process.memory_info().rss
    began = time.monotonic()
    held = []
    for one in sitting:
        held.append(await one.connect(buffer=SMALL))
        await asyncio.sleep(1.0 / CONNECTS_PER_S)
    assert all(held)
    tasks = []
    for one in reading:
        tasks.append(asyncio.create_task(one.read(events)))
        await asyncio.sleep(1.0 / CONNECTS_PER_S)
    while any(one.connections == 0 for one in reading):
        assert time.monotonic() - began < PATIENCE_S
        await asyncio.sleep(0.1)
    for _ in range(events // AT_ONCE):
        await asyncio.to_thread(told, database, alert, identification, numbers)
        largest = max(largest, process.memory_info().rss)
        await asyncio.sleep(0.2)
    while not all(task.done() for task in tasks):
        assert time.monotonic() - began < PATIENCE_S, f"{sum(not task.done() for task in tasks)} clients wait for events"
        largest = max(largest, process.memory_info().rss)
        await asyncio.sleep(0.2)
    for task in tasks:
        task.result()
    for one, connection in zip(sitting, held, strict=True):
        assert connection is not None
        await asyncio.wait_for(one.take(*connection, last=events), 60.0)
    await asyncio.gather(*(asyncio.wait_for(one.read(events), PATIENCE_S) for one in sitting))
    largest = max(largest, process.memory_info().rss)
    expected = list(range(1, events + 1))
    assert all(one.ids == expected for one in everybody)
    again = sum(one.connections - 1 for one in everybody)
    return Followed(clients, stuck, events, (largest - before) / 1e6, again, time.monotonic() - began)


def _allow_files(count: int) -> None:
    """Sockets are files, of which a process may have a thousand by default."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft < count:
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(count, hard), hard))
