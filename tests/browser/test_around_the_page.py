"""Finding one's way: windows of all sizes, keys, addresses that lead nowhere."""

import time

import pytest
from playwright.sync_api import Locator, Route, expect

from tests.browser.conftest import Seen
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import until

SHIFT = 0.1
"""Cumulative layout shift that people do not mind, by web.dev's measure."""


@pytest.mark.parametrize(("width", "height", "scheme"), [(390, 844, "light"), (1440, 900, "dark")])
def test_nothing_is_wider_than_the_window(seen: Seen, width: int, height: int, scheme: str) -> None:
    seen.page.set_viewport_size({"width": width, "height": height})
    seen.page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    for place, sign in {
        f"reports/{MACHINE}": ".elements table",
        "": "table.fleet",
        f"machines/{MACHINE}": ".element",
        f"machines/{MACHINE}/trends": ".plot canvas",
        f"machines/{MACHINE}/response": ".polar svg",
        f"machines/{MACHINE}/shapes": ".shapes svg",
        f"machines/{MACHINE}/model": "table",
        f"machines/{MACHINE}/identified": ".correlation svg",
        f"machines/{MACHINE}/settings": "table.limits",
        "subscriptions": ".panel",
    }.items():
        seen.open(place)
        expect(seen.page.locator(sign).first).to_be_attached()
        expect(seen.page.locator(".loading")).to_have_count(0)
        assert seen.page.evaluate("document.documentElement.scrollWidth") <= width, place
        seen.picture(f"{scheme}-{width}-{place.replace('/', '-') or 'fleet'}")
    assert seen.page.evaluate("document.documentElement.dataset.theme") == scheme
    assert seen.errors == []


def test_on_a_phone_what_stands_out_is_in_sight(seen: Seen) -> None:
    width = 390
    seen.page.set_viewport_size({"width": width, "height": 844})
    seen.open(f"machines/{MACHINE}")
    coupling = seen.page.locator(".element.danger, .element.alert").first
    expect(coupling).to_be_attached()
    until(lambda: abs(middle(coupling) - width / 2) < width / 4, within_s=10, what="the coupling is in the middle")


def middle(element: Locator) -> float:
    """Return the middle of an element across the window [px]."""
    box = element.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2


def test_an_address_that_was_cut_off_still_leads_somewhere(seen: Seen) -> None:
    seen.open("machines/%E0%A4%A")
    expect(seen.page.get_by_role("alert")).to_be_visible()
    seen.page.get_by_role("link", name="To the fleet").click()
    expect(seen.page.locator("table.fleet")).to_be_visible()


def test_keys_alone_lead_through_the_page(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".element").first).to_be_visible()
    seen.page.keyboard.press("2")
    expect(seen.page.get_by_role("link", name="Vibration")).to_have_attribute("aria-current", "page")
    seen.page.keyboard.press("d")
    expect(seen.page.locator("html")).to_have_attribute("data-theme", "dark")
    seen.page.keyboard.press("?")
    expect(seen.page.get_by_role("dialog", name="Keyboard shortcuts")).to_be_visible()
    seen.page.keyboard.press("Escape")
    expect(seen.page.get_by_role("dialog")).to_have_count(0)
    seen.page.keyboard.press("f")
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Fleet")
    assert seen.errors == []


def _late(route: Route) -> None:
    time.sleep(0.05)
    route.continue_()


def test_what_comes_late_moves_nothing(seen: Seen) -> None:
    watch = "new PerformanceObserver((list) => { for (const one of list.getEntries()) window.moved += one.value; })"
    seen.page.add_init_script(f"window.moved = 0; {watch}.observe({{ type: 'layout-shift', buffered: true }});")
    seen.page.route("**/api/v1/**", _late)
    for place in ("", f"machines/{MACHINE}", f"machines/{MACHINE}/trends", f"machines/{MACHINE}/response"):
        seen.open(place)
        seen.page.reload()
        expect(seen.page.locator(".loading")).to_have_count(0)
        assert seen.page.evaluate("window.moved") < SHIFT, place


def test_a_name_that_no_machine_may_have_is_said_to_be_unknown(seen: Seen) -> None:
    for place in ("machines/%00", "reports/%00"):
        seen.open(place)
        expect(seen.page.get_by_role("alert")).to_have_text("There is no machine “%00”.")
    assert seen.errors == []


def test_an_unknown_machine_is_said_to_be_unknown(seen: Seen) -> None:
    seen.open("machines/no-such-machine")
    expect(seen.page.get_by_role("alert")).to_have_text("There is no machine “no-such-machine”.")
