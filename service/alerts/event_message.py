"""The form of an alert event for everybody: in the API, in streams and in deliveries."""

from datetime import datetime

from pydantic import BaseModel, Field

from service.alerts.advice_message import Advice


class AlertEvent(BaseModel):
    """One transition of an alert, or a comment on it."""

    id: int = Field(description="grows over all alerts: the event's id in streams and deliveries")
    alert: int
    number: int = Field(description="of the event within its alert, from 1 without gaps")
    machine: str
    rule: str
    element: str
    at: datetime
    kind: str
    state_before: str
    state: str
    severity: str
    message: str = Field(description="what it is, in one sentence")
    advice: Advice | None = Field(
        default=None, description="how far, how sure, how urgent, what to do; null: an older release stored too few numbers"
    )
    by: str
    comment: str
    opened_at: datetime
    identification: int
