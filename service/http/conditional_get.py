"""Answers conditional GETs: `If-None-Match` with the ETag of the answer gets 304 (RFC 9110 §13.1.2)."""

from starlette.types import ASGIApp, Message, Receive, Scope, Send

KEPT = (b"etag", b"cache-control", b"vary", b"date", b"link")


class ConditionalGet:
    """ASGI middleware that omits a body which the client already has."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and answer 304 where its ETag matches."""
        known = [value for name, value in scope.get("headers", []) if name == b"if-none-match"]
        if scope["type"] != "http" or scope["method"] != "GET" or not known:
            await self._app(scope, receive, send)
            return
        tags = {tag.strip().removeprefix(b"W/") for value in known for tag in value.split(b",")}
        unchanged = False

        async def shorter(message: Message) -> None:
            nonlocal unchanged
            if message["type"] == "http.response.start":
                tag = next((value for name, value in message["headers"] if name.lower() == b"etag"), None)
                unchanged = message["status"] == 200 and tag is not None and (tag in tags or b"*" in tags)
                if unchanged:
                    kept = [(name, value) for name, value in message["headers"] if name.lower() in KEPT]
                    message = {**message, "status": 304, "headers": kept}
            elif unchanged:
                message = {**message, "body": b""}
            await send(message)

        await self._app(scope, receive, shorter)
