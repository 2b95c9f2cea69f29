"""All settings of the service, from the command line, the environment (`RUNDOWN_…`) or a TOML file."""

import os
import re
from collections.abc import Sequence, Set
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, IPvAnyNetwork, SecretStr, ValidationError, model_validator
from pydantic_settings import SettingsConfigDict, SettingsError

from estimator.strict_model import own_words
from service.configuration.hosts import encrypted
from service.configuration.log_format import LogFormat
from service.configuration.mqtt_settings import MqttSettings
from service.configuration.opcua_settings import OpcUaSettings
from service.configuration.settings_file import WrongSettingsFile, read_settings_file, settings_file
from service.secrets.files import read_keys, read_secret, require_private

ProcessRole = Literal["all", "ingest", "identify", "api", "opcua"]
"""Roles of a process: everything, or one part beside other processes on one PostgreSQL database.

ingest: zenoh and HTTP samples to the store. identify: computes, assesses, delivers alerts. api: the REST API and the page.
opcua: the OPC UA server.
"""

DEFAULT_ZENOH_ENDPOINT = "tcp/127.0.0.1:7447"
DEFAULT_BASELINE_RUNS = 5
DEFAULT_CONNECTIONS_PER_ADDRESS = 200


def _require_day_or_zero(days: float) -> float:
    if 0.0 < days < 1.0:
        raise ValueError(f"{days:g} is less than a day; 0 keeps for ever")
    return days


Days = Annotated[float, Field(ge=0), AfterValidator(_require_day_or_zero)]


