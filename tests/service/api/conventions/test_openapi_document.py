"""The document of the API: committed, complete, and its patterns in words."""

import asyncio
import gzip
import json
import re
import time
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from service.api.conventions.patterns import WORDS
from service.commands import openapi
from tests.api_in_process import PREFIX, Api, problem
from tests.paths import ROOT
from tests.plant import KEY

DOCUMENT = f"{PREFIX}/openapi.json"
OF_ITSELF = ("/health", "/ready", "/alive")
"""Paths where what the service says of itself is the answer also where it is not well."""


def test_every_error_is_described_as_a_problem(api: Api) -> None:
    described = api.value("/openapi.json")
    assert described["openapi"].startswith("3.1")
    assert not {"HTTPValidationError", "ValidationError"} & described["components"]["schemas"].keys()
    assert "HTTPValidationError" not in json.dumps(described)
    for path, item in described["paths"].items():
        for method, operation in item.items():
            for code, response in operation["responses"].items():
                if code == "default" or (int(code) >= 400 and not path.endswith(OF_ITSELF)):
                    assert list(response["content"]) == ["application/problem+json"], (method, path, code)
            if method == "post":
                assert "Idempotency-Key" in {one["name"] for one in operation["parameters"]}


def test_the_document_is_written_once_also_for_many_at_once(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    written = []

    def slowly() -> dict[str, str]:
        written.append(1)
        time.sleep(0.2)
        return {"openapi": "3.1.0"}

    monkeypatch.setattr(api.app, "openapi", slowly)

    async def ask() -> list[int]:
        transport = httpx.ASGITransport(api.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://rundown") as client:
            return [one.status_code for one in await asyncio.gather(*(client.get(DOCUMENT) for _ in range(20)))]

    assert asyncio.run(ask()) == [200] * 20
    assert written == [1]


def test_the_document_is_written_once(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    """Anybody may ask for it, and to write it takes some 20 ms of the thread that answers everybody."""
    first, zipped = (api.ask("GET", DOCUMENT, headers={"Accept-Encoding": one}) for one in ("identity", "gzip"))
    assert (zipped.headers["Content-Encoding"], zipped.headers["Vary"]) == ("gzip", "Accept-Encoding")
    assert first.json() == zipped.json()
    monkeypatch.setattr(json, "dumps", _must_not_be_called)
    monkeypatch.setattr(gzip, "compress", _must_not_be_called)
    for one in ("identity", "gzip"):
        assert api.ask("GET", DOCUMENT, headers={"Accept-Encoding": one}).status_code == 200


def _must_not_be_called(*_arguments: object, **_named: object) -> bytes:
    raise AssertionError("the document is written anew")


def test_the_committed_document_is_that_of_the_application() -> None:
    """A change of the API is seen in review: `python -m service.commands.openapi docs/openapi.json` renews the file."""
    committed = (ROOT / "docs" / "openapi.json").read_text(encoding="utf-8")
    assert committed == openapi.text(), "renew it: python -m service.commands.openapi docs/openapi.json"


def test_every_pattern_is_said_in_words() -> None:
    document = json.loads((ROOT / "docs" / "openapi.json").read_text())
    assert set(patterns(document)) == set(WORDS)


def patterns(part: Any) -> Iterator[str]:
    """Every pattern of a document."""
    if isinstance(part, dict):
        if isinstance(part.get("pattern"), str):
            yield part["pattern"]
        part = list(part.values())
    for one in part if isinstance(part, list) else []:
        yield from patterns(one)


def test_a_text_of_another_pattern_is_refused_in_words(api: Api) -> None:
    answer = api.get(f"/machines/{KEY.machine}/trends", parameter="nope")
    (error,) = problem(answer, 422)["errors"]
    assert "such as bearing.B1.kxx" in error["message"]


def test_documentation_needs_no_other_host(api: Api) -> None:
    answer = api.get("/docs")
    assert answer.status_code == 200
    assert re.findall(r"(?:https?:)?//[\w.-]+\.\w+[^\s\"']*", answer.text) == []
    own = re.findall(r"(?:src|href)=\"([^\"]+)\"", answer.text)
    assert own
    for address in own:
        assert api.ask("GET", address).status_code == 200, address


def operations(api: Api) -> list[tuple[str, str, dict[str, Any]]]:
    return [
        (method, path, operation)
        for path, item in api.value("/openapi.json")["paths"].items()
        for method, operation in item.items()
    ]


def test_operation_ids_are_unique_and_names(api: Api) -> None:
    ids = [operation["operationId"] for _, _, operation in operations(api)]
    assert len(ids) == len(set(ids))
    assert all(re.fullmatch(r"[a-z_]+", one) for one in ids)


def test_every_operation_says_what_it_does(api: Api) -> None:
    for method, path, operation in operations(api):
        assert operation["description"], (method, path)
        assert path.startswith(PREFIX) or path == "/metrics"
