"""Measures how long `/alive` takes while a test goes on, asked twenty times a second by a process of its own.

Where the environment names a folder (`RUNDOWN_ALIVE_TIMES`), each service that the tests start is asked so, and a file of
times is left there; `python -m benchmarks.faults.attacks` makes its figures of them.

    python -m tests.end_to_end.alive URL
"""

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

import httpx

FOLDER = "RUNDOWN_ALIVE_TIMES"
INTERVAL_S = 0.05
LONGEST_WAIT_S = 2.0
"""Longest wait for a first answer after a test that was quicker than two questions [s]."""


@contextlib.contextmanager
def probing(url: str) -> Iterator[list[float]]:
    """Yield how long each answer took [s], there when the block has ended. url: of the API."""
    took: list[float] = []
    command = [sys.executable, "-m", "tests.end_to_end.alive", url]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as asking:
        try:
            assert asking.stdout is not None
            assert asking.stdout.readline() == "asking\n"
            yield took
        finally:
            said, _ = asking.communicate("", timeout=60.0)
            took += json.loads(said)


@contextlib.contextmanager
def probing_if_asked(url: str) -> Iterator[None]:
    """Leave the times in a file where the environment names a folder for it."""
    folder = os.environ.get(FOLDER)
    if folder is None:
        yield
        return
    took: list[float] = []
    try:
        with probing(url) as took:
            yield
    finally:
        (Path(folder) / f"{uuid.uuid4()}.json").write_text(json.dumps(took))


def ask(url: str) -> None:
    """Ask until standard input ends, then print how long each answer took [s], as JSON.

    Not counted is what nobody listens for, before the service has begun and after its end, nor the first answer after a start,
    which waits for the start. An answer that is waited for at the end counts as long as it was waited for; where nothing was
    counted yet, the next answer is waited for.
    """
    took: list[float] = []
    began: list[float] = []

    def go_on() -> None:
        started = False
        with httpx.Client(timeout=60.0) as client:
            while True:
                began[:] = [time.perf_counter()]
                try:
                    client.get(f"{url}/alive")
                    if started:
                        took.append(time.perf_counter() - began[0])
                    started = True
                except httpx.TimeoutException:
                    took.append(time.perf_counter() - began[0])
                except httpx.TransportError:
                    started = False  # it is not there
                began.clear()
                time.sleep(INTERVAL_S)

    threading.Thread(target=go_on, daemon=True).start()
    print("asking", flush=True)
    sys.stdin.read()
    ends = time.perf_counter() + LONGEST_WAIT_S
    while not took and time.perf_counter() < ends:
        time.sleep(INTERVAL_S)
    waiting = [time.perf_counter() - one for one in began]
    print(json.dumps([*took, *(one for one in waiting if one > INTERVAL_S)]), flush=True)


if __name__ == "__main__":
    ask(sys.argv[1])
