"""Two plants, keys of every role, an issuer, and the application over them."""

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from service.security import api_keys
from service.security.configuration import Security
from service.security.key_set import KeySet
from service.security.role import Role
from service.security.tokens import Claims, Tokens
from storage.database.engine import Database
from tests.api_in_process import Api, InProcess
from tests.databases import Databases, opened
from tests.plant import KEY
from tests.service.security.issuer import AUDIENCE, Issuer
from tests.service.security.two_plants import HIDDEN_PLANT, Ids, fill

PATIENT = (1e6, 1e6)
"""A rate that no test reaches."""


class Clock:
    """A clock that a test turns."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@dataclass(frozen=True)
class Filled:
    """A store with two plants. keys: of each role for all plants, `own` and `hidden` ones of an admin of one plant."""

    url: str
    own: Ids
    hidden: Ids
    keys: dict[str, str]


@pytest.fixture(scope="session")
def issuer() -> Iterator[Issuer]:
    """Signs tokens."""
    with Issuer() as one:
        yield one


@pytest.fixture(scope="session")
def filled(databases: Databases, empty_template: str, tmp_path_factory: pytest.TempPathFactory) -> Filled:
    """Made once, copied for each test."""
    url = databases.copy(empty_template, tmp_path_factory.mktemp("two-plants") / "rundown.db")
    database = Database(url)
    own, hidden = fill(database)
    keys = {}
    with database.transaction() as session:
        for role in Role:
            keys[role.label] = api_keys.create(session, name=f"{role.label} {role}", role=role, plants=None, days=1)[1]
        for name, plant in (("own", KEY.plant), ("hidden", HIDDEN_PLANT)):
            keys[name] = api_keys.create(session, name=f"{name} admin", role=Role.ADMIN, plants=[plant], days=1)[1]
        expired = api_keys.create(session, name="expired", role=Role.ADMIN, plants=None, days=-1)[1]
        revoked, text = api_keys.create(session, name="revoked", role=Role.ADMIN, plants=None, days=1)
        api_keys.revoke(session, revoked.prefix)
        keys |= {"expired": expired, "revoked": text}
    database.close()
    return Filled(url, own, hidden, keys)


@pytest.fixture
def store(databases: Databases, filled: Filled, tmp_path: Path) -> Iterator[Database]:
    """A copy of the store."""
    with opened(databases, filled.url, tmp_path / "rundown.db") as one:
        yield one


def tokens(issuer: Issuer) -> Tokens:
    """The issuer's tokens."""
    return Tokens(issuer=issuer.url, audience=AUDIENCE, keys=KeySet(f"{issuer.url}/keys"), claims=Claims())


class OneLoop(InProcess):
    """Requests on one event loop: thousands of new ones would take most of the time."""

    def __init__(self, app: FastAPI) -> None:
        super().__init__(app)
        self._runner = asyncio.Runner()

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """One request."""
        return self._runner.run(self._handle(request))

    def close(self) -> None:
        """End the loop."""
        self._runner.close()


def opened_api(database: Database, security: Security) -> Api:
    """The application over a database, asked on one loop, nothing compressed, and without If-Match."""
    one = Api(database, security=security)
    one.http = httpx.Client(transport=OneLoop(one.app), base_url="http://rundown", headers={"Accept-Encoding": "identity"})
    return one


@pytest.fixture(scope="module")
def shared(databases: Databases, filled: Filled, issuer: Issuer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """The application for all tests of a module that change nothing that others need: building it takes a second."""
    with opened(databases, filled.url, tmp_path_factory.mktemp("shared") / "rundown.db") as database:
        one = opened_api(database, Security(tokens=tokens(issuer), requests=PATIENT, failures=PATIENT))
        yield one
        one.http.close()


@pytest.fixture
def api(store: Database, issuer: Issuer) -> Iterator[Api]:
    """The application, with keys and the issuer's tokens."""
    one = opened_api(store, Security(tokens=tokens(issuer), requests=PATIENT, failures=PATIENT))
    yield one
    one.http.close()


def bearer(text: str) -> dict[str, str]:
    """The header with a key or token."""
    return {"Authorization": f"Bearer {text}"}
