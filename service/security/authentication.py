"""Authenticates requests: from credentials to a principal. Results are cached for a few seconds: a look-up takes microseconds,
and a revoked key stops working once they expire.
"""

import asyncio
import contextlib
import hashlib
import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sqlalchemy.exc import DBAPIError

from service.security import api_keys
from service.security.key_set import KeysUnavailable
from service.security.principal import ANONYMOUS, OPEN, Principal
from service.security.role import Role
from service.security.tokens import TokenRefused, Tokens
from storage.clock import now
from storage.database.engine import Database
from storage.operation import api_keys as keys
from storage.operation import browser_sessions

logger = logging.getLogger(__name__)

IDENTITY_CACHE_S = 3.0
"""Lifetime of a cached result [s]: a revoked key works for so long."""
GRACE_S = 3600.0
"""Extended lifetime while the database does not answer [s]: a monitoring system must be able to see the failure."""
PATIENCE_S = 5.0
"""Time limit of the database's answer [s]."""
MAXIMUM_IDENTITIES = 10_000
COOKIE = "rundown_session"
SAFE_COOKIE = "__Host-rundown_session"
"""Name of the cookie over encrypted connections: browsers send it to this host only, and never unencrypted."""
SCHEME = "bearer "


class Unauthenticated(Exception):
    """Invalid credentials; the message says what to do."""


@dataclass(frozen=True)
class Credentials:
    """Credentials of a request. bearer: a key or a token; cookie: that of a browser's session."""

    bearer: str | None
    cookie: str | None

    @classmethod
    def of(cls, headers: Mapping[bytes, bytes], *, cookie: str) -> "Credentials":
        """Read them from a request's headers. cookie: the session's name. Raises Unauthenticated for another scheme."""
        said = headers.get(b"authorization", b"").decode("latin-1").strip()
        if said and not said.lower().startswith(SCHEME):
            raise Unauthenticated("Authorization must be 'Bearer' and an API key or a token")
        return cls(said[len(SCHEME) :].strip() or None, None if said else session_cookie(headers, cookie))


def cookie_name(scheme: str, *, public_url: str) -> str:
    """Return the name of the session's cookie for a scheme.

    Only one name is accepted: a neighbour on the same domain could set the other one.
    """
    return SAFE_COOKIE if scheme == "https" or public_url.startswith("https://") else COOKIE


def session_cookie(headers: Mapping[bytes, bytes], wanted: str) -> str | None:
    """Return the value of the session cookie of that name, if there is one."""
    for part in headers.get(b"cookie", b"").decode("latin-1").split(";"):
        name, _, value = part.strip().partition("=")
        if name == wanted and value:
            return value
    return None


def _seen(look: "asyncio.Future[bool]") -> None:
    """Take the error of a look-up that no request waits for any more: the next look-up meets it again."""
    if not look.cancelled():
        look.exception()


