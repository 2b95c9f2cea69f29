"""Clients over plain sockets, each asking again as soon as it is answered; they cost little beside what they measure."""

import selectors
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import cycle
from urllib.parse import urlsplit

import numpy as np

END_OF_HEAD = b"\r\n\r\n"
LARGEST_READ = 1 << 20


@dataclass
class _Client:
    """One connection. whole: length of the answer under way [B], 0 before its head is there."""

    connection: socket.socket
    left: int
    began: float = 0.0
    whole: int = 0
    got: bytearray = field(default_factory=bytearray)

    def ask(self, request: bytes) -> None:
        self.left -= 1
        self.whole = 0
        self.got.clear()
        self.began = time.perf_counter()
        self.connection.sendall(request)

    def answered(self) -> bool:
        """Take what came; return whether that is all."""
        part = self.connection.recv(LARGEST_READ)
        if not part:
            raise ConnectionError("the service has closed a connection")
        self.got += part
        end = self.got.find(END_OF_HEAD)
        if not self.whole and end >= 0:
            self.whole = end + len(END_OF_HEAD) + _length(bytes(self.got[:end]))
        return 0 < self.whole <= len(self.got)


def latencies(base: str, paths: list[str], *, clients: int, requests: int) -> np.ndarray:
    """Return the latencies [s] of so many GETs from `clients` concurrent clients, cycling through the paths.

    Raises ValueError on any answer but 200.
    """
    place = urlsplit(base)
    asked = cycle([_request(place.netloc, place.path + path) for path in paths])
    found: list[float] = []
    with selectors.DefaultSelector() as waiting:
        for _ in range(clients):
            connection = socket.create_connection((place.hostname, place.port))
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            one = _Client(connection, max(1, requests // clients))
            waiting.register(connection, selectors.EVENT_READ, one)
            one.ask(next(asked))
        while waiting.get_map():
            for one in _answered(waiting):
                found.append(time.perf_counter() - one.began)
                if one.left:
                    one.ask(next(asked))
                else:
                    waiting.unregister(one.connection)
                    one.connection.close()
    return np.array(found)


def _answered(waiting: selectors.BaseSelector) -> Iterator[_Client]:
    for key, _ in waiting.select():
        if key.data.answered():
            yield key.data


def _request(host: str, path: str) -> bytes:
    return f"GET {path} HTTP/1.1\r\nHost: {host}\r\nAccept: */*\r\n\r\n".encode()


def _length(head: bytes) -> int:
    first, *lines = head.decode("latin-1").lower().split("\r\n")
    if first.split()[1] != "200":
        raise ValueError(f"answered with {first}")
    return next(int(line.partition(":")[2]) for line in lines if line.startswith("content-length:"))
