"""Serialises an alert event as a CloudEvent 1.0 in structured mode (CloudEvents specification 1.0.2, JSON format)."""

import json

from service.delivery.channel import EventMessage

CONTENT_TYPE = "application/cloudevents+json"


def event_id(message: EventMessage) -> str:
    """Return the event's id, equal in all attempts: receivers recognise repeats by it."""
    return f"alert-{message.event.alert}-{message.event.number}"


def cloud_event(message: EventMessage) -> bytes:
    """Return the JSON body. `sequence` counts the alert's events from 1, for receivers to order them."""
    event = message.event
    return json.dumps(
        {
            "specversion": "1.0",
            "id": event_id(message),
            "source": f"/rundown/{message.plant}/{event.machine}",
            "type": f"rundown.alert.{event.kind}",
            "subject": f"{event.rule}/{event.element}",
            "time": event.at.isoformat().replace("+00:00", "Z"),
            "datacontenttype": "application/json",
            "sequence": f"{event.number:010d}",
            "data": event.model_dump(mode="json"),
        }
    ).encode()
