"""Refuses changes that a page of another site triggers in a person's browser (CSRF).

Sources: Fetch Metadata (Sec-Fetch-Site), RFC 6454 (Origin). Browsers always send one of the two with a change; programs send
neither. A session by cookie also needs a token that only this site's page can read.
"""

import hmac
from collections.abc import Mapping
from urllib.parse import urlsplit

from service.configuration.hosts import is_address, is_loopback
from service.security.principal import Principal

TOKEN_HEADER = "X-Rundown-Token"
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


def foreign(headers: Mapping[bytes, bytes], *, public_url: str) -> str | None:
    """Return the reason why a change seems to come from another site's page, or None."""
    site = headers.get(b"sec-fetch-site", b"none").decode("latin-1")
    if site == "same-origin":
        return None
    if site != "none":
        return f"Sec-Fetch-Site says {site[:20]}"
    origin = headers.get(b"origin")
    if origin is None:
        return None
    try:
        said = urlsplit(origin.decode("latin-1"))
    except ValueError:
        return "Origin is no site"
    own = {headers.get(b"host", b"").decode("latin-1").lower(), urlsplit(public_url).netloc.lower()} - {""}
    return None if said.scheme in ("http", "https") and said.netloc.lower() in own else "Origin is another site"


def rebound(headers: Mapping[bytes, bytes], *, public_url: str) -> str | None:
    """Return the reason why a request to a service on loopback seems to use a rebound name (DNS rebinding), or None.

    IP addresses and localhost cannot be rebound.
    """
    said = headers.get(b"host", b"").decode("latin-1")
    try:
        host = urlsplit("//" + said).hostname or ""
    except ValueError:
        return f"'{said[:100]}' is no name"
    if not host or is_address(host) or is_loopback(host) or host == urlsplit(public_url).hostname:
        return None
    return f"{host[:100]} is not a name of this service: use localhost, log in, or set RUNDOWN_PUBLIC_URL"


def refusal(
    who: Principal, method: str, headers: Mapping[bytes, bytes], *, public_url: str, with_token: bool = True
) -> str | None:
    """Return the reason why a change is refused, or None. with_token: False for login and logout, which need no token."""
    if method in SAFE_METHODS or who.kind not in ("open", "session", "anonymous"):
        return None
    found = foreign(headers, public_url=public_url)
    if found is not None:
        return f"a change that another site's page asked for is refused ({found}); behind a proxy set RUNDOWN_PUBLIC_URL"
    if who.kind == "session" and with_token:
        given = headers.get(TOKEN_HEADER.lower().encode(), b"")
        if not hmac.compare_digest(given, (who.token or "").encode()):
            return f"a change with a session's cookie needs {TOKEN_HEADER}, which GET /api/v1/me tells"
    return None
