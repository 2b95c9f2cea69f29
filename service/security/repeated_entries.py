"""Reduces repeated refusals and logins in the audit trail to one entry a minute.

The first is written at once. Further ones of the same principal and operation are counted in memory and written as one entry
when the minute is over: a flood leaves an entry a minute.
"""

import asyncio
import logging
import threading
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace

from sqlalchemy.exc import DBAPIError

from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation

logger = logging.getLogger(__name__)

MINUTE_S = 60.0
LOOK_S = 5.0
"""Time between checks for ended minutes [s]."""
MAXIMUM_COUNTS = 10_000
"""Largest number of separate counts; further ones share one."""
MAXIMUM_ADDRESSES = 100
MANY = "many"


@dataclass
class _Minute:
    ends: float
    latest: AuditedOperation
    count: int = 0
    addresses: set[str] = field(default_factory=set)

    def summary(self) -> AuditedOperation:
        """Return the counted entries as one entry."""
        some = len(self.addresses)
        where = self.latest.address if some == 1 else f"{some}{' or more' if some >= MAXIMUM_ADDRESSES else ''} addresses"
        return replace(self.latest, address=where, outcome=f"{self.latest.outcome}: {self.count} more within a minute")


class RepeatedEntries:
    """Counts of repeated entries, for use from any thread."""

    def __init__(self, database: Database, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._database = database
        self._clock = clock
        self._lock = threading.Lock()
        self._minutes: dict[tuple[str, str, str], _Minute] = {}

    def first(self, entry: AuditedOperation) -> bool:
        """Return whether an entry is the first of its minute and must be written now; count it otherwise."""
        with self._lock:
            minute = self._minutes.get(_kind(entry))
            if minute is None and len(self._minutes) >= MAXIMUM_COUNTS:
                entry = replace(entry, who=MANY, operation=MANY)
                minute = self._minutes.get(_kind(entry))
            if minute is None:
                self._minutes[_kind(entry)] = _Minute(self._clock() + MINUTE_S, entry)
                return True
            minute.latest = entry
            minute.count += 1
            if len(minute.addresses) < MAXIMUM_ADDRESSES:
                minute.addresses.add(entry.address)
            return False

    def write(self, *, everything: bool = False) -> None:
        """Write the counts of ended minutes, or of all. Blocks."""
        entries = self._take_counted(everything=everything)
        if not entries:
            return
        try:
            with self._database.transaction() as session:
                for entry in entries:
                    audit.append(session, entry)
        except DBAPIError as error:
            logger.error("not in the audit trail: %s: %s", entries, error.orig)

    @asynccontextmanager
    async def regular_writing(self) -> AsyncIterator[None]:
        """Write the counts regularly, and the rest at the end."""
        stop = asyncio.Event()
        writing = asyncio.create_task(self._write_until(stop))
        try:
            yield
        finally:
            stop.set()
            await writing

    async def _write_until(self, stop: asyncio.Event) -> None:
        while not stop.is_set():
            try:
                await asyncio.wait_for(stop.wait(), LOOK_S)
            except TimeoutError:
                await asyncio.to_thread(self.write)
        await asyncio.to_thread(self.write, everything=True)

    def _take_counted(self, *, everything: bool) -> list[AuditedOperation]:
        now = self._clock()
        with self._lock:
            over = [kind for kind, minute in self._minutes.items() if everything or minute.ends <= now]
            taken = [(kind, self._minutes.pop(kind)) for kind in over]
            counted = [(kind, minute) for kind, minute in taken if minute.count]
            # Their entry is the first of the minute that begins.
            self._minutes |= {kind: _Minute(now + MINUTE_S, minute.latest) for kind, minute in counted}
            return [minute.summary() for _, minute in counted]


def _kind(entry: AuditedOperation) -> tuple[str, str, str]:
    return entry.who, entry.operation, entry.outcome
