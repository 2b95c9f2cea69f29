"""Half-open connections without end: so many of one address are held, and where file descriptors run short it is said."""

import contextlib
import resource
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from benchmarks.serving import serving
from service.api.application import application
from service.http import connections
from storage.database.engine import Database
from tests.end_to_end.processes import ROOT, Service, python, until

MOST = 5
ALIVE = "/api/v1/alive"
HELLO = b"\x16\x03\x01\x02\x00"
"""Of a TLS handshake the head of the first record."""
WITH_DESCRIPTORS = """
import os, resource, sys
resource.setrlimit(resource.RLIMIT_NOFILE, (int(sys.argv[1]), int(sys.argv[1])))
os.execv(sys.executable, [sys.executable, *sys.argv[2:]])
"""


class ServiceOfFewDescriptors(Service):
    """A service that may hold 160 file descriptors; the tests' own process, which may hold more already, keeps its limit."""

    def started(self) -> contextlib.AbstractContextManager[subprocess.Popen[bytes]]:
        """Start the service with few descriptors."""
        flags = ["--database", self.database, "--port", str(self.port), "--zenoh-listen", self.endpoint]
        return python(self.log, "-c", WITH_DESCRIPTORS, "160", "-m", "service", "serve", *flags)


def port_of(base: str) -> int:
    return int(base.removeprefix("http://").split("/")[0].partition(":")[2])


@contextlib.contextmanager
def half_open(port: int, count: int, source: str = "127.0.0.1", sent: bytes = b"GET / ") -> Iterator[list[socket.socket]]:
    """Connections of an address on which something begins and does not end."""
    with contextlib.ExitStack() as held:
        made = []
        for _ in range(count):
            one = socket.create_connection(("127.0.0.1", port), timeout=10, source_address=(source, 0))
            made.append(held.enter_context(one))
            with contextlib.suppress(ConnectionError):
                one.sendall(sent)
        yield made


def closed(connection: socket.socket) -> bool:
    """Return whether the server let go of it."""
    connection.settimeout(0.05)
    try:
        return connection.recv(1) == b""
    except TimeoutError:
        return False
    except ConnectionError:
        return True


def test_one_address_holds_so_many_connections(database: Database, caplog: pytest.LogCaptureFixture) -> None:
    with serving(application(database, dict), connections_per_address=MOST) as base:
        with half_open(port_of(base), MOST + 20) as held:
            assert until(lambda: sum(map(closed, held)) == 20, within_s=20, what="what is too many is closed")
            with half_open(port_of(base), 1, source="127.0.0.2") as others:
                assert not closed(others[0])
        said = [record for record in caplog.records if "connections open" in record.getMessage()]
        assert [record.getMessage() for record in said] == ["127.0.0.1 has 5 connections open: further ones are closed"]
        assert until(lambda: answers(base), within_s=10, what="they have ended, and others may come")


def test_of_few_descriptors_one_address_gets_a_part_and_others_are_answered_at_once(tmp_path: Path) -> None:
    service = ServiceOfFewDescriptors(tmp_path)
    with contextlib.closing(service.client), service.running(), half_open(service.port, 200, "127.0.0.2"):
        assert service.client.get("/alive", timeout=2.0).status_code == 200
        with httpx.Client(base_url=f"http://127.0.0.1:{service.port}", timeout=2.0) as another:
            assert another.get(ALIVE).status_code == 200
    assert "127.0.0.2 has 32 connections open: further ones are closed" in service.log.read_text()


def answers(base: str) -> bool:
    with contextlib.suppress(httpx.TransportError):
        return httpx.get(f"{base}/alive").status_code == 200
    return False


def test_handshakes_that_do_not_end_count_and_trusted_proxies_may_have_more(tmp_path: Path) -> None:
    script = ROOT / "deploy" / "certificates.sh"
    for names in (("authority",), ("service", "127.0.0.1")):
        subprocess.run([script, tmp_path, *names], check=True, capture_output=True, timeout=30)
    service = Service(
        tmp_path,
        RUNDOWN_TLS_CERTIFICATE=str(tmp_path / "service.crt"),
        RUNDOWN_TLS_KEY=str(tmp_path / "service.key"),
        RUNDOWN_CONNECTIONS_PER_ADDRESS=str(MOST),
        RUNDOWN_TRUSTED_PROXIES='["127.0.0.3"]',
    )
    service.client.close()
    context = ssl.create_default_context(cafile=tmp_path / "authority.crt")
    with service.started(), httpx.Client(base_url=f"https://127.0.0.1:{service.port}", verify=context) as client:
        until(lambda: answers_over(client), within_s=30, what="the service answers over TLS")
        with (
            half_open(service.port, MOST + 20, "127.0.0.2", HELLO) as held,
            half_open(service.port, MOST + 20, "127.0.0.3", HELLO) as proxied,
        ):
            assert until(lambda: sum(map(closed, held)) == 20, within_s=20, what="what is too many is closed")
            assert client.get(ALIVE).status_code == 200
            assert not any(map(closed, proxied))
    assert "Traceback" not in service.log.read_text()


def answers_over(client: httpx.Client) -> bool:
    with contextlib.suppress(httpx.TransportError):
        return client.get(ALIVE).status_code == 200
    return False


def test_where_descriptors_run_short_it_is_said_and_the_last_are_left(
    database: Database, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "PAUSE_S", 0.1)
    monkeypatch.setattr(connections, "PATIENCE_S", 0.5)
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with serving(application(database, dict), connections_per_address=10_000) as base:
        free = lowest_free()
        resource.setrlimit(resource.RLIMIT_NOFILE, (free + 60, before[1]))
        try:
            with contextlib.ExitStack() as held:
                for number in range(2, 6):  # each connection takes two here: this process is the client as well
                    held.enter_context(half_open(port_of(base), 5, f"127.0.0.{number}"))
                until(lambda: "file descriptors run short" in caplog.text, within_s=10, what="it is said")
                assert lowest_free() < free + 60
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        assert until(lambda: answers(base), within_s=10, what="it answers again")
    assert caplog.text.count("file descriptors run short") == 1


def lowest_free() -> int:
    with socket.socket() as one:
        return one.fileno()


def test_where_there_is_none_left_new_connections_wait(
    database: Database, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """accept fails with EMFILE: the connection stays in the kernel's queue, and is answered later."""
    monkeypatch.setattr(connections, "PAUSE_S", 0.1)
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with serving(application(database, dict)) as base:
        assert answers(base)
        with socket.create_connection(("127.0.0.1", port_of(base)), timeout=10) as first:
            until(lambda: not closed(first), within_s=5, what="the first is taken")
            with socket.socket() as client:
                client.settimeout(10)
                resource.setrlimit(resource.RLIMIT_NOFILE, (client.fileno() + 1, before[1]))
                try:
                    client.connect(("127.0.0.1", port_of(base)))
                    client.sendall(f"GET {ALIVE} HTTP/1.1\r\nHost: here\r\n\r\n".encode())
                    until(lambda: "file descriptors run short" in caplog.text, within_s=10, what="it is said")
                    time.sleep(0.3)
                finally:
                    resource.setrlimit(resource.RLIMIT_NOFILE, before)
                assert client.recv(100).startswith(b"HTTP/1.1 200")
