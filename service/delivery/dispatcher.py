"""The thread that empties the outbox: what is due is sent, what failed is tried again later, by Standard Webhooks' schedule.

The database is asked often and cheaply instead of being rung for: an event that another process wrote is found as well.
"""

import asyncio
import logging
import threading
import time
from collections import Counter
from collections.abc import Coroutine
from dataclasses import dataclass
from typing import Any

import zenoh
from aiohttp import ClientSession, ClientTimeout, DummyCookieJar, TCPConnector
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from service import alerting
from service.alert_life import Severity
from service.alert_messages import AlertEvent, alert_event
from service.delivery.alertmanager import FIRING, RESEND_S, Alertmanager
from service.delivery.channel import Channel, DeliveryOutcome, EventMessage
from service.delivery.mail import Mail
from service.delivery.network import Network
from service.delivery.secret_upkeep import SecretWatch
from service.delivery.signing_secrets import SecretUnusable, SigningSecrets
from service.delivery.webhook import TIMEOUT_S, Unsigned, Webhook
from service.settings import Settings
from service.sharing import DELIVERY, Share, Whole
from storage import alerts, deliveries, machines
from storage.clock import now, to_datetime
from storage.damage import is_damage
from storage.database import Database
from storage.errors import concerns_all
from storage.plain_text import plain_text
from storage.tables import AlertEventRow, DeliveryRow, SubscriptionRow

logger = logging.getLogger(__name__)

POLL_S = 0.05
AT_ONCE = 4
"""Deliveries under way to one subscription: a receiver that hangs holds up as many and no more."""
DEADLINE_S = 30.0
"""After so long a try has failed, whatever it waits for: a name server, a turn, a server that says a word now and then."""
LARGEST_TAKE = 500
"""Deliveries begun in one look."""
RETRIES_S = (5.0, 300.0, 1800.0, 7200.0, 18_000.0, 36_000.0, 50_400.0, 72_000.0, 86_400.0)
"""Pauses before the second try and each later one; then it is given up."""
LONGEST_WISH_S = 86_400.0
RETRY_S = 1.0
"""Pause after the database did not answer."""
EXPIRY_S = 1.0
"""How often suppressions whose time is over are looked for."""
SECRETS_S = 10.0
"""How often it is looked whether all webhooks can be signed."""
SECOND = 1_000_000_000


@dataclass(frozen=True)
class DeliveryTask:
    """A delivery under way."""

    delivery_id: int
    subscription_id: int
    message: EventMessage
    channel: Channel


@dataclass(frozen=True)
class Channels:
    """Makes the channel of a subscription."""

    client: ClientSession
    session: zenoh.Session
    settings: Settings
    secrets: SigningSecrets

    def of(self, row: SubscriptionRow) -> Channel:
        """The channel of a subscription."""
        allowed = tuple(self.settings.delivery_networks)
        if row.kind == "webhook":
            try:
                return Webhook(self.client, row.target, self.secrets.reveal(row), allowed)
            except SecretUnusable as error:
                return Unsigned(str(error))
        if row.kind == "alertmanager":
            return Alertmanager(self.client, row.target, allowed, self.settings.public_url)
        if row.kind == "email":
            return Mail(self.settings, row.target)
        return Network(self.session)


def new_client() -> ClientSession:
    """For all receivers, as many connections as it takes: those of receivers that hang must not be missing for others."""
    return ClientSession(
        connector=TCPConnector(limit=0),
        timeout=ClientTimeout(total=TIMEOUT_S),
        cookie_jar=DummyCookieJar(),
        auto_decompress=False,
    )


class Unrecorded(RuntimeError):
    """How some deliveries ended cannot be written down; they are not sent again before it is."""


