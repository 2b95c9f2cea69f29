"""What every way of delivery has in common."""

from dataclasses import dataclass
from typing import Literal, Protocol

from service.alert_messages import AlertEvent

Result = Literal["delivered", "failed", "gone"]


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
