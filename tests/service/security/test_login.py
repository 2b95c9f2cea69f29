"""Logging in over HTTP: what the cookie is like, what it opens, and what another site's page cannot do with it."""

import hashlib
from collections.abc import Iterator
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from sqlalchemy import select

from service.http.security_headers import NOTHING
from service.security import api_keys
from service.security.authentication import IDENTITY_CACHE_S
from service.security.configuration import Security
from service.security.login import PATIENCE_S
from service.security.open_id import LoginFailed, OpenId
from storage.clock import now
from storage.database.engine import Database
from storage.operation import audit, browser_sessions, logins
from storage.tables.operation import BrowserSessionRow
from tests.api_in_process import PREFIX, Api, problem, value
from tests.plant import KEY
from tests.service.security.conftest import PATIENT, Filled, bearer, opened_api, tokens
from tests.service.security.issuer import CLIENT, Issuer

ME = f"{PREFIX}/me"
NOTES = f"{PREFIX}/machines/{KEY.machine}/timeline"
NOTE = {"at": "2026-01-01T00:00:00Z", "text": "looked", "by": "x"}


@pytest.fixture
def api(store: Database, issuer: Issuer) -> Iterator[Api]:
    """The application with keys and an issuer at which one can log in."""
    open_id = OpenId(issuer=issuer.url, client_id=CLIENT, client_secret="", scope="openid", public_url="http://rundown")
    security = Security(tokens=tokens(issuer), open_id=open_id, requests=PATIENT, failures=(0.001, 3.0))
    one = opened_api(store, security)
    yield one
    one.http.close()


def logged_in(api: Api, key: str) -> str:
    """The session's token, after a login."""
    answer = api.ask("POST", "/login", data={"key": key})
    assert answer.status_code == 303, answer.text
    return str(value(api.ask("GET", ME))["token"])


def test_a_session_does_what_its_key_may(api: Api, filled: Filled) -> None:
    token = logged_in(api, filled.keys["own"])
    me = value(api.ask("GET", ME))
    assert (me["name"], me["role"], me["plants"], me["kind"]) == ("own admin", "admin", [KEY.plant], "session")
    noted = value(api.ask("POST", NOTES, json=NOTE, headers={"X-Rundown-Token": token}), 201)
    assert noted["by"] == "own admin"
    problem(api.ask("GET", f"{PREFIX}/machines/quince-9"), 404)


def test_the_cookie_is_read_by_no_script_and_sent_by_no_other_site(api: Api, filled: Filled) -> None:
    cookie = api.ask("POST", "/login", data={"key": filled.keys["viewer"]}).headers["set-cookie"]
    assert cookie.startswith("rundown_session=")
    assert {"HttpOnly", "SameSite=strict", "Path=/", "Max-Age=43200"} <= set(cookie.split("; "))
    secure = httpx.Client(transport=api.http._transport, base_url="https://rundown")
    cookie = secure.post("/login", data={"key": filled.keys["viewer"]}).headers["set-cookie"]
    assert cookie.startswith("__Host-rundown_session=")
    assert "Secure" in cookie.split("; ")


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"X-Rundown-Token": "guessed"},
        {"X-Rundown-Token": "right", "Origin": "https://evil.example"},
        {"X-Rundown-Token": "right", "Origin": "null"},
        {"X-Rundown-Token": "right", "Origin": "http://["},
        {"X-Rundown-Token": "right", "Sec-Fetch-Site": "cross-site"},
        {"X-Rundown-Token": "right", "Sec-Fetch-Site": "same-site"},
    ],
)
def test_another_sites_page_changes_nothing(api: Api, filled: Filled, headers: dict[str, str]) -> None:
    token = logged_in(api, filled.keys["operator"])
    sent = headers | ({"X-Rundown-Token": token} if headers.get("X-Rundown-Token") == "right" else {})
    problem(api.ask("POST", NOTES, json=NOTE, headers=sent), 403)
    own = {"X-Rundown-Token": token, "Origin": "http://rundown", "Sec-Fetch-Site": "same-origin"}
    value(api.ask("POST", NOTES, json=NOTE, headers=own), 201)


