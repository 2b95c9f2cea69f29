"""Authenticates and authorises each request, before it is read or handled."""

import asyncio
import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus

from sqlalchemy.exc import DBAPIError
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.database_errors import categorized
from service.http.error_status import status_of
from service.http.fair_scheduling import PERSON
from service.http.problem import problem_response
from service.resilience.rate_limit import RateLimit
from service.security import browser_origin
from service.security.authentication import Authentication, Credentials, Unauthenticated, cookie_name
from service.security.key_set import KeysUnavailable
from service.security.operations import ApiOperation, Operations
from service.security.principal import ANONYMOUS, Principal, current
from service.security.repeated_entries import RepeatedEntries
from service.security.scope import NotThere, Visibility
from service.security.store import AuditedTransactions, scoped_store
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation

logger = logging.getLogger(__name__)

CHALLENGE = 'Bearer realm="rundown"'
TWICE = "a request has one Authorization header: it would not be clear who asks"
HOW = "send 'Authorization: Bearer' with an API key or a token, or log in at /login"


@dataclass(frozen=True)
class AccessRules:
    """Rules of access: operations, keys, and the plants that each person sees.

    names_checked: without authentication, accept only names of this machine itself.
    """

    operations: Operations
    authentication: Authentication
    visibility: Visibility
    public_url: str = ""
    names_checked: bool = False


@dataclass(frozen=True)
class RequestLimits:
    """Limits of what comes: `requests` per client, `failures` per address that guesses a key or a token.

    An ended session or missing credentials do not count as guesses: a page sends several requests before it goes to log in.
    """

    requests: RateLimit
    failures: RateLimit


@dataclass(frozen=True)
class _GuardedRequest:
    """A request before it is handled. operation: None for a path that there is not; parameters: parameters of its path."""

    scope: Scope
    headers: Mapping[bytes, bytes]
    operation: ApiOperation | None
    parameters: Mapping[str, str]

    @classmethod
    def of(cls, scope: Scope, operations: Operations) -> "_GuardedRequest":
        operation, parameters = operations.find(scope["method"], scope["path"]) or (None, {})
        return cls(scope, dict(scope["headers"]), operation, parameters)

    @property
    def address(self) -> str:
        return self.scope["client"][0] if self.scope.get("client") else "unknown"

    @property
    def needs_role(self) -> bool:
        return self.operation is None or self.operation.requirement.role is not None

    @property
    def is_recorded(self) -> bool:
        """Return whether it changes something that the audit trail records."""
        changes = self.scope["method"] not in browser_origin.SAFE_METHODS
        return changes and self.operation is not None and self.operation.requirement.recorded

    def entry(self, who: Principal, outcome: str) -> AuditedOperation:
        """Return the request's entry in the audit trail."""
        name = "" if self.operation is None else self.operation.name
        return AuditedOperation(who.in_full, self.address, name, f"{self.scope['method']} {self.scope['path']}", outcome)


