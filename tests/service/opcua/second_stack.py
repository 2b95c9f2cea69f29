"""A client of another stack, node-opcua, in a process of its own: see tests/opcua_client/client.js.

A process serves one connection after another: to load the library takes longer than most tests with it.
"""

import itertools
import json
import os
import queue
import shutil
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.paths import ROOT

FOLDER = ROOT / "tests" / "opcua_client"
PATIENCE_S = 30.0
_IDLE: list["SecondStack"] = []
_FOLDERS = itertools.count(1)


class ConnectionRefused(AssertionError):
    """The server did not take the client; the message is the client's."""


class SecondStack:
    """A process with at most one connected client."""

    def __init__(self) -> None:
        command = ["node", str(FOLDER / "client.js")]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self._numbers = itertools.count(1)
        self._answers: queue.Queue[dict[str, Any]] = queue.Queue()
        self.told: list[dict[str, Any]] = []
        """Notifications, in the order in which they came."""
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def connect(self, endpoint: str, folder: Path, **how: Any) -> None:
        """Connect a client. Raises ConnectionRefused."""
        self.told = []
        self.say({"endpoint": endpoint, "folder": str(folder / f"pki-{next(_FOLDERS)}"), "security": "none", **how})
        found = self.answer()
        if "refused" in found:
            raise ConnectionRefused(found["refused"])
        assert "connected" in found, found

    def disconnect(self) -> None:
        """End the client and keep its process for the next; one that does not answer is killed."""
        try:
            self.say({"request": "end"})
            ended = "ended" in self._answers.get(timeout=5.0)
        except (OSError, queue.Empty):
            ended = False
        if ended:
            _IDLE.append(self)
        else:
            self.kill()

    def kill(self) -> None:
        """End the process."""
        self._process.kill()
        self._thread.join()
        self._process.communicate()

    def ask(self, request: str, **rest: Any) -> Any:
        """Send a request and return its answer; what fails is an assertion."""
        number = next(self._numbers)
        self.say({"number": number, "request": request, **rest})
        found = self.answer()
        assert found.get("number") == number, found
        assert "answer" in found, found
        return found["answer"]

    def say(self, line: dict[str, Any]) -> None:
        """Write a line to it."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(line) + "\n")
        self._process.stdin.flush()

    def answer(self) -> dict[str, Any]:
        """Wait for a line that is no notification."""
        try:
            return self._answers.get(timeout=PATIENCE_S)
        except queue.Empty:
            raise AssertionError("the second stack does not answer") from None

    def events(self, keep: Callable[[dict[str, Any]], bool] = lambda _: True) -> list[dict[str, Any]]:
        """Return the conditions' events so far."""
        return [one for one in list(self.told) if one["told"] == "event" and keep(one)]

    def heard(self, keep: Callable[[dict[str, Any]], bool]) -> bool:
        """Return whether such an event has come."""
        return bool(self.events(keep))

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if not line.startswith("{"):
                continue  # the library's own words
            found = json.loads(line)
            if "told" in found:
                self.told.append(found)
            else:
                self._answers.put(found)
        self._answers.put({"gone": "the process has ended"})


@contextmanager
def second_stack(endpoint: str, folder: Path, **how: Any) -> Iterator[SecondStack]:
    """Yield a client that is connected. Raises ConnectionRefused. how: user, password, security, certificate, key."""
    require_node()
    client = _IDLE.pop() if _IDLE else SecondStack()
    try:
        client.connect(endpoint, folder, **how)
        yield client
    except ConnectionRefused:
        _IDLE.append(client)
        raise
    except BaseException:
        client.kill()
        raise
    if how.get("reconnects"):
        client.kill()
    else:
        client.disconnect()


def end_idle() -> None:
    """End the processes that wait for another client."""
    while _IDLE:
        _IDLE.pop().kill()


def require_node() -> None:
    """Skip where the second stack is not installed; fail where everything must be there."""
    if shutil.which("node") is not None and (FOLDER / "node_modules" / "node-opcua-client").is_dir():
        return
    words = "the second OPC UA stack is not there: npm ci --prefix tests/opcua_client"
    if os.environ.get("RUNDOWN_REQUIRE_ALL"):
        pytest.fail(words)
    pytest.skip(words)
