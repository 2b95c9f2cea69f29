"""Asking the API in the tests' own process: the application over a database, its answers, its problem details."""

import asyncio
import json
from typing import Any

import httpx
from fastapi import FastAPI

from service.api.application import application
from service.api.cache.model_process import ModelProcess
from service.delivery.signing_secrets import SigningSecrets
from service.reports.report_process import ReportProcess
from service.secrets.sealing import Sealing
from storage.database.engine import Database

PREFIX = "/api/v1"
SECRETS = SigningSecrets(Sealing([bytes(range(32))]))
"""With a key that seals."""
MODELS, REPORTS = ModelProcess(), ReportProcess()
"""Processes of all applications here: each of its own would take a second to start, and stay."""
PROBLEM = {"type", "title", "status", "detail", "errors"}


class InProcess(httpx.BaseTransport):
    """Requests go to an application without a network between; what it raises is its own answer, as from a server."""

    def __init__(self, app: FastAPI) -> None:
        self._app = app

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        """One request, on an event loop of its own."""
        return asyncio.run(self._handle(request))

    async def _handle(self, request: httpx.Request) -> httpx.Response:
        transport = httpx.ASGITransport(self._app, raise_app_exceptions=False)
        answer = await transport.handle_async_request(
            httpx.Request(request.method, request.url, headers=request.headers, content=request.read())
        )
        body = b"".join([part async for part in answer.aiter_raw()])
        return httpx.Response(answer.status_code, headers=answer.headers, content=body)


class Api:
    """The application, asked as over HTTP; `parts` is what the rest of the service says of itself."""

    def __init__(self, database: Database, **application_parts: Any) -> None:
        self.database = database
        self.parts = {"ingest": "ok", "identifying": "ok", "stream": "ok"}
        self.app: FastAPI = application(database, lambda: dict(self.parts), **({"secrets": SECRETS} | application_parts))
        self.app.state.model_process, self.app.state.report_process = MODELS, REPORTS
        # Whatever there is may be changed, where a test does not say otherwise.
        self.http = httpx.Client(transport=InProcess(self.app), base_url="http://rundown", headers={"if-match": "*"})

    def ask(self, method: str, path: str, **arguments: Any) -> httpx.Response:
        """Any request; the whole path."""
        return self.http.request(method, path, **arguments)

    def get(self, path: str, **parameters: Any) -> httpx.Response:
        """GET below the prefix."""
        return self.ask("GET", PREFIX + path, params=parameters or None)

    def value(self, path: str, **parameters: Any) -> Any:
        """Return what a GET answers that must succeed with strict JSON."""
        return value(self.get(path, **parameters))

    def __call__(self, method: str, path: str, status: int = 200, **arguments: Any) -> Any:
        """Return what any request below the prefix answers, with that status."""
        return value(self.ask(method, PREFIX + path, **arguments), status)


def value(answer: httpx.Response, status: int = 200) -> Any:
    """Return what an answer holds that must be strict JSON of this status."""
    assert answer.status_code == status, answer.text
    return json.loads(answer.text, parse_constant=_not_json)


def problem(answer: httpx.Response, status: int) -> dict[str, Any]:
    """The problem detail that an error must be."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    body: dict[str, Any] = answer.json()
    assert body.keys() == PROBLEM
    assert body["status"] == status
    assert body["title"]
    assert body["detail"]
    return body


def refused(answer: httpx.Response, status: int) -> str:
    """The detail of the problem that an error must be."""
    return str(problem(answer, status)["detail"])


def fields(answer: httpx.Response) -> list[str]:
    """The fields that a 422 names."""
    found = problem(answer, 422)["errors"]
    assert all(one["message"] for one in found)
    return [one["field"] for one in found]


def _not_json(name: str) -> None:
    raise AssertionError(f"{name} is not JSON")
