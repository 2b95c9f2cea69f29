"""All settings of the service, from the environment (`RUNDOWN_…`) or the command line."""

from typing import Annotated, Literal

from pydantic import Field, IPvAnyNetwork, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

DEFAULT_ZENOH_ENDPOINT = "tcp/127.0.0.1:7447"
DEFAULT_BASELINE_RUNS = 5


class Settings(BaseSettings):
    """Settings of `rundown serve`; each can be given as `RUNDOWN_<NAME>`."""

    model_config = SettingsConfigDict(env_prefix="RUNDOWN_", extra="ignore")

    database: str = Field(default="sqlite:///rundown.db", description="SQLAlchemy URL of the database")
    host: str = Field(default="127.0.0.1", description="address on which the REST API listens")
    port: Annotated[int, Field(ge=0, le=65535)] = Field(default=8080, description="its port; 0 takes a free one")
    zenoh_listen: list[str] = Field(
        default=[DEFAULT_ZENOH_ENDPOINT], description="endpoints on which the service is a zenoh router for its sources"
    )
    zenoh_connect: list[str] = Field(
        default=[], description="endpoints of zenoh routers to connect to; retried until they answer"
    )
    workers: Annotated[int, Field(ge=1, le=64)] = Field(default=2, description="identification processes")
    identification_timeout_s: Annotated[float, Field(gt=0)] = Field(
        default=300.0, description="an identification that takes longer is given up"
    )
    gathered_interval_s: Annotated[float, Field(gt=0)] = Field(
        default=3600.0, description="how often the newest runs are identified together"
    )
    gathered_runs: Annotated[int, Field(ge=2, le=20)] = Field(default=4, description="how many runs that takes together")
    baseline_runs: Annotated[int, Field(ge=3, le=100)] = Field(
        default=DEFAULT_BASELINE_RUNS,
        description="accepted identifications of each kind of run that make a machine's baseline",
    )
    silence_s: Annotated[float, Field(gt=0)] = Field(
        default=120.0, description="an open run is closed when its machine has sent nothing for this long"
    )
    delivery_networks: list[IPvAnyNetwork] = Field(
        default=[],
        description='private networks, such as "10.1.0.0/16", on which webhooks and Alertmanagers may be; others are refused',
    )
    public_url: str = Field(default="", description="where people reach this service, for links in alert messages")
    smtp_host: str = Field(default="", description="mail server for e-mail subscriptions; none by default")
    smtp_port: Annotated[int, Field(ge=1, le=65535)] = Field(default=25, description="its port")
    smtp_security: Literal["none", "starttls", "tls"] = Field(default="starttls", description="none, starttls or tls")
    smtp_user: str = Field(default="", description="user at the mail server, if it wants one")
    smtp_password: SecretStr = Field(default=SecretStr(""), description="the user's password")
    smtp_sender: str = Field(default="rundown@localhost", description="whom the mails are from")
    late_s: Annotated[float, Field(ge=0)] = Field(
        default=10.0, description="samples that came late are sorted into their runs when no more have come for this long"
    )
    log_level: Literal["DEBUG", "INFO", "WARNING", "ERROR"] = Field(
        default="INFO", description="DEBUG, INFO, WARNING or ERROR"
    )
