"""The API's OpenAPI document and its documentation page, from this service's own files.

The page's one inline script is allowed by its hash.
"""

import functools
import json
import re
from base64 import b64encode
from hashlib import sha256

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import FastAPI, Request, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.responses import HTMLResponse

from service.http.compression import compressed, takes_gzip
from service.security.requirement import ANYBODY

INLINE = re.compile(rb"<script>(.*?)</script>", re.DOTALL)


def add_openapi_document(app: FastAPI, *, path: str) -> None:
    """Add the document in place of the framework's route, which writes it anew for each request (some 20 ms).

    Anybody may ask for it: here it is written and compressed once, in one thread, however many ask at the same time.
    """
    one_thread = CapacityLimiter(1)
    app.router.routes[:] = [route for route in app.router.routes if getattr(route, "path", None) != path]

    @functools.cache
    def written() -> tuple[bytes, bytes]:
        plain = json.dumps(app.openapi(), ensure_ascii=False, separators=(",", ":")).encode()
        return plain, compressed(plain)

    @app.get(path, include_in_schema=False, dependencies=[ANYBODY])
    async def read_openapi_document(request: Request) -> Response:
        plain, zipped = await run_sync(written, limiter=one_thread)
        headers = {"Vary": "Accept-Encoding"}
        if takes_gzip(request.headers.get("accept-encoding", "")):
            return Response(zipped, media_type="application/json", headers={**headers, "Content-Encoding": "gzip"})
        return Response(plain, media_type="application/json", headers=headers)


def add_documentation(app: FastAPI, *, path: str, files: str, openapi: str) -> None:
    """Add the page. files: address of its scripts and styles; openapi: address of the document."""
    page = get_swagger_ui_html(
        openapi_url=openapi,
        title=f"{app.title} · API",
        swagger_js_url=f"{files}/swagger-ui-bundle.js",
        swagger_css_url=f"{files}/swagger-ui.css",
        swagger_favicon_url="/icon.svg",
        oauth2_redirect_url=None,
    )
    body = bytes(page.body)
    policy = _policy(body)

    @app.get(path, include_in_schema=False, dependencies=[ANYBODY])
    async def read_documentation(_request: Request) -> HTMLResponse:
        return HTMLResponse(body, headers={"Content-Security-Policy": policy})


def _policy(body: bytes) -> str:
    """Return a policy that lets the page run its own scripts and call this service."""
    scripts = " ".join(f"'sha256-{b64encode(sha256(one).digest()).decode()}'" for one in INLINE.findall(body))
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src 'self' {scripts}",
            "style-src 'self'",
            "img-src 'self' data:",
            "font-src 'self' data:",
            "connect-src 'self'",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        )
    )
