"""Lists the endpoints of a service that a stranger on the network could reach, from its settings and its store alone.

An endpoint is open where plant data can be read or written from the network without credentials.
"""

import ipaddress
import stat
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args
from urllib.parse import urlsplit

from sqlalchemy import make_url

from service.api.application import every_operation
from service.configuration.hosts import is_loopback
from service.configuration.settings import Settings
from service.delivery.signing_secrets import key_file
from service.messaging.access_control import AccessUnusable, read_access
from service.security.browser_origin import SAFE_METHODS
from service.security.exposure import allowed_twice, beyond, credentials_needed
from service.security.operations import ApiOperation
from storage.database.claim import DatabaseUnusable, file_of
from storage.database.engine import engine_of
from storage.database.read_only import read_only_session
from storage.files.private_files import readable_by_others
from storage.operation import api_keys

ExposureLevel = Literal["open", "weak", "guarded", "local"]
"""Worst first: open to the network without authentication; needs improvement; as it should be; this machine only."""
NETWORK, PROXY, MACHINE = "this network", "this network, by way of a proxy", "this machine only"
NOBODY = "nothing"
ENCRYPTED = ("tls", "quic")
"""Protocols of zenoh that use certificates."""
CHECKED_TLS = ("require", "verify-ca", "verify-full")
"""Values of libpq's `sslmode` that never fall back to plain text."""
OWN = ("127.0.0.0/8", "169.254.0.0/16", "::1/128", "fe80::/10")
"""Addresses of the machine itself, and of the metadata services of clouds."""
WIDE = 1 << 24
"""Networks with more addresses are too wide for a few receivers."""


@dataclass(frozen=True)
class ExposedEndpoint:
    """A reachable endpoint.

    asks: required credentials. lets: actions permitted with no more than these. because: the settings behind it.
    """

    level: ExposureLevel
    what: str
    address: str
    reach: str
    asks: str
    lets: str
    because: str


def exposed_endpoints(settings: Settings) -> list[ExposedEndpoint]:
    """Return all reachable endpoints, worst first."""
    found = [
        _api(settings, list(every_operation())),
        *(_endpoint(settings, one) for one in settings.zenoh_listen),
        *(_router(one) for one in settings.zenoh_connect),
        *_opc_ua(settings),
        *_mqtt_broker(settings),
        *_database(settings),
        *_scheduler(settings),
        *(_inner_network(one) for one in settings.delivery_networks),
        *_files(settings),
    ]
    return sorted(found, key=lambda one: get_args(ExposureLevel).index(one.level))


def credentials_asked(settings: Settings) -> tuple[bool, str]:
    """Return whether the API requires credentials, with the settings behind it."""
    path = file_of(engine_of(settings.database))
    try:
        with read_only_session(settings.database) as session:
            there = api_keys.any_exist(session)
        told = "there are API keys" if there else "there is no API key"
    except DatabaseUnusable as error:
        there = False
        missing = path is not None and not path.exists()
        told = "there is no store yet" if missing else f"API keys cannot be read and none is counted ({error})"
    issuer = f"oidc_issuer={settings.oidc_issuer}" if settings.oidc_issuer else "no oidc_issuer"
    return (
        credentials_needed(settings, keys_are_there=there),
        f"{told}, {issuer}, authentication={settings.authentication}",
    )


def _api(settings: Settings, operations: Sequence[ApiOperation]) -> ExposedEndpoint:
    asked, told = credentials_asked(settings)
    reach, why = _reach_of_api(settings)
    encrypted = bool(settings.tls_certificate) or (reach == PROXY and settings.public_url.startswith("https:"))
    level: ExposureLevel = "local"
    if reach != MACHINE:
        level = "open" if not asked else "guarded" if encrypted else "weak"
    tls = "TLS" if settings.tls_certificate else "no TLS of its own"
    address = f"{settings.host or 'every address'}, port {settings.port}"
    because = f"{why}; {told}{_twice(settings, level)}"
    if asked:
        credentials = "an API key or a token of the issuer" if settings.oidc_issuer else "an API key"
        asks = f"{credentials}, with a role for each operation; {tls}"
        lets = f"what tells no plant data: {_named(one for one in operations if one.requirement.role is None)}"
    else:
        asks = f"{NOBODY}; {tls}"
        changing = sum(not one.methods <= SAFE_METHODS for one in operations)
        lets = f"everything: {len(operations)} operations, of which {changing} change something"
    return ExposedEndpoint(level, "REST API, page and metrics", address, reach, asks, lets, because)


