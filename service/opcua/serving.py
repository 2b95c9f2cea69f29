"""The thread of the OPC UA server. The library is loaded by it alone, and only where an endpoint is configured."""

import asyncio
import logging
from typing import TYPE_CHECKING

from service.advice.site_texts import SiteTexts
from service.configuration.settings import Settings
from service.resilience.rate_limit import RateLimit
from service.resilience.supervised_thread import SupervisedThread
from storage.database.engine import Database

if TYPE_CHECKING:
    from service.opcua.server import PlantServer

logger = logging.getLogger(__name__)

POLL_S = 0.1
RETRY_S = 1.0
"""Pause after the store did not answer [s]."""
OPEN_AGAIN_S = 10.0
"""Pause after the server could not be opened [s]."""
LIBRARY = "asyncua"
LOGGED_PER_S, LOGGED_AT_ONCE = 0.2, 50.0
OPENING = "the OPC UA server is being opened: clients can connect in a moment"


class OpcUaUnusable(RuntimeError):
    """The server cannot be opened; the message says why, and what would be right."""


class OpcUaDegraded(RuntimeError):
    """The server runs with a fault; the message names it."""


class OpcUaServing(SupervisedThread):
    """The OPC UA server until it is stopped. A pass runs its event loop during the pause too: clients are served meanwhile."""

    def __init__(self, database: Database, settings: Settings, texts: SiteTexts | None = None) -> None:
        super().__init__("opcua", failure="OPC UA clients are not updated", retry_s=RETRY_S)
        self._database = database
        self._settings = settings
        self._texts = texts
        self._loop = asyncio.Runner()
        self._server: PlantServer | None = None
        self.trouble = OPENING

    @property
    def ready(self) -> bool:
        """Return whether clients can connect."""
        return self._server is not None

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system."""
        server = self._server
        return {
            "rundown_opcua_sessions": 0 if server is None else server.sessions,
            "rundown_opcua_monitored_items": 0 if server is None else server.monitored_items,
        }

    def run_once(self) -> float:
        """Update the nodes, then serve clients for POLL_S. Raises OpcUaUnusable, OpcUaDegraded, DBAPIError."""
        if self._server is not None and self._server.certificate_has_expired:
            # Nobody could connect any more: what is in the file now is looked at, and said where it is no better.
            closing, self._server = self._server, None
            self._loop.run(closing.close())
        if self._server is None:
            self._server = self._opened()
        self._loop.run(self._server.update())
        self._loop.run(asyncio.sleep(POLL_S))
        if self._server.trouble is not None:
            raise OpcUaDegraded(self._server.trouble)
        return 0.0

    def failed(self, error: Exception) -> float:
        """Keep an error as `trouble`, and let clients be served until the next attempt."""
        if isinstance(error, OpcUaUnusable):
            if self.trouble != str(error):
                logger.error("%s; trying again", error)
            self.trouble = str(error)
            return OPEN_AGAIN_S
        if isinstance(error, OpcUaDegraded):
            if self.trouble != str(error):
                logger.error("%s", error)
            self.trouble = str(error)
            return 0.0
        pause = super().failed(error)
        self._loop.run(asyncio.sleep(pause))
        return 0.0

    def finish(self) -> None:
        """End the sessions, and stop listening."""
        with self._loop:
            if self._server is not None:
                self._loop.run(self._server.close())

    def _opened(self) -> "PlantServer":
        try:
            from service.opcua.client_trust import CertificateUnusable
            from service.opcua.server import PlantServer
        except ModuleNotFoundError as error:
            raise OpcUaUnusable(f"the OPC UA server needs {error.name}: pip install 'rotorundown[opcua]'") from None
        _bound_log()
        server = PlantServer(self._database, self._settings, self._texts)
        endpoint = self._settings.opcua_listen
        try:
            self._loop.run(server.start())
        except CertificateUnusable as error:
            raise OpcUaUnusable(str(error)) from None
        except OSError as error:
            raise OpcUaUnusable(f"nothing can listen at {endpoint}: {error.strerror or error}") from None
        logger.info("OPC UA: %s", endpoint)
        return server


def _bound_log() -> None:
    """Limit the library's log: it writes several lines a request, and a traceback for each error of a client."""
    library = logging.getLogger(LIBRARY)
    library.setLevel(logging.WARNING)
    limit = RateLimit(per_s=LOGGED_PER_S, burst=LOGGED_AT_ONCE)
    for handler in logging.getLogger().handlers:
        if not any(isinstance(one, _Bound) for one in handler.filters):
            handler.addFilter(_Bound(limit))


class _Bound(logging.Filter):
    """Limits the library's log records; all others pass."""

    def __init__(self, limit: RateLimit) -> None:
        super().__init__()
        self._limit = limit

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a record is written."""
        return not record.name.startswith(LIBRARY) or self._limit.take(LIBRARY) == 0.0
