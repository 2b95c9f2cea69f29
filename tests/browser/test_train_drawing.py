"""The drawing of the train on a machine's page, in a real browser: its marks, and how its elements are chosen."""

import re

import pytest
from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service


def test_train_is_drawn_to_scale_and_the_coupling_stands_out(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    coupling = seen.page.locator("[data-element='coupling.C1']")
    expect(coupling).to_have_class(re.compile("alert|danger"))
    expect(coupling).to_contain_text(re.compile("▲|◆"))  # not by colour alone
    middle = {}
    for element in ("bearing.B1", "bearing.B2", "bearing.B4"):
        box = seen.page.locator(f"[data-element='{element}'] path").bounding_box()
        assert box is not None
        middle[element] = box["x"] + box["width"] / 2
    at = {one["element"]: one["at"] for one in service.get(f"/machines/{MACHINE}/drawing")["bearings"]}
    drawn_ratio = (middle["bearing.B2"] - middle["bearing.B1"]) / (middle["bearing.B4"] - middle["bearing.B1"])
    true_ratio = (at["bearing.B2"] - at["bearing.B1"]) / (at["bearing.B4"] - at["bearing.B1"])
    assert drawn_ratio == pytest.approx(true_ratio, abs=0.005)
    assert seen.errors == []


def test_an_alert_is_marked_where_it_was_raised(seen: Seen, service: Service) -> None:
    """Runs that still say so come afterwards."""
    alerts = [one for one in service.get(f"/machines/{MACHINE}/alerts") if one["element"] == "coupling.C1"]
    assert alerts
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    marks = seen.page.locator(".timeline li", has_text="measured").locator("time")
    expect(marks).not_to_have_count(0)
    shown = {str(one.get_attribute("datetime"))[:19] for one in marks.all()}
    assert {one["first_measured_at"][:19] for one in alerts} <= shown


@pytest.mark.parametrize(("severities", "mark"), [(["alert"], "▲"), (["danger"], "◆"), (["alert", "danger"], "◆")])
def test_an_element_is_marked_by_the_worst_of_its_alerts(
    seen: Seen, service: Service, severities: list[str], mark: str
) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    answer = [{**alert, "id": 1000 + number, "severity": severity} for number, severity in enumerate(severities)]
    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=200"), lambda route: route.fulfill(json=answer))
    seen.open(f"machines/{MACHINE}/trends")
    buttons = seen.page.get_by_role("group", name="Element").get_by_role("button")
    marked = buttons.filter(has=seen.page.locator(".severity"))
    expect(marked).to_have_count(1)
    expect(marked).to_have_text(re.compile(rf"^{mark} {severities[-1]} .*C1"))
    assert seen.errors == []


def test_an_element_of_the_train_is_chosen_by_keys(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}")
    coupling = seen.page.get_by_role("button", name=re.compile("^coupling C1"))
    coupling.focus()
    expect(coupling).to_be_focused()
    seen.page.keyboard.press("Enter")
    expect(seen.page).to_have_url(re.compile("/trends.*coupling.C1"))


@pytest.mark.parametrize("known", [True, False])
def test_an_element_that_nothing_is_known_of_looks_unlike_a_normal_one(seen: Seen, known: bool) -> None:
    def missing(route: Route) -> None:
        found = route.fetch().json()
        route.fulfill(json={**found, "missing": "no baseline", "elements": [], "parameters": []})

    if not known:
        seen.page.route(re.compile("/deviations[?]"), missing)
    seen.open(f"machines/{MACHINE}")
    disc = seen.page.locator(".element[data-element='disc.D1']")
    expect(disc).to_have_class(re.compile(r"\b(normal|changed)\b" if known else r"\bunknown\b"))
    fill, dashes = disc.locator("rect").evaluate("of => [getComputedStyle(of).fill, getComputedStyle(of).strokeDasharray]")
    panel = seen.page.locator(".panel").first.evaluate("panel => getComputedStyle(panel).backgroundColor")
    assert ((fill != panel), (dashes == "none")) == (known, known)
    if not known:
        expect(disc).to_have_attribute("aria-label", "disc D1: unknown: nothing to compare with")
    expect(seen.page.locator(".legend")).to_contain_text("▢ unknown")
    assert seen.errors == []
