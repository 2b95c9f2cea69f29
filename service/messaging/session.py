"""Opening zenoh sessions, with settings chosen by measurement."""

import json
import logging
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import zenoh

from service.messaging.access_control import StreamSecurity

logger = logging.getLogger(__name__)

ROUTER, PEER = "router", "peer"
ENDPOINT = re.compile(r"[^/\s]+/\S+")
"""An endpoint: protocol and address."""
OVER_NETWORK = ("tcp/", "tls/", "udp/", "quic/", "ws/", "wss/")
"""Beginnings of endpoints whose address ends with a port, perhaps before parameters."""
PORT = re.compile(r":\d+(?=$|[?#])")


class StreamUnusable(RuntimeError):
    """A zenoh session cannot be opened; the message names the endpoints and the cause."""


def open_session(
    *, listen: list[str], connect: list[str], routes: bool = False, security: StreamSecurity | None = None
) -> zenoh.Session:
    """Open a session: a router when it listens or `routes`, else a peer that keeps trying its endpoints.

    Two peers do not hear each other through a router between them; the service, which is reached through routers, therefore
    routes. security: certificates, and access rules where it listens. Raises StreamUnusable when an endpoint is malformed or
    cannot be listened on.
    """
    config = zenoh.Config()
    settings: dict[str, object] = {
        # A client would block in `open` until a router answers, and could not be interrupted; a peer tries in background.
        "mode": ROUTER if listen or routes else PEER,
        "listen/endpoints": listen,
        "connect/endpoints": connect,
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {"period_init_ms": 100, "period_max_ms": 1000, "period_increase_factor": 2},
        "listen/exit_on_failure": True,
        "scouting/multicast/enabled": False,
        # Shared memory silently loses samples of a lagging receiver.
        "transport/shared_memory/enabled": False,
        # Through an admin space (`@/**`) whoever reaches a session reads who is connected, and may change its settings.
        "adminspace/enabled": False,
    }
    if not connect:
        # A router waits this long for discovery before `open` returns.
        settings["scouting/delay"] = 0
    settings |= {} if security is None else security.configuration()
    if malformed := [one for one in (*listen, *connect) if not _is_endpoint(one)]:
        raise StreamUnusable(f"zenoh cannot be opened: '{malformed[0]}' is no endpoint; one is written as tcp/127.0.0.1:7447")
    try:
        for name, value in settings.items():
            config.insert_json5(name, json.dumps(value))
        return zenoh.open(config)
    except zenoh.ZError as error:
        where = ", ".join([f"listening on {e}" for e in listen] + [f"connecting to {e}" for e in connect])
        # The library's message ends with locations in its own source.
        reason = re.sub(r" at /\S+\.rs:\d+\.?", "", str(error))
        raise StreamUnusable(f"zenoh cannot be opened, {where or 'without endpoints'}: {reason}") from error


def _is_endpoint(text: str) -> bool:
    return bool(ENDPOINT.fullmatch(text) and (not text.startswith(OVER_NETWORK) or PORT.search(text)))


def connected(session: zenoh.Session) -> bool:
    """Return whether any other node is connected."""
    return bool(session.info.routers_zid() or session.info.peers_zid())


def wait_connected(session: zenoh.Session, endpoints: list[str], *, give_up: Callable[[float], bool]) -> bool:
    """Wait until the session is connected, logging now and then. `give_up(seconds)` pauses and returns whether to stop."""
    waited = 0.0
    while not connected(session):
        if waited % 5.0 < 0.2:
            logger.warning("no zenoh peer at %s yet, still trying", ", ".join(endpoints))
        if give_up(0.2):
            return False
        waited += 0.2
    return True


@contextmanager
def session(*, listen: list[str], connect: list[str], security: StreamSecurity | None = None) -> Iterator[zenoh.Session]:
    """Yield a session and close it at the end: one left open would hang the interpreter's exit."""
    opened = open_session(listen=listen, connect=connect, security=security)
    try:
        yield opened
    finally:
        opened.close()
