"""Serves subscriptions to alert events and the deliveries to them."""

from collections.abc import Awaitable, Callable
from typing import cast

from fastapi import APIRouter, Request, Response, status
from fastapi.concurrency import run_in_threadpool

from estimator.errors import Invalid, NotAllowed
from service.alerts.lifecycle import Forbidden
from service.api.alerts import subscription_rendering as rendering
from service.api.alerts import subscription_schemas as schemas
from service.api.conventions.dependencies import Number, Reading, database, principal
from service.api.conventions.paging import ById
from service.api.conventions.preconditions import IfMatch, require, tagged
from service.api.conventions.problems import CHANGES, RESPONSES
from service.api.conventions.request_places import RequestPlaces
from service.delivery.addresses import require_permitted
from service.delivery.channel import DeliveryOutcome
from service.delivery.channels import channel_kind
from service.delivery.signing import new_secret
from service.delivery.signing_secrets import SigningSecrets
from service.security.requirement import ADMIN, OPERATOR
from storage.alerts import deliveries
from storage.clock import now

SendTest = Callable[[int], Awaitable[DeliveryOutcome]]
"""Function that sends a test message to a subscription."""

router = APIRouter(prefix="/subscriptions", tags=["subscriptions"], responses=RESPONSES, dependencies=[OPERATOR])


class ReportsNotSent(Invalid):
    """Raised when reports are requested of a subscription whose kind cannot carry any."""


@router.get("", operation_id="list_subscriptions")
def list_subscriptions(request: Request, session: Reading, paging: ById) -> list[schemas.SubscriptionOut]:
    """List all subscriptions, without their secrets."""
    rows = deliveries.list_subscriptions(session, limit=paging.wanted, after=paging.after)
    return [rendering.subscription(row, _secrets(request)) for row in paging.page(rows, lambda row: (row.id,))]


@router.post("", operation_id="subscribe", dependencies=[ADMIN], status_code=status.HTTP_201_CREATED, responses=CHANGES)
async def subscribe(request: Request, body: schemas.SubscriptionIn) -> schemas.SubscriptionCreated:
    """Subscribe to every event from now on. A webhook's secret is shown here, once.

    A URL at an address to which nothing is delivered is refused here already.
    """
    if channel_kind(body.kind).url_target:  # before a thread is taken, as a name may take seconds
        await require_permitted(body.target, request.app.state.delivery_networks)
    places: RequestPlaces = request.app.state.changing_places
    async with places.place(principal(request).identity, has_gone=request.is_disconnected):
        return await run_in_threadpool(_subscribed, request, body)


def _subscribed(request: Request, body: schemas.SubscriptionIn) -> schemas.SubscriptionCreated:
    who = principal(request)
    plants = body.plants if body.plants is not None or who.plants is None else sorted(who.plants)
    for plant in plants or ():
        if not who.sees(plant):
            raise NotAllowed(f"plant '{plant}' is not one of those of {who.name}")
    kept, secrets = _reference(request, body), _secrets(request)
    secret = new_secret() if channel_kind(body.kind).signed and kept is None else None
    with database(request).transaction() as session:
        row = deliveries.subscribe(
            session,
            kind=body.kind,
            name=body.name,
            target=body.target,
            secret=kept,
            plants=plants,
            reports=body.reports,
        )
        if secret is not None:
            row.secret = secrets.sealed(secret, row.id)
            request.state.sealing = secrets.sealing  # encrypts this answer if it is stored under an Idempotency-Key
        return schemas.SubscriptionCreated(**rendering.subscription(row, secrets).model_dump(), secret=secret)


def _secrets(request: Request) -> SigningSecrets:
    return cast(SigningSecrets, request.app.state.secrets)


def _reference(request: Request, body: schemas.SubscriptionIn) -> str | None:
    """Return the reference to the secret's file or variable, if given. Raises SecretUnusable."""
    if body.secret_file is None and body.secret_env is None:
        return None
    who = principal(request)
    if who.plants is not None:  # else the service would sign their messages with another plant's secret
        detail = f"secret_file and secret_env need the role admin for all plants, and {who.name} has it for some"
        raise NotAllowed(detail)
    return _secrets(request).referred(file=body.secret_file, variable=body.secret_env)


