"""Repository of subscriptions and of the outbox, which holds the events that are still to be delivered."""

from collections.abc import Collection, Sequence

from sqlalchemy import Integer, bindparam, func, or_, select, update
from sqlalchemy.orm import Session

from estimator.errors import Conflict, Missing
from storage.clock import TOLERANCE, now
from storage.database.plant_scope import EVERY_PLANT
from storage.paging import Keys, ordered
from storage.tables.alerting import AlertEventRow, DeliveryRow, SubscriptionPlantRow, SubscriptionRow
from storage.tables.machines import MachineRow

ACTIVE, DISABLED = "active", "disabled"
MOST_ACTIVE = 200
"""Largest number of active subscriptions to a plant's events: each is a row for every event, in the event's transaction."""
PENDING, DELIVERED, GIVEN_UP = "pending", "delivered", "given_up"
STATES = (PENDING, DELIVERED, GIVEN_UP)
_OLDEST = (
    select(func.min(DeliveryRow.id))
    .where(DeliveryRow.state == PENDING)
    .where(DeliveryRow.subscription_id.not_in(bindparam("busy", expanding=True)))
    .group_by(DeliveryRow.subscription_id, DeliveryRow.alert_id)
)
_COME = or_(
    DeliveryRow.next_try_at <= bindparam("moment"), DeliveryRow.attempts == 0, DeliveryRow.last_try_at > bindparam("ahead")
)
_FIRST = bindparam("limit", type_=Integer)
DUE = select(DeliveryRow).where(DeliveryRow.id.in_(_OLDEST), _COME).order_by(DeliveryRow.id).limit(_FIRST)
"""The query of `due`, made once: it is put twenty times a second, and to make it takes longer than to put it."""


class SubscriptionUnknown(Missing):
    """Raised when no subscription has this id."""

    subject = "subscription"


class SubscriptionExists(Conflict):
    """A subscription of this name exists already."""


class TooManySubscriptions(Conflict):
    """Raised for an active subscription beyond as many as may be."""


class SubscriptionDisabled(Conflict):
    """The subscription is disabled: nothing is sent to it."""


class DeliveryUnknown(Missing):
    """Raised when no delivery has this id."""

    subject = "delivery"


def subscribe(
    session: Session,
    *,
    kind: str,
    name: str,
    target: str,
    secret: str | None,
    plants: Collection[str] | None = None,
    reports: str | None = None,
) -> SubscriptionRow:
    """Add an active subscription to the events of some plants (None: all plants).

    Raises SubscriptionExists when the name is taken, and TooManySubscriptions. reports: how often it gets some, from now on.
    """
    if by_name(session, name) is not None:
        raise SubscriptionExists(f"subscription '{name}' exists already")
    _require_place(session, plants)
    moment = now()
    row = SubscriptionRow(kind=kind, name=name, target=target, secret=secret, state=ACTIVE, reason=None, created_at=moment)
    send_reports(row, reports, moment=moment)
    row.told_of = [SubscriptionPlantRow(plant=plant) for plant in sorted(set(plants or ()))]
    session.add(row)
    session.flush()
    return row


def send_reports(row: SubscriptionRow, reports: str | None, *, moment: int) -> None:
    """Set how often a subscription gets reports, from `moment` [ns] on. reports: None for no more."""
    row.reports, row.reported_until = reports, None if reports is None else moment


def by_name(session: Session, name: str) -> SubscriptionRow | None:
    """Return the subscription of a name, visible to the caller or not: names are unique over all plants."""
    query = select(SubscriptionRow).where(SubscriptionRow.name == name).execution_options(**EVERY_PLANT)
    return session.scalars(query).one_or_none()


def subscribed_plants(row: SubscriptionRow) -> list[str] | None:
    """Return the plants whose events a subscription receives; None for all plants."""
    return [one.plant for one in row.told_of] or None


def covers_plant(row: SubscriptionRow, plant: str) -> bool:
    """Return whether a subscription receives a plant's events."""
    plants = subscribed_plants(row)
    return plants is None or plant in plants


def get(session: Session, subscription_id: int) -> SubscriptionRow:
    """Return a subscription by id; raise SubscriptionUnknown when there is none."""
    row = session.get(SubscriptionRow, subscription_id)
    if row is None:
        raise SubscriptionUnknown(subscription_id)
    return row


def list_subscriptions(session: Session, *, limit: int | None = None, after: Keys | None = None) -> Sequence[SubscriptionRow]:
    """Return all subscriptions, by id. after: id of the last one of the page before."""
    return session.scalars(ordered(select(SubscriptionRow), (SubscriptionRow.id,), after, descending=False).limit(limit)).all()


def list_subscriptions_with_secret(session: Session) -> Sequence[SubscriptionRow]:
    """Return all subscriptions that have a secret, visible to the caller or not, by id."""
    query = select(SubscriptionRow).where(SubscriptionRow.secret.is_not(None)).order_by(SubscriptionRow.id)
    return session.scalars(query.execution_options(**EVERY_PLANT)).all()


def list_reported(session: Session) -> Sequence[SubscriptionRow]:
    """Return the active subscriptions that get reports, by id."""
    query = select(SubscriptionRow).where(SubscriptionRow.reports.is_not(None), SubscriptionRow.state == ACTIVE)
    return session.scalars(query.order_by(SubscriptionRow.id)).all()


