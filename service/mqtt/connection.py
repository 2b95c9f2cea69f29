"""The thread that keeps one connection to the broker: it fails alone, and tries again until the broker answers."""

import asyncio
import logging
from abc import abstractmethod
from contextlib import suppress

import aiomqtt

from service.configuration.mqtt_settings import MqttSettings
from service.mqtt.broker import BrokerError, forget
from service.replication.work_share import Share
from service.resilience.supervised_thread import SupervisedThread

logger = logging.getLogger(__name__)

FIRST_RETRY_S, LONGEST_RETRY_S = 0.5, 15.0
"""Pauses before the broker is tried again: each time twice as long."""
LOOK_S = 0.1
"""Interval at which the thread looks whether it is to stop, or another replica to take over."""
STANDING_BY_S = 1.0


class MqttThread(SupervisedThread):
    """A thread with an event loop of its own for one connection.

    Of several replicas only the one that leads `work` connects.
    """

    def __init__(self, name: str, settings: MqttSettings, share: Share, *, work: str) -> None:
        super().__init__(name, failure="the broker cannot be used", retry_s=FIRST_RETRY_S)
        self._settings = settings
        self._share = share
        self._work = work
        self._retry_pause = FIRST_RETRY_S
        self._client: aiomqtt.Client | None = None
        self.trouble = f"no connection to {settings.mqtt_url} yet"

    @property
    def is_connected(self) -> bool:
        """Return whether the broker answers at present."""
        return self._client is not None

    @abstractmethod
    def new_client(self) -> aiomqtt.Client:
        """Return a client for the next connection."""

    @abstractmethod
    async def use(self, client: aiomqtt.Client) -> None:
        """Work with a connection until it ends or the task is cancelled; call `begun` once it works."""

    async def complete_work(self) -> None:
        """Complete what is under way before the connection is closed."""

    def note_connected(self) -> None:
        """Note that the broker is connected."""
        if self.trouble is not None:
            logger.info("%s: connected to %s", self._thread.name, self._settings.mqtt_url)
        self.trouble, self._retry_pause = None, FIRST_RETRY_S

    def run_once(self) -> float:
        """Work with one connection to its end."""
        if not self._share.is_leader(self._work):
            return STANDING_BY_S
        asyncio.run(self._connection())
        return 0.0

    def failed(self, error: Exception) -> float:
        """Record what is wrong with the broker, and try again after a pause."""
        if not isinstance(error, BrokerError):
            return super().failed(error)
        pause, self._retry_pause = self._retry_pause, min(2.0 * self._retry_pause, LONGEST_RETRY_S)
        trouble = f"{self._settings.mqtt_url} cannot be used: {error}"
        if trouble != self.trouble:
            logger.warning("%s: %s; trying again until it answers", self._thread.name, trouble)
        self.trouble = trouble
        return pause

    @property
    def _goes_on(self) -> bool:
        return not self._stop.is_set() and self._share.is_leader(self._work)

    async def _connection(self) -> None:
        client = self.new_client()
        try:
            async with client:
                self._client = client
                await self._use(client)
        finally:
            self._client = None
            forget(client)

    async def _use(self, client: aiomqtt.Client) -> None:
        """Work with a connection until it ends, the thread is to stop, or another replica takes over."""
        using = asyncio.create_task(self.use(client))
        while self._goes_on and not using.done():
            await asyncio.wait([using], timeout=LOOK_S)
        if not using.done():
            await self.complete_work()
            using.cancel()
        with suppress(asyncio.CancelledError):
            await using
