"""Posts a signed CloudEvent to a URL."""

import time
from dataclasses import dataclass
from http import HTTPStatus

from aiohttp import ClientError, ClientResponse, ClientSession

from service.delivery.addresses import Network, TargetRefused, checked
from service.delivery.channel import DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.cloud_event import CONTENT_TYPE, cloud_event, event_id
from service.delivery.signing import signed_headers
from storage.tables.alerting import SubscriptionRow

TIMEOUT_S = 15.0
"""Time limit of an attempt [s]; Standard Webhooks recommends 15 to 30 s."""
ANSWER_BYTES = 1024
"""Largest part of an answer that is read [B]: a receiver must not fill the memory."""


@dataclass(frozen=True)
class Webhook:
    """Channel to one receiver."""

    client: ClientSession
    target: str
    secret: str
    allowed: tuple[Network, ...]

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Post the event."""
        body = cloud_event(message)
        headers = signed_headers(self.secret, message_id=event_id(message), seconds=int(time.time()), body=body)
        return await post(self.client, self.target, body, headers | {"content-type": CONTENT_TYPE}, self.allowed)


def _open(row: SubscriptionRow, connections: Connections) -> Webhook:
    networks = tuple(connections.settings.delivery_networks)
    return Webhook(connections.client, row.target, connections.secrets.reveal(row), networks)


WEBHOOK = ChannelKind(
    "webhook",
    title={"en": "webhook", "de": "Webhook"},
    description="target is an http or https URL; "
    "the answer gives its secret, once, unless secret_file or secret_env says where one is",
    address={"en": "a URL", "de": "eine URL"},
    open=_open,
    url_target=True,
    signed=True,
)


async def post(
    client: ClientSession, target: str, body: bytes, headers: dict[str, str], allowed: tuple[Network, ...]
) -> DeliveryOutcome:
    """Post a body to a checked target; redirects are not followed."""
    try:
        where = await checked(target, allowed)
        async with client.post(
            where.url,
            data=body,
            headers=headers | {"host": where.host_header, "user-agent": "rundown"},
            server_hostname=where.name if where.url.scheme == "https" else None,
            allow_redirects=False,
        ) as answer:
            text = (await answer.content.read(ANSWER_BYTES)).decode("utf-8", "replace")
            return _outcome(answer, text)
    except TargetRefused as error:
        return DeliveryOutcome("failed", str(error))
    except TimeoutError:
        return DeliveryOutcome("failed", f"no answer within {TIMEOUT_S:.0f} s")
    except (ClientError, OSError, ValueError) as error:
        return DeliveryOutcome("failed", f"{type(error).__name__}: {error}")


def _outcome(answer: ClientResponse, text: str) -> DeliveryOutcome:
    said = f"{answer.status} {text}".strip()
    if answer.status < HTTPStatus.MULTIPLE_CHOICES:
        return DeliveryOutcome("delivered", said)
    if answer.status == HTTPStatus.GONE:
        return DeliveryOutcome("gone", said)
    if answer.status < HTTPStatus.BAD_REQUEST:
        return DeliveryOutcome("failed", f"{answer.status}: redirects are not followed, give the final URL")
    after = answer.headers.get("retry-after", "")
    return DeliveryOutcome("failed", said, float(after) if after.isascii() and after.isdigit() else None)
