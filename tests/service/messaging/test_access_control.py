"""Real zenoh sessions over TLS with real certificates: a source publishes as itself, and nobody publishes as another."""

import re
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import pytest
import zenoh

from formats.wire.keys import ALL_LIVE, ALL_RECEIVED, ALL_SAMPLES, Key
from service.messaging.access_control import AccessUnusable, StreamAccess, StreamSecurity, read_access
from service.messaging.session import StreamUnusable, connected, session
from tests.end_to_end.processes import ROOT
from tests.plant import wait_until
from tests.ports import free_endpoint

OWN, OTHER = Key("plant-1", "pump-7"), Key("plant-1", "fan-2")
ACCESS = StreamAccess(
    sources={"edge-7": ["plant-1/pump-7"], "edge-2": ["plant-1/fan-2"]}, readers={"historian": ["plant-1/*"]}
)
QUIET_S = 0.7
"""So long nothing must come where something is refused: what is allowed comes within a few milliseconds."""

Open = Callable[[str], AbstractContextManager[zenoh.Session]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Certificates, as the script makes them, and those of another authority."""
    made = tmp_path_factory.mktemp("certificates")
    for names in (("authority",), ("service", "127.0.0.1", "localhost"), ("edge-7",), ("edge-2",), ("historian",), ("guest",)):
        certificate(made, *names)
    for names in (("authority",), ("edge-7",)):
        certificate(made / "foreign", *names)
    return made


def certificate(folder: Path, *names: str) -> None:
    subprocess.run([ROOT / "deploy" / "certificates.sh", folder, *names], check=True, capture_output=True, timeout=30)


def security(folder: Path, name: str, access: StreamAccess | None = None) -> StreamSecurity:
    return StreamSecurity(str(folder / "authority.crt"), str(folder / f"{name}.crt"), str(folder / f"{name}.key"), access)


@pytest.fixture(scope="module")
def endpoint() -> str:
    """Return where the service listens with TLS."""
    return free_endpoint().replace("tcp/", "tls/")


@pytest.fixture(scope="module")
def service(folder: Path, endpoint: str) -> Iterator[zenoh.Session]:
    """The service's side of the network."""
    with session(listen=[endpoint], connect=[], security=security(folder, "service", ACCESS)) as opened:
        yield opened


@pytest.fixture
def opened(service: zenoh.Session, folder: Path, endpoint: str) -> Open:
    """Opens somebody's side of the network, by their certificate."""
    assert service
    return lambda name: session(listen=[], connect=[endpoint], security=security(folder, name))


def heard(service: zenoh.Session, key: str) -> tuple[list[tuple[str, bytes]], AbstractContextManager[object]]:
    found: list[tuple[str, bytes]] = []
    return found, service.declare_subscriber(key, lambda one: found.append((str(one.key_expr), one.payload.to_bytes())))


def test_a_source_publishes_as_itself_and_as_nobody_else(service: zenoh.Session, opened: Open) -> None:
    found, subscriber = heard(service, ALL_SAMPLES)
    with subscriber, opened("edge-7") as source:
        wait_until(lambda: connected(source))
        wait_until(lambda: _put(source, OWN.samples, b"own") and (OWN.samples, b"own") in found)
        source.put(OTHER.samples, b"as another")
        source.put("rundown/v1/*/*/samples", b"as all")
        source.put(OWN.samples, b"last")
        wait_until(lambda: (OWN.samples, b"last") in found)
        time.sleep(QUIET_S)
        assert {key for key, _ in found} == {OWN.samples}
        assert {payload for _, payload in found} == {b"own", b"last"}


def test_what_the_service_needs_of_a_source_works(service: zenoh.Session, opened: Open) -> None:
    """Replays from its log, its sign of life, and how far it was received."""
    tokens: list[str] = []
    with (
        service.liveliness().declare_subscriber(ALL_LIVE, lambda one: tokens.append(str(one.key_expr)), history=True),
        service.declare_queryable(ALL_RECEIVED, lambda query: query.reply(query.key_expr, b"12")),
        opened("edge-7") as source,
        source.declare_queryable(OWN.log, lambda query: query.reply(OWN.log, b"what was missed")),
        source.declare_queryable(OTHER.log, lambda query: query.reply(OTHER.log, b"made up")),
        source.liveliness().declare_token(OWN.live),
        source.liveliness().declare_token(OTHER.live),
    ):
        wait_until(lambda: answers(service, OWN.log) == [b"what was missed"])
        assert answers(service, OTHER.log) == []
        wait_until(lambda: tokens == [OWN.live])
        wait_until(lambda: answers(source, OWN.received) == [b"12"])
        assert answers(source, OTHER.received) == []
        time.sleep(QUIET_S)
        assert tokens == [OWN.live]


def test_a_source_hears_nothing_of_others(service: zenoh.Session, opened: Open) -> None:
    """Of what the service says, which its readers hear."""
    with opened("edge-2") as eavesdropper, opened("historian") as reader:
        overheard, listening = heard(eavesdropper, "rundown/v1/**")
        told, reading = heard(reader, "rundown/v1/plant-1/*/alerts/*")
        with listening, reading:
            wait_until(lambda: connected(eavesdropper))
            wait_until(lambda: _put(service, f"rundown/v1/{OWN.plant}/{OWN.machine}/alerts/1", b"danger") and len(told) > 3)
            time.sleep(QUIET_S)
            assert overheard == []


def test_a_reader_hears_its_plant_and_publishes_nothing(service: zenoh.Session, opened: Open) -> None:
    found, subscriber = heard(service, "rundown/v1/**")
    alert = "rundown/v1/plant-1/pump-7/alerts/1"
    with subscriber, opened("historian") as reader:
        told, listening = heard(reader, "rundown/v1/plant-1/*/alerts/*")
        with listening:
            wait_until(lambda: _put(service, alert, b"danger") and bool(told))
            service.put("rundown/v1/plant-2/fan-1/alerts/2", b"of another plant")
            reader.put(OWN.samples, b"made up")
            time.sleep(QUIET_S)
            assert {key for key, _ in told} == {alert}
            assert {key for key, _ in found} == {alert, "rundown/v1/plant-2/fan-1/alerts/2"}


def test_a_certificate_that_nothing_is_said_of_does_nothing(service: zenoh.Session, opened: Open) -> None:
    found, subscriber = heard(service, "rundown/v1/**")
    with subscriber, opened("guest") as guest:
        wait_until(lambda: connected(guest))
        guest.put(OWN.samples, b"made up")
        time.sleep(QUIET_S)
        assert found == []


def test_without_a_certificate_of_the_authority_nobody_is_connected(
    service: zenoh.Session, folder: Path, endpoint: str
) -> None:
    assert service
    foreign = security(folder / "foreign", "edge-7")
    pretender = StreamSecurity(str(folder / "authority.crt"), foreign.certificate, foreign.key)
    for who in (foreign, pretender):
        with session(listen=[], connect=[endpoint], security=who) as outside:
            time.sleep(QUIET_S)
            assert not connected(outside)


def test_a_key_that_does_not_fit_its_certificate_is_found_at_once(folder: Path) -> None:
    wrong = StreamSecurity(str(folder / "authority.crt"), str(folder / "service.crt"), str(folder / "edge-7.key"))
    with pytest.raises(StreamUnusable), session(listen=[free_endpoint().replace("tcp/", "tls/")], connect=[], security=wrong):
        pass


def test_the_access_file_is_checked(tmp_path: Path) -> None:
    file = tmp_path / "access.yaml"
    file.write_text("sources:\n  edge-7: [plant-1/pump-7]\nrouters: [centre]\n")
    assert read_access(file) == StreamAccess(sources={"edge-7": ["plant-1/pump-7"]}, routers=["centre"])
    wide = "sources:\n  edge-7: [plant-1/**]"
    for wrong, words in ((wide, "sources.edge-7.0"), ("source: {}", "source"), ("[", "cannot be read")):
        file.write_text(wrong)
        with pytest.raises(AccessUnusable, match=words):
            read_access(file)


def answers(asking: zenoh.Session, key: str) -> list[bytes]:
    replies = asking.get(key, timeout=1.0, consolidation=zenoh.ConsolidationMode.NONE)
    return [one.ok.payload.to_bytes() for one in replies if one.ok is not None]


def _put(source: zenoh.Session, key: str, payload: bytes) -> bool:
    """Publish until the subscription is known to the source: what it publishes before goes nowhere."""
    source.put(key, payload)
    return True


@pytest.mark.parametrize("endpoint", ["router", "tcp/127.0.0.1", "tls/server:port"])
def test_what_is_no_endpoint_is_answered_with_how_one_is_written(endpoint: str) -> None:
    words = f"zenoh cannot be opened: '{endpoint}' is no endpoint; one is written as tcp/127.0.0.1:7447"
    with pytest.raises(StreamUnusable, match=f"^{re.escape(words)}$"), session(listen=[], connect=[endpoint]):
        pass
