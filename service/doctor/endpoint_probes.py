"""Probes the endpoints of a running service: they must answer a stranger as the settings say."""

import socket
import ssl
from collections.abc import Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Literal
from urllib.parse import urlsplit

import httpx

from service.api.application import every_operation
from service.configuration.settings import Settings
from service.doctor.exposed_endpoints import ENCRYPTED
from service.doctor.own_addresses import api_trust, api_url, endpoint_here

PATIENCE_S = 5.0
ProbeLevel = Literal["ok", "not tried", "open"]


@dataclass(frozen=True)
class ProbeResult:
    """Result of one probe."""

    level: ProbeLevel
    what: str
    words: str


def probe_endpoints(settings: Settings, *, asked: bool, url: str | None = None) -> Iterator[ProbeResult]:
    """Probe every endpoint without changing anything. asked: whether credentials are needed; url: address of the API."""
    yield from _api(settings, asked=asked, url=url or api_url(settings))
    for endpoint in settings.zenoh_listen:
        if endpoint.partition("/")[0] in ENCRYPTED and settings.zenoh_tls_ca:
            yield _without_certificate(endpoint)


def _api(settings: Settings, *, asked: bool, url: str) -> Iterator[ProbeResult]:
    """Probe all readable paths that need credentials, without any."""
    what = "REST API without credentials"
    paths = [
        one.path
        for one in every_operation()
        if "GET" in one.methods and one.requirement.role is not None and "{" not in one.path
    ]
    answers: dict[str, int] = {}
    try:
        with httpx.Client(base_url=url, timeout=PATIENCE_S, verify=api_trust(settings), trust_env=False) as client:
            for path in paths:
                with client.stream("GET", path) as answer:  # some never end: how they begin is enough
                    answers[path] = answer.status_code
                if not asked:
                    break
    except (httpx.TransportError, ssl.SSLError) as error:
        yield ProbeResult("not tried", what, f"nothing answers at {url}: {error}")
        return
    given = [path for path, status in answers.items() if status < HTTPStatus.BAD_REQUEST]
    if given and asked:
        yield ProbeResult("open", what, f"{url} answers anybody: {', '.join(given)}; is it started with other settings?")
    elif given:
        yield ProbeResult("ok", what, f"GET {given[0]} is answered, as nobody needs any")
    elif set(answers.values()) == {HTTPStatus.UNAUTHORIZED}:
        yield ProbeResult("ok", what, f"{len(answers)} of {len(paths)} paths that can be read are answered 401")
    else:
        other = {path: status for path, status in answers.items() if status != HTTPStatus.UNAUTHORIZED}
        yield ProbeResult("not tried", what, f"neither given nor refused: {other}")


def _without_certificate(endpoint: str) -> ProbeResult:
    """Try a TLS handshake without a certificate; a TLS 1.3 server shows its refusal only at the first read."""
    what = f"{endpoint} without a certificate"
    where = urlsplit("//" + endpoint_here(endpoint).partition("/")[2])
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    try:
        plain = socket.create_connection((where.hostname or "", where.port or 0), timeout=PATIENCE_S)
    except OSError as error:
        return ProbeResult("not tried", what, f"nothing answers: {error}")
    try:
        with plain, context.wrap_socket(plain) as secured:
            refused = secured.recv(1) == b""
    except TimeoutError:
        refused = False
    except OSError:
        refused = True
    return ProbeResult("ok", what, "is refused") if refused else ProbeResult("open", what, "is let in: anybody could connect")