def _reach_of_api(settings: Settings) -> tuple[str, str]:
    why = f"host={settings.host}"
    if not is_loopback(settings.host):
        return NETWORK, why
    if settings.public_url and not is_loopback(urlsplit(settings.public_url).hostname or ""):
        return PROXY, f"{why}, and public_url={settings.public_url} says that something there passes requests on"
    return MACHINE, why


def _twice(settings: Settings, level: ExposureLevel) -> str:
    if level != "open":
        return ""
    if allowed_twice(settings):
        return "; allow_no_authentication and everybody_may_change_everything let it start so"
    return "" if is_loopback(settings.host) else "; `rundown serve` refuses to start so"


def _named(operations: Iterable[ApiOperation]) -> str:
    return ", ".join(f"{min(one.methods - {'HEAD'}, default='HEAD')} {one.path}" for one in operations)


def _endpoint(settings: Settings, endpoint: str) -> ExposedEndpoint:
    """Describe an endpoint on which the service is a zenoh router."""
    reached = bool(beyond([endpoint]))
    certificates = endpoint.partition("/")[0] in ENCRYPTED and bool(settings.zenoh_tls_ca)
    everything = "publish samples for any machine, and waveforms to edge agents' topics; hear all samples and alerts"
    level: ExposureLevel = "guarded" if reached else "local"
    because = f"zenoh_listen has {endpoint}, "
    if settings.zenoh_access:
        named = "a certificate of the authority that a rule names"
        asks = named if certificates else f"{named}; it takes none, so that whoever comes may do nothing"
        lets, because = _rules(Path(settings.zenoh_access)), f"{because}zenoh_access={settings.zenoh_access}"
    elif certificates:
        level = "weak" if reached else level
        asks, lets = "any certificate of the authority (mutual TLS), no rules", f"with any of them: {everything}"
        because += f"zenoh_tls_ca={settings.zenoh_tls_ca}, no zenoh_access"
    else:
        level = "open" if reached else level
        asks, lets = NOBODY, everything
        because += f"no zenoh_access{_twice(settings, level) if reached else ''}"
    return ExposedEndpoint(level, "zenoh, for sources", endpoint, NETWORK if reached else MACHINE, asks, lets, because)


def _rules(file: Path) -> str:
    try:
        access = read_access(file)
    except AccessUnusable as error:
        return f"nothing: {error}"
    return (
        f"what the rules say, else nothing: {len(access.sources)} sources, {len(access.readers)} readers, "
        f"{len(access.routers)} routers, which carry everything"
    )


def _router(endpoint: str) -> ExposedEndpoint:
    """Describe an external router to which the service connects."""
    inside = not beyond([endpoint])
    clear = endpoint.partition("/")[0] not in ENCRYPTED
    level: ExposureLevel = "local" if inside else "weak" if clear else "guarded"
    return ExposedEndpoint(
        level,
        "zenoh router",
        endpoint,
        MACHINE if inside else NETWORK,
        "what its own settings say: look there as well",
        "read and change samples on their way, who sits between" if clear and not inside else "what that router lets them",
        f"zenoh_connect has {endpoint}",
    )


def _opc_ua(settings: Settings) -> Iterator[ExposedEndpoint]:
    if not settings.opcua_listen:
        return
    inside = is_loopback(settings.opcua_address[0])
    asked, told = credentials_asked(settings)
    clear = settings.opcua_allow_unencrypted
    reached: ExposureLevel = "open" if not asked else "weak" if clear else "guarded"
    level: ExposureLevel = "local" if inside else reached
    channel = "a trusted certificate" if settings.opcua_certificate else ""
    channel += " or none at all" if channel and clear else "no certificate" if clear else ""
    yield ExposedEndpoint(
        level,
        "OPC UA server",
        settings.opcua_listen,
        MACHINE if inside else NETWORK,
        f"{'an API key as name and password' if asked else NOBODY}; {channel}",
        "nothing" if asked else "read all values and act on all alerts",
        f"opcua_listen={settings.opcua_listen}, opcua_allow_unencrypted={clear}; {told}{_twice(settings, level)}",
    )


def _mqtt_broker(settings: Settings) -> Iterator[ExposedEndpoint]:
    """Yield the plant's broker, to which the service connects."""
    if not settings.mqtt_url:
        return
    inside, encrypted = is_loopback(settings.mqtt_broker[0]), settings.mqtt_encrypted
    level: ExposureLevel = "local" if inside else "guarded" if encrypted else "weak"
    samples = "publish samples for any machine, where its rules let them" if settings.mqtt_samples == "taken" else "nothing"
    yield ExposedEndpoint(
        level,
        "MQTT broker",
        settings.mqtt_url,
        MACHINE if inside else NETWORK,
        "what its own users and access rules say: look there as well",
        samples if inside or encrypted else f"{samples}; read and change messages on their way, who sits between",
        f"mqtt_url={settings.mqtt_url}, mqtt_samples={settings.mqtt_samples}",
    )


