"""The part of the service: loaded only where configured, failing alone, and what settings say."""

import asyncio
import contextlib
import socket
import subprocess
import sys
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

import pytest

from service.configuration.settings import Settings, SettingsWrong, settings_of
from service.opcua.serving import OPENING, OpcUaServing
from service.security.exposure import Exposed, require_authentication
from storage.database.engine import Database
from tests.plant import wait_until
from tests.ports import free_port
from tests.service.opcua.certificates import Authority
from tests.service.opcua.second_stack import second_stack

RUBBISH = (
    b"\x00" * 100,
    b"GET / HTTP/1.1\r\n\r\n",
    b"HELF\xff\xff\xff\xff" + b"a" * 1000,
    b"MSGF\x10\0\0\0" + b"b" * 8,
)
LOOPBACK = "opc.tcp://127.0.0.1:{}"


def test_without_an_endpoint_the_library_is_not_loaded() -> None:
    """Its memory, some 100 MB with the standard's address space, is spent only where it is asked for."""
    script = "import sys\nfrom service.commands import service_threads\nassert 'asyncua' not in sys.modules, 'loaded'\n"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.long
def test_a_port_that_is_taken_is_the_parts_trouble_until_it_is_free(database: Database) -> None:
    port = free_port()
    settings = Settings(opcua_listen=LOOPBACK.format(port), opcua_allow_unencrypted=True)
    first, second = OpcUaServing(database, settings), OpcUaServing(database, settings)
    first.start()
    wait_until(lambda: first.ready and first.trouble is None)
    second.start()
    try:
        wait_until(lambda: second.trouble not in (None, OPENING))
        assert second.trouble is not None
        assert f"nothing can listen at opc.tcp://127.0.0.1:{port}" in second.trouble
        assert second.alive
        assert first.trouble is None
        assert second.gauges == {"rundown_opcua_sessions": 0, "rundown_opcua_monitored_items": 0}
    finally:
        second.stop()
        first.stop()


def test_an_own_certificate_that_has_expired_is_said(database: Database, tmp_path: Path) -> None:
    authority = Authority(tmp_path)
    certificate, key = authority.issue("server", "urn:rundown:test", ends=timedelta(days=-1))
    settings = Settings(
        opcua_listen=LOOPBACK.format(free_port()),
        opcua_certificate=str(certificate),
        opcua_key=str(key),
        opcua_trusted=str(authority.trusted),
    )
    serving = OpcUaServing(database, settings)
    serving.start()
    try:
        wait_until(lambda: serving.trouble not in (None, OPENING))
        assert "expired at" in str(serving.trouble)
    finally:
        serving.stop()


@pytest.mark.long
def test_a_certificate_that_expires_meanwhile_is_said_and_a_new_one_taken(database: Database, tmp_path: Path) -> None:
    authority = Authority(tmp_path)
    certificate, key = authority.issue("server", "urn:rundown:test", ends=timedelta(seconds=25))
    settings = Settings(
        opcua_listen=LOOPBACK.format(free_port()),
        opcua_certificate=str(certificate),
        opcua_key=str(key),
        opcua_trusted=str(authority.trusted),
    )
    serving = OpcUaServing(database, settings)
    serving.start()
    try:
        wait_until(lambda: serving.ready, seconds=24.0)
        wait_until(lambda: "expired at" in str(serving.trouble), seconds=40.0)
        assert not serving.ready
        assert serving.alive
        renewed, renewed_key = authority.issue("renewed", "urn:rundown:test")
        renewed_key.replace(key)
        renewed.replace(certificate)
        wait_until(lambda: serving.ready and serving.trouble is None, seconds=40.0)
    finally:
        serving.stop()


