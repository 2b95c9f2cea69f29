"""Checks whether the database answers within a time limit: a hanging database would block every caller."""

import asyncio
import threading
import time
from concurrent.futures import Future

from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.findings import jobs

PATIENCE_S = 3.0
"""Time limit of an answer [s]."""


class DatabaseCheck:
    """Database checks in a thread of their own, one at a time: callers meanwhile wait for the same answer.

    An instance belongs to one event loop. It uses none of the request threads, which may all be blocked.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._pending: Future[dict[str, int]] | None = None
        self._since = 0.0

    async def jobs(self) -> dict[str, int]:
        """Count the identification jobs by state. Raises DatabaseUnusable, DBAPIError."""
        if self._pending is None or self._pending.done():
            self._pending, self._since = Future(), time.monotonic()
            threading.Thread(target=self._count_jobs, args=(self._pending,), name="database check", daemon=True).start()
        since = self._since
        left = max(0.0, since + PATIENCE_S - time.monotonic())
        try:
            # Shielded: other callers wait for it too.
            return await asyncio.wait_for(asyncio.shield(asyncio.wrap_future(self._pending)), left)
        except TimeoutError:
            said = f"the database has not answered for {time.monotonic() - since:.0f} s"
            raise DatabaseUnusable(said, outline=said) from None

    def _count_jobs(self, asked: "Future[dict[str, int]]") -> None:
        try:
            self._database.check()
            with self._database.reading() as session:
                found = jobs.count(session)
        except Exception as error:  # noqa: BLE001 - whoever asked is told
            asked.set_exception(error)
        else:
            asked.set_result(found)
