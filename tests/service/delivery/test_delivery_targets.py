"""Tests where webhooks cannot be sent to: by whatever spelling, an address that only the service reaches."""

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
    "http://[64:ff9b::a00:1]/",
    "http://[64:ff9b:1:a00:0:100::]/",
    "http://[64:ff9b:1::8.8.8.8]/",
    "http://[2002:a00:1::]/",
    "http://[2002:808:808::1]/",
    "http://[2001:0:808:808:0:ffff:80ff:fffe]/",  # Teredo, to 127.0.0.1
    "http://[2001:0:7f00:1:0:ffff:f7f7:f7f7]/",  # Teredo, by way of 127.0.0.1
    "http://[2001:0:808:808:0:ffff:f7f7:f7f7]/",
    "http://[::127.0.0.1]/",
    "http://[::8.8.8.8]/",
    "http://[::ffff:0:127.0.0.1]/",
    "http://[::5efe:7f00:1]/",
    "http://[2001:db8::5efe:7f00:1]/",
    "http://[2606:4700::5efe:7f00:1]/",
    "http://[2606:4700::200:5efe:10.0.0.1]/",
    "http://[fe80::5efe:7f00:1]/",
    "http://[fec0::1]/",
    "http://[feff::1]/",
    "http://[5f00::1]/",
    "http://[3fff::1]/",
    "http://[2001:db8::1]/",
    "http://[2001:20::1]/",
    "http://[100::1]/",
    "http://[4000::1]/",
    "http://192.88.99.1/",
    "http://[::ffff:192.88.99.1]/",
    "http://192.0.0.9/",
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
    "target",
    ["https://8.8.8.8/hook", "http://[2606:4700:4700::1111]:8080/", "http://[64:ff9b::8.8.8.8]/", "http://[::ffff:8.8.8.8]/"],
)
def test_public_addresses_are_not(target: str) -> None:
    assert asyncio.run(checked(target, ())).url.path in ("/", "/hook")


def test_an_allowed_network_is_that_one_only() -> None:
    allowed = (ipaddress.ip_network("10.1.0.0/16"),)
    assert asyncio.run(checked("http://10.1.2.3/", allowed)).name == "10.1.2.3"
    with pytest.raises(TargetRefused, match="RUNDOWN_DELIVERY_NETWORKS"):
        asyncio.run(checked("http://10.2.2.3/", allowed))


@pytest.mark.parametrize(
    ("target", "network"),
    [
        ("[fec0::1]", "fec0::/10"),
        ("[::ffff:10.1.2.3]", "10.1.0.0/16"),
        ("[64:ff9b::10.1.2.3]", "10.1.0.0/16"),
        ("[64:ff9b:1::10.1.2.3]", "64:ff9b:1::/48"),
        ("[2002:a01:203::1]", "2002:a01:203::/48"),
        ("192.88.99.1", "192.88.99.0/24"),
        ("[3fff::5efe:a01:203]", "3fff::/20"),
    ],
)
def test_what_is_refused_can_be_allowed_by_its_own_network(target: str, network: str) -> None:
    assert asyncio.run(checked(f"http://{target}/", (ipaddress.ip_network(network),)))


@pytest.mark.parametrize("target", ["64:ff9b:1::10.1.2.3", "2002:a01:203::1", "::10.1.2.3", "2606:4700::5efe:10.1.2.3"])
def test_what_leads_to_an_allowed_network_by_a_way_of_its_own_is_not_allowed_with_it(target: str) -> None:
    with pytest.raises(TargetRefused):
        asyncio.run(checked(f"http://[{target}]/", (ipaddress.ip_network("10.1.0.0/16"),)))


def test_the_connection_goes_to_the_address_that_was_looked_at() -> None:
    """A name that says something else a moment later changes nothing."""
    found = asyncio.run(
        checked("http://localhost:8080/hook", (ipaddress.ip_network("127.0.0.0/8"), ipaddress.ip_network("::1")))
    )
    assert found.url.host is not None
    assert ipaddress.ip_address(found.url.host).is_loopback
    assert (found.name, found.host_header) == ("localhost", "localhost:8080")
