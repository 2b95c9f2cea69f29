"""The thread that empties the outbox: it sends due deliveries and retries failed ones after Standard Webhooks' schedule.

It polls the database, often and cheaply, to find the events of other processes as well.
"""

import asyncio
import time
from contextlib import AsyncExitStack

import zenoh

from service.advice.site_texts import SiteTexts
from service.alerts import transitions
from service.configuration.settings import Settings
from service.delivery.channel import DeliveryOutcome
from service.delivery.channel_kind import Connections, EventBroker
from service.delivery.channels import new_client, open_channel
from service.delivery.messages import trial_message
from service.delivery.outbox import Delivery, Outbox
from service.delivery.reminders import RESEND_S, remind
from service.delivery.secret_upkeep import SecretWatch
from service.delivery.sending import outcome_of, within_deadline
from service.delivery.signing_secrets import SigningSecrets
from service.replication.work_share import DELIVERY, Share, WholeShare
from service.resilience.supervised_thread import SupervisedThread
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.tables.alerting import SubscriptionRow

POLL_S = 0.05
RETRY_S = 1.0
"""Pause after the database did not answer [s]."""
EXPIRY_S = 1.0
"""Time between searches for expired suppressions [s]."""
SECRETS_S = 10.0
"""Time between checks whether all webhooks can be signed [s]."""


class Unrecorded(RuntimeError):
    """Outcomes of some deliveries cannot be stored; these are not sent again before they are."""


class Dispatcher(SupervisedThread):
    """Delivery of alert events until it is stopped; interrupted deliveries are repeated after the next start.

    A turn runs the thread's event loop for its pause too: deliveries go on meanwhile.
    """

    def __init__(
        self,
        database: Database,
        session: zenoh.Session,
        settings: Settings,
        share: Share | None = None,
        secrets: SigningSecrets | None = None,
        broker: EventBroker | None = None,
        texts: SiteTexts | None = None,
    ) -> None:
        super().__init__("delivery", failure="alert deliveries cannot be read or recorded", retry_s=RETRY_S)
        self._database = database
        self._outbox = Outbox(database)
        self._secrets = secrets or SigningSecrets.of(settings)
        self.watch = SecretWatch(database, self._secrets)
        """Watch of the signing secrets."""
        self._share = share or WholeShare()
        self._session = session
        self._broker = broker
        self._settings = settings
        self._texts = texts or SiteTexts()
        self._loop = asyncio.Runner()
        self._open = AsyncExitStack()
        self._connections: Connections | None = None
        self._under_way: dict[int, asyncio.Task[DeliveryOutcome]] = {}
        self._deliveries: dict[int, Delivery] = {}
        self._resending: asyncio.Task[None] | None = None
        self._expire_at = 0.0
        self._resend_at = 0.0
        self._watch_at = 0.0

    def run_once(self) -> float:
        """Look for finished and due deliveries, then let those under way go on for POLL_S."""
        self._loop.run(self._update_deliveries())
        self._loop.run(asyncio.sleep(POLL_S))
        return 0.0

    def failed(self, error: Exception) -> float:
        """Keep an error as `trouble`, and let the deliveries under way go on until the next attempt."""
        if isinstance(error, Unrecorded):
            self.trouble, pause = str(error), RETRY_S
        else:
            pause = super().failed(error)
        self._loop.run(asyncio.sleep(pause))
        return 0.0

    def finish(self) -> None:
        """Cancel the deliveries under way and close the connections."""
        with self._loop:
            self._loop.run(self._close())

    async def _close(self) -> None:
        left = [*self._under_way.values(), *([self._resending] if self._resending else [])]
        for one in left:
            one.cancel()
        await asyncio.gather(*left, return_exceptions=True)
        await self._open.aclose()

    async def _update_deliveries(self) -> None:
        """Record finished deliveries, then begin those that are due. Raises Unrecorded, at the end."""
        if self._connections is None:
            client = await self._open.enter_async_context(new_client())
            self._connections = Connections(client, self._session, self._settings, self._secrets, self._broker, self._texts)
        finished = {number: outcome_of(one) for number, one in self._under_way.items() if one.done()}
        if finished:
            for number in await asyncio.to_thread(self._outbox.record, finished):
                del self._under_way[number], self._deliveries[number], finished[number]
        await self._begin(self._connections)
        if finished:
            raise Unrecorded(f"how {len(finished)} alert deliveries ended cannot be recorded; the log says why")

    async def _begin(self, connections: Connections) -> None:
        """Begin the due deliveries, checks and reminders."""
        moment = time.monotonic()
        if moment >= self._watch_at:
            self._watch_at = moment + SECRETS_S
            await asyncio.to_thread(self.watch.check)
        if not self._share.is_leader(DELIVERY):
            return
        if moment >= self._expire_at:
            self._expire_at = moment + EXPIRY_S
            await asyncio.to_thread(self._expire)
        for one in await asyncio.to_thread(self._outbox.due, self._deliveries, connections):
            self._deliveries[one.id] = one
            self._under_way[one.id] = asyncio.create_task(_send(one))
        if moment >= self._resend_at and (self._resending is None or self._resending.done()):
            self._resend_at = moment + RESEND_S
            self._resending = asyncio.create_task(remind(self._database, connections))

    def _expire(self) -> None:
        while True:
            with self._database.reading() as session:
                if not transitions.any_expired(session):
                    return
            with self._database.transaction() as session:
                transitions.release_expired(session)

    async def send_test(self, subscription_id: int) -> DeliveryOutcome:
        """Send a test message to a subscription, from any event loop. Raises SubscriptionUnknown."""

        def found() -> SubscriptionRow:
            with self._database.reading() as session:
                return deliveries.get(session, subscription_id)

        row = await asyncio.to_thread(found)
        async with new_client() as client:
            channel = open_channel(
                row, Connections(client, self._session, self._settings, self._secrets, self._broker, self._texts)
            )
            return await within_deadline(channel.send(trial_message(self._texts.language)))


async def _send(one: Delivery) -> DeliveryOutcome:
    return await within_deadline(one.channel.send(one.message))
