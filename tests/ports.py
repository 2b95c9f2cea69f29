"""Ports on loopback for the services that tests start: each is handed out once, to one process of the tests."""

import itertools
import os
import socket

FIRST_PORT, LAST_PORT = 12_000, 32_000
"""Below the range from which the system draws ports of outgoing connections: none of these takes one in between."""
PORTS_PER_PROCESS = 1_000


def _block() -> int:
    """Return this process's block: the workers of one run have different ones."""
    run, worker = os.environ.get("PYTEST_XDIST_TESTRUNUID"), os.environ.get("PYTEST_XDIST_WORKER", "gw0")
    first = int(run[:8], 16) if run else os.getpid()
    return (first + int(worker.removeprefix("gw"))) % ((LAST_PORT - FIRST_PORT) // PORTS_PER_PROCESS)


_first_of_block = FIRST_PORT + PORTS_PER_PROCESS * _block()
_offsets = itertools.count()


def free_port() -> int:
    """Hand out a port that nothing listens on.

    Raises RuntimeError where all of this process's are taken.
    """
    for offset in itertools.islice(_offsets, PORTS_PER_PROCESS):
        port = _first_of_block + offset % PORTS_PER_PROCESS
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port
    raise RuntimeError(f"no port from {_first_of_block} to {_first_of_block + PORTS_PER_PROCESS - 1} is free")


def free_endpoint() -> str:
    """Hand out a zenoh endpoint on a port that nothing listens on."""
    return f"tcp/127.0.0.1:{free_port()}"
