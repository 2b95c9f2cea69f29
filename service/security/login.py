"""Login on the page with an API key or at the issuer; the session's cookie is hidden from scripts."""

import asyncio
import hmac
import secrets
from pathlib import Path
from typing import cast
from urllib.parse import parse_qs

from fastapi import APIRouter, Request
from fastapi.responses import RedirectResponse, Response

from service.resilience.rate_limit import RateLimit
from service.security.api_keys import key_hash
from service.security.authentication import SAFE_COOKIE, Authentication, Unauthenticated, cookie_name, session_cookie
from service.security.configuration import Security
from service.security.key_set import KeysUnavailable
from service.security.login_page import login_page
from service.security.open_id import CALLBACK, LoginFailed
from service.security.principal import Principal
from service.security.repeated_entries import RepeatedEntries
from service.security.requirement import ANYBODY
from service.security.role import Role
from service.security.tokens import TokenRefused
from storage.clock import now
from storage.database.engine import Database
from storage.operation import audit, browser_sessions, logins
from storage.operation.audit import AuditedOperation
from storage.tables.operation import LoginRow

router = APIRouter(include_in_schema=False, dependencies=[ANYBODY])

LASTS_S = 12 * 3600
PATIENCE_S = 600
"""Time limit of a login at the issuer [s]."""
LARGEST_FORM = 4096
UNDER_WAY_COOKIE = "rundown_login"
STYLE = Path(__file__).with_name("login.css")


@router.get("/login")
def read_login(request: Request) -> Response:
    """Serve the login page; redirect clients that are logged in already or need no login."""
    who: Principal = request.state.principal
    return login_page(request) if who.kind == "anonymous" else RedirectResponse("/", 303)


@router.get("/login.css")
def read_style() -> Response:
    """Serve the style sheet of the login page."""
    return Response(STYLE.read_bytes(), media_type="text/css", headers={"Cache-Control": "no-cache"})


@router.post("/login")
async def log_in(request: Request) -> Response:
    """Log in with an API key."""
    address = request.client.host if request.client else "unknown"
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > LARGEST_FORM:
            return login_page(request, "no_key", 413)
    given = parse_qs(body.decode("latin-1")).get("key", [""])[0].strip()
    authentication = cast(Authentication, request.app.state.authentication)
    try:
        who = await asyncio.to_thread(authentication.key, given)
    except Unauthenticated as error:
        wait = cast(RateLimit, request.app.state.failures).take(address)
        if not wait:
            await asyncio.to_thread(_refused, request, AuditedOperation("unknown", address, "log_in", "API key", "refused"))
            return login_page(request, "refused", 401, error=error)
        answer = login_page(request, "too_many", 429)
        answer.headers["Retry-After"] = str(round(wait) + 1)
        return answer
    if who.role is None or who.role is Role.SOURCE:
        return login_page(request, "source_key", 403)
    return await asyncio.to_thread(_begin_session, request, who, key_prefix=who.identity.removeprefix("key "))


@router.get("/login/issuer")
def begin_issuer_login(request: Request) -> Response:
    """Redirect the browser to the issuer."""
    security = cast(Security, request.app.state.security)
    if security.open_id is None:
        return login_page(request, "no_issuer", 404)
    try:
        begun = security.open_id.begin()
    except LoginFailed as error:
        return login_page(request, "refused", 503, error=error)
    cookie = secrets.token_urlsafe(32)
    with cast(Database, request.app.state.database).transaction() as session:
        logins.begin(
            session,
            state_hash=key_hash(begun.state),
            browser_hash=key_hash(cookie),
            verifier=begun.verifier,
            nonce=begun.nonce,
            expires_at=now() + PATIENCE_S * 1_000_000_000,
        )
    answer = RedirectResponse(begun.url, 303)
    # Lax, not strict: the issuer redirects the browser back here.
    answer.set_cookie(
        UNDER_WAY_COOKIE, cookie, max_age=PATIENCE_S, path="/login", httponly=True, samesite="lax", secure=_encrypted(request)
    )
    return answer


