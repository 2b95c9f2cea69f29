"""Webhooks: a signed CloudEvent posted to a URL."""

import time
from dataclasses import dataclass

import httpx

from service.delivery.addresses import Network, TargetRefused, checked
from service.delivery.channel import Message, Outcome
from service.delivery.cloud_event import CONTENT_TYPE, cloud_event, event_id
from service.delivery.signing import signed_headers

TIMEOUT_S = 15.0
"""Standard Webhooks recommends 15 to 30 s."""
ANSWER_BYTES = 1024
"""So much of an answer is read: a receiver must not fill the memory."""


@dataclass(frozen=True)
class Webhook:
    """One receiver."""

    client: httpx.AsyncClient
    target: str
    secret: str
    allowed: tuple[Network, ...]

    async def send(self, message: Message) -> Outcome:
        """Post the event."""
        body = cloud_event(message)
        headers = signed_headers(self.secret, message_id=event_id(message), seconds=int(time.time()), body=body)
        return await post(self.client, self.target, body, headers | {"content-type": CONTENT_TYPE}, self.allowed)


async def post(
    client: httpx.AsyncClient, target: str, body: bytes, headers: dict[str, str], allowed: tuple[Network, ...]
) -> Outcome:
    """Post to a checked target; redirects are not followed."""
    try:
        where = await checked(target, allowed)
        async with client.stream(
            "POST",
            where.url,
            content=body,
            headers=headers | {"host": where.host, "user-agent": "rundown"},
            extensions={"sni_hostname": httpx.URL(target).host},
            follow_redirects=False,
        ) as answer:
            text = await _beginning(answer)
            return _outcome(answer, text)
    except TargetRefused as error:
        return Outcome("failed", str(error))
    except httpx.TimeoutException:
        return Outcome("failed", f"no answer within {TIMEOUT_S:.0f} s")
    except (httpx.HTTPError, OSError, ValueError) as error:
        return Outcome("failed", f"{type(error).__name__}: {error}")


async def _beginning(answer: httpx.Response) -> str:
    taken = b""
    async for part in answer.aiter_raw(ANSWER_BYTES):
        taken += part
        if len(taken) >= ANSWER_BYTES:
            break
    return taken[:ANSWER_BYTES].decode("utf-8", "replace")


def _outcome(answer: httpx.Response, text: str) -> Outcome:
    said = f"{answer.status_code} {text}".strip()
    if answer.is_success:
        return Outcome("delivered", said)
    if answer.status_code == httpx.codes.GONE:
        return Outcome("gone", said)
    if answer.has_redirect_location or answer.is_redirect:
        return Outcome("failed", f"{answer.status_code}: redirects are not followed, give the final URL")
    after = answer.headers.get("retry-after", "")
    return Outcome("failed", said, float(after) if after.isascii() and after.isdigit() else None)