def _database(settings: Settings) -> Iterator[ExposedEndpoint]:
    url = make_url(settings.database)
    if url.get_dialect().name != "postgresql":
        return
    host = url.host or next(iter(url.normalized_query.get("host", ())), "")
    mode = next(iter(url.normalized_query.get("sslmode", ())), "prefer")
    inside = not host or host.startswith("/") or is_loopback(host)
    checked = mode in CHECKED_TLS
    level: ExposureLevel = "local" if inside else "guarded" if checked else "weak"
    yield ExposedEndpoint(
        level,
        "PostgreSQL",
        f"{host or 'a socket'}:{url.port or 5432}",
        MACHINE if inside else NETWORK,
        "what its pg_hba.conf says, which is not seen from here",
        "nothing, without a login there" if checked or inside else "overhear all data on the way: TLS is not asked for",
        f"database names it, sslmode={mode}",
    )


def _scheduler(settings: Settings) -> Iterator[ExposedEndpoint]:
    if not settings.dask_scheduler:
        return
    where = urlsplit(settings.dask_scheduler)
    inside, tls = is_loopback(where.hostname or ""), where.scheme == "tls"
    level: ExposureLevel = "local" if inside else "guarded" if tls else "open"
    yield ExposedEndpoint(
        level,
        "Dask scheduler",
        settings.dask_scheduler,
        MACHINE if inside else NETWORK,
        "a certificate, as Dask's configuration says" if tls else NOBODY,
        "nothing" if tls else "run programs in its workers, which see samples of runs",
        f"dask_scheduler={settings.dask_scheduler}",
    )


def _inner_network(network: ipaddress.IPv4Network | ipaddress.IPv6Network) -> ExposedEndpoint:
    """Describe a private network to which the service posts."""
    own = any(network.overlaps(one) for one in map(ipaddress.ip_network, OWN) if one.version == network.version)
    level: ExposureLevel = "weak" if own or network.num_addresses > WIDE else "guarded"
    also = ", among them addresses of the service's machine itself" if own else ""
    return ExposedEndpoint(
        level,
        "inner addresses for webhooks",
        str(network),
        "whoever may ask the REST API",
        "the role admin, where the API asks for one",
        f"have the service post signed events to any of its addresses{also}",
        f"delivery_networks has {network}",
    )


def _files(settings: Settings) -> Iterator[ExposedEndpoint]:
    """Yield files that others on this machine may read or write; for files of secrets the service also refuses to start."""
    path = file_of(engine_of(settings.database))
    database = [] if path is None else readable_by_others(path)
    named = (
        settings.tls_key,
        settings.zenoh_tls_key,
        settings.opcua_key,
        settings.mqtt_tls_key,
        settings.mqtt_password_file,
        settings.database_file,
        settings.smtp_password_file,
        settings.oidc_client_secret_file,
        settings.zenoh_access,
    )
    key = key_file(settings)
    others = [Path(one) for one in named if one] + ([] if key is None else [key])
    folders = [Path(one) for one in (settings.backups, settings.webhook_secrets_folder) if one]
    inside = [file for folder in folders for file in _within(folder)]
    for file in [*database, *(one for one in [*others, *inside] if _open_to_others(one, settings))]:
        yield ExposedEndpoint(
            "weak",
            "file",
            str(file),
            "other users of this machine",
            NOBODY,
            "read it, or write to it",
            "its mode: chmod 640 or 600 it",
        )


def _within(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError:  # a folder that may not be listed shows no open file
        return []


def _open_to_others(file: Path, settings: Settings) -> bool:
    """Check whether others may read or write a file; the access rules are public, and must only not be writable."""
    try:
        mode = file.stat().st_mode
    except OSError:
        return False
    forbidden = stat.S_IWOTH if str(file) == settings.zenoh_access else stat.S_IROTH | stat.S_IWOTH
    return bool(mode & forbidden) and stat.S_ISREG(mode)


def endpoint_lines(door: ExposedEndpoint) -> str:
    """Return an endpoint in words."""
    lines = (
        f"{door.level:8s} {door.what}: {door.address}",
        f"         reached from  {door.reach}",
        f"         asks for      {door.asks}",
        f"         lets anybody  {door.lets}",
        f"         because       {door.because}",
    )
    return "\n".join(lines)
