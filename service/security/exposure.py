"""Refuses to start a service that is open to the network without credentials."""

from collections.abc import Sequence
from urllib.parse import urlsplit

from service.configuration.hosts import is_loopback
from service.configuration.settings import Settings

TWICE = (
    "to serve it to everybody who reaches it all the same, say so twice: --allow-no-authentication and "
    "RUNDOWN_EVERYBODY_MAY_CHANGE_EVERYTHING=true"
)

TWICE_FOR_ROUTERS = (
    "to open it to everybody all the same, say so twice: RUNDOWN_ALLOW_NO_AUTHENTICATION=true and "
    "RUNDOWN_EVERYBODY_MAY_CHANGE_EVERYTHING=true"
)


class Exposed(RuntimeError):
    """Everybody on the network could change everything; the message says what would be right."""


def require_authentication(settings: Settings, *, keys_are_there: bool) -> list[str]:
    """List the endpoints that are open by double permission, for the log. Raises Exposed where it is missing."""
    found = _unprotected_access(settings, keys_are_there=keys_are_there)
    if found and not allowed_twice(settings):
        raise Exposed(f"{'; '.join(found)}; {TWICE}")
    return found


def require_guarded(settings: Settings, listen: Sequence[str]) -> list[str]:
    """List the open zenoh endpoints of a router that runs alone, by double permission. Raises Exposed where it is missing."""
    found = _open_endpoints(settings, listen)
    if found and not allowed_twice(settings):
        raise Exposed(f"{'; '.join(found)}; {TWICE_FOR_ROUTERS}")
    return found


def _open_endpoints(settings: Settings, listen: Sequence[str]) -> list[str]:
    if settings.zenoh_access:
        return []
    return [
        f"anybody could publish for any machine on {endpoint}: set RUNDOWN_ZENOH_ACCESS and RUNDOWN_ZENOH_TLS_… "
        "(docs/security.md), or listen on loopback"
        for endpoint in beyond(listen)
    ]


def _unprotected_access(settings: Settings, *, keys_are_there: bool) -> list[str]:
    found = []
    if not is_loopback(settings.host) and not credentials_needed(settings, keys_are_there=keys_are_there):
        found.append(
            f"the API on {settings.host} would need no credentials: make a first key with "
            "`rundown key create NAME --role admin`, or set RUNDOWN_OIDC_ISSUER"
        )
    found += _open_opcua(settings, keys_are_there=keys_are_there)
    return found + _open_endpoints(settings, settings.zenoh_listen)


def _open_opcua(settings: Settings, *, keys_are_there: bool) -> list[str]:
    if not settings.opcua_listen or is_loopback(settings.opcua_address[0]):
        return []
    if keys_are_there or settings.authentication == "required":
        return []
    return [
        f"anybody could acknowledge alerts at {settings.opcua_listen}: make a first key with "
        "`rundown key create NAME --role operator`, or listen on loopback"
    ]


def credentials_needed(settings: Settings, *, keys_are_there: bool) -> bool:
    """Check whether the API requires credentials."""
    return keys_are_there or bool(settings.oidc_issuer) or settings.authentication == "required"


def allowed_twice(settings: Settings) -> bool:
    """Check whether both settings allow everybody to do everything."""
    return settings.allow_no_authentication and settings.everybody_may_change_everything


def beyond(endpoints: Sequence[str]) -> list[str]:
    """Return the zenoh endpoints that other machines can reach."""
    return [one for one in endpoints if not one.startswith("unix") and not is_loopback(host_of(one))]


def host_of(endpoint: str) -> str:
    """Return the host of a zenoh endpoint such as tcp/[::]:7447."""
    return urlsplit("//" + endpoint.partition("/")[2].partition("?")[0].partition("#")[0]).hostname or ""
