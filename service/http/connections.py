"""Accepts connections: a limited number per address, and never the last file descriptors of the process.

The event loop's own server has no such limits, and closes new connections silently when descriptors run out.
"""

import asyncio
import contextlib
import errno
import logging
import resource
import socket
import ssl
import sys
from collections import Counter
from collections.abc import Callable

from service.http.protocol import PATIENCE_S, HttpProtocol
from service.resilience.rate_limit import RateLimit

logger = logging.getLogger(__name__)

BACKLOG = 2048
AT_ONCE = 100
"""Largest number of connections accepted in one turn of the event loop."""
RESERVED = 32
"""Descriptors reserved for the database, the sources and the workers; a quarter when the limit is low."""
SHARE = 4
"""One address may hold the fraction 1/SHARE of the descriptors: it must not block the others."""
PAUSE_S = 1.0
"""Time for which new connections wait when descriptors run short [s]."""
LOG_INTERVAL_S = 60.0
SHORT = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class Acceptor:
    """Acceptor of a listening socket's connections. It is used on the event loop only."""

    def __init__(
        self,
        listener: socket.socket,
        protocol: Callable[[], HttpProtocol],
        *,
        tls: ssl.SSLContext | None,
        most: int,
        exempt: Callable[[str], bool],
    ) -> None:
        """Set the limits: `most` connections of one address at a time, handshakes included, unless the address is `exempt`."""
        self._listener = listener
        self._protocol = protocol
        self._tls = tls
        self._most = most
        self._exempt = exempt
        self._loop = asyncio.get_running_loop()
        self._open: Counter[str] = Counter()
        self._tasks: set[asyncio.Task[None]] = set()
        self._log_rate = RateLimit(per_s=1.0 / LOG_INTERVAL_S, burst=1.0)
        self._pause: asyncio.TimerHandle | None = None

    def start(self) -> None:
        """Begin to accept connections."""
        self._listener.setblocking(False)
        self._listener.listen(BACKLOG)
        self._loop.add_reader(self._listener, self._accept)

    def close(self) -> None:
        """Stop accepting connections; open ones go on."""
        self._loop.remove_reader(self._listener)
        if self._pause is not None:
            self._pause.cancel()

    def _accept(self) -> None:
        for _ in range(AT_ONCE):
            try:
                connection, peer = self._listener.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:
                if error.errno not in SHORT:
                    raise
                self._wait(str(error))
                return
            if connection.fileno() >= _last():  # descriptors count up from the lowest free number
                connection.close()
                self._wait("the last ones are for the rest of the service")
                return
            self._take(connection, peer[0])

    def _take(self, connection: socket.socket, address: str) -> None:
        most = min(self._most, _last() // SHARE)
        if self._open[address] >= most and not self._exempt(address):
            connection.close()
            if not self._log_rate.take(address):
                logger.warning("%s has %d connections open: further ones are closed", address, most)
            return
        self._open[address] += 1
        connection.setblocking(False)
        task = self._loop.create_task(self._count_until_closed(connection, address))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _count_until_closed(self, connection: socket.socket, address: str) -> None:
        """Count a connection from its acceptance to its end."""
        protocol = self._protocol()
        protocol.lost = self._loop.create_future()
        try:
            # A failed or unfinished handshake is the peer's fault, and not reported.
            with contextlib.suppress(OSError):
                await self._loop.connect_accepted_socket(
                    lambda: protocol,
                    connection,
                    ssl=self._tls,
                    ssl_handshake_timeout=PATIENCE_S if self._tls else None,
                )
                await protocol.lost
        finally:
            self._open[address] -= 1
            if not self._open[address]:
                del self._open[address]

    def _wait(self, reason: str) -> None:
        """Pause accepting: an immediate retry would fail again."""
        if not self._log_rate.take(""):
            logger.error(
                "file descriptors run short (%s), with %d connections of %d addresses open: new ones wait; "
                "raise the limit (LimitNOFILE=, ulimit -n) or find out who holds them",
                reason,
                self._open.total(),
                len(self._open),
            )
        self._loop.remove_reader(self._listener)
        self._pause = self._loop.call_later(PAUSE_S, self._loop.add_reader, self._listener, self._accept)


def _last() -> int:
    """Return the first descriptor that no connection gets."""
    allowed = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return sys.maxsize if allowed == resource.RLIM_INFINITY else allowed - min(RESERVED, allowed // 4)
