"""Every route that there is, asked by everybody there may be: made from the application itself, so that none escapes."""

from collections.abc import Iterator
from typing import Any

import httpx
import pytest
from fastapi import APIRouter, FastAPI

from service.api.application import ROWS
from service.security.operations import ApiOperation, Operations, Undeclared
from service.security.requirement import ANYBODY, VIEWER, Requirement
from service.security.role import Role
from service.security.scope import FREE
from tests.api_in_process import Api, InProcess, problem
from tests.service.security.conftest import Filled, bearer
from tests.service.security.forged import KINDS, refused
from tests.service.security.issuer import Issuer
from tests.service.security.two_plants import Ids, leaks

FOR_ANYBODY = {
    "/",
    "/assets/{name}",
    "/icon.svg",
    "/login",
    "/login.css",
    "/login/issuer",
    "/login/callback",
    "/logout",
    "/api/v1/openapi.json",
    "/api/v1/docs",
    "/api/v1/docs/static",
    "/api/v1/alive",
    "/api/v1/health",
    "/api/v1/ready",
}
"""All that is open without credentials; a route that is added to it is seen in review."""
ENDLESS = {"stream_alert_events"}
"""Answers that never end; test_plant_scope reads them."""


def operations(api: Api) -> Iterator[tuple[ApiOperation, str]]:
    """Every route with each of its methods."""
    for one in api.app.state.operations:
        for method in sorted(one.methods):
            yield one, method


def path(one: ApiOperation, ids: Ids) -> str:
    return ids.path(one.path) + ("/swagger-ui.css" if one.path.endswith("/docs/static") else "")


def foreign_queries(api: Api, one: ApiOperation, method: str, ids: Ids) -> dict[str, Any]:
    """Query parameters that name something of another plant, wherever an operation takes some."""
    described = api.app.openapi()["paths"].get(one.path, {}).get(method.lower(), {})
    values = {
        "first": ids.identification_id,
        "second": ids.identification_id,
        "identification": ids.identification_id,
        "run": ids.run_id,
        "machine": ids.machine_id,
        "parameter": "coupling.C1.kxx",
        "after": 0,
    }
    named = {each["name"]: each for each in described.get("parameters", []) if each["in"] == "query"}
    assert {name for name, each in named.items() if each.get("required")} <= values.keys() | {"plane", "rpm"}, one.path
    return {name: values[name] for name in named if name in values and name != "after"}


def test_what_is_open_to_anybody_is_what_is_listed(shared: Api) -> None:
    open_to_anybody = {one.path for one, _ in operations(shared) if one.requirement.role is None}
    assert open_to_anybody == FOR_ANYBODY


@pytest.mark.parametrize("credentials", KINDS)
def test_who_is_not_known_gets_nothing(shared: Api, issuer: Issuer, filled: Filled, credentials: str) -> None:
    headers = refused(issuer, filled.keys)[credentials]
    asked = 0
    for one, method in operations(shared):
        answer = shared.ask(method, path(one, filled.hidden), headers=headers)
        assert not leaks(answer.text), f"{method} {one.path}"
        if one.requirement.role is not None:
            asked += 1
            assert problem(answer, 401)["detail"].endswith("or log in at /login"), f"{method} {one.path}"
            assert answer.headers["www-authenticate"].startswith("Bearer")
    assert asked > 60


@pytest.mark.parametrize("role", [*Role, None])
@pytest.mark.parametrize("way", ["key", "token"])
def test_each_role_gets_what_it_may_have(shared: Api, issuer: Issuer, filled: Filled, role: Role | None, way: str) -> None:
    if way == "key" and role is None:
        pytest.skip("a key always has a role")
    label = "" if role is None else role.label
    headers = bearer(filled.keys[label] if way == "key" else issuer.token(rundown_role=label, key="e1"))
    allowed: set[str] = set()
    refused: set[str] = set()
    for one, method in operations(shared):
        if one.requirement.role is None or (one.name in ENDLESS and role not in (None, Role.SOURCE)):
            continue
        answer = shared.ask(method, path(one, filled.own), headers=headers)
        may = role is not None and (role >= one.requirement.role or (one.requirement.sources and role is Role.SOURCE))
        assert (answer.status_code not in (401, 403)) == may, f"{method} {one.path}: {answer.status_code} {answer.text}"
        assert answer.status_code < 500 or one.name in ("add_samples",), f"{method} {one.path}: {answer.text}"
        if not may:
            problem(answer, 403)
        (allowed if may else refused).add(one.name)
    assert (role is Role.ADMIN) == (not refused)
    assert role is None or allowed


