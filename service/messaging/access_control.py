"""Access control on the zenoh network, by certificate: a source publishes only under its own identity.

Certificates are identified by their common names. zenoh reads the rules only at its start, so that a change needs a restart of
the service. Refused messages are dropped without a report to the sender; their source seems never to send.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from formats.wire.keys import Key
from service.configuration.settings import Settings, SettingsWrong, settings_of

PlantMachine = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}/[A-Za-z0-9_-]{1,64}$")]
PlantMachinePattern = Annotated[str, Field(pattern=r"^([A-Za-z0-9_-]{1,64}|\*)/([A-Za-z0-9_-]{1,64}|\*)$")]
CertificateName = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[^\x00-\x1f]+$")]

EVERYTHING = "rundown/v1/**"
ALL = (
    "put",
    "delete",
    "declare_subscriber",
    "query",
    "reply",
    "declare_queryable",
    "liveliness_token",
    "liveliness_query",
    "declare_liveliness_subscriber",
)
INTEREST = ("declare_subscriber", "declare_queryable", "liveliness_query", "declare_liveliness_subscriber")
"""Messages by which the service announces that it listens; without them a source would not send."""


class AccessUnusable(ValueError):
    """The access control file is wrong; the message says where."""


class StreamAccess(BaseModel):
    """Access rules.

    sources: the plant/machine that each certificate publishes for; readers: those that each may listen to, * for all; routers:
    certificates of routers and other services, which may carry and see everything.
    """

    model_config = ConfigDict(extra="forbid")

    sources: dict[CertificateName, Annotated[list[PlantMachine], Field(min_length=1)]] = {}
    readers: dict[CertificateName, Annotated[list[PlantMachinePattern], Field(min_length=1)]] = {}
    routers: list[CertificateName] = []

    def rules(self) -> dict[str, Any]:
        """Return the rules in the form of zenoh's configuration."""
        rules, subjects, policies = [], [], []

        def allow(name: str, kind: str, *parts: dict[str, Any]) -> None:
            numbered = [{"id": f"{kind} {name} {number}", "permission": "allow"} | one for number, one in enumerate(parts)]
            rules.extend(numbered)
            subjects.append({"id": f"{kind} {name}", "cert_common_names": [name]})
            policies.append({"rules": [one["id"] for one in numbered], "subjects": [f"{kind} {name}"]})

        for name, places in self.sources.items():
            allow(name, "source", *_source([Key(*place.split("/")) for place in places]))
        for name, wide in self.readers.items():
            allow(name, "reader", *_reader(wide))
        for name in self.routers:
            allow(name, "router", _rule(ALL, ("ingress", "egress"), [EVERYTHING]))
        return {"enabled": True, "default_permission": "deny", "rules": rules, "subjects": subjects, "policies": policies}


@dataclass(frozen=True)
class StreamSecurity:
    """Certificate files by which a session authenticates itself, and the access rules where it listens."""

    authority: str
    certificate: str
    key: str
    access: StreamAccess | None = None

    @classmethod
    def of(cls, settings: Settings) -> "StreamSecurity | None":
        """Return the security that the settings ask for; None without certificates. Raises AccessUnusable."""
        if not settings.zenoh_tls_ca:
            return None
        access = read_access(Path(settings.zenoh_access)) if settings.zenoh_access else None
        return cls(settings.zenoh_tls_ca, settings.zenoh_tls_certificate, settings.zenoh_tls_key, access)

    def configuration(self) -> dict[str, object]:
        """Return zenoh's configuration. Both sides present certificates: without enable_mtls anybody would get in."""
        tls = {
            "root_ca_certificate": self.authority,
            "enable_mtls": True,
            "listen_certificate": self.certificate,
            "listen_private_key": self.key,
            "connect_certificate": self.certificate,
            "connect_private_key": self.key,
            "verify_name_on_connect": True,
            "close_link_on_expiration": True,
        }
        return {"transport/link/tls": tls} | ({} if self.access is None else {"access_control": self.access.rules()})


def from_environment() -> StreamSecurity | None:
    """Return the security for commands beside `serve`, which have the same settings. Raises AccessUnusable."""
    try:
        return StreamSecurity.of(settings_of())
    except SettingsWrong as error:
        raise AccessUnusable(str(error)) from error


def read_access(path: Path) -> StreamAccess:
    """Read the access control file. Raises AccessUnusable."""
    try:
        return StreamAccess.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")) or {})
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise AccessUnusable(f"{path} cannot be read: {error}") from error
    except ValidationError as error:
        wrong = "; ".join(f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors())
        raise AccessUnusable(f"{path}: {wrong}") from error


def _source(keys: list[Key]) -> list[dict[str, Any]]:
    """Return the rules of a source: publish, reply for its log and status, hold a liveliness token, query `received`."""
    answered = [key for one in keys for key in (one.log, one.status)]
    received = [one.received for one in keys]
    return [
        _rule(("put",), ("ingress",), [one.samples for one in keys]),
        _rule(("liveliness_token",), ("ingress",), [one.live for one in keys]),
        _rule(("declare_queryable", "reply"), ("ingress",), answered),
        _rule(("query",), ("egress",), answered),
        _rule(("query",), ("ingress",), received),
        _rule(("reply",), ("egress",), received),
        _rule(INTEREST, ("egress",), [EVERYTHING]),
    ]


def _reader(places: list[str]) -> list[dict[str, Any]]:
    """Return the rules of a reader: receive alerts as they happen, the last one of each, and samples."""
    heard = [f"rundown/v1/{place}/{what}" for place in places for what in ("alerts/*", "samples")]
    return [
        _rule(("declare_subscriber", "query"), ("ingress",), heard),
        _rule(("put", "reply"), ("egress",), heard),
        _rule(("declare_queryable",), ("egress",), [EVERYTHING]),
    ]


def _rule(messages: tuple[str, ...], flows: tuple[str, ...], keys: list[str]) -> dict[str, Any]:
    return {"messages": list(messages), "flows": list(flows), "key_exprs": keys}
