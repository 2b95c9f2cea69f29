"""Serves the dashboard as built from `dashboard/`: a few files, read and compressed once.

Names under `assets/` change with their content and are cached for ever; everything else is revalidated by its ETag. The page
may load nothing from another host and run no script but its own.
"""

import gzip
import hashlib
import mimetypes
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from fastapi import APIRouter, Request, Response
from starlette.exceptions import HTTPException

from service.http.compression import takes_gzip
from service.security.requirement import ANYBODY

FOLDER = Path(str(resources.files("service"))) / "dashboard"
FIRST = "index.html"
STAMP = "built-from.txt"
SMALLEST = 500
"""Smallest file that is compressed [B]."""
POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
SAFE = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
}
FOR_EVER = "public, max-age=31536000, immutable"
ASK_AGAIN = "no-cache"

router = APIRouter(include_in_schema=False, dependencies=[ANYBODY])


@dataclass(frozen=True)
class File:
    """A file of the page. compressed: by gzip, where that is smaller."""

    body: bytes
    compressed: bytes | None
    media_type: str
    etag: str
    cache: str


@cache
def files() -> dict[str, File]:
    """Return every file of the built page by its path."""
    paths = [path for path in sorted(FOLDER.rglob("*")) if path.is_file() and path.name != STAMP]
    return {path.relative_to(FOLDER).as_posix(): _file(path) for path in paths}


def _file(path: Path) -> File:
    body = path.read_bytes()
    compressed = gzip.compress(body, 9, mtime=0) if len(body) >= SMALLEST else None
    kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    return File(
        body=body,
        compressed=compressed if compressed is not None and len(compressed) < len(body) else None,
        media_type=f"{kind}; charset=utf-8" if kind.startswith(("text/", "image/svg")) else kind,
        etag=f'"{hashlib.sha256(body).hexdigest()[:20]}"',
        cache=FOR_EVER if path.parent.name == "assets" else ASK_AGAIN,
    )


@router.get("/")
def read_page(request: Request) -> Response:
    """Serve the page; the view within it stands behind the # of the address."""
    return _answer(request, FIRST)


@router.get("/assets/{name}")
def read_asset(request: Request, name: str) -> Response:
    """Serve a script or style sheet of the page."""
    return _answer(request, f"assets/{name}")


@router.get("/icon.svg")
def read_icon(request: Request) -> Response:
    """Serve the icon of the browser's tab."""
    return _answer(request, "icon.svg")


def _answer(request: Request, name: str) -> Response:
    file = files().get(name)
    if file is None:
        raise HTTPException(404, f"the page has no file {name}")
    headers = SAFE | {"ETag": file.etag, "Cache-Control": file.cache, "Vary": "Accept-Encoding"}
    if file.etag in [tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")]:
        return Response(status_code=304, headers=headers)
    if file.compressed is None or not takes_gzip(request.headers.get("accept-encoding", "")):
        return Response(file.body, headers=headers, media_type=file.media_type)
    return Response(file.compressed, headers=headers | {"Content-Encoding": "gzip"}, media_type=file.media_type)
