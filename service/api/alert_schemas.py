"""What the API is asked and answers about alerts, suppressions, timelines and subscriptions."""

from datetime import UTC, datetime
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from estimator.written import Written
from service.api.evidence import AlertEvidence
from service.api.times import Time
from service.delivery.channels import CHANNEL_KINDS, channel_kind
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


if TYPE_CHECKING:
    ChannelName = str
else:
    ChannelName = Literal[tuple(one.kind for one in CHANNEL_KINDS)]
SIGNED_CHANNELS = " or ".join(one.kind for one in CHANNEL_KINDS if one.signed)


class SubscriptionIn(Written):
    """Who is told of every alert event."""

    model_config = ConfigDict(
        json_schema_extra={
            "description": "Who is told of every alert event.\n\n"
            + " ".join(f"{one.kind}: {one.description}." for one in CHANNEL_KINDS)
        }
    )

    kind: ChannelName
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
        declared = channel_kind(self.kind)
        if declared.address is None and self.target:
            raise ValueError(f"target: {self.kind} needs none")
        if declared.address is not None and not self.target:
            raise ValueError(f"target: {self.kind} needs one: {declared.address}")
        try:
            declared.check_target(self.target)
        except ValueError as error:
            raise ValueError(f"target: {error}") from error
        return self

    @model_validator(mode="after")
    def _secret(self) -> "SubscriptionIn":
        given = [one for one in (self.secret_file, self.secret_env) if one is not None]
        if len(given) > channel_kind(self.kind).signed:
            raise ValueError(f"secret_file, secret_env: at most one of them, and for a {SIGNED_CHANNELS} only")
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
