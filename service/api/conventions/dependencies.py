"""Dependencies of the endpoints: the database, read sessions, the client's identity, time ranges."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import ExitStack
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, cast

from anyio import CancelScope
from fastapi import Depends, Path, Query, Request
from fastapi.exceptions import RequestValidationError
from sqlalchemy.orm import Session

from service.api.conventions.request_places import RequestPlaces
from service.api.conventions.times import Time
from service.identification.job_options import Requester
from service.identification.job_quota import JobQuota
from service.security.principal import Principal
from service.security.store import Store
from storage.clock import from_datetime
from storage.findings.job_order import ASKED

LAST_INSTANT = 2**63 - 1
"""Last instant that the store can count, in the year 2262 [ns]."""


def database(request: Request) -> Store:
    """Return the database restricted to what the client may see; changes through it are recorded in the audit trail."""
    return cast(Store, request.state.store)


def principal(request: Request) -> Principal:
    """Return the authenticated client."""
    return cast(Principal, request.state.principal)


def requester(request: Request, priority: int = ASKED) -> Requester:
    """Return who asks for identifications, with their quota of waiting jobs."""
    return Requester(principal(request).identity, cast(JobQuota, request.app.state.job_quota), priority)


async def _reading(request: Request) -> AsyncIterator[Session]:
    places = cast(RequestPlaces, request.app.state.reading_places)
    async with places.place(principal(request).identity, has_gone=request.is_disconnected):
        # Opening a session asks the database nothing yet; closing it may, and is left to a thread, whatever happens meanwhile.
        with ExitStack() as opened:
            yield opened.enter_context(database(request).reading())
            closing = opened.pop_all()
            with CancelScope(shield=True):
                await asyncio.to_thread(closing.close)


def moment(value: datetime | None) -> int | None:
    """Return a time of a query in nanoseconds [ns], limited to the first and the last instant that the store can count."""
    return None if value is None else instant(value)


def instant(value: datetime) -> int:
    """Return a time in nanoseconds [ns], limited to the first and the last instant that the store can count."""
    return max(-LAST_INSTANT, min(LAST_INSTANT, from_datetime(value)))


MICROSECOND = 1_000
"""Resolution of times in answers and queries [ns]."""
Reading = Annotated[Session, Depends(_reading, scope="function")]
"""A session until the answer is made: whoever takes an answer slowly holds no connection."""
MachineId = Annotated[str, Path(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="id of the machine")]
Number = Annotated[int, Path(ge=0, le=2**62)]
From = Annotated[Time | None, Query(alias="from", description="RFC 3339; without a zone it counts as UTC")]
To = Annotated[Time | None, Query(alias="to", description="RFC 3339; without a zone it counts as UTC")]


@dataclass(frozen=True)
class TimeRange:
    """A closed range of time, as the store counts it [ns]; None: open at that end."""

    first: int | None
    last: int | None


async def _period(first: From = None, last: To = None) -> TimeRange:
    begin, end = moment(first), moment(last)
    if end is not None:
        end = min(LAST_INSTANT, end + MICROSECOND - 1)  # answers are cut to whole ones: what they say belongs to it as well
    if begin is not None and end is not None and begin > end:
        message = "from lies behind to: exchange them"
        raise RequestValidationError([{"type": "value_error", "loc": ("query", "from"), "msg": message, "input": str(first)}])
    return TimeRange(begin, end)


Period = Annotated[TimeRange, Depends(_period)]
