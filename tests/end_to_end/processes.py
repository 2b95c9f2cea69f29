"""Rundown's commands as processes of their own, and what the tests ask of a running service."""

import contextlib
import functools
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, TypeVar

import httpx
import yaml

from tests.end_to_end.alive import probing_if_asked
from tests.end_to_end.prepared import PreparedProcess
from tests.ports import free_port

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
DATA = ROOT / "tests" / "data"
START_TIMEOUT_S = 90.0
"""Longest time of a start [s], on a machine that is busy with other tests."""
STOP_TIMEOUT_S = 60.0
"""Longest time of a stop [s]: what deploy/systemd grants it, as a machine may be busy while what has come is stored."""

T = TypeVar("T")


def rundown(*arguments: str, timeout: float = 60.0, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end. Raises TimeoutExpired."""
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        started = PreparedProcess(arguments, output, os.environ | environment, errors=errors)
        try:
            status = started.wait(timeout)
        except subprocess.TimeoutExpired:
            started.kill()
            started.wait()
            raise
        output.seek(0)
        errors.seek(0)
        return subprocess.CompletedProcess(started.args, status, output.read(), errors.read())


@contextlib.contextmanager
def process(log: Path, *arguments: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """A command of Rundown in the background, ended by its process id at the end."""
    with log.open("ab") as output:
        started = PreparedProcess(arguments, output, os.environ | environment)
    with _ended_at_last(started):
        yield started


@contextlib.contextmanager
def python(log: Path, *arguments: str, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """A Python process in the background, ended by its process id at the end."""
    with log.open("ab") as output:
        started = subprocess.Popen(
            [sys.executable, *arguments],
            stdout=output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            env=os.environ | environment,
        )
    with _ended_at_last(started):
        yield started


@contextlib.contextmanager
def _ended_at_last(started: subprocess.Popen[bytes]) -> Iterator[None]:
    try:
        yield
    finally:
        if started.poll() is None:
            started.send_signal(signal.SIGTERM)
            started.send_signal(signal.SIGCONT)  # a test may have ended while it was frozen
        try:
            started.wait(STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            started.kill()
            started.wait()
            raise


def until(look: Callable[[], T | None], *, within_s: float, what: str, seen: Callable[[], object] = str) -> T:
    """Return what `look` returns as soon as it is neither None nor False. seen: what the failure tells beside, at its end."""
    deadline = time.monotonic() + within_s
    while True:
        found = look()
        if found is not None and found is not False:
            return found
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {within_s:.0f} s: {what} {seen()}")
        time.sleep(0.05)


@functools.cache
def empty_store() -> bytes:
    """Return the file of a store without a row: to migrate a new one takes each service half a second."""
    from storage.database.engine import Database  # half a second to import, which processes of the tests should not spend

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "empty.db"
        Database(f"sqlite:///{path}").close()
        return path.read_bytes()


class Service:
    """A place where `rundown serve` runs: its database, its ports. It can be killed and started again.

    endpoint: where sources connect, to the service itself or, if one is given, to that router. database: its URL; by default
    the file rundown.db in the folder, which is there and empty at the first start.
    """

    def __init__(self, folder: Path, *, router: str | None = None, database: str | None = None, **environment: str) -> None:
        self.folder = folder
        self.database = database or f"sqlite:///{folder / 'rundown.db'}"
        self._file = None if database else folder / "rundown.db"
        self.port = free_port()
        self.endpoint = router or f"tcp/127.0.0.1:{free_port()}"
        self._network = "--zenoh-connect" if router else "--zenoh-listen"
        self.log = folder / "serve.log"
        self._environment = {"RUNDOWN_SILENCE_S": "2"} | environment
        self.client = httpx.Client(base_url=f"http://127.0.0.1:{self.port}/api/v1", timeout=20.0, headers={"if-match": "*"})

    def started(self) -> AbstractContextManager[subprocess.Popen[bytes]]:
        """The service, on its way to be ready."""
        if self._file is not None and not self._file.exists():
            self._file.touch(mode=0o600)
            self._file.write_bytes(empty_store())
        flags = ["--database", self.database, "--port", str(self.port)]
        return process(self.log, "serve", *flags, self._network, self.endpoint, **self._environment)

    @contextlib.contextmanager
    def running(self) -> Iterator[subprocess.Popen[bytes]]:
        """The service, ready."""
        with probing_if_asked(f"http://127.0.0.1:{self.port}/api/v1"), self.started() as started:
            until(lambda: self._ready(started), within_s=START_TIMEOUT_S, what="the service is ready")
            yield started

    def _ready(self, started: subprocess.Popen[bytes]) -> bool:
        assert started.poll() is None, self.log.read_text()
        with contextlib.suppress(httpx.TransportError):
            return self.client.get("/ready").status_code == 200
        return False

    def get(self, path: str, **parameters: Any) -> Any:
        """The JSON answer to a request that must succeed."""
        answer = self.client.get(path, params=parameters)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def post(self, path: str, body: dict[str, Any]) -> Any:
        """The JSON answer to a request that must make or queue something."""
        answer = self.client.post(path, json=body)
        assert answer.status_code in (201, 202), answer.text
        return answer.json()

    def create(self, name: str) -> dict[str, Any]:
        """Create a machine from the examples."""
        answer = self.client.post("/machines", json=example(name))
        assert answer.status_code == 201, answer.text
        return dict(answer.json())

    def idle(self) -> bool:
        """Return whether no identification is waiting or running."""
        jobs = self.get("/health")["jobs"]
        return bool(jobs.get("queued", 0) == 0 and jobs.get("running", 0) == 0)


def example(name: str) -> dict[str, Any]:
    """A document of the examples."""
    return dict(yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text()))
