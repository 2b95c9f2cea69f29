"""Declaration of a kind of delivery channel, and the connections that its channels use."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import zenoh
from aiohttp import ClientSession

from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.configuration.settings import Settings
from service.delivery.channel import Channel
from service.delivery.signing_secrets import SigningSecrets
from service.wording.language import Locale, require_every_language
from storage.tables.alerting import SubscriptionRow


class EventBroker(Protocol):
    """A broker that keeps the last event of each topic."""

    async def publish_event(self, plant: str, event: AlertEvent) -> str:
        """Publish an event and return where, once the broker has it. Raises OSError while it is away."""


@dataclass(frozen=True)
class Connections:
    """Connections and settings that channels send with.

    broker: the plant's MQTT broker, where one is configured. texts: texts of findings, which messages are made of.
    """

    client: ClientSession
    session: zenoh.Session
    settings: Settings
    secrets: SigningSecrets
    broker: EventBroker | None = None
    texts: SiteTexts = field(default_factory=SiteTexts)


def _accept(_target: str) -> None:
    """Accept any target."""


@dataclass(frozen=True)
class ChannelKind:
    """Declaration of one kind of channel. Raises ValueError where its parts contradict each other, or a language is missing.

    kind: its name in the API. title: its name on the page, by language. description: description of a subscription's target,
    for the API. address: form of the target in a few words, by language; None where there is no target. open: makes the
    channel of a subscription; may raise SecretUnusable. check_target: raises ValueError for a target of another form.
    url_target: whether the target is a URL, whose address is checked before delivery. signed: whether messages are signed with
    a secret of the subscription. reminded: whether its channels are RemindingChannels. reporting: whether reports of machines
    can be sent by it.
    """

    kind: str
    title: Mapping[Locale, str]
    description: str
    address: Mapping[Locale, str] | None
    open: Callable[[SubscriptionRow, Connections], Channel]
    check_target: Callable[[str], None] = _accept
    url_target: bool = False
    signed: bool = False
    reminded: bool = False
    reporting: bool = False

    def __post_init__(self) -> None:
        if self.address is None and (self.url_target or self.check_target is not _accept):
            raise ValueError(f"channel kind '{self.kind}' has no target and checks one")
        require_every_language(f"title of channel kind '{self.kind}'", self.title)
        if self.address is not None:
            require_every_language(f"address of channel kind '{self.kind}'", self.address)
