"""Answers HEAD like GET, without the body (RFC 9110 §9.3.2)."""

from starlette.types import ASGIApp, Message, Receive, Scope, Send


class _Answered(Exception):
    """The head of the answer was sent."""


class HeadRequests:
    """ASGI middleware that handles HEAD as GET and sends the head of the answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on; a HEAD is answered without a body."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return

        async def head_only(message: Message) -> None:
            await send({**message, "body": b"", "more_body": False} if message["type"] == "http.response.body" else message)
            if message.get("more_body", False):
                raise _Answered  # a stream would never end

        try:
            await self._app({**scope, "method": "GET"}, receive, head_only)
        except _Answered:
            return
