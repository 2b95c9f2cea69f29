"""Registry of the kinds of delivery channels, each declared in its own module: `CHANNEL_KINDS`.

To add one, write its module in this folder and name its declaration here.
"""

from collections.abc import Mapping, Sequence

from aiohttp import ClientSession, ClientTimeout, DummyCookieJar, TCPConnector

from service.delivery.alertmanager import ALERTMANAGER
from service.delivery.channel import Channel, Undeliverable
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.mail import EMAIL
from service.delivery.mqtt_channel import MQTT
from service.delivery.signing_secrets import SecretUnusable
from service.delivery.webhook import TIMEOUT_S, WEBHOOK
from service.delivery.zenoh_channel import ZENOH
from storage.tables.alerting import SubscriptionRow

CHANNEL_KINDS: tuple[ChannelKind, ...] = (WEBHOOK, ALERTMANAGER, EMAIL, ZENOH, MQTT)
"""All kinds, in the order in which people see them."""


class ChannelUnknown(ValueError):
    """A subscription is of an undeclared kind."""


def by_kind(declared: Sequence[ChannelKind]) -> Mapping[str, ChannelKind]:
    """Return declarations by kind. Raises ValueError where one is declared twice."""
    found = {one.kind: one for one in declared}
    if len(found) < len(declared):
        raise ValueError(f"a channel kind is declared twice: {', '.join(one.kind for one in declared)}")
    return found


_BY_KIND = by_kind(CHANNEL_KINDS)


def is_channel(kind: str) -> bool:
    """Return whether a kind of channel is declared."""
    return kind in _BY_KIND


def channel_kind(kind: str) -> ChannelKind:
    """Return the declaration of a kind of channel. Raises ChannelUnknown where there is none."""
    if kind not in _BY_KIND:
        raise ChannelUnknown(f"'{kind}' is no kind of subscription that this release knows: {', '.join(_BY_KIND)}")
    return _BY_KIND[kind]


def open_channel(row: SubscriptionRow, connections: Connections) -> Channel:
    """Return the channel of a subscription; for one that cannot be served, a channel that fails with the reason."""
    try:
        return channel_kind(row.kind).open(row, connections)
    except (ChannelUnknown, SecretUnusable) as error:
        return Undeliverable(str(error))


def new_client() -> ClientSession:
    """Return a client without a limit of connections: hanging receivers must not use up those of the others."""
    return ClientSession(
        connector=TCPConnector(limit=0),
        timeout=ClientTimeout(total=TIMEOUT_S),
        cookie_jar=DummyCookieJar(),
        auto_decompress=False,
    )
