"""Publishes alert events on the plant's MQTT broker, which keeps the last one of each rule and element for later listeners."""

from service.delivery.channel import Channel, EventMessage, Undeliverable
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.plant_channel import PlantChannel
from storage.tables.alerting import SubscriptionRow


def _open(_row: SubscriptionRow, connections: Connections) -> Channel:
    broker = connections.broker
    if broker is None:
        return Undeliverable("no broker is set: RUNDOWN_MQTT_URL")

    async def publish(message: EventMessage) -> str:
        return await broker.publish_event(message.plant, message.event)

    return PlantChannel(publish)


MQTT = ChannelKind(
    "mqtt",
    title={"en": "the plant's broker (MQTT)", "de": "der Broker der Anlage (MQTT)"},
    description="the broker of the service's settings, no target; it is told of trends, too",
    address=None,
    open=_open,
)