def disable(session: Session, row: SubscriptionRow, reason: str) -> None:
    """Disable a subscription; its pending deliveries are given up and can be sent again later."""
    row.state, row.reason = DISABLED, reason
    waiting = select(DeliveryRow).where(DeliveryRow.subscription_id == row.id, DeliveryRow.state == PENDING)
    for delivery in session.scalars(waiting):
        delivery.state, delivery.answer = GIVEN_UP, f"subscription disabled: {reason}"


def enable(session: Session, row: SubscriptionRow) -> None:
    """Enable a subscription; it receives events from now on. Raises TooManySubscriptions."""
    if row.state != ACTIVE:
        _require_place(session, subscribed_plants(row))
    row.state, row.reason = ACTIVE, None


def _require_place(session: Session, plants: Collection[str] | None) -> None:
    """Raise TooManySubscriptions where a plant's events go to as many active ones as may be, visible to the caller or not.

    plants: those whose events another one is to get; None or none: all.
    """
    named = select(SubscriptionPlantRow.subscription_id)
    active = select(func.count(SubscriptionRow.id)).where(SubscriptionRow.state == ACTIVE)
    to_all = session.scalar(active.where(SubscriptionRow.id.not_in(named)).execution_options(**EVERY_PLANT)) or 0
    by_plant = (
        select(SubscriptionPlantRow.plant, func.count())
        .join(SubscriptionRow, SubscriptionRow.id == SubscriptionPlantRow.subscription_id)
        .where(SubscriptionRow.state == ACTIVE)
        .group_by(SubscriptionPlantRow.plant)
    )
    found = session.execute(by_plant.execution_options(**EVERY_PLANT))
    if to_all + max((count for plant, count in found if not plants or plant in plants), default=0) >= MOST_ACTIVE:
        raise TooManySubscriptions(
            f"{MOST_ACTIVE} subscriptions to the events of a plant are active, as many as may be: disable some first"
        )


def require_active(row: SubscriptionRow) -> None:
    """Raise SubscriptionDisabled unless a subscription is active."""
    if row.state != ACTIVE:
        raise SubscriptionDisabled(f"subscription '{row.name}' is disabled ({row.reason}): enable it first")


def queue(session: Session, event: AlertEventRow) -> None:
    """Add an event to the outbox of every active subscription that receives events of its plant."""
    machine = session.get_one(MachineRow, event.machine_id)
    # Also of those that whoever made the event happen may not see.
    query = select(SubscriptionRow).where(SubscriptionRow.state == ACTIVE).execution_options(**EVERY_PLANT)
    for row in session.scalars(query):
        if covers_plant(row, machine.plant):
            queue_for(session, row, event)


def queue_for(session: Session, row: SubscriptionRow, event: AlertEventRow) -> DeliveryRow:
    """Add an event to the outbox of one subscription."""
    delivery = DeliveryRow(
        subscription_id=row.id,
        event_id=event.id,
        alert_id=event.alert_id,
        state=PENDING,
        attempts=0,
        next_try_at=event.at,
        last_try_at=None,
        answer=None,
    )
    session.add(delivery)
    return delivery


def retry_now(session: Session, kind: str) -> None:
    """Make the pending deliveries of all subscriptions of a kind due at once: their receiver is back."""
    own = select(SubscriptionRow.id).where(SubscriptionRow.kind == kind)
    waiting = update(DeliveryRow).where(DeliveryRow.state == PENDING, DeliveryRow.subscription_id.in_(own))
    session.execute(waiting.values(next_try_at=now()))


def due(session: Session, moment: int, *, busy: Sequence[int], limit: int) -> Sequence[DeliveryRow]:
    """Return the deliveries to try at a time [ns]: the oldest pending one of each subscription and alert, once it is due.

    busy: ids of subscriptions that take no deliveries at present. A delivery that was never tried is due; so is one whose last
    attempt lies in the future, because the clock was set back since.
    """
    moments = {"moment": moment, "ahead": moment + TOLERANCE}
    return session.scalars(DUE, moments | {"busy": busy, "limit": limit}).all()


def of_subscription(session: Session, subscription_id: int, *, limit: int, after: Keys | None = None) -> Sequence[DeliveryRow]:
    """Return the deliveries of a subscription, newest first. after: id of the last one of the page before."""
    query = select(DeliveryRow).where(DeliveryRow.subscription_id == subscription_id)
    return session.scalars(ordered(query, (DeliveryRow.id,), after).limit(limit)).all()


def delivery(session: Session, delivery_id: int) -> DeliveryRow:
    """Return a delivery by id; raise DeliveryUnknown when there is none."""
    row = session.get(DeliveryRow, delivery_id)
    if row is None:
        raise DeliveryUnknown(delivery_id)
    return row


def redeliver(row: DeliveryRow) -> None:
    """Make a delivery pending again, due now, with its attempts reset."""
    row.state, row.attempts, row.next_try_at, row.answer = PENDING, 0, now(), None


def counts(session: Session) -> dict[str, int]:
    """Return the number of deliveries in each state."""
    query = select(DeliveryRow.state, func.count()).group_by(DeliveryRow.state)
    return {state: number for state, number in session.execute(query)}  # noqa: C416 - dict() loses the types
