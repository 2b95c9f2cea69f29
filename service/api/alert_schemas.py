"""What the API is asked and answers about alerts, suppressions, timelines and subscriptions."""

import re
from datetime import UTC, datetime
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, Field, model_validator

from estimator.written import Written
from service.api.evidence import AlertEvidence
from service.api.times import Time
from service.delivery.signing_secrets import FILE_NAME, VARIABLE
from service.security.principal import Author

Name = Annotated[str, Field(min_length=1, max_length=120, pattern=r"^[^\x00-\x1f]*$")]
Comment = Annotated[str, Field(max_length=2000, pattern=r"^[^\x00]*$")]
Said = Annotated[str, Field(min_length=1, max_length=2000, pattern=r"^[^\x00]*[^\x00\s][^\x00]*$")]
"""A comment that says something."""


EARLIEST, LATEST = datetime(1970, 1, 1, tzinfo=UTC), datetime(2262, 1, 1, tzinfo=UTC)
"""What the store can count in nanoseconds."""


def _aware(moment: datetime) -> datetime:
    if moment.tzinfo is None:
        raise ValueError("a moment needs its zone, such as 2026-11-21T12:00:00Z")
    if not EARLIEST <= moment <= LATEST:
        raise ValueError(f"a moment lies between {EARLIEST:%Y} and {LATEST:%Y}")
    return moment


Moment = Annotated[Time, AfterValidator(_aware)]


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
    message: str
    evidence: AlertEvidence
    identification: int
    measured_at: datetime = Field(description="when the run was measured that says so last")
    first_measured_at: datetime = Field(description="when the run was measured that raised it")
    opened_at: datetime = Field(description="when it was raised")
    updated_at: datetime
    closed_at: datetime | None
    events: int = Field(description="how many events it has had")


class By(Written):
    """Who does it, and why."""

    by: Author
    comment: Comment = ""


class Remark(Written):
    """A comment and who makes it."""

    by: Author
    comment: Said


class Shelving(By):
    """Until when: at most 30 days ahead. There is no shelving for ever."""

    until: Moment


class SuppressionIn(By):
    """Suppress a machine's alerts, or only those of a rule or an element."""

    kind: Literal["suppressed_by_design", "out_of_service"]
    rule: Annotated[str, Field(min_length=1, max_length=64)] | None = None
    element: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    until: Moment | None = Field(default=None, description="ends by itself; by default a person ends it")


class SuppressionOut(BaseModel):
    """A suppression in force; shelvings among them."""

    id: int
    machine: str
    kind: str
    rule: str | None
    element: str | None
    since: datetime
    until: datetime | None
    by: str
    comment: str
    ended_at: datetime | None
    ended_by: str | None


class TimelineIn(Written):
    """A note or a marker. A maintenance begins a new baseline."""

    at: Moment
    kind: Literal["note", "maintenance", "marker"] = "note"
    text: Said
    by: Author


class TimelineOut(BaseModel):
    """An entry on a machine's timeline."""

    id: int
    machine: str
    at: datetime
    kind: str
    text: str
    by: str
    created_at: datetime


class BaselineIn(Written):
    """A new baseline. Without named identifications it is made of the first accepted ones of each kind of run."""

    since: Moment
    reason: Said
    by: Author
    identifications: Annotated[list[Annotated[int, Field(ge=0, le=2**62)]], Field(max_length=200)] | None = None


class BaselineOut(BaseModel):
    """From when on, and with what, a machine is compared."""

    id: int
    machine: str
    since: datetime
    identifications: list[int] | None
    reason: str
    by: str
    created_at: datetime


_ADDRESS = re.compile(r"[^\s@,;<>\"]+@[^\s@,;<>\"]+")


class SubscriptionIn(Written):
    """Who is told of every alert event.

    webhook: target is an http or https URL; the answer gives its secret, once, unless secret_file or secret_env says where
    one is. alertmanager: the URL of a Prometheus
    Alertmanager. email: one address, or several with commas between. zenoh: the plant's own network, no target.
    """

    kind: Literal["webhook", "alertmanager", "email", "zenoh"]
    name: Name
    target: Annotated[str, Field(max_length=2000, pattern=r"^[^\x00-\x1f]*$")] = ""
    plants: Annotated[list[Annotated[str, Field(min_length=1, max_length=64)]], Field(min_length=1, max_length=100)] | None = (
        Field(default=None, description="only of these plants' events; by default of all that who asks may see")
    )
    secret_file: Annotated[str, Field(pattern=FILE_NAME)] | None = Field(
        default=None, description="name of a file in the folder that the service has for them, which holds a webhook's secret"
    )
    secret_env: Annotated[str, Field(pattern=VARIABLE)] | None = Field(
        default=None, description="variable of the service's environment that holds it"
    )

    @model_validator(mode="after")
    def _target(self) -> "SubscriptionIn":
        if (self.kind == "zenoh") == bool(self.target):
            raise ValueError("target: zenoh needs none, every other kind needs one")
        if self.kind == "email" and not all(_ADDRESS.fullmatch(one.strip(" ")) for one in self.target.split(",")):
            raise ValueError("target: an e-mail address such as anna@plant.example, or several with commas between")
        return self

    @model_validator(mode="after")
    def _secret(self) -> "SubscriptionIn":
        given = [one for one in (self.secret_file, self.secret_env) if one is not None]
        if len(given) > (self.kind == "webhook"):
            raise ValueError("secret_file, secret_env: at most one of them, and for a webhook only")
        return self


class SubscriptionOut(BaseModel):
    """A subscription, without its secret."""

    id: int
    kind: str
    name: str
    target: str
    state: str = Field(description="active or disabled")
    reason: str | None = Field(description="why it is disabled")
    secret_kept: str | None = Field(description="where a webhook's secret is: sealed, file NAME, env NAME, or plain")
    trouble: str | None = Field(description="why nothing can be sent: the secret cannot be had")
    plants: list[str] | None = Field(description="of whose events it tells; null for all")
    created_at: datetime


class SubscriptionCreated(SubscriptionOut):
    """A new subscription with the secret that signs its messages, where one was made for it; it is not shown again."""

    secret: str | None


class DeliveryOut(BaseModel):
    """One event on its way to one subscription."""

    id: int
    subscription: int
    event: int
    alert: int
    state: str = Field(description="pending, delivered or given_up")
    attempts: int
    next_try_at: datetime | None
    last_try_at: datetime | None
    answer: str | None = Field(description="what the last try met with")


class TestOut(BaseModel):
    """How a test message was met with."""

    result: str = Field(description="delivered, failed or gone")
    answer: str