class Authentication:
    """Authentication of requests. required: credentials are needed even where there is neither a key nor an issuer."""

    def __init__(
        self,
        database: Database,
        *,
        tokens: Tokens | None = None,
        required: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._database = database
        self._tokens = tokens
        self._clock = clock
        self._on = required or tokens is not None or self._any_keys_exist()
        self._checked_at = clock()
        self._looking: asyncio.Future[bool] | None = None
        """The look for a first key that is under way."""
        self._identities: dict[bytes, tuple[float, Principal]] = {}

    async def on(self) -> bool:
        """Check whether credentials are needed. A first key is noticed within seconds; once needed, they stay so."""
        if not self._on and self._clock() - self._checked_at > IDENTITY_CACHE_S:
            self._checked_at = self._clock()
            if self._looking is None or self._looking.done():  # one thread at most waits for a database that hangs
                self._looking = asyncio.ensure_future(asyncio.to_thread(self._any_keys_exist))
                self._looking.add_done_callback(_seen)
            with contextlib.suppress(TimeoutError):  # as it was: data are in the database that does not answer
                self._on = await asyncio.wait_for(asyncio.shield(self._looking), PATIENCE_S)
        return self._on

    async def principal(self, given: Credentials) -> Principal:
        """Return the principal of these credentials. Raises Unauthenticated, KeysUnavailable, DBAPIError."""
        if not await self.on():
            return OPEN
        text = given.bearer or given.cookie
        if text is None:
            return ANONYMOUS
        place = hashlib.sha256((b"b" if given.bearer else b"c") + text.encode()).digest()
        known = self._identities.get(place)
        if known is not None and self._clock() < known[0]:
            return known[1]
        try:
            found = await asyncio.wait_for(asyncio.to_thread(self._checked, given), PATIENCE_S)
        except (DBAPIError, TimeoutError) as error:
            if known is not None and self._clock() < known[0] + GRACE_S:
                return known[1]
            if isinstance(error, TimeoutError):
                raise KeysUnavailable(
                    f"the database has not answered for {PATIENCE_S:g} s: keys cannot be looked up"
                ) from None
            raise
        if len(self._identities) >= MAXIMUM_IDENTITIES:
            self._identities.clear()
        self._identities[place] = self._clock() + IDENTITY_CACHE_S, found
        return found

    async def still_valid(self, given: Credentials, who: Principal) -> bool:
        """Check whether credentials still stand for the same principal, for long-lived answers."""
        try:
            return await self.principal(given) == who
        except Unauthenticated:
            return False

    def forget(self, cookie: str) -> None:
        """Remove an ended session from the cache: it stops working at once in this process."""
        self._identities.pop(hashlib.sha256(b"c" + cookie.encode()).digest(), None)

    def key(self, text: str) -> Principal:
        """Return the principal of an API key. Raises Unauthenticated."""
        prefix = api_keys.prefix_of(text)
        with self._database.reading() as session:
            row = None if prefix is None else keys.find(session, prefix)
            if not api_keys.is_valid_secret(row, text) or row is None:
                raise Unauthenticated("this API key is not known, has expired or was revoked: ask an administrator for one")
            stale = keys.use_is_stale(row, at=now())
            found = api_keys.principal(row)
        if stale:
            self._note_use(row.prefix)
        return found

    def token(self, text: str) -> Principal:
        """Return the principal of an issuer's token; blocks for its keys. Raises Unauthenticated, KeysUnavailable."""
        if self._tokens is None:
            raise Unauthenticated("this is no API key, and tokens are not taken here: no issuer is configured")
        try:
            return self._tokens.principal(text)
        except TokenRefused as error:
            raise Unauthenticated(f"the token is not valid: {error}; get a new one from the issuer") from error

    def _checked(self, given: Credentials) -> Principal:
        if given.bearer is None:
            return self._session(given.cookie or "")
        return self.key(given.bearer) if given.bearer.startswith(api_keys.BEGIN) else self.token(given.bearer)

    def _session(self, cookie: str) -> Principal:
        with self._database.reading() as session:
            row = browser_sessions.find(session, api_keys.key_hash(cookie), at=now())
            if row is None:
                raise Unauthenticated("the session is over: log in again")
            if row.key_prefix is not None:
                key = keys.find(session, row.key_prefix)
                if key is None or not keys.valid(key, at=now()):
                    raise Unauthenticated("the API key that you logged in with is no longer valid: log in with another one")
            plants = None if row.plants is None else frozenset(row.plants)
            identity = f"session of key {row.key_prefix}" if row.key_prefix else f"session of {row.name}"
            return Principal(row.name, Role.of(row.role), plants, "session", identity, row.token)

    def _any_keys_exist(self) -> bool:
        with self._database.reading() as session:
            return keys.any_exist(session)

    def _note_use(self, prefix: str) -> None:
        try:
            with self._database.transaction() as session:
                keys.note_use(session, prefix)
        except DBAPIError as error:  # recording the use is no condition of access
            logger.warning("that key %s was used cannot be written down: %s", prefix, error.orig)
