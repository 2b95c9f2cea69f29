"""The outbox: who receives which events, what is due, and that a disabled subscription gets nothing."""

import pytest
from sqlalchemy.orm import Session

from storage.alerts import deliveries
from storage.alerts.deliveries import DeliveryUnknown, SubscriptionDisabled, SubscriptionExists, SubscriptionUnknown
from storage.clock import TOLERANCE, now
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope
from storage.tables.alerting import DeliveryRow, SubscriptionRow
from tests.plant import KEY
from tests.storage.alerts.stored_alerts import add, add_event


def subscribe(session: Session, name: str, *plants: str) -> SubscriptionRow:
    target = f"https://example.org/{name}"
    return deliveries.subscribe(session, kind="webhook", name=name, target=target, secret=None, plants=plants or None)


def queued(session: Session, row: SubscriptionRow) -> list[DeliveryRow]:
    """Return the deliveries of a subscription, oldest first."""
    return list(reversed(deliveries.of_subscription(session, row.id, limit=99)))


def test_names_are_unique_and_plants_listed_once(plant: Database) -> None:
    with plant.transaction() as session:
        row = subscribe(session, "historian", "plant-2", "plant-1", "plant-2")
        assert deliveries.subscribed_plants(row) == ["plant-1", "plant-2"]
        assert (deliveries.covers_plant(row, "plant-2"), deliveries.covers_plant(row, "plant-3")) == (True, False)
        everything = subscribe(session, "scada")
        assert deliveries.subscribed_plants(everything) is None
        assert deliveries.covers_plant(everything, "plant-3")
        assert deliveries.by_name(session, "scada") is everything
        assert list(deliveries.list_subscriptions(session, after=(row.id,))) == [everything]
        with pytest.raises(SubscriptionExists, match="'scada' exists already"):
            subscribe(session, "scada")


