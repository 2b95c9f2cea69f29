"""Peers that send no HTTP, too much of it or too little, over real sockets: each is told so and let go of."""

import json
import socket
import threading
import time
from collections.abc import Iterator

import pytest

from benchmarks.serving import served
from service.http import protocol
from service.http.protocol import LARGEST_HEAD
from storage.database.engine import Database

BEGUN = b"GET /api/v1/alive HTTP/1.1\r\nHost: here\r\n"
WHOLE = BEGUN + b"\r\n"


@pytest.fixture
def base(database: Database) -> Iterator[str]:
    """Yield where a server listens."""
    with served(database) as url:
        yield url


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> float:
    """Return how long a request may take [s]."""
    monkeypatch.setattr(protocol, "PATIENCE_S", 0.5)
    return 0.5


def opened(base: str) -> socket.socket:
    """A connection."""
    host, _, port = base.removeprefix("http://").split("/")[0].partition(":")
    return socket.create_connection((host, int(port)), timeout=10)


def rest(client: socket.socket) -> bytes:
    """Return what comes until the server closes."""
    came = b""
    try:
        while part := client.recv(65536):
            came += part
    except ConnectionResetError:
        return came  # it closed while we still sent
    return came


def problem(answer: bytes) -> tuple[int, str]:
    """Status and detail; a problem document it must be, with the headers that all answers have."""
    head, _, body = answer.partition(b"\r\n\r\n")
    lines = head.decode().split("\r\n")
    headers = dict(line.lower().split(": ", 1) for line in lines[1:])
    assert headers["content-type"] == "application/problem+json"
    assert headers["x-content-type-options"] == "nosniff"
    assert int(headers["content-length"]) == len(body)
    said = json.loads(body)
    assert said["status"] == int(lines[0].split()[1])
    return said["status"], said["detail"]


@pytest.mark.parametrize(
    "sent",
    [
        b"hello\r\n\r\n",
        b"GET / HTTP/9\r\n\r\n",
        b"GET /\x00 HTTP/1.1\r\n\r\n",
        BEGUN + b"no colon\r\n\r\n",
        # What a proxy may take for another header, or for another request, than we would.
        BEGUN + b"Authorization : Bearer x\r\n\r\n",
        BEGUN + b"Authorization: Bearer x\r\n\ty\r\n\r\n",
        BEGUN + b"Authorization: Bearer x\x00\r\n\r\n",
        BEGUN + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n",
        BEGUN + b"Content-Length: 5\r\nContent-Length: 6\r\n\r\n",
    ],
)
def test_what_is_no_http_is_told_so_as_a_problem(base: str, sent: bytes) -> None:
    with opened(base) as client:
        client.sendall(sent)
        status, detail = problem(rest(client))
    assert status == 400
    assert "no HTTP/1.1 request" in detail


@pytest.mark.parametrize("hosts", [b"", b"Host: here\r\nHost: there\r\n"], ids=["none", "two"])
def test_a_request_names_one_host(base: str, hosts: bytes) -> None:
    with opened(base) as client:
        client.sendall(b"GET /api/v1/alive HTTP/1.1\r\n" + hosts + b"\r\n")
        status, detail = problem(rest(client))
    assert (status, "Host" in detail) == (400, True)


def test_http_1_0_needs_no_host(base: str) -> None:
    with opened(base) as client:
        client.sendall(b"GET /api/v1/alive HTTP/1.0\r\n\r\n")
        assert rest(client).startswith(b"HTTP/1.1 200")


