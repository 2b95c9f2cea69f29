"""The built page as the service serves it: up to date, whole, compressed, kept by browsers, and nothing from elsewhere."""

import gzip
import hashlib
import re
from collections.abc import Iterator

import httpx
import pytest

from benchmarks.serving import served
from service.api.operation.dashboard import FOLDER, STAMP, files
from storage.database.engine import Database
from tests.paths import ROOT

SOURCES = ROOT / "dashboard"
STAMPED = ("index.html", "package-lock.json", "public", "src", "vite.config.js")
"""As in dashboard/vite.config.js."""
LARGEST_GZIP = 400_000
"""Largest size of the page in all [B]."""


@pytest.fixture
def client(database: Database) -> Iterator[httpx.Client]:
    """A client that takes what it gets, compressed or not."""
    with served(database) as url, httpx.Client(base_url=url.removesuffix("/api/v1"), trust_env=False) as one:
        yield one


def stamp() -> str:
    """SHA-256 over name and content of every source of the page."""
    paths = [path for name in STAMPED for path in [SOURCES / name, *(SOURCES / name).rglob("*")] if path.is_file()]
    digest = hashlib.sha256()
    for path in sorted(paths, key=lambda path: path.relative_to(SOURCES).as_posix()):
        digest.update(f"{path.relative_to(SOURCES).as_posix()}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()


def test_built_page_is_that_of_its_sources() -> None:
    built = (FOLDER / STAMP).read_text().strip()
    assert built == stamp(), "service/dashboard/ is older than dashboard/: run `make dashboard` and commit both"


def test_lock_file_names_no_registry() -> None:
    assert "resolved" not in (SOURCES / "package-lock.json").read_text()


def test_page_asks_no_other_host() -> None:
    for name, file in files().items():
        addresses = re.findall(rb"(?:https?:)?//[\w-]+(?:\.[\w-]+)+", file.body)
        assert [one for one in addresses if b"www.w3.org" not in one] == [], name  # names of XML languages are no addresses


def test_page_runs_no_script_and_no_style_of_its_own_text() -> None:
    text = files()["index.html"].body.decode()
    assert re.findall(r"<script(?![^>]*\bsrc=)", text) == []
    assert "<style" not in text
    assert " style=" not in text


def test_everything_that_the_page_names_is_there(client: httpx.Client) -> None:
    page = client.get("/")
    assert page.status_code == 200
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    named = re.findall(r'(?:src|href)="(/[^"]+)"', page.text)
    assert len(named) >= 3
    for address in named:
        assert client.get(address).status_code == 200, address


def test_policy_allows_only_the_service_itself(client: httpx.Client) -> None:
    for path in ("/", *(f"/{name}" for name in files() if name.startswith("assets/"))):
        headers = client.get(path).headers
        policy = dict(part.split(" ", 1) for part in headers["content-security-policy"].split("; "))
        assert policy["default-src"] == "'none'"
        assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == "'self'"
        assert policy["frame-ancestors"] == "'none'"
        assert headers["x-content-type-options"] == "nosniff"


def test_page_is_asked_for_again_and_assets_are_kept(client: httpx.Client) -> None:
    assert client.get("/").headers["cache-control"] == "no-cache"
    for name in files():
        if name.startswith("assets/"):
            assert "immutable" in client.get(f"/{name}").headers["cache-control"]


def test_what_is_known_is_not_sent_again(client: httpx.Client) -> None:
    tag = client.get("/").headers["etag"]
    again = client.get("/", headers={"if-none-match": f'"other", W/{tag}'})
    assert again.status_code == 304
    assert again.content == b""
    assert again.headers["etag"] == tag
    assert client.get("/", headers={"if-none-match": '"other"'}).status_code == 200


@pytest.mark.parametrize(
    ("accepted", "coded"),
    [("gzip, br", True), ("*", True), ("gzip;q=0", False), ("br", False), ("", False), ("GZIP;q=0.5", True)],
)
def test_compressed_only_for_who_takes_it(client: httpx.Client, accepted: str, coded: bool) -> None:
    name = next(name for name in files() if name.endswith(".js"))
    with client.stream("GET", f"/{name}", headers={"accept-encoding": accepted}) as answer:
        raw = b"".join(answer.iter_raw())
    assert (answer.headers.get("content-encoding") == "gzip") == coded
    assert answer.headers["vary"] == "Accept-Encoding"
    assert (gzip.decompress(raw) if coded else raw) == files()[name].body


def test_head_answers_without_a_body(client: httpx.Client) -> None:
    answer = client.head("/")
    assert answer.status_code == 200
    assert answer.content == b""
    assert int(answer.headers["content-length"]) > 0


def test_unknown_file_is_a_problem(client: httpx.Client) -> None:
    answer = client.get("/assets/index-00000000.js")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


def test_whole_page_is_small() -> None:
    assert sum(len(file.compressed or file.body) for file in files().values()) < LARGEST_GZIP
