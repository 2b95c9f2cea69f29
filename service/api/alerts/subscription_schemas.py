"""Models of subscriptions to alert events and of the deliveries to them."""

from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from estimator.strict_model import StrictModel
from service.api.conventions.fields import DisplayName
from service.delivery.channels import CHANNEL_KINDS, channel_kind
from service.reports.period import ReportInterval
from service.secrets.references import FILE_NAME, VARIABLE

if TYPE_CHECKING:
    ChannelName = str
else:
    ChannelName = Literal[tuple(one.kind for one in CHANNEL_KINDS)]
REPORTING_CHANNELS = " or ".join(one.kind for one in CHANNEL_KINDS if one.reporting)
SIGNED_CHANNELS = " or ".join(one.kind for one in CHANNEL_KINDS if one.signed)


class SubscriptionIn(StrictModel):
    """A subscription to alert events, and where they are sent."""

    model_config = ConfigDict(
        json_schema_extra={
            "description": "A subscription to alert events, and where they are sent.\n\n"
            + " ".join(f"{one.kind}: {one.description}." for one in CHANNEL_KINDS)
        }
    )

    kind: ChannelName
    name: DisplayName
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
    reports: ReportInterval | None = Field(
        default=None,
        description="how often the reports of its machines (PDF) are sent as well, from the next whole week or month on; "
        f"by {REPORTING_CHANNELS} only",
    )

    @model_validator(mode="after")
    def _reports(self) -> "SubscriptionIn":
        if self.reports is not None and not channel_kind(self.kind).reporting:
            raise ValueError(f"reports: sent by {REPORTING_CHANNELS} only")
        return self

    @model_validator(mode="after")
    def _target(self) -> "SubscriptionIn":
        declared = channel_kind(self.kind)
        if declared.address is None and self.target:
            raise ValueError(f"target: {self.kind} needs none")
        if declared.address is not None and not self.target:
            raise ValueError(f"target: {self.kind} needs one: {declared.address['en']}")
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


class ReportsIn(StrictModel):
    """A choice of how often a subscription gets the reports of its machines."""

    reports: ReportInterval | None = Field(description="from the next whole week or month on; null: no more")


class SubscriptionOut(BaseModel):
    """A subscription, without its secret."""

    id: int
    kind: str
    name: str
    target: str
    state: str = Field(description="active or disabled")
    reason: str | None = Field(description="why it is disabled")
    secret_kept: str | None = Field(description="where a webhook's secret is: sealed, file NAME, env NAME, or plain")
    trouble: str | None = Field(description="why nothing can be sent: the secret is unavailable")
    plants: list[str] | None = Field(description="of whose events it tells; null for all")
    reports: str | None = Field(description="how often it gets the reports of its machines: weekly or monthly; null: never")
    created_at: datetime


class SubscriptionCreated(SubscriptionOut):
    """A new subscription with its signing secret, if one was generated; the secret is not shown again."""

    secret: str | None


class DeliveryOut(BaseModel):
    """Delivery of one event to one subscription."""

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
    """Result of a test message."""

    result: str = Field(description="delivered, failed or gone")
    answer: str
