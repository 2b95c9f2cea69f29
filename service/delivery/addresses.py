"""Where deliveries may go: to public addresses, and to the private networks that the operator names.

A receiver's URL is given by a person over the API; without this guard it could make the service talk to machines that only
the service can reach. The address is looked up once and the connection goes to what was looked up, so that a name that
changes between check and use gains nothing.
"""

import asyncio
import ipaddress
import socket
from dataclasses import dataclass

from yarl import URL

Network = ipaddress.IPv4Network | ipaddress.IPv6Network
Address = ipaddress.IPv4Address | ipaddress.IPv6Address


NAT64 = (ipaddress.IPv6Network("64:ff9b::/96"), ipaddress.IPv6Network("64:ff9b:1::/48"))
METADATA = (ipaddress.IPv4Address("168.63.129.16"), ipaddress.IPv4Address("192.0.0.192"))
"""Where clouds tell a machine about itself at an address that counts as public (Azure, Oracle); others have private ones."""


class TargetRefused(ValueError):
    """Nothing is sent there; the message says why and what would be right."""


@dataclass(frozen=True)
class Target:
    """A checked URL: `url` with the looked-up address in the place of its name; the name, and the port with it as a header."""

    url: URL
    name: str
    host_header: str


def parsed(text: str) -> URL:
    """A URL that something can be sent to. Raises TargetRefused."""
    try:
        url = URL(text)
        if url.scheme not in ("http", "https") or not url.host:
            raise TargetRefused(f"'{text[:200]}' is not a URL that begins with http:// or https:// and names a host")
        if url.user is not None or url.password is not None:
            raise TargetRefused("a URL with a user or a password in it is not taken: it would be shown to everybody")
        _ = url.port
    except (ValueError, TypeError) as error:
        raise error if isinstance(error, TargetRefused) else TargetRefused(f"'{text[:200]}' is no URL: {error}") from error
    return url


async def checked(text: str, allowed: tuple[Network, ...]) -> Target:
    """Look a URL's host up and check every address it has. Raises TargetRefused."""
    url = parsed(text)
    name = url.host or ""
    try:
        found = await asyncio.get_running_loop().getaddrinfo(name, url.port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        raise TargetRefused(f"the host {name} is not known: {error}") from error
    addresses = [_address(str(one[4][0])) for one in found]
    for address in addresses:
        _require(name, address, allowed)
    return Target(url.with_host(str(addresses[0])), name, url.authority)


def _address(text: str) -> Address:
    """The address at which it ends: some of IPv6 stand for one of IPv4 behind a gateway (RFC 4291, 3056, 4380, 6052)."""
    address = ipaddress.ip_address(text.split("%")[0])
    if not isinstance(address, ipaddress.IPv6Address):
        return address
    behind = address.ipv4_mapped or address.sixtofour or (address.teredo[1] if address.teredo else None)
    if behind is None and any(address in network for network in NAT64):
        behind = ipaddress.IPv4Address(int(address) & 0xFFFFFFFF)
    return behind or address


def _require(host: str, address: Address, allowed: tuple[Network, ...]) -> None:
    if address.is_global and not address.is_multicast and address not in METADATA:
        return
    if any(address.version == network.version and address in network for network in allowed):
        return
    raise TargetRefused(
        f"{host} is at {address}, which is no public address: an operator allows private ones by RUNDOWN_DELIVERY_NETWORKS"
    )
