"""Publishes alert events on the plant's MQTT broker, which keeps the last one of each rule and element for later listeners."""

from dataclasses import dataclass

from service.delivery.channel import DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind, Connections, EventBroker
from storage.tables.alerting import SubscriptionRow


@dataclass(frozen=True)
class PlantBroker:
    """Channel to the plant's own broker."""

    broker: EventBroker | None

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Publish an event; it is delivered once the broker has confirmed it."""
        if self.broker is None:
            return DeliveryOutcome("failed", "no broker is set: RUNDOWN_MQTT_URL")
        try:
            topic = await self.broker.publish_event(message.plant, message.event)
        except OSError as error:
            return DeliveryOutcome("failed", str(error))
        return DeliveryOutcome("delivered", f"published on {topic}")


def _open(_row: SubscriptionRow, connections: Connections) -> PlantBroker:
    return PlantBroker(connections.broker)


MQTT = ChannelKind(
    "mqtt",
    title="the plant's broker (MQTT)",
    description="the broker of the service's settings, no target; it is told of trends, too",
    address=None,
    open=_open,
)