def test_where_nobody_needs_to_log_in_another_sites_page_changes_nothing_either(plant: Database) -> None:
    """On loopback, a page of the internet can make the browser ask."""
    api = opened_api(plant, Security())
    for headers in ({"Origin": "https://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        problem(api.ask("POST", NOTES, json=NOTE, headers=headers), 403)
    value(api.ask("POST", NOTES, json=NOTE), 201)
    value(api.ask("POST", NOTES, json=NOTE, headers={"Origin": "http://rundown"}), 201)
    api.http.close()


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("localhost:8080", 200),
        ("127.0.0.1:8080", 200),
        ("[::1]:8080", 200),
        ("plant.example", 200),
        ("evil.example", 421),
        ("[", 421),
    ],
)
def test_a_name_that_was_made_to_mean_this_machine_reads_nothing(plant: Database, host: str, status: int) -> None:
    """DNS rebinding: the page of another site asks under its own name."""
    api = opened_api(plant, Security(names_checked=True, public_url="https://plant.example"))
    assert api.ask("GET", f"{PREFIX}/machines", headers={"Host": host}).status_code == status
    api.http.close()


def test_over_tls_a_neighbours_cookie_logs_nobody_in(api: Api, filled: Filled) -> None:
    """Of another name of the same domain it may be, unless its name says that it is this host's."""
    logged_in(api, filled.keys["viewer"])
    cookie = dict(api.http.cookies)["rundown_session"]
    api.http.cookies.clear()
    api.http.base_url = "https://rundown"
    problem(api.ask("GET", ME, headers={"Cookie": f"rundown_session={cookie}"}), 401)
    both = {"Cookie": f"rundown_session=another; __Host-rundown_session={cookie}"}
    assert value(api.ask("GET", ME, headers=both))["role"] == "viewer"
    api.http.base_url = "http://rundown"
    problem(api.ask("GET", ME, headers={"Cookie": f"__Host-rundown_session={cookie}"}), 401)


def test_logging_out_ends_the_session_at_once(api: Api, filled: Filled) -> None:
    logged_in(api, filled.keys["viewer"])
    cookie = dict(api.http.cookies)
    assert api.ask("POST", "/logout", headers={"Origin": "http://rundown"}).status_code == 204
    assert not api.http.cookies
    problem(api.ask("GET", ME, headers={"Cookie": f"rundown_session={cookie['rundown_session']}"}), 401)


def test_a_session_ends_with_its_key(api: Api, filled: Filled) -> None:
    logged_in(api, filled.keys["viewer"])
    with api.database.transaction() as session:
        api_keys.revoke(session, filled.keys["viewer"].split("_")[1])
    authentication = api.app.state.authentication
    before = authentication._clock
    authentication._clock = lambda: before() + IDENTITY_CACHE_S + 0.1
    assert "no longer valid" in problem(api.ask("GET", ME), 401)["detail"]


def test_each_login_has_a_new_cookie(api: Api, filled: Filled) -> None:
    found = {api.ask("POST", "/login", data={"key": filled.keys["viewer"]}).headers["set-cookie"] for _ in range(3)}
    assert len(found) == 3


def test_wrong_keys_are_slowed_down_and_written_down(api: Api, filled: Filled) -> None:
    codes = [api.ask("POST", "/login", data={"key": "rundown_00000000_x"}).status_code for _ in range(5)]
    assert codes == [401, 401, 401, 429, 429]
    assert int(api.ask("POST", "/login", data={"key": "no"}).headers["retry-after"]) > 1
    assert api.ask("POST", "/login", data={"key": filled.keys["viewer"]}).status_code == 303
    with api.database.reading() as session:
        rows = audit.newest(session, limit=2)
    assert [(row.operation, row.outcome) for row in rows] == [("log_in", "done"), ("log_in", "refused")]


