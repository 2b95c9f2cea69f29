"""Checks whether the database answers, within a bounded time: one that hangs would hold whoever asks it."""

import asyncio
import threading
import time
from concurrent.futures import Future

from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.findings import jobs

PATIENCE_S = 3.0
"""An answer that takes longer is none."""


class DatabaseCheck:
    """Asks from a thread of its own, one question at a time: who asks meanwhile waits for the same answer.

    Belongs to one event loop. None of the threads that work on requests is needed: all of them may be held.
    """

    def __init__(self, database: Database) -> None:
        self._database = database
        self._asked: Future[dict[str, int]] | None = None
        self._since = 0.0

    async def jobs(self) -> dict[str, int]:
        """Count the identification jobs by state. Raises DatabaseUnusable, DBAPIError."""
        if self._asked is None or self._asked.done():
            self._asked, self._since = Future(), time.monotonic()
            threading.Thread(target=self._ask, args=(self._asked,), name="database check", daemon=True).start()
        since = self._since
        left = max(0.0, since + PATIENCE_S - time.monotonic())
        try:
            # Shielded: others wait for it, too.
            return await asyncio.wait_for(asyncio.shield(asyncio.wrap_future(self._asked)), left)
        except TimeoutError:
            raise DatabaseUnusable(f"the database has not answered for {time.monotonic() - since:.0f} s") from None

    def _ask(self, asked: "Future[dict[str, int]]") -> None:
        try:
            self._database.check()
            with self._database.reading() as session:
                found = jobs.count(session)
        except Exception as error:  # noqa: BLE001 - whoever asked is told
            asked.set_exception(error)
        else:
            asked.set_result(found)