class Settings(MqttSettings, OpcUaSettings):
    """Settings of `rundown serve`; each can be given as `RUNDOWN_<NAME>`."""

    model_config = SettingsConfigDict(env_prefix="RUNDOWN_", extra="ignore")

    role: ProcessRole = Field(
        default="all",
        description="what this process does: all, or ingest, identify, api or opcua beside others on one PostgreSQL",
    )
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
    dask_scheduler: str = Field(
        default="",
        description="address of a Dask scheduler, such as tcp://10.0.0.5:8786; its workers identify",
    )
    identification_memory_mb: Annotated[int, Field(ge=256)] = Field(
        default=2048, description="memory that an identification process may hold of its own [MiB]"
    )
    identification_timeout_s: Annotated[float, Field(gt=0)] = Field(
        default=300.0, description="an identification that takes longer is stopped; three times, then quarantined"
    )
    asked_jobs_per_principal: Annotated[int, Field(ge=1)] = Field(
        default=500, description="identifications that may wait of those that one principal asked for"
    )
    asked_jobs_per_machine: Annotated[int, Field(ge=1)] = Field(
        default=200, description="identifications of one machine that may wait of those that people asked for"
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
    sealing_key_file: str = Field(
        default="",
        description="file of the keys that seal secrets in the database, one a line, the first one seals; "
        "beside an SQLite file one is made by itself",
    )
    webhook_secrets_folder: str = Field(
        default="", description="folder of files that hold secrets of webhooks, which a subscription names by `secret_file`"
    )
    finding_texts: str = Field(
        default="", description="file of the site's own texts of findings (YAML): what to check and to do, in its own words"
    )
    locale: Literal["en", "de"] = Field(
        default="en",
        description="language of mails, webhooks and reports, and of answers to those who ask for no other: en, de",
    )
    report_units: Literal[
        "um_pp,rpm", "um_p,rpm", "mil_pp,rpm", "mil_p,rpm", "um_pp,hz", "um_p,hz", "mil_pp,hz", "mil_p,hz"
    ] = Field(
        default="um_pp,rpm",
        description="units of reports as PDF that are mailed, or asked for without any: um or mil, _pp or _p (0-to-peak), "
        "then rpm or hz, such as mil_pp,rpm",
    )
    public_url: str = Field(default="", description="where people reach this service: for links in messages, logging in")
    smtp_host: str = Field(default="", description="mail server for e-mail subscriptions; none by default")
    smtp_port: Annotated[int, Field(ge=1, le=65535)] = Field(default=25, description="its port")
    smtp_security: Literal["none", "starttls", "tls"] = Field(default="starttls", description="none, starttls or tls")
    smtp_user: str = Field(default="", description="user at the mail server, if it wants one")
    smtp_password: SecretStr = Field(default=SecretStr(""), description="the user's password")
    smtp_sender: str = Field(default="rundown@localhost", description="whom the mails are from")
    late_s: Annotated[float, Field(ge=0)] = Field(
        default=10.0,
        description="samples that came late are sorted in when none have come for this long, at most ten times as long",
    )
    raw_days: Days = Field(
        default=0.0,
        description="samples outside of runs, older than a machine's newest by this many days, are deleted; 0: never",
    )
    run_days: Days = Field(
        default=0.0, description="the same for the samples of runs; what was found of them is kept for ever; 0: never"
    )
    disk_budget_gb: Annotated[float, Field(ge=0)] = Field(
        default=0.0, description="how large the database may become before it is warned of; 0: as large as the disk"
    )
    backups: str = Field(
        default="", description="folder in which the nightly backups are kept, so that the service tells how old the newest is"
    )
    log_format: LogFormat = Field(default="text", description="text for people, json for a log collector: an object a line")
    log_level: Literal["DEBUG", "INFO", "WARNING", "ERROR"] = Field(
        default="INFO", description="DEBUG, INFO, WARNING or ERROR"
    )
    authentication: Literal["auto", "required"] = Field(
        default="auto", description="auto: needed as soon as there is an API key or an issuer; required: in any case"
    )
    allow_no_authentication: bool = Field(
        default=False, description="first of two settings without which nothing but loopback is served without authentication"
    )
    everybody_may_change_everything: bool = Field(default=False, description="the second: it says what that means")
    trusted_proxies: list[IPvAnyNetwork] = Field(
        default=[],
        description='reverse proxies, such as "127.0.0.1" or "10.0.3.0/24", that are believed (X-Forwarded-For, -Proto)',
    )
    connections_per_address: Annotated[int, Field(ge=1)] = Field(
        default=DEFAULT_CONNECTIONS_PER_ADDRESS,
        description="of one address to the API at once; trusted proxies may have more",
    )
    requests_per_s: Annotated[float, Field(gt=0)] = Field(default=100.0, description="of one principal, in the long run")
    requests_burst: Annotated[float, Field(ge=1)] = Field(default=500.0, description="of one principal, at once")
    oidc_issuer: str = Field(default="", description="issuer of tokens (OpenID Connect), exactly as they say it")
    oidc_audience: str = Field(default="", description="what a token must be made for")
    oidc_jwks: str = Field(default="", description="URL or file of its keys; by default what its configuration says")
    oidc_client_id: str = Field(default="", description="this service as its client, to log in on the page with it")
    oidc_client_secret: SecretStr = Field(default=SecretStr(""), description="its secret, if the issuer gave one")
    oidc_client_secret_file: str = Field(default="", description="file that holds it")
    oidc_scope: str = Field(default="openid profile", description="what is asked for at a login")
    oidc_role_claim: str = Field(default="rundown_role", description="claim that names the role; a dot leads into one")
    oidc_plants_claim: str = Field(default="rundown_plants", description="claim that names the plants, or * for all")
    oidc_name_claim: str = Field(default="name", description="claim that names the person")
    oidc_roles: dict[str, str] = Field(default={}, description="what the issuer calls a role: its name to ours")
    tls_certificate: str = Field(default="", description="file of the certificate chain; with it, the API speaks TLS")
    tls_key: str = Field(default="", description="file of its key, which others must not be able to read")
    zenoh_tls_ca: str = Field(default="", description="file of the authority that signed the sources' certificates")
    zenoh_tls_certificate: str = Field(default="", description="file of the service's certificate on the zenoh network")
    zenoh_tls_key: str = Field(default="", description="file of its key, which others must not be able to read")
    zenoh_access: str = Field(default="", description="file that says which certificate may publish for which machines (YAML)")
    smtp_password_file: str = Field(default="", description="file that holds the mail server's password")
    database_file: str = Field(default="", description="file that holds the database's URL, where a password is in it")

    @model_validator(mode="after")
    def _from_files(self) -> Self:
        for name, file in (("smtp_password", self.smtp_password_file), ("oidc_client_secret", self.oidc_client_secret_file)):
            if file:
                setattr(self, name, SecretStr(read_secret(file)))
        if self.database_file:
            self.database = read_secret(self.database_file)
        return self

    @model_validator(mode="after")
    def _complete_issuer(self) -> Self:
        if self.oidc_issuer and not self.oidc_audience:
            raise ValueError("oidc_issuer needs oidc_audience: without it tokens made for other services would be taken")
        if self.oidc_client_id and not self.public_url:
            raise ValueError("oidc_client_id needs public_url: that is where the issuer sends people back to")
        for name in ("oidc_issuer", "oidc_jwks"):
            url = getattr(self, name)
            if url.startswith("http://") and not encrypted(url):
                raise ValueError(f"{name}: {url} must be https: who sits between could make tokens")
        return self

    @model_validator(mode="after")
    def _complete_certificates(self) -> Self:
        if bool(self.tls_certificate) != bool(self.tls_key):
            raise ValueError("tls_certificate and tls_key: both, or neither")
        zenoh_tls = {bool(one) for one in (self.zenoh_tls_ca, self.zenoh_tls_certificate, self.zenoh_tls_key)}
        if len(zenoh_tls) != 1:
            raise ValueError("zenoh_tls_ca, zenoh_tls_certificate and zenoh_tls_key: all three, or none")
        if self.zenoh_access and not self.zenoh_tls_ca:
            raise ValueError("zenoh_access goes by certificates: it needs zenoh_tls_ca, _certificate and _key")
        for key in (self.tls_key, self.zenoh_tls_key):
            if key:
                require_private(key)
        if self.sealing_key_file:
            read_keys(self.sealing_key_file)
        return self

    @model_validator(mode="after")
    def _of_role(self) -> Self:
        """Require PostgreSQL for a role beside others; unless set, all but ingest connect to a local zenoh router."""
        if self.role == "opcua" and not self.opcua_listen:
            raise ValueError("role 'opcua' is the OPC UA server: say where it listens with opcua_listen")
        if self.role != "all" and not self.database.startswith("postgresql"):
            kind = re.match(r"\w*", self.database)
            raise ValueError(
                f"role '{self.role}' works beside others, which needs a PostgreSQL database: a URL that begins with "
                f"postgresql+psycopg://, not with {kind[0] if kind else ''}"
            )
        if self.role in ("identify", "api", "opcua") and "zenoh_listen" not in self.model_fields_set:
            self.zenoh_listen = []
            if "zenoh_connect" not in self.model_fields_set:
                self.zenoh_connect = [DEFAULT_ZENOH_ENDPOINT]
        return self


WORDS = {
    "int_parsing": "needs a whole number",
    "int_type": "needs a whole number",
    "int_from_float": "needs a whole number",
    "float_parsing": "needs a number",
    "float_type": "needs a number",
    "bool_parsing": "needs true or false",
    "bool_type": "needs true or false",
    "string_type": "needs a text, in quotes",
    "list_type": 'needs a list, in brackets, such as ["one", "two"]',
    "dict_type": 'needs names with values, in a file such as { name = "value" }',
}
"""Words for a value of another kind, by pydantic's kind of error."""


class SettingsWrong(ValueError):
    """Settings are unusable; the message says which and why, but never their values: these may be secrets."""


def settings_of(**given: Any) -> Settings:
    """Return the settings from the arguments, else the environment, else the file that it names. Raises SettingsWrong."""
    filed: dict[str, Any] = {}
    try:
        filed = _from_file()
        return Settings(**(filed | given))
    except WrongSettingsFile as error:
        raise SettingsWrong(str(error)) from None
    except ValidationError as error:
        found = [_problem(one["loc"], one["type"], one["msg"], filed=set(filed) - set(given)) for one in error.errors()]
    except SettingsError as error:
        raise SettingsWrong(f'{error}: lists are written as JSON, such as ["tcp/127.0.0.1:7447"]') from None
    raise SettingsWrong("\n".join(found))


def _problem(location: Sequence[int | str], kind: str, message: str, *, filed: Set[str]) -> str:
    """Return what is wrong with a setting, and where it was said. filed: the settings that the file decides."""
    words = own_words(message)
    if not location:
        return words
    words = WORDS.get(kind, words)
    place = f"{settings_file()}: " if location[0] in filed else ""
    return f"{place}setting {'.'.join(map(str, location))}: {words}"


def _from_file() -> dict[str, Any]:
    """Return the settings of the file that the environment does not have, too."""
    path = settings_file()
    if path is None:
        return {}
    prefix = str(Settings.model_config.get("env_prefix", ""))
    there = {name.upper() for name in os.environ}
    found = read_settings_file(path, known=Settings.model_fields)
    return {name: value for name, value in found.items() if f"{prefix}{name}".upper() not in there}
