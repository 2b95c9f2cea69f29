"""From an alert to what is done about it: every click of the pointer is counted, no address is typed."""

import re

import pytest
from playwright.sync_api import Locator, Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import COUNT
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service, until

MOST_CLICKS = 8


class Pointer:
    """A pointer that counts its clicks; it clicks only what a person sees, alone."""

    def __init__(self) -> None:
        self.clicks: list[str] = []

    def click(self, place: Locator) -> None:
        """Click on a place that must be there and in sight."""
        expect(place).to_have_count(1)
        expect(place).to_be_visible()
        self.clicks.append(place.inner_text() or place.get_attribute("name") or "")
        place.click()


def test_an_alert_is_judged_acknowledged_passed_on_and_printed_in_few_clicks(seen: Seen, service: Service) -> None:
    seen.page.add_init_script("window.printed = 0; window.print = () => { window.printed += 1; };")
    pointer, page = Pointer(), seen.page
    seen.open()
    pointer.click(page.locator("a.first-alert"))
    judged_on_one_page(seen, service)
    row = page.locator(".alert-row")
    pointer.click(row.get_by_role("button", name="Acknowledge"))
    expect(page.get_by_label("Your name")).to_be_focused()
    page.keyboard.type("anna")
    pointer.click(page.get_by_role("dialog").get_by_role("button", name="Acknowledge"))
    expect(row.locator(".state")).to_have_text("acknowledged")
    pointer.click(row.get_by_role("button", name="Instruct the crew"))
    told = page.get_by_label("What is to be done")
    expect(told).to_be_focused()
    assert "coupling C1" in told.input_value()
    page.keyboard.press("Control+End")
    page.keyboard.type(" Check the coupling at the next stop.")
    pointer.click(page.get_by_role("dialog").get_by_role("button", name="Instruct the crew"))
    expect(row.locator(".history")).to_contain_text("Check the coupling at the next stop.")
    pointer.click(page.get_by_role("link", name="Report"))
    expect(page.locator(".report")).to_be_visible()
    pointer.click(page.get_by_role("button", name="Print"))
    assert page.evaluate("window.printed") == 1
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    assert alert["state"] == "acknowledged"
    assert service.get(f"/alerts/{alert['id']}/events")[-1]["comment"].endswith("Check the coupling at the next stop.")
    assert len(pointer.clicks) <= MOST_CLICKS, pointer.clicks
    assert seen.errors == []


def judged_on_one_page(seen: Seen, service: Service) -> None:
    """All that a judgement needs is there without a click: evidence, train, trends, the response beside the coupling."""
    page = seen.page
    expect(page.locator("h1")).to_have_text("Misalignment of coupling C1")
    expect(page.locator(".alert-row .facts:not(.advice)")).to_contain_text("Largest changes")
    expect(page.locator(".element.danger, .element.alert")).to_have_count(1)
    expect(page.get_by_role("group", name=re.compile("coupling.C1.* over time")).first).to_be_visible()
    bode = page.get_by_role("group", name=re.compile("^Amplitude of"))
    until(lambda: bode.locator("canvas").evaluate(COUNT) > 20, within_s=15, what="the Bode plot is drawn")
    drawing = service.get(f"/machines/{MACHINE}/drawing")
    at = next(one["at"] for one in drawing["couplings"])
    shown = re.findall(r"\w+", str(bode.get_attribute("aria-label")).split(" over ")[0].removeprefix("Amplitude of "))
    distance = {one["channel"]: abs(one["at"] - at) for one in drawing["probes"]}
    nearest = min(distance.values())
    assert min(distance[one] for one in shown) == pytest.approx(nearest), "the plot is of the probes beside the coupling"


def test_bode_opens_at_the_probes_beside_what_an_alert_is_about(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/response")
    expect(seen.page.get_by_text("The probes beside coupling C1")).to_be_visible()
    pressed = seen.page.get_by_role("group", name="Channels").locator("[aria-pressed=true]")
    assert "B1X" not in pressed.all_inner_texts()
    assert seen.errors == []


def test_what_is_judged_stays_while_alerts_and_runs_come(seen: Seen, service: Service) -> None:
    """The next run shows the alert as well: plots stay, zoomed as they are, until those of that run are there."""
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    found = service.get(f"/identifications/{alert['identification']}")
    earlier = next(run["id"] for run in service.get(f"/machines/{MACHINE}/runs") if run["id"] not in found["runs"])
    held: list[Route] = []
    seen.open(f"alerts/{alert['id']}")
    zoomed = seen.page.locator(".uplot[data-zoomed='1']")
    bode = seen.page.get_by_role("group", name=re.compile("^Amplitude of"))
    until(
        lambda: bode.count() == 1 and bode.locator("canvas").evaluate(COUNT) > 20, within_s=15, what="the Bode plot is drawn"
    )
    bode.get_by_role("button", name="Zoom in").click()
    expect(zoomed).to_have_count(3)
    seen.page.evaluate("window.scrollTo(0, 900)")
    next_one = found | {"id": 9001, "runs": [earlier]}
    seen.page.route(re.compile("/identifications/9001$"), lambda route: held.append(route))
    seen.page.route(re.compile(rf"/alerts/{alert['id']}$"), lambda route: route.fulfill(json=alert | {"identification": 9001}))
    until(lambda: _is_asked(seen, held), within_s=15, what="the next identification is asked for")
    expect(zoomed).to_have_count(3)
    held.pop().fulfill(json=next_one)
    expect(seen.page.get_by_text(f"Below: run {earlier}, ")).to_be_visible()
    expect(zoomed).to_have_count(3)
    assert seen.page.evaluate("window.scrollY") == 900
    assert seen.errors == []


def _is_asked(seen: Seen, held: list[Route]) -> bool:
    seen.page.wait_for_timeout(50)
    return len(held) > 0


def test_a_later_alert_does_not_change_which_probes_are_looked_at(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    seen.open(f"machines/{MACHINE}/response")
    pressed = seen.page.get_by_role("group", name="Channels").locator("[aria-pressed=true]")
    expect(pressed).not_to_have_count(0)
    before = pressed.all_inner_texts()
    later = alert | {"id": 9001, "element": "bearing.B1"}
    with seen.page.expect_response(re.compile(r"/alerts\?open=true"), timeout=15_000):
        seen.page.route(re.compile(r"/alerts\?open=true"), lambda route: route.fulfill(json=[later, alert]))
    seen.page.wait_for_timeout(300)
    assert pressed.all_inner_texts() == before
    seen.page.reload()
    expect(seen.page.get_by_text("The probes beside bearing B1")).to_be_visible()
    assert pressed.all_inner_texts() != before


def test_an_alert_that_is_not_there_leads_back(seen: Seen) -> None:
    seen.open("alerts/999999")
    expect(seen.page.get_by_role("alert")).to_have_text("There is no alert “999999”.")