def test_where_no_credentials_are_needed_a_client_is_whom_it_says(database: Database, tmp_path: Path) -> None:
    endpoint = LOOPBACK.format(free_port())
    serving = OpcUaServing(database, Settings(opcua_listen=endpoint, opcua_allow_unencrypted=True))
    serving.start()
    try:
        wait_until(lambda: serving.ready)
        with second_stack(endpoint, tmp_path, application="urn:second-stack:client") as client:
            assert client.ask("browse", node="ns=2;i=1") == {"status": "Good", "names": []}
            assert serving.gauges["rundown_opcua_sessions"] == 1
    finally:
        serving.stop()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"opcua_listen": "http://x:1", "opcua_allow_unencrypted": True}, "opc.tcp://HOST:PORT"),
        ({"opcua_listen": "opc.tcp://127.0.0.1:99999", "opcua_allow_unencrypted": True}, "opc.tcp://HOST:PORT"),
        ({"opcua_listen": "opc.tcp://127.0.0.1:4840"}, "opcua_allow_unencrypted"),
        ({"opcua_certificate": "a.pem"}, "all three, or none"),
        ({"role": "opcua", "database": "postgresql+psycopg://x/y"}, "opcua_listen"),
    ],
)
def test_settings_that_cannot_be_meant_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsWrong, match=words.replace(".", r"\.")):
        settings_of(**given)


def test_open_to_the_network_without_keys_it_does_not_start() -> None:
    settings = Settings(opcua_listen="opc.tcp://0.0.0.0:4840", opcua_allow_unencrypted=True)
    with pytest.raises(Exposed, match="anybody could acknowledge alerts"):
        require_authentication(settings, keys_are_there=False)
    assert require_authentication(settings, keys_are_there=True) == []


@pytest.fixture
def unencrypted(database: Database) -> Iterator[tuple[int, OpcUaServing]]:
    """A server without security, and its port."""
    port = free_port()
    serving = OpcUaServing(database, Settings(opcua_listen=LOOPBACK.format(port), opcua_allow_unencrypted=True))
    serving.start()
    try:
        wait_until(lambda: serving.ready and serving.trouble is None)
        yield port, serving
        assert serving.trouble is None
    finally:
        serving.stop()


def test_who_announces_more_than_was_agreed_on_is_cut_off(unencrypted: tuple[int, OpcUaServing], tmp_path: Path) -> None:
    """Two gigabytes, of which the library would keep what comes of them, from anybody."""
    port, _ = unencrypted
    with socket.create_connection(("127.0.0.1", port)) as stranger:
        stranger.settimeout(20.0)
        stranger.sendall(b"MSGC" + (2**31).to_bytes(4, "little"))
        with pytest.raises((ConnectionResetError, BrokenPipeError)):
            stranger.sendall(bytes(64 * 2**20))
    with second_stack(LOOPBACK.format(port), tmp_path, application="urn:second-stack:client") as client:
        assert client.ask("browse", node="ns=2;i=1")["status"] == "Good"


def test_who_only_holds_connections_keeps_others_of_other_addresses_out_of_nothing(
    unencrypted: tuple[int, OpcUaServing], tmp_path: Path
) -> None:
    port, _ = unencrypted
    with contextlib.ExitStack() as held:
        strangers = []
        for _ in range(120):
            one = socket.create_connection(("127.0.0.1", port), source_address=("127.0.0.2", 0))
            strangers.append(held.enter_context(one))

        def refused() -> int:
            return sum(_is_closed(one) for one in strangers)

        wait_until(lambda: refused() >= 100)
        assert refused() == 100, "twenty of an address may be on their way in"
        with second_stack(LOOPBACK.format(port), tmp_path, application="urn:second-stack:client") as client:
            assert client.ask("browse", node="ns=2;i=1")["status"] == "Good"


def _is_closed(one: socket.socket) -> bool:
    one.setblocking(False)
    try:
        return one.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True


@pytest.mark.long
def test_strange_bytes_end_their_own_connection_only(unencrypted: tuple[int, OpcUaServing], tmp_path: Path) -> None:
    port, _ = unencrypted

    async def throw(content: bytes) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(content)
        await writer.drain()
        await asyncio.sleep(0.1)
        writer.close()
        del reader

    for content in RUBBISH:
        asyncio.run(throw(content))
    with second_stack(LOOPBACK.format(port), tmp_path, application="urn:second-stack:client") as client:
        assert client.ask("browse", node="ns=2;i=1")["status"] == "Good"
