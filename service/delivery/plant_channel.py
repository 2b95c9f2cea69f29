"""Channels to the plant's own networks. They need no target: an event is published under a name made from it."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from service.delivery.channel import DeliveryOutcome, EventMessage

Publish = Callable[[EventMessage], Awaitable[str]]
"""Publishes an event and returns where. Raises OSError where the network does not take it."""


@dataclass(frozen=True)
class PlantChannel:
    """Channel to one network of the plant."""

    publish: Publish

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Publish an event; it is delivered once the network has taken it."""
        try:
            place = await self.publish(message)
        except OSError as error:
            return DeliveryOutcome("failed", str(error))
        return DeliveryOutcome("delivered", f"published on {place}")