class Guard:
    """ASGI middleware in front of all operations."""

    def __init__(
        self, app: ASGIApp, *, database: Database, rules: AccessRules, limits: RequestLimits, repeated: RepeatedEntries
    ) -> None:
        """Set up. repeated: refusals that the audit trail has already."""
        self._app = app
        self._database = database
        self._rules = rules
        self._limits = limits
        self._repeated = repeated

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its principal and its store, or refuse it."""
        if scope["type"] == "websocket":  # no operation uses them, and they would bypass the checks
            await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        if sum(name == b"authorization" for name, _ in scope["headers"]) > 1:
            await problem_response(HTTPStatus.BAD_REQUEST, TWICE)(scope, receive, send)
            return
        asked = _GuardedRequest.of(scope, self._rules.operations)
        try:
            who, given = await self._principal(asked)
            refused = await self._refusal(who, asked)
        except Unauthenticated as error:
            await self._challenge(asked, str(error))(scope, receive, send)
        except (NotThere, KeysUnavailable, DBAPIError) as error:
            told = categorized(error) if isinstance(error, DBAPIError) else error
            await problem_response(status_of(told), told.detail)(scope, receive, send)
        else:
            if refused is None:
                await self._pass_on(who, given, asked, receive, send)
            else:
                await self._record_refusal(who, asked, refused)
                await refused(scope, receive, send)

    async def _principal(self, asked: _GuardedRequest) -> tuple[Principal, Credentials | None]:
        try:
            name = cookie_name(asked.scope["scheme"], public_url=self._rules.public_url)
            given = Credentials.of(asked.headers, cookie=name)
            return await self._rules.authentication.principal(given), given
        except Unauthenticated:
            if not asked.needs_role:
                return ANONYMOUS, None  # a person with an ended session must be able to log in again
            raise

    def _challenge(self, asked: _GuardedRequest, reason: str) -> Response:
        """Return the answer to a request without valid credentials."""
        rate = self._limits.failures if b"authorization" in asked.headers else self._limits.requests
        wait = rate.take(asked.address)
        return _wait(wait) if wait else _unauthenticated(reason, asked.headers)

    async def _refusal(self, who: Principal, asked: _GuardedRequest) -> Response | None:
        """Return why a request is refused; None when it is not. Raises NotThere for what is of a plant that is not visible."""
        refused = self._limited(who, asked) or self._foreign(who, asked) or _unauthorized(who, asked)
        if refused is None and asked.operation is not None and who.plants is not None:
            await self._require_visible(who, asked.operation, asked.parameters)
        return refused

    def _limited(self, who: Principal, asked: _GuardedRequest) -> Response | None:
        """Return the answer to a client that asks too often."""
        if who.kind == "open":
            return None
        wait = self._limits.requests.take(who.identity if who.known else asked.address)
        return _wait(wait) if wait else None

    def _foreign(self, who: Principal, asked: _GuardedRequest) -> Response | None:
        """Return the answer to a request that another page sent, or under a name that is not this machine's."""
        public_url = self._rules.public_url
        if who.kind == "open" and self._rules.names_checked:
            stranger = browser_origin.rebound(asked.headers, public_url=public_url)
            if stranger is not None:
                return problem_response(HTTPStatus.MISDIRECTED_REQUEST, stranger)
        reason = browser_origin.refusal(
            who, asked.scope["method"], asked.headers, public_url=public_url, with_token=asked.needs_role
        )
        return None if reason is None else problem_response(HTTPStatus.FORBIDDEN, reason)

    async def _record_refusal(self, who: Principal, asked: _GuardedRequest, refused: Response) -> None:
        if refused.status_code == HTTPStatus.FORBIDDEN and asked.operation is not None:
            entry = asked.entry(who, "refused")
            if self._repeated.first(entry):
                await self._append_audited(entry)

    async def _require_visible(self, who: Principal, operation: ApiOperation, parameters: Mapping[str, str]) -> None:
        wanted = {name: parameters[name] for name in operation.scoped}
        if wanted and not self._rules.visibility.known(who, wanted):
            await asyncio.to_thread(self._rules.visibility.require, who, wanted)

    async def _pass_on(
        self, who: Principal, given: Credentials | None, asked: _GuardedRequest, receive: Receive, send: Send
    ) -> None:
        recorded = None
        if asked.is_recorded:
            recorded = AuditedTransactions(self._database, who.plants, asked.entry(who, "done"))

        async def still_valid() -> bool:
            return given is None or await self._rules.authentication.still_valid(given, who)

        state = asked.scope.setdefault("state", {})
        state["principal"] = who
        state[PERSON] = who.identity if who.known else ""
        state["operation"] = asked.operation
        state["store"] = recorded or scoped_store(self._database, who.plants)
        state["still_valid"] = still_valid
        code = 0

        async def recording_send(message: Message) -> None:
            nonlocal code
            if message["type"] == "http.response.start":
                code = message["status"]
            await send(message)

        reset = current.set(who)
        try:
            await self._app(asked.scope, receive, recording_send if recorded else send)
        finally:
            current.reset(reset)
        if recorded is not None and not recorded.written and 0 < code < HTTPStatus.BAD_REQUEST:
            await self._append_audited(asked.entry(who, f"answered {code}"))

    async def _append_audited(self, entry: AuditedOperation) -> None:
        try:
            await asyncio.to_thread(self._append, entry)
        except DBAPIError as error:
            logger.error("not in the audit trail: %s: %s", entry, error.orig)

    def _append(self, entry: AuditedOperation) -> None:
        with self._database.transaction() as session:
            audit.append(session, entry)


def _unauthorized(who: Principal, asked: _GuardedRequest) -> Response | None:
    """Return the answer to a principal who may not use the operation."""
    if asked.operation is None or asked.operation.requirement.met(who):
        return None
    words = asked.operation.requirement.words
    if not who.known:
        return _unauthenticated(f"this operation needs {words}", asked.headers)
    is_now = "no role" if who.role is None else f"the role {who.role.label}"
    return problem_response(
        HTTPStatus.FORBIDDEN,
        f"this operation needs {words}, and {who.name} has {is_now}"
        f"{'' if who.plants is None else ' for some plants'}: ask an administrator",
    )


def _unauthenticated(reason: str, headers: Mapping[bytes, bytes]) -> Response:
    challenge = CHALLENGE + (', error="invalid_token"' if b"authorization" in headers else "")
    return problem_response(HTTPStatus.UNAUTHORIZED, f"{reason}: {HOW}", {"WWW-Authenticate": challenge})


def _wait(seconds: float) -> Response:
    whole = max(1, math.ceil(seconds))
    detail = f"too many requests: ask again in {whole} s"
    return problem_response(HTTPStatus.TOO_MANY_REQUESTS, detail, {"Retry-After": str(whole)})
