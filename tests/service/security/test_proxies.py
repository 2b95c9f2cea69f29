"""Tests who is believed about where a request comes from: the proxies that are named, and by default nobody."""

from contextlib import closing
from ipaddress import ip_network
from pathlib import Path

import httpx
import pytest
from pydantic import ValidationError

from service.configuration.settings import Settings
from service.security.proxies import normalised_networks, proxy_matcher
from storage.database.engine import Database
from storage.operation import audit
from tests.end_to_end.processes import Service, rundown
from tests.service.security.conftest import bearer

FORGED = "203.0.113.66"


@pytest.mark.parametrize(
    ("trusted", "address", "limited"),
    [("[]", "127.0.0.1", True), ('["127.0.0.0/8"]', FORGED, False)],
    ids=["nobody", "loopback"],
)
def test_the_address_is_the_peers_own_unless_a_trusted_proxy_says_another(
    tmp_path: Path, trusted: str, address: str, limited: bool
) -> None:
    # uvicorn's own setting, which would believe everybody, has no effect.
    service = Service(tmp_path, RUNDOWN_TRUSTED_PROXIES=trusted, FORWARDED_ALLOW_IPS="*")
    key = rundown("key", "create", "anna", "--role", "admin", "--database", service.database).stdout.strip()
    page = httpx.Client(base_url=f"http://127.0.0.1:{service.port}")
    with closing(service.client), service.running(), page as client:
        forged = [{"X-Forwarded-For": f"{FORGED[:-2]}{number}", "X-Forwarded-Proto": "https"} for number in range(66, 86)]
        answers = [client.post("/login", data={"key": "wrong"}, headers=one) for one in forged]
        assert (429 in [one.status_code for one in answers]) == limited
        assert ("strict-transport-security" in answers[0].headers) != limited
        (row,) = client.get("/api/v1/audit", params={"limit": 1}, headers=bearer(key)).json()
        assert (row["operation"], row["address"]) == ("log_in", address)
    with closing(Database(service.database)) as database, database.reading() as session:  # a clean stop told the rest
        told = audit.newest(session, limit=1)[0]
    more = f"{[one.status_code for one in answers].count(401) - 1} more within a minute"
    assert (told.address, told.outcome) == (address if limited else "19 addresses", f"refused: {more}")


HOPS = [
    ([f"198.51.100.1, {FORGED}"], FORGED),  # the first is what the caller wrote, the last what the proxy saw
    ([f"198.51.100.1, {FORGED}, 10.0.3.7, 127.0.0.9"], FORGED),  # over trusted proxies
    ([f"{FORGED},10.0.4.7"], "10.0.4.7"),  # over a proxy that is not named
    ([FORGED, "198.51.100.1"], "198.51.100.1"),  # two lines: the proxy's own comes last
    ([], "127.0.0.1"),
]
"""Lines of X-Forwarded-For, and the address that counts."""


def test_of_several_hops_the_last_that_is_no_trusted_proxy_counts(tmp_path: Path) -> None:
    service = Service(tmp_path, RUNDOWN_TRUSTED_PROXIES='["127.0.0.0/8", "10.0.3.0/24"]')
    made = [
        rundown("key", "create", f"anna-{one}", "--role", "admin", "--database", service.database) for one in range(len(HOPS))
    ]
    keys = [one.stdout.strip() for one in made]
    page = httpx.Client(base_url=f"http://127.0.0.1:{service.port}")
    with closing(service.client), service.running(), page as client:
        for key, (lines, _) in zip(keys, HOPS, strict=True):
            headers = [("X-Forwarded-For", one) for one in lines]
            assert client.post("/login", data={"key": key}, headers=headers).status_code == 303
        rows = client.get("/api/v1/audit", params={"limit": 50}, headers=bearer(keys[0])).json()
    logins = [row["address"] for row in reversed(rows) if row["operation"] == "log_in"]
    assert logins == [address for _, address in HOPS]


def test_a_proxy_is_known_on_either_kind_of_socket() -> None:
    networks = [ip_network("127.0.0.1"), ip_network("10.0.3.0/24"), ip_network("fd00::/8")]
    assert normalised_networks(networks)[3:] == ["::ffff:127.0.0.1/128", "::ffff:10.0.3.0/120"]
    is_proxy = proxy_matcher(networks)
    assert all(map(is_proxy, ["127.0.0.1", "::ffff:10.0.3.7", "10.0.3.255", "fd12::1"]))
    assert not any(map(is_proxy, ["127.0.0.2", "10.0.4.1", "::ffff:10.0.4.1", "::1", "", "localhost", "10.0.3.7:80"]))


@pytest.mark.parametrize("wrong", ["*", "proxy.example", "10.0.3.7/8"])
def test_a_proxy_is_named_by_an_address_or_a_network(wrong: str) -> None:
    with pytest.raises(ValidationError):
        Settings.model_validate({"trusted_proxies": [wrong]})