@router.get("/{subscription_id}", operation_id="read_subscription")
def read_subscription(
    request: Request, session: Reading, response: Response, subscription_id: Number
) -> schemas.SubscriptionOut:
    """Read one subscription, and the ETag that a change needs."""
    return tagged(response, rendering.subscription(deliveries.get(session, subscription_id), _secrets(request)))


@router.post("/{subscription_id}/disable", operation_id="disable_subscription", dependencies=[ADMIN])
def disable_subscription(
    request: Request, response: Response, subscription_id: Number, if_match: IfMatch = None
) -> schemas.SubscriptionOut:
    """Disable a subscription; pending deliveries are given up and can be delivered again."""
    with database(request).transaction() as session:
        row = deliveries.get(session, subscription_id)
        require(if_match, rendering.subscription(row, _secrets(request)))
        deliveries.disable(session, row, "by request")
        return tagged(response, rendering.subscription(row, _secrets(request)))


@router.post("/{subscription_id}/enable", operation_id="enable_subscription", dependencies=[ADMIN], responses=CHANGES)
def enable_subscription(
    request: Request, response: Response, subscription_id: Number, if_match: IfMatch = None
) -> schemas.SubscriptionOut:
    """Enable a subscription: it receives events from now on."""
    with database(request).transaction() as session:
        row = deliveries.get(session, subscription_id)
        require(if_match, rendering.subscription(row, _secrets(request)))
        deliveries.enable(session, row)
        return tagged(response, rendering.subscription(row, _secrets(request)))


@router.put("/{subscription_id}/reports", operation_id="set_reports", dependencies=[ADMIN])
def set_reports(
    request: Request,
    response: Response,
    subscription_id: Number,
    body: schemas.ReportsIn,
    if_match: IfMatch = None,
) -> schemas.SubscriptionOut:
    """Set how often a subscription gets the reports of its machines by mail, from the next whole week or month on."""
    with database(request).transaction() as session:
        row = deliveries.get(session, subscription_id)
        require(if_match, rendering.subscription(row, _secrets(request)))
        if body.reports is not None and not channel_kind(row.kind).reporting:
            raise ReportsNotSent(f"reports are sent by {schemas.REPORTING_CHANNELS} only, and '{row.name}' is {row.kind}")
        if body.reports != row.reports:  # what was due before stays due
            deliveries.send_reports(row, body.reports, moment=now())
        return tagged(response, rendering.subscription(row, _secrets(request)))


@router.get("/{subscription_id}/deliveries", operation_id="list_deliveries")
def list_deliveries(session: Reading, subscription_id: Number, paging: ById) -> list[schemas.DeliveryOut]:
    """List the delivery log, newest first."""
    deliveries.get(session, subscription_id)
    rows = deliveries.of_subscription(session, subscription_id, limit=paging.wanted, after=paging.after)
    return [rendering.delivery(row) for row in paging.page(rows, lambda row: (row.id,))]


@router.post(
    "/{subscription_id}/deliveries/{delivery_id}/again", operation_id="redeliver", dependencies=[ADMIN], responses=CHANGES
)
def redeliver(request: Request, subscription_id: Number, delivery_id: Number) -> schemas.DeliveryOut:
    """Deliver an event once more, now, whatever its state."""
    with database(request).transaction() as session:
        subscription = deliveries.get(session, subscription_id)
        row = deliveries.delivery(session, delivery_id)
        if row.subscription_id != subscription_id:
            raise deliveries.DeliveryUnknown(f"{delivery_id} of subscription {subscription_id}")
        deliveries.require_active(subscription)
        deliveries.redeliver(row)
        return rendering.delivery(row)


@router.post("/{subscription_id}/test", operation_id="test_subscription", dependencies=[ADMIN], responses=CHANGES)
async def test_subscription(request: Request, subscription_id: Number) -> schemas.TestOut:
    """Send a test message now and answer with the result. It is not in the delivery log."""
    send_test: SendTest | None = request.app.state.send_test
    if send_test is None:
        raise Forbidden("this process delivers nothing: ask the one that does")
    outcome = await send_test(subscription_id)
    return schemas.TestOut(result=outcome.result, answer=outcome.answer)
