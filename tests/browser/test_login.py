"""Logging in, changing something and logging out in a real browser, under the page's own content security policy."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect
from sqlalchemy import func, select

from benchmarks.serving import serving
from service.api.application import application
from service.security import api_keys
from service.security.configuration import Security
from service.security.key_set import KeySet
from service.security.open_id import OpenId
from service.security.role import Role
from service.security.tokens import Claims, Tokens
from storage.database.engine import Database
from storage.operation import audit
from storage.tables.base import Base
from tests.browser.conftest import PATIENCE_MS
from tests.plant import KEY, sqlite_url
from tests.ports import free_port
from tests.service.security.issuer import AUDIENCE, CLIENT, Issuer
from tests.service.security.two_plants import HIDDEN, fill


@dataclass(frozen=True)
class KeyedService:
    """A service with keys and an issuer."""

    url: str
    database: Database
    key: str
    issuer: Issuer


@pytest.fixture(scope="module")
def secured(tmp_path_factory: pytest.TempPathFactory) -> Iterator[KeyedService]:
    """A service over two plants; the key is an operator's of the first."""
    path = tmp_path_factory.mktemp("secured") / "rundown.db"
    database = Database(sqlite_url(path))
    fill(database)
    with database.transaction() as session:
        _, key = api_keys.create(session, name="Olga", role=Role.OPERATOR, plants=[KEY.plant], days=1)
    port = free_port()
    base = f"http://127.0.0.1:{port}"
    with Issuer() as issuer:
        open_id = OpenId(issuer=issuer.url, client_id=CLIENT, client_secret="", scope="openid", public_url=base)
        tokens = Tokens(issuer=issuer.url, audience=AUDIENCE, keys=KeySet(open_id.keys_url), claims=Claims())
        app = application(database, dict, security=Security(tokens=tokens, open_id=open_id))
        with serving(app, port=port):
            yield KeyedService(base, database, key, issuer)
    database.close()


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    """A window of its own, with its own cookies."""
    one = browser.new_context(viewport={"width": 1200, "height": 800})
    one.set_default_timeout(PATIENCE_MS)
    yield one
    one.close()


def watched(context: BrowserContext) -> tuple[Page, list[str]]:
    """A page, and what the browser complains of; that somebody is not logged in is no complaint."""
    page, complaints = context.new_page(), list[str]()
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" and "401" not in said.text else None)
    return page, complaints


def test_one_logs_in_with_a_key_changes_something_and_logs_out(context: BrowserContext, secured: KeyedService) -> None:
    page, complaints = watched(context)
    page.goto(f"{secured.url}/#/alerts")
    expect(page).to_have_url(f"{secured.url}/login")
    page.get_by_label("API key").fill("rundown_00000000_wrong")
    page.get_by_role("button", name="Log in").click()
    expect(page.get_by_role("alert")).to_contain_text("Not logged in")
    page.get_by_label("API key").fill(secured.key)
    page.get_by_role("button", name="Log in").click()
    expect(page.get_by_text("Olga (operator)")).to_be_visible()
    expect(page).to_have_url(f"{secured.url}/#/alerts")
    expect(page.locator("main")).to_contain_text("Misalignment of coupling C1")
    for word in ("orchard", HIDDEN):
        expect(page.locator("body")).not_to_contain_text(word)
    page.get_by_role("button", name="Acknowledge").first.click()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_label("Your name")).to_have_value("Olga")
    dialog.get_by_label("Your name").fill("Somebody Else")
    dialog.get_by_role("button", name="Acknowledge").click()
    expect(dialog).to_have_count(0)
    with secured.database.reading() as session:
        newest = audit.newest(session, limit=1)[0]
    assert newest.operation == "acknowledge_alert"
    assert newest.who.startswith("Olga (session of key ")
    (cookie,) = context.cookies()
    assert (cookie["name"], cookie["httpOnly"], cookie["sameSite"]) == ("rundown_session", True, "Strict")
    page.get_by_role("button", name="Log out").click()
    expect(page).to_have_url(f"{secured.url}/login")
    page.goto(f"{secured.url}/")
    expect(page).to_have_url(f"{secured.url}/login")
    assert complaints == []


