"""The requests that pages of the documentation print with curl, put to the API as printed, one after the other."""

import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from tests.api_in_process import Api
from tests.paths import ROOT
from tests.plant import KEY

PAGES = ("alerts.md", "integrators.md")
HOST = "localhost:8080"
UNENDING = "/stream"
"""End of addresses whose answers do not end."""
BATCH = "@batch.json"
"""The batch that a page shows is sent in measurements/test_ingestion.py, to a service that stores samples."""


@dataclass(frozen=True)
class Printed:
    """A request: its method, its address from the host on, headers, and body."""

    method: str
    address: str
    headers: dict[str, str]
    body: str | None


def printed(page: str) -> Iterator[Printed]:
    """The requests of a page, as a shell makes them of the lines that stand there."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL):
        if block.startswith("curl"):
            script = f"curl() {{ printf '%s\\0' \"$@\"; printf '\\1'; }}\n{block}"
            done = subprocess.run(["bash", "-euc", script], capture_output=True, text=True, check=True)
            yield from (request(words.split("\0")[:-1]) for words in done.stdout.split("\1")[:-1])


def request(words: list[str]) -> Printed:
    """A request of curl's arguments."""
    method, headers, body, address = "GET", {}, None, ""
    left = iter(words)
    for word in left:
        if word == "-X":
            method = next(left)
        elif word == "-H":
            name, _, value = next(left).partition(": ")
            headers[name.lower()] = value
        elif word in ("-d", "--data"):
            body = next(left)
        elif not word.startswith("-"):
            address = word
    assert address.startswith(HOST), words
    return Printed(method, address.removeprefix(HOST), headers, body)


@pytest.mark.parametrize("page", PAGES)
def test_requests_are_answered_as_printed(changing: Api, page: str) -> None:
    found = [one for one in printed(page) if not one.address.endswith(UNENDING) and one.body != BATCH]
    assert len(found) >= 8
    etag = ""
    for one in found:
        headers = {name: value.replace('"ETAG"', etag) for name, value in one.headers.items()}
        answer = changing.ask(
            one.method, one.address.replace("motor-pump", KEY.machine), headers={"if-match": ""} | headers, content=one.body
        )
        assert answer.status_code in (200, 201, 202, 204), f"{one.method} {one.address}: {answer.status_code} {answer.text}"
        etag = answer.headers.get("etag", etag)
