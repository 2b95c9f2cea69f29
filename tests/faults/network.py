"""A wire that can be cut: forwards TCP connections to an endpoint, holds back what it is given, or breaks them."""

import contextlib
import socket
import threading
from types import TracebackType
from typing import Self

PIECE = 65_536


class Wire:
    """From a port of its own to a port on loopback."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._open = threading.Event()
        self._open.set()
        self._ends: list[socket.socket] = []
        self._thread = threading.Thread(target=self._accept, daemon=True)
        self._thread.start()

    @property
    def endpoint(self) -> str:
        """Return where to connect to."""
        return f"tcp/127.0.0.1:{self._listener.getsockname()[1]}"

    def hold(self) -> None:
        """Let nothing pass from here on, in neither direction, without telling either end."""
        self._open.clear()

    def release(self) -> None:
        """Break the connections of before, what they held is gone; new ones pass."""
        self.cut()
        self._open.set()

    def cut(self) -> None:
        """Break all connections at once."""
        ends, self._ends = self._ends, []
        for end in ends:
            _close(end)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._listener.close()
        self.release()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return  # closed
            try:
                far = socket.create_connection(("127.0.0.1", self._port), timeout=1.0)
            except OSError:
                near.close()
                continue
            far.settimeout(None)
            self._ends += [near, far]
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self._forward, args=(source, sink), daemon=True).start()

    def _forward(self, source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):  # cut
            while piece := source.recv(PIECE):
                self._open.wait()
                sink.sendall(piece)
        for end in (source, sink):
            _close(end)


def _close(end: socket.socket) -> None:
    """Close a connection, also for the thread that waits in it."""
    with contextlib.suppress(OSError):  # it is closed already
        end.shutdown(socket.SHUT_RDWR)
    end.close()
