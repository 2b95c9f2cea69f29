"""Access control on the zenoh network, by certificate: a source publishes as itself and as no other.

The names are the certificates' common names. zenoh reads them at its start and not again: after a change the service is
started anew. What is refused is dropped without a word to its sender, and shows as a source that is never heard of.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from service.configuration.settings import Settings, SettingsWrong, settings_of
from service.wire.keys import Key

Place = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}/[A-Za-z0-9_-]{1,64}$")]
Wide = Annotated[str, Field(pattern=r"^([A-Za-z0-9_-]{1,64}|\*)/([A-Za-z0-9_-]{1,64}|\*)$")]
Name = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[^\x00-\x1f]+$")]

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
"""By which the service tells that it listens; without it a source would not send."""


class AccessUnusable(ValueError):
    """The file that says who may do what is wrong; the message says where."""


class StreamAccess(BaseModel):
    """sources: what each certificate publishes for, as plant/machine; readers: what each may listen to, * for all;
    routers: certificates of routers and other services, which carry and see everything.
    """

    model_config = ConfigDict(extra="forbid")

    sources: dict[Name, Annotated[list[Place], Field(min_length=1)]] = {}
    readers: dict[Name, Annotated[list[Wide], Field(min_length=1)]] = {}
    routers: list[Name] = []

    def rules(self) -> dict[str, Any]:
        """As zenoh's configuration has it."""
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
    """Files with which a session proves who it is, and who may do what where it listens."""

    authority: str
    certificate: str
    key: str
    access: StreamAccess | None = None

    @classmethod
    def of(cls, settings: Settings) -> "StreamSecurity | None":
        """As the settings say; None without certificates. Raises AccessUnusable."""
        if not settings.zenoh_tls_ca:
            return None
        access = read_access(Path(settings.zenoh_access)) if settings.zenoh_access else None
        return cls(settings.zenoh_tls_ca, settings.zenoh_tls_certificate, settings.zenoh_tls_key, access)

    def configuration(self) -> dict[str, object]:
        """As zenoh's configuration has it. Both sides show certificates: without enable_mtls anybody would get in."""
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
    """Return the same for the commands beside `serve`, which have the same settings. Raises AccessUnusable."""
    try:
        return StreamSecurity.of(settings_of())
    except SettingsWrong as error:
        raise AccessUnusable(str(error)) from error


def read_access(path: Path) -> StreamAccess:
    """Read the file. Raises AccessUnusable."""
    try:
        return StreamAccess.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")) or {})
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise AccessUnusable(f"{path} cannot be read: {error}") from error
    except ValidationError as error:
        wrong = "; ".join(f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors())
        raise AccessUnusable(f"{path}: {wrong}") from error


def _source(keys: list[Key]) -> list[dict[str, Any]]:
    """Allow what a source does: publish, answer for its log and how it is, be there, and ask how far it was received."""
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
    """Allow what a reader does: hear alerts as they happen, the last of each, and samples."""
    heard = [f"rundown/v1/{place}/{what}" for place in places for what in ("alerts/*", "samples")]
    return [
        _rule(("declare_subscriber", "query"), ("ingress",), heard),
        _rule(("put", "reply"), ("egress",), heard),
        _rule(("declare_queryable",), ("egress",), [EVERYTHING]),
    ]


def _rule(messages: tuple[str, ...], flows: tuple[str, ...], keys: list[str]) -> dict[str, Any]:
    return {"messages": list(messages), "flows": list(flows), "key_exprs": keys}
