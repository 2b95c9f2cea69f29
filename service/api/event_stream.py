"""Alert events as server-sent events: live, and from any event on for a client that was away.

Source: WHATWG HTML, "Server-sent events". One task reads new events for all clients; each client has a bounded queue, and one
that does not read is let go: it comes back with its `Last-Event-ID` and loses nothing.
"""

import asyncio
import logging
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from fastapi.responses import StreamingResponse
from sqlalchemy.exc import DBAPIError

from service.alert_messages import AlertEvent, alert_event
from service.api.access import database
from storage import alerts
from storage.database import Database

logger = logging.getLogger(__name__)
router = APIRouter(tags=["alerts"])

POLL_S = 0.05
"""How often the event table is asked for news: a bell inside the process would not ring for events that another one wrote."""
RETRY_S = 1.0
KEEP_ALIVE_S = 15.0
"""A comment as often as this tells proxies and clients that the stream lives."""
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
PAGE = 500
"""Events read at once for a client that was away."""


@dataclass(eq=False)
class Client:
    """One reader. joined: it gets every event behind this one; slow: it gets no more, and must come back."""

    joined: int
    queue: asyncio.Queue[AlertEvent] = field(default_factory=lambda: asyncio.Queue(QUEUE_SIZE))
    slow: bool = False


class Broadcaster:
    """Hands each new event to every client. Reads the table only while there are clients."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._clients: set[Client] = set()
        self._joining = asyncio.Lock()
        self._task: asyncio.Task[None] | None = None
        self._last = 0

    @property
    def clients(self) -> int:
        """How many read."""
        return len(self._clients)

    async def join(self) -> Client:
        """A new client."""
        async with self._joining:
            if self._task is None or self._task.done():
                self._last = await asyncio.to_thread(self._newest)
                self._task = asyncio.create_task(self._run())
            client = Client(self._last)
            self._clients.add(client)
            return client

    def leave(self, client: Client) -> None:
        """A client is gone."""
        self._clients.discard(client)

    def page(self, after: int) -> list[AlertEvent]:
        """Some events behind a number, oldest first."""
        with self._database.reading() as session:
            return [alert_event(row) for row in alerts.events_after(session, after, limit=PAGE)]

    def _newest(self) -> int:
        with self._database.reading() as session:
            return alerts.newest_event(session)

    async def _run(self) -> None:
        while True:
            try:
                for event in await asyncio.to_thread(self.page, self._last):
                    self._hand_out(event)
                pause = POLL_S
            except DBAPIError as error:
                logger.error("alert events cannot be read, trying again: %s", error.orig)
                pause = RETRY_S
            await asyncio.sleep(pause)
            if not self._clients:
                return

    def _hand_out(self, event: AlertEvent) -> None:
        self._last = event.id
        for client in list(self._clients):
            if client.queue.full():
                client.slow = True
                self._clients.discard(client)
            else:
                client.queue.put_nowait(event)


def _text(event: AlertEvent) -> str:
    return f"id: {event.id}\nevent: alert\ndata: {event.model_dump_json()}\n\n"


async def stream(broadcaster: Broadcaster, after: int | None) -> AsyncIterator[str]:
    """Events behind `after`, or from now on, for ever; ends when the client does not keep up."""
    client = await broadcaster.join()
    try:
        yield ": who comes back with the last id in Last-Event-ID misses nothing\nretry: 1000\n\n"
        last = client.joined if after is None else after
        while last < client.joined and (page := await asyncio.to_thread(broadcaster.page, last)):
            for event in page:
                yield _text(event)
            last = page[-1].id
        while not (client.slow and client.queue.empty()):
            try:
                news = await asyncio.wait_for(client.queue.get(), KEEP_ALIVE_S)
            except TimeoutError:
                yield ": still here\n\n"
                continue
            if news.id > last:
                yield _text(news)
                last = news.id
    finally:
        broadcaster.leave(client)


@router.get(
    "/alert-events/stream",
    operation_id="stream_alert_events",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {"schema": EVENT_SCHEMA}}}},
)
async def stream_alert_events(
    request: Request,
    last_event_id: Annotated[int | None, Header(ge=0, le=2**62, description="continue behind this event")] = None,
    after: Annotated[int | None, Query(ge=0, le=2**62, description="the same, for clients that cannot set headers")] = None,
) -> StreamingResponse:
    """Alert events as they happen (server-sent events); `data` is an alert event in JSON."""
    broadcaster: Broadcaster = request.app.state.broadcaster
    database(request).check()
    begin = last_event_id if last_event_id is not None else after
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(stream(broadcaster, begin), media_type="text/event-stream", headers=headers)
