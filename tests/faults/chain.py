"""Edge, router and service as processes that can be killed, frozen and started again, and the check of what came of it."""

import contextlib
import itertools
import signal
import subprocess
import sys
import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Literal, Self

from tests.end_to_end.processes import Service, process, python, until
from tests.faults.measured import expected, stored_at
from tests.faults.network import Wire
from tests.plant import assert_same_samples, document
from tests.ports import free_port

ChainPart = Literal["edge", "router", "service"]
PARTS: tuple[ChainPart, ...] = ("edge", "router", "service")


class Chain:
    """A source with a durable log, a router and the service; `samples` of it at `rate` a second.

    wire: between router and service, and held or cut at will, where `wired`.
    """

    def __init__(self, folder: Path, *, samples: int, rate: float, wired: bool = False, database: str | None = None) -> None:
        self.folder = folder
        self.samples = samples
        self._rate = rate
        port = free_port()
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self._around = contextlib.ExitStack()
        self.wire = Wire(port) if wired else None
        self.service = Service(folder, router=self.wire.endpoint if self.wire else self.endpoint, database=database)
        self._running: dict[ChainPart, tuple[AbstractContextManager[subprocess.Popen[bytes]], subprocess.Popen[bytes]]] = {}

    def start(self, part: ChainPart) -> None:
        """Begin, or begin again."""
        if part == "service":
            context = self.service.started()
        elif part == "router":
            context = process(self.folder / "router.log", "router", "--listen", self.endpoint)
        else:
            arguments = [self.endpoint, str(self.folder / "edge.db"), str(self.samples), str(self._rate)]
            context = python(self.folder / "edge.log", "-m", "tests.faults.edge", *arguments)
        self._running[part] = context, context.__enter__()

    def kill(self, part: ChainPart) -> None:
        """Kill it without warning, like a power cut."""
        context, one = self._running.pop(part)
        one.kill()
        one.wait()
        context.__exit__(None, None, None)

    def freeze(self, part: ChainPart, seconds: float) -> None:
        """Stop it from doing anything, its connections open."""
        self._running[part][1].send_signal(signal.SIGSTOP)
        try:
            time.sleep(seconds)
        finally:
            self._running[part][1].send_signal(signal.SIGCONT)

    def __enter__(self) -> Self:
        if self.wire is not None:
            self._around.enter_context(self.wire)
        self.start("router")
        self.start("service")
        until(lambda: self.service._ready(self._running["service"][1]), within_s=30, what="the service is ready")
        answer = self.service.client.post("/machines", json=document())
        assert answer.status_code == 201, answer.text
        self.start("edge")
        return self

    def __exit__(self, *_: object) -> None:
        for part in list(self._running):
            context = self._running.pop(part)[0]
            context.__exit__(*sys.exc_info())
        self.service.client.close()
        self._around.close()

    def pid(self, part: ChainPart) -> int:
        """Return its process id."""
        return self._running[part][1].pid

    def wait_ready(self, *, ready: bool, within_s: float) -> float:
        """Wait until the service reports that it is ready, or that it is not; return the time that took [s]."""
        began = time.monotonic()
        status = 200 if ready else 503
        until(
            lambda: self.service.client.get("/ready").status_code == status,
            within_s=within_s,
            what=f"the service is {'ready' if ready else 'not ready'}",
        )
        return time.monotonic() - began

    def wait_received(self, count: int, *, within_s: float = 60.0) -> None:
        """Wait until so many samples are stored."""
        until(lambda: self.received() >= count, within_s=within_s, what=f"{count} samples stored")

    def check_exact(self) -> None:
        """The store holds what was measured, in order, once."""
        self.wait_received(self.samples)
        (row,) = self.service.get("/sources")
        assert (row["received"], row["next_sequence"], row["lost"]) == (self.samples, self.samples, 0)
        numbers, samples = stored_at(self.service.database)
        assert numbers == list(range(self.samples))
        assert_same_samples(samples, expected(self.samples))
        for log in ("edge.log", "serve.log"):
            text = (self.folder / log).read_text()
            assert "Traceback" not in text, text[text.index("Traceback") :][:4000]

    def received(self) -> int:
        """Return how many samples are stored, as far as the service says; 0 while it says nothing."""
        with contextlib.suppress(Exception):
            return sum(row["received"] for row in self.service.get("/sources"))
        return 0


def every_order() -> list[tuple[ChainPart, ...]]:
    """All orders in which the three parts can be killed."""
    return list(itertools.permutations(PARTS))
