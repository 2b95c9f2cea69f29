"""Models of subscriptions to alert events and of the deliveries to them."""

import re
from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, Field, model_validator

from estimator.written import Written
from service.api.fields import Name
from service.secret_references import FILE_NAME, VARIABLE

_ADDRESS = re.compile(r"[^\s@,;<>\"]+@[^\s@,;<>\"]+")


class SubscriptionIn(Written):
    """A subscription to alert events, and where they are sent.

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
    """Result of a test message."""

    result: str = Field(description="delivered, failed or gone")
    answer: str
