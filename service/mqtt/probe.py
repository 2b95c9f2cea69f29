"""Looks whether the broker lets the service in."""

import asyncio

from service.configuration.mqtt_settings import MqttSettings
from service.mqtt.broker import BrokerError, forget, new_client


def refusal(settings: MqttSettings) -> str | None:
    """Return why the broker cannot be used by these settings; None where it lets the service in."""
    try:
        asyncio.run(_connect(settings))
    except BrokerError as error:
        return str(error)
    return None


async def _connect(settings: MqttSettings) -> None:
    client = new_client(settings, "doctor", lasting=False)
    try:
        async with client:
            pass
    finally:
        forget(client)
