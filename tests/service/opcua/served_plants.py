"""A running OPC UA server with an authority, certificates and keys of people of two plants."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from service.configuration.settings import Settings
from service.opcua.serving import OPENING, OpcUaServing
from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from tests.plant import KEY, wait_until
from tests.ports import free_port
from tests.service.opcua.certificates import Authority
from tests.service.security.two_plants import HIDDEN_PLANT, Ids

SECURITY = "Basic256Sha256"
CLIENT = "urn:second-stack:client"


@dataclass
class ServedPlants:
    """A server, what its two plants have, and who may do what there."""

    serving: OpcUaServing
    settings: Settings
    endpoint: str
    harbour: Ids
    orchard: Ids
    authority: Authority
    keys: dict[str, str] = field(default_factory=dict)

    def client(self, name: str, **certificate: Any) -> dict[str, Any]:
        """Return a client that connects. certificate: what is other than usual about theirs."""
        file, key = self.authority.issue(f"{name}-{len(certificate)}", CLIENT, **certificate)
        how = {"user": name, "password": self.keys[name], "security": SECURITY, "application": CLIENT}
        return how | {"certificate": str(file), "key": str(key)}


def add_key(database: Database, name: str, role: Role, plants: list[str] | None, days: float = 1.0) -> tuple[str, str]:
    """Make a key; its prefix and its text."""
    with database.transaction() as session:
        row, text = api_keys.create(session, name=name, role=role, plants=plants, days=days)
        return row.prefix, text


@contextmanager
def served_plants(database: Database, folder: Path, harbour: Ids, orchard: Ids) -> Iterator[ServedPlants]:
    """Yield a server over a store until the block ends."""
    authority = Authority(folder)
    certificate, key = authority.issue("server", "urn:rundown:test")
    endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
    settings = Settings(
        opcua_listen=endpoint, opcua_certificate=str(certificate), opcua_key=str(key), opcua_trusted=str(authority.trusted)
    )
    people = {
        "operator": (Role.OPERATOR, [KEY.plant]),
        "viewer": (Role.VIEWER, [KEY.plant]),
        "stranger": (Role.OPERATOR, [HIDDEN_PLANT]),
        "everywhere": (Role.OPERATOR, None),
        "probe": (Role.SOURCE, [KEY.plant]),
    }
    keys = {name: add_key(database, name, role, plants)[1] for name, (role, plants) in people.items()}
    serving = OpcUaServing(database, settings)
    serving.start()
    try:
        wait_until(lambda: serving.trouble != OPENING)
        assert serving.trouble is None, serving.trouble
        yield ServedPlants(serving, settings, endpoint, harbour, orchard, authority, keys)
    finally:
        serving.stop()
        time.sleep(0)
