"""Whoever reaches the service's zenoh session on loopback cannot ask or change it through zenoh's admin space."""

import json
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
import zenoh

from service.messaging.session import open_session
from tests.plant import wait_until
from tests.ports import free_port


@contextmanager
def listening(port: int, *, admin_space: bool) -> Iterator[zenoh.Session]:
    """The service's session, or one like it with an admin space: what a look at it would find."""
    endpoint = f"tcp/127.0.0.1:{port}"
    if admin_space:
        config = zenoh.Config()
        wanted = {"mode": "router", "listen/endpoints": [endpoint], "adminspace": {"enabled": True}, "scouting/delay": 0}
        for name, value in (wanted | {"scouting/multicast/enabled": False}).items():
            config.insert_json5(name, json.dumps(value))
        opened = zenoh.open(config)
    else:
        opened = open_session(listen=[endpoint], connect=[])
    try:
        yield opened
    finally:
        opened.close()


@pytest.mark.parametrize("admin_space", [False, True])
def test_nobody_asks_the_service_who_is_connected(admin_space: bool) -> None:
    port = free_port()
    with listening(port, admin_space=admin_space) as service:
        attacker = open_session(listen=[], connect=[f"tcp/127.0.0.1:{port}"])
        try:
            wait_until(lambda: bool(attacker.info.routers_zid()))
            found = [str(reply.ok.key_expr) for reply in attacker.get("@/**", timeout=2.0) if reply.ok is not None]
            assert any(one.startswith(f"@/{service.zid()}/") for one in found) == admin_space, found
        finally:
            attacker.close()
