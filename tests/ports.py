"""Ports on loopback for the services that tests start: each is handed out once, to one process of the tests."""

import fcntl
import functools
import itertools
import os
import socket
import tempfile
from collections.abc import Iterator
from pathlib import Path

FIRST_PORT, LAST_PORT = 12_000, 32_000
"""Below the range from which the system draws ports of outgoing connections: none of these takes one in between."""
PORTS_PER_PROCESS = 1_000
BLOCKS = (LAST_PORT - FIRST_PORT) // PORTS_PER_PROCESS


@functools.cache
def _block() -> int:
    """Claim a block that no other process of tests has, of this run or of one beside it, until this process ends."""
    run, worker = os.environ.get("PYTEST_XDIST_TESTRUNUID"), os.environ.get("PYTEST_XDIST_WORKER", "gw0")
    first = (int(run[:8], 16) if run else os.getpid()) + int(worker.removeprefix("gw"))
    for block in ((first + further) % BLOCKS for further in range(BLOCKS)):
        path = Path(tempfile.gettempdir()) / f"rundown-test-ports-{os.getuid()}-{block}.lock"
        file = os.open(path, os.O_CREAT | os.O_WRONLY | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(file)
        else:
            return block  # the file stays open, and with it the claim
    return first % BLOCKS


@functools.cache
def _ports() -> Iterator[int]:
    """Return this process's ports, again and again."""
    first = FIRST_PORT + PORTS_PER_PROCESS * _block()
    return itertools.cycle(range(first, first + PORTS_PER_PROCESS))


def free_port() -> int:
    """Hand out a port that nothing listens on.

    Raises RuntimeError where all of this process's are taken.
    """
    for port in itertools.islice(_ports(), PORTS_PER_PROCESS):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port
    raise RuntimeError("no port of this process of tests is free")


def free_endpoint() -> str:
    """Hand out a zenoh endpoint on a port that nothing listens on."""
    return f"tcp/127.0.0.1:{free_port()}"
