"""Real receivers on loopback: an HTTP server that answers by path, and what it was sent."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from estimator.machine.document import Machine
from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.configuration.settings import Settings
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow

LOOPBACK = ["127.0.0.0/8"]
LATE_S = 0.05


@dataclass(frozen=True)
class ReceivedRequest:
    """One request."""

    path: str
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


@dataclass
class Receiver:
    """An HTTP server. `/ok` takes, `/hang` never answers, `/error` answers 500, `/gone` 410, `/redirect` 307 to `/ok`,
    `/rubbish` takes and says what is no text,
    `/flaky` 503 until `well` is set, `/endless` sends without end, `/late` takes after some milliseconds,
    `/held` once `well` is set."""

    port: int = 0
    received: list[ReceivedRequest] = field(default_factory=list)
    well: threading.Event = field(default_factory=threading.Event)
    over: threading.Event = field(default_factory=threading.Event)

    def url(self, path: str) -> str:
        return f"http://127.0.0.1:{self.port}{path}"

    def at(self, path: str) -> list[ReceivedRequest]:
        return [one for one in list(self.received) if one.path == path]


@contextmanager
def receiver() -> Iterator[Receiver]:
    """A receiver that listens until the block ends."""
    state = Receiver()

    class ReceivingHandler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["content-length"]))
            state.received.append(ReceivedRequest(self.path, {k.lower(): v for k, v in self.headers.items()}, body))
            kind = self.path.split("/")[1]
            if kind == "hang":
                state.over.wait(600.0)
                return
            if kind == "late":
                time.sleep(LATE_S)
            if kind == "held":
                state.well.wait(60.0)
            status = {"error": 500, "gone": 410, "redirect": 307, "rubbish": 200}.get(kind, 204)
            if kind == "flaky" and not state.well.is_set():
                status = 503
            if kind == "endless":
                self._endless()
                return
            self.send_response(status)
            if kind == "redirect":
                self.send_header("location", state.url("/ok"))
            said = b"\x00\x1b\xff no text" if kind == "rubbish" and status != 204 else b""
            self.send_header("content-length", str(len(said)))
            self.end_headers()
            self.wfile.write(said)

        def _endless(self) -> None:
            self.send_response(500)
            self.end_headers()
            try:
                while not state.over.is_set():
                    self.wfile.write(b"x" * 65536)
            except OSError:
                self.close_connection = True

        def log_message(self, *_: Any) -> None:
            """Say nothing."""

    class ReceivingServer(ThreadingHTTPServer):
        daemon_threads = True
        request_queue_size = 256

    server = ReceivingServer(("127.0.0.1", 0), ReceivingHandler)
    state.port = server.server_address[1]
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    try:
        yield state
    finally:
        state.over.set()
        state.well.set()
        server.shutdown()
        server.server_close()
        thread.join()


def settings(**changes: Any) -> Settings:
    """Settings that allow deliveries on loopback."""
    return Settings(**({"delivery_networks": LOOPBACK} | changes))


def subscribe(database: Database, target: str, *, name: str, kind: str = "webhook", secret: str | None = None) -> int:
    """A subscription's id."""
    with database.transaction() as session:
        return deliveries.subscribe(session, kind=kind, name=name, target=target, secret=secret or "whsec_c2VjcmV0").id


def raise_one(database: Database, found: IdentificationRow, machine: Machine, *, element: str = "coupling.C1") -> int:
    """Raise an alert; its id."""
    with database.transaction() as session:
        finding = AlertFinding({}, found.id, found.measured_at)
        return transitions.raise_alert(session, machine.id, rule="misalignment", element=element, finding=finding).id
