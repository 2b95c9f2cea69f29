"""Reads HTTP requests from the network; malformed, oversized and too slow ones are refused, and the connection closed.

The server library has no such limits: a peer without credentials could exhaust memory and connections.
"""

import asyncio
from http import HTTPStatus

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from service.http.problem import problem_response
from service.http.security_headers import ALWAYS, NO_STORE

LARGEST_HEAD = 64 * 1024
"""Largest size of a request's line and headers together [B]; browsers and proxies send some kilobytes at most."""
PATIENCE_S = 20.0
"""Time within which a whole request must arrive [s], extended for requests that keep the least rate."""
SLOWEST = 500.0
"""Least rate of requests that take longer [B/s]."""


_TOO_LARGE = f"a request's line and headers may have {LARGEST_HEAD} bytes together: send what is long in the body"
_TOO_SLOW = (
    f"the request did not come whole: it may take {PATIENCE_S:.0f} s, or longer if {SLOWEST:.0f} bytes come in every second"
)


_UNREADABLE = "this is no HTTP/1.1 request: a line, a header or a chunk of it is wrong, or it is TLS or another protocol"
_NO_HOST = "a request has one Host header (RFC 9112, section 3.2)"


class HeadRefused(ValueError):
    """A head that is refused, with status and detail; raised to stop the parser."""


class HttpProtocol(HttpToolsProtocol):
    """A connection with limits of size and time."""

    _timer: asyncio.TimerHandle | None = None
    _waits = False
    """Set while a request is awaited or being received."""
    _begun = False
    """Set once a part of this request has arrived."""
    _in_head = True
    _since = 0.0
    _came = 0
    """Bytes of this request, without those that may belong to an earlier one."""
    _completed = 0
    """Number of requests received whole."""
    _fault = (HTTPStatus.BAD_REQUEST, _UNREADABLE)
    """Status and detail to answer when the parser stops."""
    _refusal: tuple[HTTPStatus, str] | None = None
    """Refusal to send once earlier requests have their answers."""
    lost: asyncio.Future[None] | None = None
    """Future that completes when the connection ends."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin with a time limit: a peer that sends nothing may not stay."""
        super().connection_made(transport)
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Release the connection."""
        self._stop_waiting()
        super().connection_lost(exc)
        if self.lost is not None and not self.lost.done():
            self.lost.set_result(None)

    def data_received(self, data: bytes) -> None:
        """Pass data to the parser and check the limits."""
        if self._refusal is not None:
            return
        if not self._waits and not self._is_responding():
            self._wait()
        before = self._completed
        super().data_received(data)
        if self._completed == before:
            self._received_bytes += len(data)
        if self._waits and self._in_head and self._received_bytes > LARGEST_HEAD and not self.transport.is_closing():
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE, _TOO_LARGE)

    def on_message_begin(self) -> None:
        """Begin a request."""
        super().on_message_begin()
        self._wait()
        self._begun = True

    def on_headers_complete(self) -> None:
        """Check the head of a request. Raises HeadRefused."""
        if len(self.url) + sum(len(name) + len(value) for name, value in self.headers) > LARGEST_HEAD:
            self._fault = HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE, _TOO_LARGE
            raise HeadRefused(*self._fault)
        if self.parser.get_http_version() == "1.1" and [name for name, _ in self.headers].count(b"host") != 1:
            self._fault = HTTPStatus.BAD_REQUEST, _NO_HOST
            raise HeadRefused(*self._fault)
        self._in_head = False
        super().on_headers_complete()

    def on_message_complete(self) -> None:
        """Finish receiving a request. If it was answered already, begin to wait for the next one."""
        self._completed += 1
        self._stop_waiting()
        super().on_message_complete()
        if not self._is_responding():
            self._wait()

    def on_response_complete(self) -> None:
        """Answer the next request in the queue, or refuse it."""
        super().on_response_complete()
        if self._refusal is not None and not self._is_responding() and not self.transport.is_closing():
            self._refuse(*self._refusal)

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002 - the library says the same of everything
        """Refuse a request that the parser could not read."""
        self._refuse(*self._fault)

    def _is_responding(self) -> bool:
        return self.cycle is not None and not self.cycle.response_complete

    def _wait(self) -> None:
        """Begin to wait for a request."""
        self._waits, self._begun, self._in_head = True, False, True
        self._since, self._received_bytes = self.loop.time(), 0
        if self._timer is None:
            self._timer = self.loop.call_later(PATIENCE_S, self._check_timeout)

    def _stop_waiting(self) -> None:
        self._waits = False
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _check_timeout(self) -> None:
        """Disconnect a peer that took too long. While reading is paused, the delay is not the peer's."""
        self._timer = None
        left = self._since + PATIENCE_S + self._received_bytes / SLOWEST - self.loop.time()
        if left > 0 or self.flow.read_paused:
            self._timer = self.loop.call_later(max(left, 1.0), self._check_timeout)
        elif self._begun:
            self._refuse(HTTPStatus.REQUEST_TIMEOUT, _TOO_SLOW)
        else:
            self.transport.close()

    def _refuse(self, status: HTTPStatus, detail: str) -> None:
        """Answer without the application, and close the connection."""
        if self._is_responding() and self._in_head:
            self._refusal = status, detail
            self._stop_waiting()
            return
        if not (self._is_responding() and self.cycle.response_started):
            answer = problem_response(status, detail, {"Connection": "close"})
            headers = [*answer.raw_headers, *ALWAYS, NO_STORE]
            lines = [f"HTTP/1.1 {status} {status.phrase}".encode(), *(b": ".join(one) for one in headers)]
            self.transport.write(b"\r\n".join([*lines, b"", bytes(answer.body)]))
        self.transport.close()
