"""Classifies host names and URLs by who can reach them and who can eavesdrop."""

import functools
import ipaddress
from urllib.parse import urlsplit

KEPT_HOSTS = 256
"""Number of hosts whose class is cached: each request names one."""


@functools.lru_cache(KEPT_HOSTS)
def is_loopback(host: str) -> bool:
    """Check whether an address is reachable from this machine only."""
    try:
        return ipaddress.ip_address(host.strip("[]").split("%")[0]).is_loopback
    except ValueError:
        return host == "localhost"


@functools.lru_cache(KEPT_HOSTS)
def is_address(host: str) -> bool:
    """Check whether a host is an IP address, not a name."""
    try:
        ipaddress.ip_address(host.strip("[]").split("%")[0])
    except ValueError:
        return False
    return True


def encrypted(url: str) -> bool:
    """Check whether traffic to a URL is safe from eavesdroppers: https, or loopback."""
    parts = urlsplit(url)
    return parts.scheme == "https" or (parts.scheme == "http" and is_loopback(parts.hostname or ""))
