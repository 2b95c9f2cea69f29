"""Supports `Idempotency-Key` on POST: a repeated request is executed once and gets the same answer.

A key is stored before the work begins, gets its answer afterwards, and is kept for a day. A key without an answer, seen by
another process or after a crash, means that the outcome is unknown: check before asking under a new key. Source: the IETF
draft "The Idempotency-Key HTTP Header Field".
"""

import asyncio
import hashlib
import re
from http import HTTPStatus

from sqlalchemy.exc import IntegrityError
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.problem import problem_response
from service.secrets.sealing import SEALED, SealBroken, Sealing
from storage.database.engine import Database
from storage.operation import idempotency
from storage.operation.idempotency import StoredResponse

LONGEST_KEY = 255
KEY_PATTERN = r"^[!-~]+$"
KEPT_HEADERS = (b"content-type", b"location", b"etag")
REPLAYED = "Idempotency-Replayed"


class Idempotency:
    """ASGI middleware over a database. sealing: opens answers that are stored encrypted."""

    def __init__(self, app: ASGIApp, database: Database, sealing: Sealing | None = None) -> None:
        self._app = app
        self._database = database
        self._sealing = sealing

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or replay the answer that it got before."""
        keys = []
        if scope["type"] == "http" and scope["method"] == "POST" and _requires_role(scope):
            keys = [value for header, value in scope["headers"] if header == b"idempotency-key"]
        if not keys:
            await self._app(scope, receive, send)
            return
        name = b", ".join(keys).decode("latin-1").strip()
        if not 0 < len(name) <= LONGEST_KEY or not re.fullmatch(KEY_PATTERN, name):
            detail = f"Idempotency-Key must be 1 to {LONGEST_KEY} printable ASCII characters without a space, such as a UUID"
            await problem_response(HTTPStatus.BAD_REQUEST, detail)(scope, receive, send)
            return
        body = await _read_body(receive)
        if body is None:
            return  # the client has disconnected
        fingerprint = hashlib.sha256(_request_target(scope) + body).hexdigest()
        who = scope["state"]["principal"]
        # Each principal has keys and answers of their own.
        place = hashlib.sha256(f"{who.identity} {name}".encode()).hexdigest() if who.known else name
        earlier = await asyncio.to_thread(self._earlier, place, name, fingerprint)
        if earlier is not None:
            await earlier(scope, receive, send)
            return
        await self._work(place, scope, body, receive, send)

    def _earlier(self, place: str, name: str, fingerprint: str) -> Response | None:
        """Return the answer to a key that was claimed before; None for a new key, which is claimed now."""
        try:
            with self._database.transaction() as session:
                row = idempotency.claim(session, place, fingerprint)
        except IntegrityError:  # another request was faster
            return self._earlier(place, name, fingerprint)
        if row is None:
            return None
        if row.fingerprint != fingerprint:
            return problem_response(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                f"Idempotency-Key '{name}' was used for another request: take a new key for each",
            )
        if row.status is None:
            return problem_response(
                HTTPStatus.CONFLICT,
                f"the request under Idempotency-Key '{name}' is under way, or it is not known what became of it: "
                "ask again in a moment, and look before asking under a new key",
                {"Retry-After": "1"},
            )
        body = self._decrypt(row.body or b"", place)
        if body is None:
            return problem_response(
                HTTPStatus.CONFLICT,
                f"the request under Idempotency-Key '{name}' was done; its answer told a secret and cannot be opened any more",
            )
        answer = Response(body, row.status)
        for header, value in row.headers or []:
            answer.headers[header] = value
        answer.headers[REPLAYED] = "true"
        return answer

    def _decrypt(self, body: bytes, place: str) -> bytes | None:
        """Return a stored answer in plain text; None where it is encrypted and no key opens it."""
        if not body.startswith(SEALED.encode()):
            return body
        try:
            return None if self._sealing is None else self._sealing.open(body.decode(), place=_place(place))
        except SealBroken:
            return None

    async def _work(self, place: str, scope: Scope, body: bytes, receive: Receive, send: Send) -> None:
        given = False

        async def again() -> Message:
            nonlocal given
            if given:
                return await receive()
            given = True
            return {"type": "http.request", "body": body, "more_body": False}

        status, headers, parts = 0, [], list[bytes]()

        async def recording_send(message: Message) -> None:
            nonlocal status, headers
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = [[n.decode(), v.decode("latin-1")] for n, v in message["headers"] if n.lower() in KEPT_HEADERS]
            elif message["type"] == "http.response.body":
                parts.append(message.get("body", b""))
                if not message.get("more_body", False):
                    # Stored before it is sent: a client that received it can rely on it.
                    answer = StoredResponse(
                        status, headers, _stored_body(b"".join(parts), place, scope["state"].get("sealing"))
                    )
                    await asyncio.to_thread(self._record_answer, place, answer, done=_is_committed(scope))
            await send(message)

        try:
            await self._app(scope, again, recording_send)
        except BaseException:
            if not _is_committed(scope):  # otherwise the outcome is unknown, and the key stays claimed
                await asyncio.to_thread(self._release, place)
            raise

    def _record_answer(self, place: str, answer: StoredResponse, *, done: bool) -> None:
        with self._database.transaction() as session:
            if answer.status >= HTTPStatus.BAD_REQUEST and answer.status != HTTPStatus.CONFLICT and not done:
                idempotency.release(session, place)  # nothing was done and the request can be corrected: the key stays usable
            else:
                idempotency.store_response(session, place, answer)

    def _release(self, place: str) -> None:
        with self._database.transaction() as session:
            idempotency.release(session, place)


def _requires_role(scope: Scope) -> bool:
    """Check whether the operation needs a role: requests that anybody may make must not write to the store."""
    operation = scope["state"]["operation"]
    return operation is not None and operation.requirement.role is not None


def _place(key: str) -> str:
    return f"answer to {key}"


def _stored_body(body: bytes, key: str, sealing: Sealing | None) -> bytes:
    """Return an answer as it is stored. sealing: encrypts answers that contain a secret."""
    return body if sealing is None else sealing.seal(body, place=_place(key)).encode()


def _is_committed(scope: Scope) -> bool:
    """Check whether the request committed a transaction."""
    return bool(getattr(scope["state"].get("store"), "written", False))


def _request_target(scope: Scope) -> bytes:
    return b"\n".join([scope["path"].encode(), scope["query_string"], b""])


async def _read_body(receive: Receive) -> bytes | None:
    parts = []
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        parts.append(message.get("body", b""))
        if not message.get("more_body", False):
            return b"".join(parts)