def test_an_event_is_queued_for_all_active_subscriptions_to_its_plant(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        own, all_plants = subscribe(session, "own", KEY.plant), subscribe(session, "all")
        other, disabled = subscribe(session, "other", "plant-2"), subscribe(session, "disabled")
        deliveries.disable(session, disabled, "it is gone")
        event = add_event(session, add(session, found, "coupling.C1"))
        deliveries.queue(session, event)
        session.flush()
        for row in (own, all_plants):
            (one,) = queued(session, row)
            assert (one.event_id, one.state, one.attempts, one.next_try_at) == (event.id, deliveries.PENDING, 0, event.at)
        assert queued(session, other) == queued(session, disabled) == []
        assert deliveries.counts(session) == {deliveries.PENDING: 2}


def test_the_oldest_pending_one_of_each_alert_is_due(plant: Database, found: int) -> None:
    """So that events of one alert arrive in their order, while those of another do not wait for them."""
    with plant.transaction() as session:
        row, busy = subscribe(session, "a"), subscribe(session, "b")
        first, second = add(session, found, "coupling.C1"), add(session, found, "bearing.B1")
        mine = [deliveries.queue_for(session, row, add_event(session, one)) for one in (first, first, second)]
        for_busy = deliveries.queue_for(session, busy, add_event(session, second))
        session.flush()
        moment = now()

        def due(*without: int, limit: int = 9) -> list[DeliveryRow]:
            return list(deliveries.due(session, moment, busy=without, limit=limit))

        assert due() == [mine[0], mine[2], for_busy]
        assert due(busy.id) == [mine[0], mine[2]]
        assert due(limit=1) == mine[:1]
        mine[0].state = deliveries.DELIVERED
        session.flush()
        assert due(busy.id) == mine[1:]


@pytest.mark.parametrize(
    ("attempts", "next_try", "last_try", "expected"),
    [
        (1, -1, -5, True),
        (1, 5, -5, False),
        (0, 5, None, True),  # never tried
        (1, 5, TOLERANCE - 5, False),
        (1, 5, TOLERANCE + 5, True),  # the clock was set back since
    ],
)
def test_one_that_failed_waits_for_its_next_attempt(
    plant: Database, found: int, attempts: int, next_try: int, last_try: int | None, expected: bool
) -> None:
    with plant.transaction() as session:
        one = deliveries.queue_for(session, subscribe(session, "a"), add_event(session, add(session, found, "coupling.C1")))
        moment = now()
        one.attempts, one.next_try_at = attempts, moment + next_try
        one.last_try_at = None if last_try is None else moment + last_try
        session.flush()
        assert list(deliveries.due(session, moment, busy=[], limit=9)) == [one] * expected


def test_a_disabled_subscription_gives_up_what_waits_and_keeps_what_was_delivered(plant: Database, found: int) -> None:
    with plant.transaction() as session:
        row, alert = subscribe(session, "a"), add(session, found, "coupling.C1")
        done, waiting = (deliveries.queue_for(session, row, add_event(session, alert)) for _ in range(2))
        done.state = deliveries.DELIVERED
        session.flush()
        deliveries.disable(session, row, "410 Gone")
        assert done.state == deliveries.DELIVERED
        assert (waiting.state, waiting.answer) == (deliveries.GIVEN_UP, "subscription disabled: 410 Gone")
        with pytest.raises(SubscriptionDisabled, match="'a' is disabled \\(410 Gone\\)"):
            deliveries.require_active(row)
        deliveries.enable(session, row)
        deliveries.require_active(row)
        waiting.attempts = 7
        deliveries.redeliver(deliveries.delivery(session, waiting.id))
        session.flush()
        assert (waiting.state, waiting.attempts, waiting.answer) == (deliveries.PENDING, 0, None)
        assert list(deliveries.due(session, now(), busy=[], limit=9)) == [waiting]


def test_only_subscriptions_with_a_secret_are_listed_as_such(plant: Database) -> None:
    with plant.transaction() as session:
        subscribe(session, "a")
        row = subscribe(session, "b")
        row.secret = "sealed:x"
        session.flush()
        assert list(deliveries.list_subscriptions_with_secret(session)) == [row]


def test_what_is_unknown_is_named(plant: Database) -> None:
    with plant.reading() as session:
        with pytest.raises(SubscriptionUnknown) as no_subscription:
            deliveries.get(session, 7)
        with pytest.raises(DeliveryUnknown) as no_delivery:
            deliveries.delivery(session, 8)
    assert (no_subscription.value.detail, no_delivery.value.detail) == ("no subscription 7", "no delivery 8")


def test_a_subscription_beyond_as_many_as_may_be_active_is_refused(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deliveries, "MOST_ACTIVE", 2)
    with plant.transaction() as session:
        first = subscribe(session, "first")
        subscribe(session, "second")
        with pytest.raises(deliveries.TooManySubscriptions, match="2 subscriptions to the events of a plant are active"):
            subscribe(session, "third")
        deliveries.disable(session, first, "by request")
        subscribe(session, "third")
        with pytest.raises(deliveries.TooManySubscriptions):
            deliveries.enable(session, first)


def test_active_subscriptions_are_counted_that_get_the_same_events_whoever_asks(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of other plants take no place, and those that the caller does not see do: each gets a row for every event."""
    monkeypatch.setattr(deliveries, "MOST_ACTIVE", 2)
    with plant.transaction() as session:
        subscribe(session, "all")
        subscribe(session, "other", "plant-2")
    with PlantScope(plant, frozenset({KEY.plant})).transaction() as session:
        own = subscribe(session, "own", KEY.plant)
        with pytest.raises(deliveries.TooManySubscriptions):
            subscribe(session, "another", KEY.plant)
        deliveries.disable(session, own, "by request")
        deliveries.enable(session, own)
        deliveries.disable(session, own, "by request")
    with plant.transaction() as session:
        with pytest.raises(deliveries.TooManySubscriptions):
            subscribe(session, "everything")
        with pytest.raises(deliveries.TooManySubscriptions):
            subscribe(session, "both", KEY.plant, "plant-2")
        subscribe(session, "mine", KEY.plant)
