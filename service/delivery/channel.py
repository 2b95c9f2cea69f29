"""What every way of delivery has in common: messages, outcomes, and the channel that sends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

from service.alerts.event_message import AlertEvent

Result = Literal["delivered", "failed", "gone"]
FIRING = frozenset({"unacknowledged", "acknowledged"})
"""States of alerts that last and call somebody."""


@dataclass(frozen=True)
class EventMessage:
    """An event and the plant of its machine."""

    event: AlertEvent
    plant: str


@dataclass(frozen=True)
class DeliveryOutcome:
    """How a try went. gone: the receiver wants nothing more, ever. retry_after: the receiver's own wish [s]."""

    result: Result
    answer: str
    retry_after: float | None = None


class Channel(Protocol):
    """One way of delivery to one receiver."""

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Deliver an event; errors on the way are an outcome, not an exception."""
        ...


@runtime_checkable
class RemindingChannel(Protocol):
    """A channel whose receiver is told again and again of alerts that last."""

    async def push(self, messages: Sequence[EventMessage]) -> DeliveryOutcome:
        """Tell how alerts stand after their events; errors on the way are an outcome."""
        ...


@dataclass(frozen=True)
class Undeliverable:
    """Channel of a subscription to which nothing can be sent."""

    reason: str

    async def send(self, message: EventMessage) -> DeliveryOutcome:  # noqa: ARG002 - whatever it is
        """Fail with the reason."""
        return DeliveryOutcome("failed", self.reason)
