"""A service in several processes on one PostgreSQL database, with a router and a source, that can be killed and frozen."""

import contextlib
import signal
import subprocess
import sys
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import Any, Self

import httpx
import numpy as np

from tests.end_to_end.processes import process, python, until
from tests.faults.measured import expected, stored_at
from tests.plant import assert_same_samples, document
from tests.ports import free_port

Running = tuple[AbstractContextManager[subprocess.Popen[bytes]], subprocess.Popen[bytes]]


class Layout:
    """Replicas by name: the role and a number, such as `ingest1`. Each has its own port for health and metrics."""

    def __init__(self, folder: Path, *, database: str, **environment: str) -> None:
        self.folder = folder
        self.database = database
        self.endpoint = f"tcp/127.0.0.1:{free_port()}"
        self._environment = {"RUNDOWN_SILENCE_S": "5"} | environment
        self._clients: dict[str, httpx.Client] = {}
        self._running: dict[str, Running] = {}

    def __enter__(self) -> Self:
        self._begin("router", process(self.folder / "router.log", "router", "--listen", self.endpoint))
        return self

    def __exit__(self, *_: object) -> None:
        for name in reversed(list(self._running)):
            context, _one = self._running.pop(name)
            context.__exit__(*sys.exc_info())
        for client in self._clients.values():
            client.close()

    def start(self, name: str, *, database: str | None = None, clock: Path | None = None) -> None:
        """Begin a replica, or begin it again on the same port.

        database: URL by which it reaches the database, when not the layout's. clock: file that says by how many seconds its
        clock is off.
        """
        if name not in self._clients:
            base = f"http://127.0.0.1:{free_port()}/api/v1"
            self._clients[name] = httpx.Client(base_url=base, timeout=20.0, headers={"if-match": "*"})
        flags = ["--database", database or self.database, "--port", str(self.client(name).base_url.port)]
        arguments = ["serve", "--role", name.rstrip("0123456789"), *flags, "--zenoh-connect", self.endpoint]
        log = self.folder / f"{name}.log"
        if clock is None:
            self._begin(name, process(log, *arguments, **self._environment))
        else:
            shifted = ["-m", "tests.faults.shifted_clock", str(clock), *arguments]
            self._begin(name, python(log, *shifted, **self._environment))

    def start_ready(self, *names: str) -> None:
        """Begin replicas and wait until they are ready."""
        for name in names:
            self.start(name)
        for name in names:
            until(partial(self._ready, name), within_s=30, what=f"{name} is ready")

    def create_machine(self, name: str, body: dict[str, Any] | None = None) -> None:
        """Make a machine known, by default the one that the source measures."""
        answer = self.client(name).post("/machines", json=body or document())
        assert answer.status_code == 201, answer.text

    def start_source(self, *, samples: int, rate: float) -> None:
        """Begin the source, which has a durable log."""
        arguments = [self.endpoint, str(self.folder / "edge.db"), str(samples), str(rate)]
        self._begin("edge", python(self.folder / "edge.log", "-m", "tests.faults.edge", *arguments))

    def kill(self, name: str) -> None:
        """Kill it without warning, like a power cut."""
        context, one = self._running.pop(name)
        one.kill()
        one.wait()
        context.__exit__(None, None, None)

    def stop(self, name: str) -> None:
        """Stop it in the regular way, like an operator."""
        context, _ = self._running.pop(name)
        context.__exit__(None, None, None)

    def send(self, name: str, number: signal.Signals) -> None:
        """A signal to a process."""
        self._running[name][1].send_signal(number)

    def client(self, name: str) -> httpx.Client:
        """Return a client of a replica's API."""
        return self._clients[name]

    def get(self, name: str, path: str, **parameters: Any) -> Any:
        """The JSON answer to a request that must succeed."""
        answer = self.client(name).get(path, params=parameters)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def received(self, name: str) -> int:
        """Samples stored, as a replica tells; 0 while it does not."""
        with contextlib.suppress(httpx.TransportError, AssertionError):
            return sum(row["received"] for row in self.get(name, "/sources"))
        return 0

    def shares(self, name: str) -> dict[str, int]:
        """Return how many parts of the machines each replica that lives stores, by role and process id."""
        return {f"{row['role']} {row['process']}": row["machine_shares"] for row in self.get(name, "/replicas")}

    def pid(self, name: str) -> int:
        """Process id."""
        return self._running[name][1].pid

    def check_exact(self, name: str, samples: int, *, within_s: float = 60.0) -> None:
        """The store holds what was measured, once.

        Not always in the order in which it was measured: a new owner stores what arrives when the source's log has not
        replied in time, and recalls the samples before it afterwards. They are found by their times.
        """
        until(lambda: self.received(name) >= samples, within_s=within_s, what=f"{samples} samples stored")
        (row,) = self.get(name, "/sources")
        assert (row["received"], row["next_sequence"], row["lost"]) == (samples, samples, 0)
        numbers, held = stored_at(self.database)
        assert sorted(numbers) == list(range(samples))
        assert_same_samples(held.pick(np.argsort(numbers)), expected(samples))

    def _begin(self, name: str, context: AbstractContextManager[subprocess.Popen[bytes]]) -> None:
        self._running[name] = context, context.__enter__()

    def _ready(self, name: str) -> bool:
        _, started = self._running[name]
        assert started.poll() is None, (self.folder / f"{name}.log").read_text()
        with contextlib.suppress(httpx.TransportError):
            return self.client(name).get("/ready").status_code == 200
        return False
