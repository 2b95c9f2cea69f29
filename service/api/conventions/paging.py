"""Pages long lists: `?limit=` and an opaque `?cursor=`, with the address of the next page in the Link header (RFC 8288)."""

import base64
import binascii
import json
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

import msgspec
from fastapi import Depends, Query, Request, Response
from fastapi.exceptions import RequestValidationError

from storage.paging import Keys

T = TypeVar("T")

LARGEST_LIMIT = 1000
LARGEST_INTEGER = 2**63 - 1


@dataclass
class Paging:
    """One page of a list: its size and the key that it follows. Ask the store for `wanted` rows and pass them to `page`."""

    limit: int
    after: Keys | None
    request: Request
    response: Response

    @property
    def wanted(self) -> int:
        """Return the number of rows to ask the store for: one more than shown, to see whether a next page exists."""
        return self.limit + 1

    def page(self, rows: Sequence[T], keys: Callable[[T], Keys]) -> Sequence[T]:
        """Return the rows to show. Where more follow, add the Link header with the address of the next page."""
        if len(rows) <= self.limit:
            return rows
        shown = rows[: self.limit]
        cursor = _written(_list_of(self.request), keys(shown[-1]))
        following = self.request.url.include_query_params(cursor=cursor, limit=self.limit)
        self.response.headers["Link"] = f'<{following.path}?{following.query}>; rel="next"'
        return shown

    def json(self, answer: Sequence[Mapping[str, Any] | msgspec.Raw] | Mapping[str, Any]) -> Response:
        """Return a response with many rows, encoded without validating each: null for NaN, RFC 3339 times."""
        return Response(msgspec.json.encode(answer), media_type="application/json", headers=dict(self.response.headers))


def _list_of(request: Request) -> int:
    """Return a checksum of the list's path: it binds a cursor to its list."""
    return zlib.crc32(request.url.path.encode())


def _written(which: int, keys: Keys) -> str:
    return base64.urlsafe_b64encode(json.dumps([which, *keys]).encode()).decode().rstrip("=")


def _read(cursor: str, kind: str, which: int) -> Keys:
    try:
        found = json.loads(base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True))
    except (binascii.Error, ValueError, RecursionError):
        found = None
    if isinstance(found, list) and found[:1] == [which] and len(found) == 1 + len(kind):
        keys = tuple(found[1:])
        if _fits(keys, kind):
            return keys
    message = "this is no cursor of this list: take the one from the Link header of the part before, or none to begin"
    raise RequestValidationError([{"type": "value_error", "loc": ("query", "cursor"), "msg": message, "input": cursor}])


def _fits(keys: tuple[Any, ...], kind: str) -> bool:
    return all(
        (type(key) is int and abs(key) <= LARGEST_INTEGER) if one == "i" else (isinstance(key, str) and key.isprintable())
        for key, one in zip(keys, kind, strict=True)
    )


def _paging(kind: str, default: int) -> Any:
    async def paging(
        request: Request,
        response: Response,
        limit: Annotated[int, Query(ge=1, le=LARGEST_LIMIT)] = default,
        cursor: Annotated[
            str | None, Query(min_length=1, max_length=200, description="from the Link header of the part before")
        ] = None,
    ) -> Paging:
        return Paging(limit, None if cursor is None else _read(cursor, kind, _list_of(request)), request, response)

    return Depends(paging)


ByTime = Annotated[Paging, _paging("ii", 100)]
"""Pages of lists ordered by a time and an id."""
ById = Annotated[Paging, _paging("i", 100)]
"""Pages of lists ordered by an id or a number."""
BySource = Annotated[Paging, _paging("ssi", LARGEST_LIMIT)]
"""Pages of the list of sources."""
ByName = Annotated[Paging, _paging("s", LARGEST_LIMIT)]
"""Pages of lists ordered by a name."""