@router.get(CALLBACK)
def complete_login(request: Request) -> Response:
    """Complete a login at the issuer with its code."""
    security = cast(Security, request.app.state.security)
    if security.open_id is None or security.tokens is None:
        return login_page(request, "no_issuer", 404)
    address = request.client.host if request.client else "unknown"
    try:
        begun, answered = _under_way(request), dict(request.query_params)
        token = security.open_id.finish(answered, verifier=begun.verifier)
        claims = security.tokens.checked(token, audience=security.open_id.client_id, nonce=begun.nonce)
        who = security.tokens.stands_for(claims)
    except (LoginFailed, TokenRefused, KeysUnavailable) as error:
        _refused(request, AuditedOperation("unknown", address, "log_in", "issuer", "refused"))
        return login_page(request, "refused", 401, error=error)
    if who.role is None or who.role is Role.SOURCE:
        return login_page(request, "no_role", 403, name=who.name)
    answer = _begin_session(request, who, key_prefix=None)
    answer.delete_cookie(UNDER_WAY_COOKIE, path="/login")
    return answer


@router.post("/logout")
def log_out(request: Request) -> Response:
    """End the session."""
    cookie = session_cookie(dict(request.scope["headers"]), _cookie_name(request))
    if cookie is not None:
        cast(Authentication, request.app.state.authentication).forget(cookie)
        with cast(Database, request.app.state.database).transaction() as session:
            browser_sessions.end(session, key_hash(cookie))
    answer = Response(status_code=204)
    answer.delete_cookie(_cookie_name(request), path="/", secure=_encrypted(request), httponly=True, samesite="strict")
    return answer


def _begin_session(request: Request, who: Principal, *, key_prefix: str | None) -> Response:
    """Begin a session under a fresh cookie, and return the answer that sets it."""
    cookie, role = secrets.token_urlsafe(32), who.role
    assert role is not None
    address = request.client.host if request.client else "unknown"
    with cast(Database, request.app.state.database).transaction() as session:
        browser_sessions.begin(
            session,
            cookie_hash=key_hash(cookie),
            name=who.name,
            role=role.label,
            plants=None if who.plants is None else list(who.plants),
            key_prefix=key_prefix,
            token=secrets.token_urlsafe(32),
            expires_at=now() + LASTS_S * 1_000_000_000,
        )
        entry = AuditedOperation(who.in_full, address, "log_in", "page", "done")
        if cast(RepeatedEntries, request.app.state.repeated).first(entry):
            audit.append(session, entry)
    answer = RedirectResponse("/", 303)
    answer.set_cookie(
        _cookie_name(request), cookie, max_age=LASTS_S, path="/", httponly=True, samesite="strict", secure=_encrypted(request)
    )
    return answer


def _under_way(request: Request) -> LoginRow:
    """Return the login that is being completed, begun at any replica. Raises LoginFailed."""
    state, browser = request.query_params.get("state", ""), request.cookies.get(UNDER_WAY_COOKIE, "")
    with cast(Database, request.app.state.database).transaction() as session:
        found = logins.pop(session, key_hash(state), at=now())
    if found is None or not hmac.compare_digest(found.browser_hash, key_hash(browser)):
        raise LoginFailed("this login was not begun here, or too long ago: begin again")
    return found


def _encrypted(request: Request) -> bool:
    return _cookie_name(request) == SAFE_COOKIE


def _cookie_name(request: Request) -> str:
    security = cast(Security, request.app.state.security)
    return cookie_name(request.url.scheme, public_url=security.public_url)


def _refused(request: Request, entry: AuditedOperation) -> None:
    if not cast(RepeatedEntries, request.app.state.repeated).first(entry):
        return
    with cast(Database, request.app.state.database).transaction() as session:
        audit.append(session, entry)