def test_of_somebodys_sessions_the_newest_go_on(api: Api, filled: Filled, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(browser_sessions, "MOST", 2)
    logged_in(api, filled.keys["analyst"])
    found = []
    for _ in range(3):
        logged_in(api, filled.keys["viewer"])
        found.append(api.http.cookies["rundown_session"])
    with api.database.reading() as session:
        assert [browser_sessions.find(session, api_keys.key_hash(one), at=now()) is not None for one in found] == [
            False,
            True,
            True,
        ]
        assert len(session.scalars(select(BrowserSessionRow)).all()) == 3


def test_a_sources_key_and_a_long_form_log_nobody_in(api: Api, filled: Filled) -> None:
    assert api.ask("POST", "/login", data={"key": filled.keys["source"]}).status_code == 403
    assert api.ask("POST", "/login", data={"key": "x" * 5000}).status_code == 413


# --- at the issuer --------------------------------------------------------------------------------------------------


def begun(api: Api) -> str:
    """Return where the issuer sends the browser."""
    away = api.ask("GET", "/login/issuer")
    assert away.status_code == 303
    asked = parse_qs(urlsplit(away.headers["location"]).query)
    assert asked["code_challenge_method"] == ["S256"]
    assert len(asked["state"][0]) == len(asked["nonce"][0]) == 43
    back = httpx.get(away.headers["location"], follow_redirects=False).headers["location"]
    assert back.startswith("http://rundown/login/callback?")
    return str(back)


def test_a_login_at_the_issuer_gives_its_role_and_plants(api: Api, issuer: Issuer) -> None:
    issuer.claims = {"sub": "berta", "name": "Berta", "rundown_role": "analyst", "rundown_plants": [KEY.plant]}
    back = begun(api)
    assert api.ask("GET", back).status_code == 303
    me = value(api.ask("GET", ME))
    assert (me["name"], me["role"], me["plants"]) == ("Berta (berta)", "analyst", [KEY.plant])
    api.http.cookies.clear()
    assert api.ask("GET", back).status_code == 401  # a code is good once


def test_a_name_at_the_issuer_may_be_of_any_length_and_hold_anything(api: Api, issuer: Issuer) -> None:
    issuer.claims = {"sub": "berta", "name": "B\x00" * 100, "rundown_role": "viewer", "rundown_plants": "*"}
    assert api.ask("GET", begun(api)).status_code == 303
    name = value(api.ask("GET", ME))["name"]
    assert (len(name), name[:10], name[-8:]) == (120, "B\\x00B\\x00", " (berta)")


@pytest.mark.parametrize(
    ("claims", "shown"),
    [
        ({"sub": "mallory", "name": "root"}, "root (mallory)"),
        ({"sub": "mallory", "name": "own admin"}, "own admin (mallory)"),
        ({"sub": "mallory", "name": "\u202e(toor"}, "\\u202e(toor (mallory)"),
        ({"sub": "root", "name": None, "preferred_username": None}, "root (root)"),
        ({"sub": "m" * 200, "name": "root"}, f"root ({'m' * 47}…{hashlib.sha256(b'm' * 200).hexdigest()[:16]})"),
    ],
)
def test_a_name_from_the_issuer_never_stands_alone(api: Api, issuer: Issuer, claims: dict[str, Any], shown: str) -> None:
    issuer.claims = claims | {"rundown_role": "analyst", "rundown_plants": "*"}
    assert api.ask("GET", begun(api)).status_code == 303
    me = value(api.ask("GET", ME))
    token = {"X-Rundown-Token": me["token"]}
    by_session = value(api.ask("POST", NOTES, json=NOTE, headers=token), 201)["by"]
    api.http.cookies.clear()
    by_token = value(api.ask("POST", NOTES, json=NOTE, headers=bearer(issuer.token(**issuer.claims))), 201)["by"]
    assert [me["name"], by_session, by_token] == [shown] * 3
    with api.database.reading() as session:
        rows = audit.newest(session, limit=2)
        assert [row.who for row in rows] == [f"{shown} (token {claims['sub']})"[:200], f"session of {shown}"]


def test_a_login_comes_to_its_end_at_another_replica(api: Api, store: Database, issuer: Issuer) -> None:
    issuer.claims = {"sub": "berta", "name": "Berta", "rundown_role": "viewer", "rundown_plants": "*"}
    back = begun(api)
    open_id = OpenId(issuer=issuer.url, client_id=CLIENT, client_secret="", scope="openid", public_url="http://rundown")
    other = opened_api(store, Security(tokens=tokens(issuer), open_id=open_id, requests=PATIENT))
    other.http.cookies.update(api.http.cookies)
    assert other.ask("GET", back).status_code == 303
    assert value(other.ask("GET", ME))["name"] == "Berta (berta)"
    other.http.close()


def test_a_login_takes_no_longer_than_its_time(api: Api, issuer: Issuer, monkeypatch: pytest.MonkeyPatch) -> None:
    issuer.claims = {"sub": "berta", "name": "Berta", "rundown_role": "viewer", "rundown_plants": "*"}
    back = begun(api)
    late = now() + (PATIENCE_S + 1) * 1_000_000_000
    monkeypatch.setattr("service.security.login.now", lambda: late)
    assert "too long ago" in api.ask("GET", back).text


def test_of_logins_that_nobody_ends_so_many_are_kept(store: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(logins, "MOST", 3)
    for number in range(5):
        with store.transaction() as session:
            logins.begin(
                session,
                state_hash=f"s{number}",
                browser_hash="b",
                verifier="v",
                nonce="n",
                expires_at=now() + 10**9 * (60 + number),
            )
    with store.transaction() as session:
        taken = [number for number in range(5) if logins.pop(session, f"s{number}", at=now()) is not None]
        assert taken == [2, 3, 4]
        assert all(logins.pop(session, f"s{number}", at=now()) is None for number in range(5))


def test_a_login_that_another_browser_began_is_not_taken(api: Api, issuer: Issuer) -> None:
    """Or somebody could be made to work under another's name."""
    issuer.claims = {"sub": "mallory", "name": "Mallory", "rundown_role": "admin", "rundown_plants": "*"}
    back = begun(api)
    api.http.cookies.clear()
    assert api.ask("GET", back).status_code == 401
    assert "set-cookie" not in api.ask("GET", "/login/callback?code=x&state=y").headers


def test_who_has_no_role_at_the_issuer_is_told_so(api: Api, issuer: Issuer) -> None:
    issuer.claims = {"sub": "carl", "name": "Carl", "rundown_role": None, "rundown_plants": "*"}
    answer = api.ask("GET", begun(api))
    assert answer.status_code == 403
    assert "Carl (carl) has no role here" in answer.text


@pytest.mark.parametrize("changes", [{"nonce": "another"}, {"aud": "another"}, {"exp": 1}])
def test_an_id_token_of_another_login_is_not_taken(api: Api, issuer: Issuer, changes: dict[str, object]) -> None:
    issuer.claims = {"sub": "carl", "name": "Carl", "rundown_role": "admin", "rundown_plants": "*"}
    exchanged = issuer.exchanged

    def forged(form: dict[str, str]) -> dict[str, object]:
        assert "id_token" in exchanged(form)
        claims: dict[str, Any] = {"aud": CLIENT, "rundown_role": "admin"}
        return {"id_token": issuer.token(**(claims | changes))}

    issuer.exchanged = forged  # type: ignore[method-assign]
    try:
        assert api.ask("GET", begun(api)).status_code == 401
    finally:
        issuer.exchanged = exchanged  # type: ignore[method-assign]


def test_an_issuer_that_calls_itself_otherwise_is_not_believed(issuer: Issuer) -> None:
    other = OpenId(issuer=issuer.url + "/", client_id=CLIENT, client_secret="", scope="openid", public_url="http://rundown")
    with pytest.raises(LoginFailed, match="calls itself"):
        other.begin()


# --- headers of every answer ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["/", "/login", "/nothing", ME, "/metrics", f"{PREFIX}/docs", f"{PREFIX}/openapi.json"])
def test_every_answer_says_what_browsers_may_do_with_it(api: Api, filled: Filled, path: str) -> None:
    for headers in ({}, bearer(filled.keys["viewer"])):
        found = api.ask("GET", path, headers=headers).headers
        assert found["x-content-type-options"] == "nosniff"
        assert found["referrer-policy"] in ("no-referrer", "same-origin")
        assert "frame-ancestors 'none'" in found["content-security-policy"]
        assert "unsafe-inline" not in found["content-security-policy"]
        assert found["cross-origin-opener-policy"] == "same-origin"
        assert "strict-transport-security" not in found
    assert api.ask("GET", ME).headers["content-security-policy"] == NOTHING
    assert api.ask("GET", ME).headers["cache-control"] == "no-store"


def test_an_unexpected_error_has_them_as_well(api: Api, filled: Filled) -> None:
    api.parts = None  # type: ignore[assignment]
    answer = api.ask("GET", f"{PREFIX}/health/stages", headers=bearer(filled.keys["viewer"]))
    assert answer.status_code == 500
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_over_tls_browsers_are_told_to_stay_there(api: Api) -> None:
    secure = httpx.Client(transport=api.http._transport, base_url="https://rundown")
    assert secure.get("/login").headers["strict-transport-security"] == "max-age=31536000"


# --- where answers lead to ------------------------------------------------------------------------------------------

EVIL = {"Host": "evil.example"}


@pytest.mark.parametrize("path", [f"{PREFIX}/machines/", f"{NOTES}/", "/login/", "/login/issuer/", "//evil.example/"])
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_no_answer_leads_to_what_the_host_header_says(api: Api, filled: Filled, path: str, method: str) -> None:
    answer = api.http.request(method, f"http://rundown{path}", headers=EVIL | bearer(filled.keys["admin"]))
    assert answer.status_code in (404, 405)
    assert "evil" not in answer.headers.get("location", "")


def test_neither_a_login_nor_a_list_leads_to_what_the_host_header_says(api: Api, filled: Filled) -> None:
    away = parse_qs(urlsplit(api.ask("GET", "/login/issuer", headers=EVIL).headers["location"]).query)
    assert away["redirect_uri"] == ["http://rundown/login/callback"]
    assert api.ask("POST", "/login", headers=EVIL, data={"key": filled.keys["viewer"]}).headers["location"] == "/"
    part = api.ask("GET", f"{PREFIX}/machines?limit=1", headers=EVIL | bearer(filled.keys["admin"]))
    assert part.headers["link"].startswith(f"<{PREFIX}/machines?")


@pytest.mark.parametrize("first", ["admin", "viewer", "revoked"])
def test_who_asks_is_said_once(api: Api, filled: Filled, first: str) -> None:
    both = [("Authorization", f"Bearer {filled.keys[one]}") for one in (first, "admin")]
    asked = api.http.build_request("GET", f"http://rundown{ME}", headers=httpx.Headers(both))
    assert "one Authorization header" in problem(api.http.send(asked), 400)["detail"]


def test_the_login_page_is_in_the_language_of_who_logs_in(api: Api, filled: Filled) -> None:
    german, chosen = {"Accept-Language": "de-DE,de;q=0.9,en;q=0.5"}, {"Accept-Language": "en"}
    page = api.ask("GET", "/login", headers=german)
    assert '<html lang="de">' in page.text
    assert "Anmelden" in page.text
    assert "Mit der eigenen Organisation anmelden" in page.text
    assert page.headers["vary"] == "Accept-Language"
    refused = api.ask("POST", "/login", data={"key": "rundown_00000000_wrong"}, headers=german)
    assert refused.status_code == 401
    assert "Nicht angemeldet: dieser API-Schlüssel ist nicht bekannt, abgelaufen oder widerrufen" in refused.text
    assert 'action="/login"' in refused.text
    # The language that was chosen on the page goes before that of the browser, and stays for the next try.
    said = api.ask("POST", "/login?locale=de", data={"key": filled.keys["source"]}, headers=chosen)
    assert "Dieser Schlüssel dient nur zum Senden von Messwerten." in said.text
    assert 'action="/login?locale=de"' in said.text
    assert '<html lang="en">' in api.ask("GET", "/login?locale=xx", headers=chosen).text
