"""Restricts deliveries to public addresses and to the private networks that the operator names.

A receiver's URL comes from a person over the API; without this check it could reach machines that only the service can reach.
The name is resolved once and the connection goes to the resolved address: a name that changes between check and use gains
nothing.
"""

import asyncio
import ipaddress
import socket
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass

from yarl import URL

from estimator.errors import Invalid
from service.delivery.daemon_threads import DaemonThreads

LOOK_UPS = DaemonThreads(8, name="look-up")
"""Separate threads for name resolution: without a name server each blocks for many seconds."""
Network = ipaddress.IPv4Network | ipaddress.IPv6Network
Address = ipaddress.IPv4Address | ipaddress.IPv6Address
LONGEST_LOOK_UP_S = 3.0
"""Time after which the name of a new target is not waited for [s]; each delivery looks it up again."""


NAT64 = ipaddress.IPv6Network("64:ff9b::/96")
"""NAT64 prefix with a known position of the IPv4 address; local prefixes in 64:ff9b:1::/48 have none (RFC 8215)."""
PUBLIC_IPV6 = ipaddress.IPv6Network("2000::/3")
"""Global unicast range of IPv6. It excludes the site-local fec0::/10, IPv4-compatible ::/96, IPv4-translated ::ffff:0:0:0/96
and segments 5f00::/16, some of which `ipaddress` takes for public.
"""
NOT_PUBLIC = tuple(
    ipaddress.ip_network(network)
    for network in (
        "168.63.129.16/32",  # Azure's metadata service; those of other clouds have private addresses
        "192.0.0.0/24",  # protocol assignments, with Oracle's metadata service
        "192.88.99.0/24",  # 6to4 relays
        "2001::/23",  # protocol assignments, with Teredo, which leads to an IPv4 address
        "2002::/16",  # 6to4, which leads to an IPv4 address
        "3fff::/20",  # documentation
    )
)
"""Networks that some versions of `ipaddress` take for public."""
ISATAP = 0x5EFE
"""Upper half of an interface id whose lower half is an IPv4 address of the site; bit 0x02000000 is free (RFC 5214)."""


class TargetRefused(Invalid):
    """The target of a delivery is not permitted; the message says why and what would be right."""


@dataclass(frozen=True)
class Target:
    """A checked URL: `url` with the resolved address instead of the name, the name itself, and the Host header."""

    url: URL
    name: str
    host_header: str


def parsed(text: str) -> URL:
    """Parse a URL that deliveries can be sent to. Raises TargetRefused."""
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


class HostUnknown(TargetRefused):
    """The host of a target has no address at present: a name that is not resolved yet may be later."""


async def require_permitted(text: str, allowed: tuple[Network, ...]) -> None:
    """Require of a URL that deliveries to it are permitted; one whose host is not known yet is. Raises TargetRefused.

    Names that are looked up for deliveries do not wait for these, of which only so many wait: each delivery checks again.
    """
    parsed(text)
    with suppress(HostUnknown, TimeoutError):
        await asyncio.wait_for(checked(text, allowed, NEW_NAMES), LONGEST_LOOK_UP_S)


async def checked(text: str, allowed: tuple[Network, ...], look_ups: "LookUps | None" = None) -> Target:
    """Resolve a URL's host and check each of its addresses. look_ups: by default those of deliveries. Raises TargetRefused."""
    url = parsed(text)
    name = url.host or ""
    try:
        found = await _addresses_of(name, url.port, look_ups or NAMES)
    except (OSError, UnicodeError) as error:
        raise HostUnknown(f"the host {name} is not known: {error}") from error
    addresses = [_address(one) for one in found]
    for address in addresses:
        _require(name, address, allowed)
    return Target(url.with_host(str(addresses[0])), name, url.authority)


class LookUps:
    """Look-ups of names in threads of their own, one per name: a hanging name blocks one thread, however many wait for it."""

    def __init__(self, threads: DaemonThreads, *, most: int | None = None) -> None:
        """Set up. most: number of names that may be looked up or wait; further ones count as unknown. None: without bound."""
        self._threads = threads
        self._most = most
        self._under_way: dict[tuple[str, int | None], Future[list[str]]] = {}

    async def addresses(self, name: str, port: int | None) -> list[str]:
        """Return all addresses of a name. Raises OSError, HostUnknown."""
        answer = self._under_way.get((name, port))
        if answer is None or answer.done():
            if self._most is not None and len(self._under_way) >= self._most:
                raise HostUnknown(f"the host {name} is not known: {self._most} other names are being looked up")
            answer = self._under_way[name, port] = self._threads.submit(_resolve, name, port)
            answer.add_done_callback(lambda _: self._under_way.pop((name, port), None))
        return await asyncio.shield(asyncio.wrap_future(answer))


NAMES = LookUps(LOOK_UPS)
NEW_NAMES = LookUps(DaemonThreads(4, name="look-up of a new target"), most=16)


async def _addresses_of(name: str, port: int | None, look_ups: LookUps) -> list[str]:
    """Return all addresses of a host. A literal address needs no name server."""
    try:
        return _resolve(name, port, socket.AI_NUMERICHOST)
    except socket.gaierror:
        return await look_ups.addresses(name, port)


def _resolve(name: str, port: int | None, flags: int = 0) -> list[str]:
    return [str(one[4][0]) for one in socket.getaddrinfo(name, port, type=socket.SOCK_STREAM, flags=flags)]


def _address(text: str) -> Address:
    """Return the final address: some IPv6 addresses stand for an IPv4 address (RFC 4291, 6052)."""
    address = ipaddress.ip_address(text.split("%")[0])
    if not isinstance(address, ipaddress.IPv6Address):
        return address
    if address in NAT64:
        return ipaddress.IPv4Address(int(address) & 0xFFFFFFFF)
    return address.ipv4_mapped or address


def _is_public(address: Address) -> bool:
    """Check whether an address is public and stands for no other address."""
    if not address.is_global or address.is_multicast or any(address in network for network in NOT_PUBLIC):
        return False
    if isinstance(address, ipaddress.IPv4Address):
        return True
    return address in PUBLIC_IPV6 and (int(address) >> 32) & 0xFDFFFFFF != ISATAP


def _require(host: str, address: Address, allowed: tuple[Network, ...]) -> None:
    if _is_public(address):
        return
    if any(address.version == network.version and address in network for network in allowed):
        return
    raise TargetRefused(
        f"{host} is at {address}, which is no public address: an operator allows private ones by RUNDOWN_DELIVERY_NETWORKS"
    )
