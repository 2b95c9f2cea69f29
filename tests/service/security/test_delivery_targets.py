"""Where webhooks cannot be sent to: by whatever spelling, an address that only the service reaches."""

import asyncio
import ipaddress

import pytest

from service.delivery.addresses import TargetRefused, checked

REFUSED = [
    "http://127.0.0.1/",
    "http://127.1/",
    "http://2130706433/",
    "http://0x7f000001/",
    "http://0/",
    "http://0.0.0.0/",
    "http://localhost/",
    "http://[::1]/",
    "http://[::]/",
    "http://[::ffff:127.0.0.1]/",
    "http://[::ffff:10.0.0.1]/",
    "http://[2002:7f00:1::]/",
    "http://[2002:a9fe:a9fe::]/",
    "http://[64:ff9b::169.254.169.254]/",
    "http://[64:ff9b:1::10.0.0.1]/",
    "http://[fe80::1]/",
    "http://[fd00:ec2::254]/",
    "http://169.254.169.254/latest/meta-data/",
    "http://168.63.129.16/",
    "http://100.100.100.200/",
    "http://192.0.0.192/",
    "http://10.0.0.1/",
    "http://172.16.0.1/",
    "http://192.168.0.1/",
    "http://224.0.0.1/",
    "http://255.255.255.255/",
    "http://[ff02::1]/",
    "http://user:password@8.8.8.8/",
    "ftp://8.8.8.8/",
    "file:///etc/passwd",
    "gopher://8.8.8.8/",
    "//8.8.8.8/",
]


@pytest.mark.parametrize("target", REFUSED)
def test_it_is_refused(target: str) -> None:
    with pytest.raises(TargetRefused):
        asyncio.run(checked(target, ()))


@pytest.mark.parametrize(
    "target", ["https://8.8.8.8/hook", "http://[2606:4700:4700::1111]:8080/", "http://[64:ff9b::8.8.8.8]/"]
)
def test_public_addresses_are_not(target: str) -> None:
    assert asyncio.run(checked(target, ())).url.path in ("/", "/hook")


def test_an_allowed_network_is_that_one_only() -> None:
    allowed = (ipaddress.ip_network("10.1.0.0/16"),)
    assert asyncio.run(checked("http://10.1.2.3/", allowed)).name == "10.1.2.3"
    with pytest.raises(TargetRefused, match="RUNDOWN_DELIVERY_NETWORKS"):
        asyncio.run(checked("http://10.2.2.3/", allowed))


def test_the_connection_goes_to_the_address_that_was_looked_at() -> None:
    """A name that says something else a moment later changes nothing."""
    found = asyncio.run(
        checked("http://localhost:8080/hook", (ipaddress.ip_network("127.0.0.0/8"), ipaddress.ip_network("::1")))
    )
    assert found.url.host is not None
    assert ipaddress.ip_address(found.url.host).is_loopback
    assert (found.name, found.host_header) == ("localhost", "localhost:8080")