def test_one_logs_in_at_the_issuer(context: BrowserContext, secured: KeyedService) -> None:
    page, complaints = watched(context)
    secured.issuer.claims = {"sub": "berta", "name": "Berta", "rundown_role": "viewer", "rundown_plants": "*"}
    page.goto(f"{secured.url}/login")
    page.get_by_role("link", name="Log in with your organisation").click()
    expect(page.get_by_text("Berta (berta) (viewer)")).to_be_visible()
    expect(page.locator("main")).to_contain_text(HIDDEN)
    assert [one["name"] for one in context.cookies()] == ["rundown_session"]
    assert complaints == []


def test_the_documentation_page_works_under_its_policy(context: BrowserContext, secured: KeyedService, tmp_path: Path) -> None:
    page, complaints = watched(context)
    page.goto(f"{secured.url}/api/v1/docs")
    expect(page.get_by_role("heading", name="Rundown")).to_be_visible()
    expect(page.locator(".opblock").first).to_be_visible()
    page.screenshot(path=tmp_path / "docs.png")
    assert complaints == []


def test_a_viewer_who_presses_every_button_is_told_why_and_changes_nothing(
    context: BrowserContext, secured: KeyedService
) -> None:
    with secured.database.transaction() as session:
        _, key = api_keys.create(session, name="Vera", role=Role.VIEWER, plants=[KEY.plant], days=1)
    page, _ = watched(context)
    page.goto(f"{secured.url}/login")
    page.get_by_label("API key").fill(key)
    page.get_by_role("button", name="Log in").click()
    expect(page.get_by_text("Vera (viewer)")).to_be_visible()
    before = rows(secured.database)
    changes: list[int] = []
    page.on(
        "response",
        lambda answer: changes.append(answer.status) if answer.request.method in ("POST", "PUT", "DELETE") else None,
    )
    pressed = [f"{view}: {button}" for view in VIEWS_WITH_BUTTONS for button in pressed_buttons(page, secured.url, view)]
    assert len(pressed) >= 10, pressed
    assert changes, "nothing was sent: no button was pressed that would change something"
    assert set(changes) == {403}, changes
    assert rows(secured.database) == before


VIEWS_WITH_BUTTONS = (
    "alerts",
    "subscriptions",
    f"machines/{KEY.machine}",
    *(f"machines/{KEY.machine}/{tab}" for tab in ("settings", "balancing")),
)
GIVEN = {"date": "2030-01-01", "datetime-local": "2030-01-01T12:00", "number": "1"}
"""Text for a field that must not stay empty, by its type; `x` for others."""


def pressed_buttons(page: Page, base: str, view: str) -> Iterator[str]:
    """Press each button of a view once, with its form filled in; each answer stands in the form or on the page."""
    done: set[str] = set()
    while True:
        page.goto(f"{base}/")
        page.goto(f"{base}/#/{view}")
        expect(page.locator("main .panel, main .alert-row").first).to_be_visible()
        expect(page.locator(".loading")).to_have_count(0)
        for folded in page.locator("main details:not([open]) > summary").all():
            folded.click()
        texts = [one.strip() for one in page.locator("main button:visible:enabled").all_inner_texts()]
        left = [at for at, text in enumerate(texts) if text not in done]
        if not left:
            return
        done.add(texts[left[0]])
        page.locator("main button:visible:enabled").nth(left[0]).click()
        dialog = page.get_by_role("dialog")
        if dialog.count():
            for field in dialog.locator("input[required], textarea[required]").all():
                if field.input_value() == "":
                    field.fill(GIVEN.get(field.get_attribute("type") or "", "x"))
            dialog.locator("button[type=submit]").click()
            expect(dialog.get_by_role("alert")).to_contain_text("viewer")
        yield texts[left[0]]


def rows(database: Database) -> dict[str, int]:
    """Return the number of rows of each table, without who has logged in and what was tried."""
    with database.reading() as session:
        tables = [
            one for one in Base.metadata.sorted_tables if one.name not in ("audit", "browser_sessions", "logins", "api_keys")
        ]
        return {one.name: session.scalar(select(func.count()).select_from(one)) or 0 for one in tables}
