"""Every view of the page, and what is on it once it is there."""

from collections.abc import Mapping

from playwright.sync_api import Page, expect

from tests.browser.shown_service import MACHINE

VIEWS = {
    "fleet": ("", "table.fleet"),
    "wall": ("wall", ".tile"),
    "alerts": ("alerts", ".alert-row"),
    "alert": ("alerts/1", ".polar svg"),
    "notifications": ("subscriptions", ".panel"),
    "overview": (f"machines/{MACHINE}", ".element"),
    "vibration": (f"machines/{MACHINE}/vibration", ".polar svg"),
    "trends": (f"machines/{MACHINE}/trends", ".plot canvas"),
    "response": (f"machines/{MACHINE}/response", ".polar svg"),
    "shapes": (f"machines/{MACHINE}/shapes", ".modes svg"),
    "model": (f"machines/{MACHINE}/model", "table"),
    "balancing": (f"machines/{MACHINE}/balancing", ".panel"),
    "parameters": (f"machines/{MACHINE}/identified", ".correlation svg"),
    "settings": (f"machines/{MACHINE}/settings", "table.limits"),
    "report": (f"reports/{MACHINE}", ".elements table"),
}
"""By name the place behind the #, and what shows that it is drawn."""


def show(page: Page, base: str, view: str, *, views: Mapping[str, tuple[str, str]] = VIEWS) -> None:
    """Open a view and wait until nothing of it is being loaded."""
    place, sign = views[view]
    page.goto(f"{base}/#/{place}")
    expect(page.locator(sign).first).to_be_attached()
    expect(page.locator(".loading")).to_have_count(0)
