"""No view has a fault that axe-core finds: on a screen by day and by night, and on a phone."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from tests.browser.conftest import Seen
from tests.browser.views import VIEWS, show

TRANSITION_MS = 300
"""Colours that are still changing have no contrast yet."""


def faults(page: Page, view: str) -> list[str]:
    """Return what axe-core finds in the page as it is."""
    page.wait_for_timeout(TRANSITION_MS)
    found = Axe().run(page).response["violations"]
    return [f"{view}: {one['id']}: {node['target']} {node['failureSummary']}" for one in found for node in one["nodes"][:3]]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_on_a_screen(seen: Seen, scheme: str) -> None:
    seen.page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    found = []
    for view in VIEWS:
        show(seen.page, seen.base, view)
        found += faults(seen.page, f"{view}, {scheme}")
    assert found == []


def test_on_a_phone(phone: Seen) -> None:
    found = []
    for view in VIEWS:
        show(phone.page, phone.base, view)
        found += faults(phone.page, f"{view}, phone")
    assert found == []


def test_in_dialogs(seen: Seen) -> None:
    show(seen.page, seen.base, "alert")
    found = []
    for name in ("Acknowledge", "Instruct the crew", "Shelve"):
        seen.page.locator(".alert-row").get_by_role("button", name=name).click()
        found += faults(seen.page, f"dialog {name}")
        seen.page.keyboard.press("Escape")
    assert found == []