class Dispatcher:
    """Delivers until it is stopped; what is then under way is delivered again after the next start."""

    def __init__(
        self,
        database: Database,
        session: zenoh.Session,
        settings: Settings,
        share: Share | None = None,
        secrets: SigningSecrets | None = None,
    ) -> None:
        self._database = database
        self._secrets = secrets or SigningSecrets.of(settings)
        self.watch = SecretWatch(database, self._secrets)
        """Of the secrets that sign."""
        self._share = share or Whole()
        self._session = session
        self._settings = settings
        self._stop = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run()), name="delivery", daemon=True)
        self._under_way: dict[int, asyncio.Task[DeliveryOutcome]] = {}
        self._tasks: dict[int, DeliveryTask] = {}
        self._resending: asyncio.Task[None] | None = None
        self._expire_at = 0.0
        self._resend_at = 0.0
        self._watch_at = 0.0
        self.trouble: str | None = None
        """Why nothing can be delivered at the moment."""

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """Deliver no more."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    async def _run(self) -> None:
        async with new_client() as client:
            channels = Channels(client, self._session, self._settings, self._secrets)
            while not self._stop.is_set():
                pause = POLL_S
                try:
                    await self._look(channels)
                    self.trouble = None
                except DBAPIError as error:
                    self.trouble = str(error.orig)
                    logger.error("alert deliveries cannot be read or recorded, trying again: %s", error.orig)
                    pause = RETRY_S
                except Unrecorded as error:
                    self.trouble = str(error)
                    pause = RETRY_S
                except Exception:
                    self.trouble = "unexpected error; the log has it"
                    logger.exception("unexpected error in the delivery thread")
                    pause = RETRY_S
                await asyncio.sleep(pause)
            left = [*self._under_way.values(), *([self._resending] if self._resending else [])]
            for one in left:
                one.cancel()
            await asyncio.gather(*left, return_exceptions=True)

    async def _look(self, channels: Channels) -> None:
        """Record what has finished, then begin what is due. Raises Unrecorded, at the end."""
        finished = {number: _ended(one) for number, one in self._under_way.items() if one.done()}
        if finished:
            for number in await asyncio.to_thread(self._record, finished):
                del self._under_way[number], self._tasks[number], finished[number]
        await self._begin(channels)
        if finished:
            raise Unrecorded(f"how {len(finished)} alert deliveries ended cannot be recorded; the log says why")

    async def _begin(self, channels: Channels) -> None:
        """Send what is due."""
        moment = time.monotonic()
        if moment >= self._watch_at:
            self._watch_at = moment + SECRETS_S
            await asyncio.to_thread(self.watch.look)
        if not self._share.leads(DELIVERY):
            return
        if moment >= self._expire_at:
            self._expire_at = moment + EXPIRY_S
            await asyncio.to_thread(self._expire)
        for task in await asyncio.to_thread(self._due, channels):
            self._tasks[task.delivery_id] = task
            self._under_way[task.delivery_id] = asyncio.create_task(_sent(task))
        if moment >= self._resend_at and (self._resending is None or self._resending.done()):
            self._resend_at = moment + RESEND_S
            self._resending = asyncio.create_task(self._resend(channels))

    def _due(self, channels: Channels) -> list[DeliveryTask]:
        load = Counter(task.subscription_id for task in self._tasks.values())
        busy = [subscription for subscription, count in load.items() if count >= AT_ONCE]
        found: list[DeliveryTask] = []
        unsayable: dict[int, str] = {}
        with self._database.reading() as session:
            for row in deliveries.due(session, now(), busy=busy, limit=LARGEST_TAKE):
                if row.id in self._tasks or load[row.subscription_id] >= AT_ONCE:
                    continue
                try:
                    with session.begin_nested():
                        found.append(_task(session, row, channels))
                    load[row.subscription_id] += 1
                except MemoryError:
                    raise  # of the moment, not of the row
                except Exception as error:
                    if concerns_all(error):
                        raise  # so is this
                    logger.exception("delivery %d of event %d cannot be made into a message", row.id, row.event_id)
                    unsayable[row.id] = f"event {row.event_id} cannot be made into a message: {type(error).__name__}: {error}"
        if unsayable:
            self._give_up(unsayable)
        return found

    def _give_up(self, reasons: dict[int, str]) -> None:
        """Try no more: later events of the same alerts wait behind these."""
        with self._database.transaction() as session:
            for number, reason in reasons.items():
                row = deliveries.delivery(session, number)
                row.state, row.last_try_at, row.answer = deliveries.GIVEN_UP, now(), plain_text(reason)[:2000]

    def _record(self, finished: dict[int, DeliveryOutcome]) -> list[int]:
        """Write down how deliveries ended; returns which need no more of it. One that cannot be stops no other."""
        try:
            return self._record_together(finished)
        except DBAPIError as error:
            if concerns_all(error):
                raise
        done = []
        for number, outcome in finished.items():
            try:
                done += self._record_together({number: outcome})
            except DBAPIError as error:
                if concerns_all(error):
                    raise
                logger.error("how delivery %d ended cannot be recorded: %s", number, error.orig)
        return done

    def _record_together(self, finished: dict[int, DeliveryOutcome]) -> list[int]:
        """In one transaction. Raises DBAPIError, also of damage: behind that, SQLite writes nothing more in one."""
        done = []
        with self._database.transaction() as session:
            for number, outcome in finished.items():
                try:
                    with session.begin_nested():
                        _note(session, number, outcome)
                except deliveries.DeliveryUnknown:
                    logger.warning("delivery %d has ended, and is not in the database any more", number)
                except (DataError, IntegrityError):
                    logger.exception("how delivery %d ended cannot be recorded", number)
                    continue
                except Exception as error:
                    if concerns_all(error) or is_damage(error):
                        raise  # of the database, which is asked again
                    logger.exception("how delivery %d ended cannot be recorded", number)
                    continue
                done.append(number)
        return done

    def _expire(self) -> None:
        with self._database.reading() as session:
            if not alerting.any_over(session):
                return
        with self._database.transaction() as session:
            alerting.release_over(session)

    async def _resend(self, channels: Channels) -> None:
        """Tell every Alertmanager of all alerts that last."""
        try:
            targets, messages = await asyncio.to_thread(self._lasting)
        except DBAPIError as error:
            logger.error("lasting alerts cannot be read: %s", error.orig)
            return
        except Exception:
            logger.exception("unexpected error while lasting alerts are read")
            return
        # At the same time: behind some that hang, the others would take the alerts for resolved.
        await asyncio.gather(*(_remind(row, channels.of(row), messages) for row in targets))

    def _lasting(self) -> tuple[list[SubscriptionRow], list[EventMessage]]:
        with self._database.reading() as session:
            rows = [row for row in deliveries.every(session) if row.kind == "alertmanager" and row.state == deliveries.ACTIVE]
            if not rows:
                return [], []
            found = []
            for alert in alerts.find(session, machine_id=None, only_open=True, limit=10_000):
                if alert.state not in FIRING:
                    continue
                try:
                    found.append(_message(session, alerts.history(session, alert.id)[-1]))
                except MemoryError:
                    raise
                except Exception as error:
                    if concerns_all(error):
                        raise
                    logger.exception("no Alertmanager is told that alert %d lasts", alert.id)
            return rows, found

    async def try_out(self, subscription_id: int) -> DeliveryOutcome:
        """Send a test message to a subscription, from whatever loop. Raises SubscriptionUnknown."""

        def found() -> SubscriptionRow:
            with self._database.reading() as session:
                return deliveries.get(session, subscription_id)

        row = await asyncio.to_thread(found)
        async with new_client() as client:
            channel = Channels(client, self._session, self._settings, self._secrets).of(row)
            return await _sent(DeliveryTask(0, row.id, test_message(), channel))


def test_message() -> EventMessage:
    """A message that says that it is none."""
    moment = to_datetime(now())
    event = AlertEvent(
        id=0,
        alert=0,
        number=1,
        machine="test",
        rule="test",
        element="test",
        at=moment,
        kind="test",
        state_before="normal",
        state="normal",
        severity=Severity.ALERT.label,
        message="This is a test of Rundown's alert delivery; no machine is meant.",
        by=alerting.SERVICE,
        comment="",
        opened_at=moment,
        identification=0,
    )
    return EventMessage(event, "test")


def _message(session: Session, event: AlertEventRow) -> EventMessage:
    return EventMessage(alert_event(event), machines.get(session, event.machine_id).plant)


def _task(session: Session, row: DeliveryRow, channels: Channels) -> DeliveryTask:
    channel = channels.of(deliveries.get(session, row.subscription_id))
    return DeliveryTask(row.id, row.subscription_id, _message(session, session.get_one(AlertEventRow, row.event_id)), channel)


def _note(session: Session, number: int, outcome: DeliveryOutcome) -> None:
    """Write down how a delivery ended, and when it is tried again. Raises DeliveryUnknown."""
    row = deliveries.delivery(session, number)
    row.attempts += 1
    row.last_try_at = now()
    answer = row.answer = plain_text(outcome.answer)[:2000]  # of a stranger: it must not stop what others are told
    if outcome.result == "delivered":
        row.state = deliveries.DELIVERED
    elif outcome.result == "gone":
        row.state = deliveries.GIVEN_UP
        subscription = deliveries.get(session, row.subscription_id)
        deliveries.disable(session, subscription, f"the receiver answered {answer[:200]}")
        logger.warning("subscription '%s' is disabled: its receiver is gone", subscription.name)
    elif row.attempts > len(RETRIES_S):
        row.state = deliveries.GIVEN_UP
        logger.warning("delivery %d is given up after %d tries: %s", number, row.attempts, answer[:200])
    elif row.state == deliveries.PENDING:
        wish = min(outcome.retry_after or 0.0, LONGEST_WISH_S)
        row.next_try_at = now() + int(max(RETRIES_S[row.attempts - 1], wish) * SECOND)


def _ended(one: asyncio.Task[DeliveryOutcome]) -> DeliveryOutcome:
    """How a delivery ended, also where it broke off in a way that no channel should."""
    error = asyncio.CancelledError() if one.cancelled() else one.exception()
    return one.result() if error is None else DeliveryOutcome("failed", f"{type(error).__name__}: {error}")


async def _remind(row: SubscriptionRow, channel: Channel, messages: list[EventMessage]) -> None:
    """Tell one Alertmanager of what lasts."""
    own = [one for one in messages if deliveries.tells(row, one.plant)]
    if own and isinstance(channel, Alertmanager):
        outcome = await _in_time(channel.push(own))
        if outcome.result != "delivered":
            logger.warning("Alertmanager '%s' cannot be told of lasting alerts: %s", row.name, outcome.answer[:200])


async def _sent(task: DeliveryTask) -> DeliveryOutcome:
    return await _in_time(task.channel.send(task.message))


async def _in_time(sending: Coroutine[Any, Any, DeliveryOutcome]) -> DeliveryOutcome:
    try:
        return await asyncio.wait_for(sending, DEADLINE_S)
    except TimeoutError:
        return DeliveryOutcome("failed", f"it was not done within {DEADLINE_S:g} s")
    except Exception as error:  # noqa: BLE001 - whatever a channel meets becomes the delivery's recorded failure
        return DeliveryOutcome("failed", f"{type(error).__name__}: {error}")
