"""Alert events as server-sent events: live, and from any event on for a client that was disconnected.

Source: WHATWG HTML, "Server-sent events". One task reads new events for all clients. Each client has a bounded queue; a client
that does not keep up is disconnected and resumes with its `Last-Event-ID`, without losing events.
"""

import asyncio
import logging
import threading
from collections import OrderedDict
from collections.abc import AsyncGenerator, Awaitable, Callable
from dataclasses import dataclass, field
from typing import Annotated, cast

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import StreamingResponse

from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.api.conventions.dependencies import database, principal
from service.resilience.supervised_thread import report_failure
from service.security.requirement import VIEWER
from service.security.scope import Visibility
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.alerting import AlertEventRow

logger = logging.getLogger(__name__)
router = APIRouter(tags=["alerts"], dependencies=[VIEWER])

POLL_S = 0.05
"""Time between queries for new events [s]: other processes write events too, and an in-process signal would miss these."""
RETRY_S = 1.0
KEEP_ALIVE_S = 15.0
"""Time between keep-alive comments, by which proxies and clients see that the stream lives [s]."""
QUEUE_SIZE = 256
EVENT_SCHEMA = {
    "type": "object",
    "description": "each event",
    "properties": {
        "id": {"type": "string", "description": "for Last-Event-ID"},
        "event": {"const": "alert"},
        "data": {"type": "string", "description": "an AlertEvent", "contentMediaType": "application/json"},
    },
}
PAGE = 100
"""Events in one page of the backlog, which returning clients share."""
PAGES = 8
"""Largest number of cached pages."""


@dataclass(frozen=True)
class StreamEvent:
    """An event with its serialised bytes, which all clients share. event: None where it cannot be rendered."""

    number: int
    event: AlertEvent | None
    text: bytes = b""


@dataclass(eq=False)
class Client:
    """One reader of the stream.

    joined: it gets every event behind this one. slow: it gets no further events and must reconnect. None in its queue: the
    service stops.
    """

    joined: int
    queue: asyncio.Queue[StreamEvent | None] = field(default_factory=lambda: asyncio.Queue(QUEUE_SIZE))
    slow: bool = False


class Broadcaster:
    """Broadcast of each new event to every client. The table is read only while there are clients."""

    def __init__(self, database: Database, texts: SiteTexts | None = None) -> None:
        self._database = database
        self._texts = texts or SiteTexts()
        self._clients: set[Client] = set()
        self._joining = asyncio.Lock()
        self._task: asyncio.Task[None] | None = None
        self._last = 0
        self._ended = False
        self._pages: OrderedDict[int, list[StreamEvent]] = OrderedDict()
        self._lock = threading.Lock()  # of the pages
        self.trouble: str | None = None
        """Reason why no events are sent at the moment."""

    @property
    def clients(self) -> int:
        """Count the connected clients."""
        return len(self._clients)

    async def join(self) -> Client:
        """Add a client."""
        async with self._joining:
            if self._task is None or self._task.done():
                if not self._clients:  # else they would miss what they have not been told yet
                    self._last = await asyncio.to_thread(self.newest)
                self._task = asyncio.create_task(self._run())
            client = Client(self._last)
            if self._ended:
                client.slow = True
            else:
                self._clients.add(client)
            return client

    def remove(self, client: Client) -> None:
        """Remove a client that has disconnected."""
        self._clients.discard(client)

    def end(self) -> None:
        """End all streams, once their clients have received the queued events."""
        self._ended = True
        for client in self._clients:
            client.slow = True
            if client.queue.empty():
                client.queue.put_nowait(None)
        self._clients.clear()

    def page(self, after: int) -> list[StreamEvent]:
        """Return a page of events behind a number, oldest first; empty only where no more exist."""
        first = after // PAGE * PAGE
        with self._lock:
            page = self._pages.get(first)
            if page is None:
                page = self._read(first)
                if len(page) == PAGE:  # nothing will be added to it
                    self._pages[first] = page
                    while len(self._pages) > PAGES:
                        self._pages.popitem(last=False)
        return [one for one in page if one.number > after]

    def _read(self, after: int) -> list[StreamEvent]:
        with self._database.reading() as session:
            return [_stream_event(row, self._texts) for row in alerts.events_after(session, after, limit=PAGE)]

    def newest(self) -> int:
        """Return the number of the newest event."""
        with self._database.reading() as session:
            return alerts.newest_event(session)

    async def _run(self) -> None:
        # Not a SupervisedThread: a task of the API's event loop, whose queues it fills, that ends with the last client.
        while True:
            try:
                for one in await asyncio.to_thread(self._read, self._last):
                    self._dispatch(one)
                self.trouble = None
            except Exception as error:  # noqa: BLE001 - it is logged
                self.trouble = report_failure(logger, "alert events cannot be read", error)
            await asyncio.sleep(RETRY_S if self.trouble else POLL_S)
            if not self._clients:
                self.trouble = None  # nobody's
                return

    def _dispatch(self, one: StreamEvent) -> None:
        self._last = one.number
        for client in list(self._clients):
            if client.queue.full():
                client.slow = True
                self._clients.discard(client)
            else:
                client.queue.put_nowait(one)


