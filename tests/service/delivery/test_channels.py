"""Kinds of channels: declared once, and none takes the place of one that is unknown."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from service.api.alerts.subscription_schemas import SubscriptionIn
from service.delivery.channel import RemindingChannel
from service.delivery.channel_kind import ChannelKind
from service.delivery.channels import CHANNEL_KINDS, ChannelUnknown, by_kind, channel_kind, is_channel
from service.delivery.mail import EMAIL
from service.delivery.zenoh_channel import ZENOH
from service.wording.language import Locale

TELEX: Mapping[Locale, str] = {"en": "telex", "de": "Fernschreiber"}
DOCS = Path(__file__).parents[3] / "docs"


def test_an_unknown_kind_is_an_error_that_names_the_known_ones() -> None:
    assert not is_channel("telex")
    with pytest.raises(ChannelUnknown, match=r"'telex' is no kind .*: webhook, alertmanager, email, zenoh, mqtt"):
        channel_kind("telex")


def test_a_kind_is_declared_once() -> None:
    with pytest.raises(ValueError, match="declared twice"):
        by_kind([*CHANNEL_KINDS, CHANNEL_KINDS[0]])


def test_a_target_is_checked_only_where_there_is_one() -> None:
    with pytest.raises(ValueError, match="'telex' has no target and checks one"):
        ChannelKind("telex", TELEX, "none", None, open=ZENOH.open, check_target=EMAIL.check_target)


def test_every_language_names_a_channel_and_its_addresses() -> None:
    with pytest.raises(ValueError, match="title of channel kind 'telex' is missing in: de"):
        ChannelKind("telex", {"en": "telex"}, "none", None, open=ZENOH.open)
    with pytest.raises(ValueError, match="address of channel kind 'telex' is missing in: en"):
        ChannelKind("telex", TELEX, "a number", {"de": "eine Nummer"}, open=ZENOH.open)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"kind": "telex", "target": "1"}, "Input should be 'webhook', 'alertmanager', 'email', 'zenoh' or 'mqtt'"),
        ({"kind": "zenoh", "target": "x"}, "target: zenoh needs none"),
        ({"kind": "webhook"}, "target: webhook needs one: a URL"),
        ({"kind": "email", "target": "anna"}, "target: an e-mail address such as anna@plant.example"),
        ({"kind": "email", "target": "a@b", "secret_env": "RUNDOWN_WEBHOOK_SECRET_A"}, "and for a webhook only"),
    ],
)
def test_a_subscription_is_checked_by_its_kind(said: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        SubscriptionIn.model_validate({"name": "one"} | said)


def test_the_documentation_has_every_kind() -> None:
    page = (DOCS / "alerts.md").read_text()
    assert [one.kind for one in CHANNEL_KINDS if f"| `{one.kind}` |" not in page] == []


def test_only_those_that_are_reminded_can_be() -> None:
    """The declaration and the class say the same."""
    classes = {one.kind: one.open.__annotations__["return"] for one in CHANNEL_KINDS}
    assert {kind for kind, of in classes.items() if issubclass(of, RemindingChannel)} == {
        one.kind for one in CHANNEL_KINDS if one.reminded
    }
