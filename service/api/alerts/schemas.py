"""Models of alerts and their suppressions."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, Field

from estimator.strict_model import StrictModel
from service.alerts.advice_message import Advice
from service.api.conventions.fields import Comment, Moment, NonBlankText
from service.api.findings.evidence import AlertEvidence
from service.security.principal import Author


class AlertOut(BaseModel):
    """A statement about a machine with its evidence."""

    id: int
    machine: str
    rule: str
    element: str
    state: str = Field(
        description="unacknowledged, acknowledged, returned, latched_unacknowledged, latched_acknowledged, shelved, "
        "suppressed_by_design, out_of_service; normal once it is closed"
    )
    condition: str = Field(description="the state without its suppressions")
    severity: str = Field(description="alert or danger")
    latching: bool = Field(description="whether a person must reset it after its cause is gone")
    suppressions: list[str]
    message: str = Field(description="what it is, in one sentence")
    advice: Advice | None = Field(
        default=None, description="how far, how sure, how urgent, what to do; null: an older release stored too few numbers"
    )
    evidence: AlertEvidence
    identification: int
    measured_at: datetime = Field(description="when the run was measured that says so last")
    first_measured_at: datetime = Field(description="when the run was measured that raised it")
    opened_at: datetime = Field(description="when it was raised")
    updated_at: datetime
    closed_at: datetime | None
    events: int = Field(description="how many events it has had")


class By(StrictModel):
    """The person who acts, and the reason."""

    by: Author
    comment: Comment = ""


class Remark(StrictModel):
    """A comment with its author."""

    by: Author
    comment: NonBlankText


class Shelving(By):
    """A request to shelve an alert for at most 30 days; none is shelved for ever."""

    until: Moment
    until_cleared: bool = Field(default=False, description="it ends before then when the cause is gone: a new one calls")


class SuppressionIn(By):
    """Request to suppress a machine's alerts, or only those of a rule or an element."""

    kind: Literal["suppressed_by_design", "out_of_service"]
    rule: Annotated[str, Field(min_length=1, max_length=64)] | None = None
    element: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    until: Moment | None = Field(default=None, description="ends by itself; by default a person ends it")


class SuppressionOut(BaseModel):
    """A suppression, which may be a shelving."""

    id: int
    machine: str
    kind: str
    rule: str | None
    element: str | None
    since: datetime
    until: datetime | None
    until_cleared: bool = Field(description="whether it ends before `until` when the cause is gone")
    by: str
    comment: str
    ended_at: datetime | None
    ended_by: str | None
