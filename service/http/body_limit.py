"""Limits the size of request bodies: larger ones are answered with 413 and not read.

What is to be parsed comes in turn: parsing holds the event loop, which in between answers others for as long.
"""

import asyncio
import time

from fastapi import HTTPException, status
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.problem import problem_response

LARGEST_BODY = 2 * 1024 * 1024
"""Largest body [B]; a batch of samples may have half of it."""
IN_TURN = 1024
"""Size from which on a body waits for its turn [B]."""
NOTICEABLE_S = 0.002
"""Duration of parsing from which on others are given as long [s]."""


class TooLarge(HTTPException):
    """The body exceeds the limit."""


class BodyLimit:
    """ASGI middleware that limits request bodies."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._turn = asyncio.Lock()
        self._passed = 0.0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and stop it when its body exceeds the limit."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        announced = dict(scope["headers"]).get(b"content-length", b"")
        if announced.isdigit() and int(announced) > LARGEST_BODY:
            await problem_response(status.HTTP_413_CONTENT_TOO_LARGE, _words(), {"Connection": "close"})(scope, receive, send)
            return
        size = 0

        async def counted() -> Message:
            nonlocal size
            message = await receive()
            size += len(message.get("body", b""))
            if size > LARGEST_BODY:
                raise TooLarge(status.HTTP_413_CONTENT_TOO_LARGE, _words(), {"Connection": "close"})
            if size >= IN_TURN and message["type"] == "http.request" and not message.get("more_body"):
                await self._wait()
            return message

        started = False

        async def watching_send(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self._app(scope, counted, watching_send)
        except TooLarge as error:
            if started:
                raise
            await problem_response(error.status_code, error.detail, error.headers)(scope, receive, send)

    async def _wait(self) -> None:
        """Wait until earlier bodies are parsed, then as long again as the last one took: others are answered meanwhile."""
        behind_another = self._turn.locked()
        async with self._turn:
            took = time.monotonic() - self._passed if behind_another else 0.0
            await asyncio.sleep(took if took > NOTICEABLE_S else 0)
            self._passed = time.monotonic()


def _words() -> str:
    return f"a request's body may have {LARGEST_BODY} bytes at most: make it smaller, or send it in parts"