def test_another_plant_is_not_there(api: Api, filled: Filled) -> None:
    """By id nothing is found, in lists it does not stand, and what is answered is the same as for what there is not."""
    nothing = Ids("no-such-9", *[999_999] * 9)
    headers = bearer(filled.keys["own"])
    looked = 0
    for one, method in operations(api):
        if one.name in ENDLESS or one.requirement.role is None:
            continue
        mine = api.ask(method, path(one, filled.own), headers=headers, json=None)
        assert not leaks(mine.text), f"{method} {one.path}: {mine.text[:500]}"
        assert mine.status_code < 500 or one.name == "add_samples", f"{method} {one.path}: {mine.text}"
        if one.requirement.every_plant:
            problem(mine, 403)
            continue
        query = foreign_queries(api, one, method, filled.hidden)
        with_query = api.ask(method, path(one, filled.own), headers=headers, params=query)
        assert not leaks(with_query.text, but=tuple(map(str, query.values()))), f"{method} {one.path} {query}"
        if not one.scoped:
            continue
        looked += 1
        theirs = api.ask(method, path(one, filled.hidden), headers=headers)
        missing = api.ask(method, path(one, nothing), headers=headers)
        assert problem(theirs, 404)["title"] == "Not Found", f"{method} {one.path}"
        assert told(theirs.text, filled.hidden) == told(missing.text, nothing), f"{method} {one.path}"
    assert looked > 50


def test_who_may_see_the_other_plant_finds_it_by_the_same_paths(api: Api, filled: Filled) -> None:
    """Without this the test before could pass because nothing is there."""
    headers = bearer(filled.keys["hidden"])
    found = 0
    for one, method in operations(api):
        if method == "GET" and one.scoped:
            answer = api.ask(method, path(one, filled.hidden), headers=headers)
            assert answer.status_code in (200, 409, 422), f"{one.path}: {answer.text}"
            found += leaks(answer.text)
    assert found > 15


def told(text: str, ids: Ids) -> str:
    """An answer without the ids that were asked for."""
    for value in sorted(map(str, vars(ids).values()), key=len, reverse=True):
        text = text.replace(f" {value}", " …")
    return text


def test_a_route_that_says_nothing_keeps_the_application_from_starting() -> None:
    def built(*dependencies: Any, path: str = "/new", method: str = "GET") -> Operations:
        app = FastAPI(openapi_url=None)
        router = APIRouter(dependencies=list(dependencies))
        router.add_api_route(path, lambda: None, methods=[method])
        app.include_router(router)
        return Operations(app, public={}, scoped=frozenset(ROWS), free=FREE)

    assert len(list(built(VIEWER))) == 1
    assert len(list(built(ANYBODY))) == 1
    with pytest.raises(Undeclared, match="/new does not say which role"):
        built()
    with pytest.raises(Undeclared, match="viewers change nothing"):
        built(VIEWER, method="POST")
    with pytest.raises(Undeclared, match="bearing_id"):
        built(VIEWER, path="/bearings/{bearing_id}")


def test_without_a_guard_a_requirement_opens_nothing() -> None:
    app = FastAPI()
    app.add_api_route("/", lambda: "secret", dependencies=[VIEWER])
    with httpx.Client(transport=InProcess(app), base_url="http://rundown") as client:
        assert client.get("/").status_code == 403


def test_requirements_have_words() -> None:
    assert Requirement(Role.OPERATOR, sources=True).words == "the role operator or source"
    assert Requirement(Role.ADMIN, every_plant=True).words == "the role admin for all plants"
