"""Interface of delivery channels: messages, outcomes, and the channel that sends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

from service.alerts.event_message import AlertEvent

DeliveryResult = Literal["delivered", "failed", "gone"]
FIRING = frozenset({"unacknowledged", "acknowledged"})
"""States of alerts that persist and notify."""


@dataclass(frozen=True)
class EventMessage:
    """An event with the plant of its machine."""

    event: AlertEvent
    plant: str


@dataclass(frozen=True)
class DeliveryOutcome:
    """Outcome of an attempt. gone: the receiver wants no further messages; retry_after: pause that it asked for [s]."""

    result: DeliveryResult
    answer: str
    retry_after: float | None = None


class Channel(Protocol):
    """A way of delivery to one receiver."""

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Deliver an event; errors on the way are an outcome, not an exception."""
        ...


@runtime_checkable
class RemindingChannel(Protocol):
    """A channel whose receiver is reminded of persisting alerts."""

    async def push(self, messages: Sequence[EventMessage]) -> DeliveryOutcome:
        """Push the states of alerts after their events; errors on the way are an outcome."""
        ...


@dataclass(frozen=True)
class Undeliverable:
    """Channel of a subscription that cannot be served."""

    reason: str

    async def send(self, message: EventMessage) -> DeliveryOutcome:  # noqa: ARG002 - whatever it is
        """Fail with the reason."""
        return DeliveryOutcome("failed", self.reason)