def _stream_event(row: AlertEventRow, texts: SiteTexts) -> StreamEvent:
    """Return an event with its text; an event that cannot be rendered has none, so that later ones still get through."""
    try:
        event = alert_event(row, texts)
        return StreamEvent(row.id, event, _text(event))
    except (ValueError, OverflowError):
        logger.exception("alert event %d cannot be sent to streams", row.id)
        return StreamEvent(row.id, None)


def _text(event: AlertEvent) -> bytes:
    return f"id: {event.id}\nevent: alert\ndata: {event.model_dump_json()}\n\n".encode()


async def _always_valid() -> bool:
    return True


def _all_visible(_event: AlertEvent) -> bool:
    return True


def _is_visible(sees: Callable[[AlertEvent], bool], one: StreamEvent) -> bool:
    return one.event is not None and sees(one.event)


async def stream(
    broadcaster: Broadcaster,
    after: int | None,
    *,
    sees: Callable[[AlertEvent], bool] = _all_visible,
    still_valid: Callable[[], Awaitable[bool]] = _always_valid,
) -> AsyncGenerator[bytes]:
    """Yield events behind `after` that the client sees, or from now on, without end; first the id behind which they begin.

    An `after` beyond the newest event belongs to another store, such as the one before a restore: the stream then begins now.
    It ends when the client does not keep up, or when `still_valid` finds its credentials no longer valid.
    """
    client = await broadcaster.join()
    try:
        last = client.joined if after is None else after
        if last > client.joined and last > await asyncio.to_thread(broadcaster.newest):
            yield f": there is no event {last}: this begins behind the newest one, ask for the alerts anew\n".encode()
            last = client.joined
        yield f": who comes back with the last id in Last-Event-ID misses nothing\nid: {last}\nretry: 1000\n\n".encode()
        while last < client.joined and (page := await asyncio.to_thread(broadcaster.page, last)):
            for one in page:
                if _is_visible(sees, one):
                    yield one.text
            last = page[-1].number
        while not (client.slow and client.queue.empty()):
            try:
                news = await asyncio.wait_for(client.queue.get(), KEEP_ALIVE_S)
            except TimeoutError:
                if not await still_valid():
                    return
                yield b": still here\n\n"
                continue
            if not await still_valid():
                return
            if news is not None and news.number > last:
                if _is_visible(sees, news):
                    yield news.text
                last = news.number
    finally:
        broadcaster.remove(client)


@router.get(
    "/alert-events/stream",
    operation_id="stream_alert_events",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {"schema": EVENT_SCHEMA}}}},
)
async def stream_alert_events(
    request: Request,
    last_event_id: Annotated[int | None, Header(ge=0, le=2**62, description="continue after this event")] = None,
    after: Annotated[int | None, Query(ge=0, le=2**62, description="the same, for clients that cannot set headers")] = None,
) -> StreamingResponse:
    """Stream alert events as they happen (server-sent events); `data` is an alert event in JSON."""
    broadcaster: Broadcaster = request.app.state.broadcaster
    database(request).check()
    begin = last_event_id if last_event_id is not None else after
    who, visibility = principal(request), cast(Visibility, request.app.state.visibility)
    events = stream(
        broadcaster, begin, sees=lambda event: visibility.sees(who, event.machine), still_valid=request.state.still_valid
    )
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)