@pytest.mark.parametrize("end", [b"", b"\r\n\r\n"], ids=["endless", "whole"])
@pytest.mark.parametrize("line", [b"X: " + b"a" * 300, b"a" * 300], ids=["headers", "one header"])
def test_a_head_has_a_bound(base: str, line: bytes, end: bytes) -> None:
    separator = b"\r\n" if line.startswith(b"X") else b""
    head = BEGUN + (b"" if separator else b"X: ") + separator.join([line] * (LARGEST_HEAD // 250)) + end
    with opened(base) as client:
        client.sendall(head)
        status, detail = problem(rest(client))
    assert status == 431
    assert str(LARGEST_HEAD) in detail


def test_a_large_head_within_the_bound_is_read(base: str) -> None:
    with opened(base) as client:
        client.sendall(BEGUN + b"X: " + b"a" * (LARGEST_HEAD - 1000) + b"\r\n\r\n")
        assert client.recv(65536).startswith(b"HTTP/1.1 200")


@pytest.mark.parametrize(
    "sent",
    [BEGUN, b"PUT /api/v1/machines/m HTTP/1.1\r\nHost: here\r\nContent-Length: 100\r\n\r\n{"],
    ids=["head", "body"],
)
def test_a_request_that_never_ends_is_let_go_of(base: str, impatient: float, sent: bytes) -> None:
    with opened(base) as client:
        client.sendall(sent)
        began = time.monotonic()
        answer = rest(client)
        took = time.monotonic() - began
    status, _ = problem(answer)
    assert status == 408
    assert impatient / 2 < took < impatient + 5


def test_a_peer_that_says_nothing_is_let_go_of(base: str, impatient: float) -> None:
    with opened(base) as client:
        assert rest(client) == b""
    assert impatient > 0


def test_an_answered_peer_that_begins_again_and_never_ends_is_let_go_of(base: str, impatient: float) -> None:
    with opened(base) as client:
        client.sendall(WHOLE)
        assert client.recv(65536).startswith(b"HTTP/1.1 200")
        client.sendall(b"\r\n")  # which ends the library's own patience
        began = time.monotonic()
        rest(client)
        assert time.monotonic() - began < impatient + 5


def test_a_slow_request_that_goes_on_is_read(base: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(protocol, "PATIENCE_S", 0.2)
    monkeypatch.setattr(protocol, "SLOWEST", 20.0)
    with opened(base) as client:
        for part in range(0, len(WHOLE), 5):
            client.sendall(WHOLE[part : part + 5])
            time.sleep(0.1)
        assert client.recv(65536).startswith(b"HTTP/1.1 200")


def test_requests_sent_ahead_are_all_answered(base: str) -> None:
    with opened(base) as client:
        client.sendall(WHOLE * 3)
        came = b""
        while came.count(b"HTTP/1.1 200") < 3:
            part = client.recv(65536)
            assert part, came
            came += part


def test_what_was_asked_before_is_answered_before_a_refusal(base: str) -> None:
    with opened(base) as client:
        client.sendall(WHOLE * 2 + b"junk\r\n\r\n")
        came = rest(client)
    assert came.count(b"HTTP/1.1 200") == 2
    assert problem(came[came.index(b"HTTP/1.1 400") :])[0] == 400


def test_thousands_of_requests_sent_ahead_are_no_large_head(base: str) -> None:
    count = 3 * LARGEST_HEAD // len(WHOLE)
    with opened(base) as client:
        sender = threading.Thread(target=client.sendall, args=[WHOLE * count + WHOLE[:10]])
        sender.start()
        came = 0
        left = b""
        while came < count:
            part = client.recv(2**20)
            assert part, f"{came} of {count}"
            left += part
            came += left.count(b"HTTP/1.1 200")
            left = left[-11:] if b"HTTP/1.1 200" not in left[-11:] else b""
        sender.join()


def test_a_body_that_comes_after_its_answer_does_not_keep_a_connection(base: str, impatient: float) -> None:
    with opened(base) as client:
        client.sendall(b"GET /api/v1/alive HTTP/1.1\r\nHost: here\r\nContent-Length: 2\r\n\r\n")
        assert client.recv(65536).startswith(b"HTTP/1.1 200")
        client.sendall(b"{}")
        began = time.monotonic()
        assert rest(client) == b""
        assert time.monotonic() - began < impatient + 5


def test_half_a_request_does_not_end_a_stream(plant: Database, impatient: float) -> None:
    with served(plant) as base, opened(base) as client:
        client.sendall(b"GET /api/v1/alert-events/stream HTTP/1.1\r\nHost: here\r\n\r\n")
        assert client.recv(65536).startswith(b"HTTP/1.1 200")
        client.sendall(BEGUN)
        client.settimeout(4 * impatient)
        with pytest.raises(TimeoutError):  # it goes on
            rest(client)
