"""Limits the size of request bodies: larger ones are answered with 413 and not read."""

from fastapi import HTTPException, status
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.problem import problem_response

LARGEST_BODY = 2 * 1024 * 1024
"""Largest body [B]; a batch of samples may have half of it."""


class TooLarge(HTTPException):
    """The body exceeds the limit."""


class BodyLimit:
    """ASGI middleware that limits request bodies."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

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


def _words() -> str:
    return f"a request's body may have {LARGEST_BODY} bytes at most: make it smaller, or send it in parts"
