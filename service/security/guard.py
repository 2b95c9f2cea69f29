"""Authenticates and authorises each request, before it is read or handled."""

import asyncio
import logging
import math
from collections.abc import Mapping
from http import HTTPStatus

from sqlalchemy.exc import DBAPIError
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.database_errors import categorized
from service.http.error_status import status_of
from service.http.problem import problem_response
from service.resilience.rate_limit import RateLimit
from service.security import browser_origin
from service.security.authentication import Authentication, Credentials, Unauthenticated, cookie_name
from service.security.key_set import KeysUnavailable
from service.security.operations import ApiOperation, Operations
from service.security.principal import ANONYMOUS, Principal, current
from service.security.repeated_entries import RepeatedEntries
from service.security.scope import NotThere, Visibility
from service.security.store import AuditedTransactions, plain
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation

logger = logging.getLogger(__name__)

CHALLENGE = 'Bearer realm="rundown"'
TWICE = "a request has one Authorization header: it would not be clear who asks"
HOW = "send 'Authorization: Bearer' with an API key or a token, or log in at /login"


class Guard:
    """ASGI middleware in front of all operations."""

    def __init__(
        self,
        app: ASGIApp,
        *,
        database: Database,
        operations: Operations,
        authentication: Authentication,
        visibility: Visibility,
        requests: RateLimit,
        failures: RateLimit,
        repeated: RepeatedEntries,
        public_url: str = "",
        names_checked: bool = False,
    ) -> None:
        """Set the limits: `requests` per client, `failures` per address that guesses a key or a token.

        An ended session or missing credentials do not count as guesses: a page sends several requests before it goes to log
        in. names_checked: without authentication, accept only names of this machine itself.
        """
        self._app = app
        self._database = database
        self._operations = operations
        self._authentication = authentication
        self._visibility = visibility
        self._requests = requests
        self._failures = failures
        self._repeated = repeated
        self._public_url = public_url
        self._names_checked = names_checked

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
        headers = dict(scope["headers"])
        found = self._operations.find(scope["method"], scope["path"])
        operation = None if found is None else found[0]
        try:
            who, given = await self._principal(scope["scheme"], headers, operation)
            refused = self._refusal(who, scope, headers, operation)
            if refused is None and found is not None and who.plants is not None:
                await self._require_visible(who, *found)
        except Unauthenticated as error:
            rate = self._failures if b"authorization" in headers else self._requests
            wait = rate.take(_address(scope))
            answer = _wait(wait) if wait else _unauthenticated(str(error), headers)
            await answer(scope, receive, send)
            return
        except (NotThere, KeysUnavailable, DBAPIError) as error:
            told = categorized(error) if isinstance(error, DBAPIError) else error
            await problem_response(status_of(told), told.detail)(scope, receive, send)
            return
        if refused is not None:
            if refused.status_code == HTTPStatus.FORBIDDEN and operation is not None:
                entry = _entry(who, scope, operation, "refused")
                if self._repeated.first(entry):
                    await self._append_audited(entry)
            await refused(scope, receive, send)
            return
        await self._pass_on(who, given, operation, scope, receive, send)

    async def _principal(
        self, scheme: str, headers: Mapping[bytes, bytes], operation: ApiOperation | None
    ) -> tuple[Principal, Credentials | None]:
        try:
            given = Credentials.of(headers, cookie=cookie_name(scheme, public_url=self._public_url))
            return await self._authentication.principal(given), given
        except Unauthenticated:
            if operation is not None and operation.requirement.role is None:
                return ANONYMOUS, None  # a person with an ended session must be able to log in again
            raise

    def _refusal(
        self, who: Principal, scope: Scope, headers: Mapping[bytes, bytes], operation: ApiOperation | None
    ) -> Response | None:
        if who.kind != "open" and (wait := self._requests.take(who.identity if who.known else _address(scope))):
            return _wait(wait)
        if who.kind == "open" and self._names_checked:
            stranger = browser_origin.rebound(headers, public_url=self._public_url)
            if stranger is not None:
                return problem_response(HTTPStatus.MISDIRECTED_REQUEST, stranger)
        with_token = operation is None or operation.requirement.role is not None
        reason = browser_origin.refusal(who, scope["method"], headers, public_url=self._public_url, with_token=with_token)
        if reason is not None:
            return problem_response(HTTPStatus.FORBIDDEN, reason)
        if operation is None or operation.requirement.met(who):
            return None
        if not who.known:
            return _unauthenticated(f"this operation needs {operation.requirement.words}", headers)
        is_now = "no role" if who.role is None else f"the role {who.role.label}"
        return problem_response(
            HTTPStatus.FORBIDDEN,
            f"this operation needs {operation.requirement.words}, and {who.name} has {is_now}"
            f"{'' if who.plants is None else ' for some plants'}: ask an administrator",
        )

    async def _require_visible(self, who: Principal, operation: ApiOperation, parameters: Mapping[str, str]) -> None:
        wanted = {name: parameters[name] for name in operation.scoped}
        if wanted and not self._visibility.known(who, wanted):
            await asyncio.to_thread(self._visibility.require, who, wanted)

    async def _pass_on(
        self,
        who: Principal,
        given: Credentials | None,
        operation: ApiOperation | None,
        scope: Scope,
        receive: Receive,
        send: Send,
    ) -> None:
        changes = (
            operation is not None and scope["method"] not in browser_origin.SAFE_METHODS and operation.requirement.recorded
        )
        recorded = None
        if operation is not None and changes:
            recorded = AuditedTransactions(self._database, who.plants, _entry(who, scope, operation, "done"))

        async def still() -> bool:
            return given is None or await self._authentication.still(given, who)

        state = scope.setdefault("state", {})
        state["principal"] = who
        state["operation"] = operation
        state["store"] = recorded or plain(self._database, who.plants)
        state["still"] = still
        code = 0

        async def recording_send(message: Message) -> None:
            nonlocal code
            if message["type"] == "http.response.start":
                code = message["status"]
            await send(message)

        reset = current.set(who)
        try:
            await self._app(scope, receive, recording_send if recorded else send)
        finally:
            current.reset(reset)
        if recorded is not None and operation is not None and not recorded.written and 0 < code < HTTPStatus.BAD_REQUEST:
            await self._append_audited(_entry(who, scope, operation, f"answered {code}"))

    async def _append_audited(self, entry: AuditedOperation) -> None:
        try:
            await asyncio.to_thread(self._append, entry)
        except DBAPIError as error:
            logger.error("not in the audit trail: %s: %s", entry, error.orig)

    def _append(self, entry: AuditedOperation) -> None:
        with self._database.transaction() as session:
            audit.append(session, entry)


def _entry(who: Principal, scope: Scope, operation: ApiOperation, outcome: str) -> AuditedOperation:
    return AuditedOperation(who.in_full, _address(scope), operation.name, f"{scope['method']} {scope['path']}", outcome)


def _address(scope: Scope) -> str:
    return scope["client"][0] if scope.get("client") else "unknown"


def _unauthenticated(reason: str, headers: Mapping[bytes, bytes]) -> Response:
    challenge = CHALLENGE + (', error="invalid_token"' if b"authorization" in headers else "")
    return problem_response(HTTPStatus.UNAUTHORIZED, f"{reason}: {HOW}", {"WWW-Authenticate": challenge})


def _wait(seconds: float) -> Response:
    whole = max(1, math.ceil(seconds))
    detail = f"too many requests: ask again in {whole} s"
    return problem_response(HTTPStatus.TOO_MANY_REQUESTS, detail, {"Retry-After": str(whole)})
