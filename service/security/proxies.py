"""The reverse proxies of a deployment: their X-Forwarded-For and X-Forwarded-Proto are trusted."""

from collections.abc import Callable, Sequence
from ipaddress import IPv4Network, IPv6Network, ip_address, ip_network

ProxyNetwork = IPv4Network | IPv6Network
MAPPED = "::ffff:"
"""Prefix of IPv4 peers on a socket that listens on IPv6 (RFC 4291, section 2.5.5.2)."""


def proxy_matcher(networks: Sequence[ProxyNetwork]) -> Callable[[str], bool]:
    """Return a predicate that is true for addresses of these proxies."""
    seen = [ip_network(one) for one in normalised_networks(networks)]

    def is_proxy(address: str) -> bool:
        try:
            found = ip_address(address)
        except ValueError:
            return False
        return any(found in network for network in seen)

    return is_proxy


def normalised_networks(networks: Sequence[ProxyNetwork]) -> list[str]:
    """Return the networks, with the IPv4 ones also in their IPv6-mapped form."""
    mapped = [f"{MAPPED}{one.network_address}/{96 + one.prefixlen}" for one in networks if isinstance(one, IPv4Network)]
    return [*map(str, networks), *mapped]
