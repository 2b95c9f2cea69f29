"""Signatures against the reference library of Standard Webhooks; addresses that the service must not talk to."""

import asyncio
import ipaddress
import json
from datetime import UTC, datetime

import pytest
from standardwebhooks.webhooks import Webhook, WebhookVerificationError

from service.delivery.addresses import TargetRefused, checked, parsed
from service.delivery.signing import new_secret, signed_headers

LOOPBACK = (ipaddress.ip_network("127.0.0.0/8"),)


def test_the_reference_library_takes_the_signature_and_refuses_a_changed_body() -> None:
    secret, body = new_secret(), json.dumps({"a": "é"}).encode()
    headers = signed_headers(secret, message_id="alert-1-1", seconds=int(datetime.now(UTC).timestamp()), body=body)
    reference = Webhook(secret)
    assert reference.verify(body, headers) == {"a": "é"}
    with pytest.raises(WebhookVerificationError):
        reference.verify(body + b" ", headers)
    with pytest.raises(WebhookVerificationError):
        Webhook(new_secret()).verify(body, headers)


def test_secrets_differ() -> None:
    assert len({new_secret() for _ in range(100)}) == 100


@pytest.mark.parametrize(
    "url",
    [
        "http://127.0.0.1/",
        "http://localhost:9093/",
        "http://[::1]/",
        "http://10.0.0.1/",
        "http://192.168.1.1/",
        "http://169.254.169.254/latest/meta-data",
        "http://0.0.0.0/",
        "http://[::ffff:127.0.0.1]/",
        "http://[fe80::1]/",
        "http://[fd00::1]/",
        "http://2130706433/",
        "http://0x7f.1/",
        "http://224.0.0.1/",
    ],
)
def test_private_targets_are_refused_unless_allowed(url: str) -> None:
    with pytest.raises(TargetRefused):
        asyncio.run(checked(url, ()))


def test_a_network_that_the_operator_names_is_allowed_and_no_other() -> None:
    found = asyncio.run(checked("http://localhost:8000/hook?a=1", (*LOOPBACK, ipaddress.ip_network("::1/128"))))
    assert str(found.url) in ("http://127.0.0.1:8000/hook?a=1", "http://[::1]:8000/hook?a=1")
    assert found.host_header == "localhost:8000"
    with pytest.raises(TargetRefused, match="RUNDOWN_DELIVERY_NETWORKS"):
        asyncio.run(checked("http://10.0.0.1/", LOOPBACK))


@pytest.mark.parametrize(
    "url", ["", "ftp://example.org/", "/hook", "http://", "file:///etc/passwd", "http://u:p@example.org/"]
)
def test_what_is_no_target_is_refused(url: str) -> None:
    with pytest.raises(TargetRefused):
        parsed(url)
