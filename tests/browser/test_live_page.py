"""The page follows what happens, in many tabs, and survives a service that is gone."""

import csv
import re
import signal
import subprocess
import threading

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import drawn, wait_drawn
from tests.browser.shown_service import MACHINE, simulate
from tests.end_to_end.processes import Service, until

PROBLEM = "application/problem+json"


def test_an_older_run_is_shown_and_one_that_is_not_there_is_not_replaced(seen: Seen, service: Service) -> None:
    runs = service.get(f"/machines/{MACHINE}/runs")

    def newest_only(route: Route) -> None:  # as on a machine with more runs than the page lists
        route.fulfill(json=runs[:2])

    seen.page.route(re.compile(r"/runs\?limit="), newest_only)
    oldest = runs[-1]["id"]
    seen.open(f"machines/{MACHINE}/response?run={oldest}")
    expect(seen.page.locator("main select").first).to_have_value(str(oldest))
    wait_drawn(seen.page, 3)
    seen.open(f"machines/{MACHINE}/response?run=999999")
    expect(seen.page.get_by_role("alert")).to_contain_text("no run 999999")
    expect(seen.page.locator("main select").first).to_have_value("")
    expect(seen.page.locator(".plot canvas")).to_have_count(0)


def test_an_identification_that_is_not_listed_is_the_one_that_the_choice_shows(seen: Seen, service: Service) -> None:
    listed = service.get(f"/machines/{MACHINE}/identifications")
    oldest = listed[-1]["id"]
    other = {**service.get(f"/identifications/{oldest}"), "machine": "another"}
    seen.page.route(re.compile(r"/identifications\?limit="), lambda route: route.fulfill(json=listed[:2]))
    seen.open(f"machines/{MACHINE}/identified?identification={oldest}&against={oldest}")
    choices = seen.page.locator("main select")
    expect(choices.first).to_have_value(str(oldest))
    expect(choices.nth(1)).to_have_value(str(oldest))
    seen.page.route(re.compile(rf"/identifications/{oldest}$"), lambda route: route.fulfill(json=other))
    seen.page.reload()
    expect(seen.page.locator("main")).to_contain_text("is of another machine: another")


SEEN = """Object.defineProperty(document, "hidden", { get: () => window.away === true });
Object.defineProperty(document, "visibilityState", { get: () => (document.hidden ? "hidden" : "visible") });"""
"""A headless browser shows all of its tabs at once; here it can be told that one lies behind another."""


TABS = 8
"""More than the six connections that a browser has to one host over HTTP/1.1."""


SIGNALS = """() => {
  window.signals = [];
  const signal = document.querySelector(".connection-state");
  const note = new MutationObserver(() => signals.push(signal.textContent));
  note.observe(signal, { subtree: true, characterData: true, childList: true });
}"""
"""Notes each change of what is said of the connection."""


def put(tab: Page, *, away: bool) -> None:
    """Put a tab behind another, or back in front."""
    tab.evaluate("(away) => { window.away = away; document.dispatchEvent(new Event('visibilitychange')); }", away)


def test_many_tabs_share_the_connections_of_one_browser(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    context = seen.page.context
    context.add_init_script(SEEN)
    tabs: list[Page] = []
    for _ in range(TABS):
        for tab in tabs[-1:]:
            put(tab, away=True)
        tabs.append(context.new_page())
        tabs[-1].goto(f"{seen.base}/#/machines/{MACHINE}")
        expect(tabs[-1].locator(".alert-row")).to_be_visible()
        expect(tabs[-1].locator(".connection-state")).to_have_text("● live")
    said = {"by": "otto", "comment": "while you were away"}
    service.client.post(f"/alerts/{alert['id']}/comments", json=said).raise_for_status()
    expect(tabs[-1].locator(".alert-row")).to_contain_text(f"{alert['events'] + 1} event", timeout=3000)
    tabs[0].wait_for_timeout(500)
    expect(tabs[0].locator(".alert-row")).to_contain_text(f"{alert['events']} event")  # a tab that nobody sees asks nothing
    put(tabs[-1], away=True)
    put(tabs[0], away=False)
    expect(tabs[0].locator(".alert-row")).to_contain_text(f"{alert['events'] + 1} event", timeout=3000)
    expect(tabs[0].locator(".connection-state")).to_have_text("● live")


def test_what_only_waits_is_not_reported_as_a_service_that_is_gone(seen: Seen) -> None:
    waiting: list[Route] = []
    seen.page.route(
        re.compile(r"/api/v1/(?!alert-events/stream)"), lambda route: waiting.append(route)
    )  # as without a free connection
    other = seen.page.context.new_page()
    other.goto(f"{seen.base}/#/machines/{MACHINE}")
    expect(other.locator(".alert-row")).to_be_visible()
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    seen.page.evaluate(SIGNALS)
    seen.page.wait_for_timeout(10_000)  # two beats, and the patience with each
    assert sum("alert-events" in one.request.url for one in waiting) >= 1
    assert seen.page.evaluate("signals") == []
    seen.page.unroute_all()
    other.close()


def test_a_live_run_is_followed(seen: Seen, service: Service) -> None:
    service.create("motor-pump")
    seen.open("machines/motor-pump")
    expect(seen.page.get_by_text("No run yet")).to_be_visible()
    source = threading.Thread(
        target=simulate, args=(service, "motor-pump"), kwargs={"cycles": 1, "rate": 25.0, "wait_s": 60}, daemon=True
    )
    source.start()
    bar = seen.page.locator(".now .collecting progress")
    expect(bar).to_be_visible()
    first = float(bar.evaluate("bar => bar.value"))
    until(lambda: bar.count() == 1 and float(bar.evaluate("bar => bar.value")) > first, within_s=20, what="the bar moves")
    until(lambda: max(drawn(seen.page), default=0) > 20, within_s=20, what="the run is drawn while it grows")
    seen.picture("live-run")
    source.join(60)
    expect(seen.page.locator("table").get_by_text("run-up")).to_be_visible()
    assert seen.errors == []


def test_a_live_run_is_drawn_over_an_earlier_one_of_its_kind(seen: Seen, service: Service) -> None:
    """The newest run is said to be going on: nothing depends on how fast one grows. What is drawn is of the service."""
    runs = service.get(f"/machines/{MACHINE}/runs")
    now = runs[0]
    earlier = [run for run in runs[1:] if run["kind"] == now["kind"]]

    def going_on(route: Route) -> None:
        going = {"id": now["id"], "kind": now["kind"], "started_at": now["started_at"], "progress": 0.5}
        route.fulfill(json={**route.fetch().json(), "run": going})

    seen.page.route(re.compile(rf"/machines/{MACHINE}/state"), going_on)
    seen.open(f"machines/{MACHINE}")
    panel = seen.page.locator(".live")
    chosen = panel.get_by_label("Overlay")
    expect(chosen.locator("option")).to_have_count(1 + len(earlier))
    expect(panel.get_by_text("overlaid run")).to_have_count(0)
    alone = columns(panel)
    assert len(alone) > 1
    chosen.select_option(str(earlier[-1]["id"]))
    expect(seen.page).to_have_url(re.compile(rf"reference={earlier[-1]['id']}$"))
    expect(panel.get_by_text("overlaid run")).to_be_visible()
    until(lambda: len(columns(panel)) > len(alone), within_s=20, what="the earlier run is there")
    assert columns(panel) == [alone[0], *(f"{name}, overlaid run" for name in alone[1:]), *alone[1:]]
    seen.picture("live-run-overlaid")
    chosen.select_option("")
    until(lambda: columns(panel) == alone, within_s=20, what="the earlier run is gone")
    assert seen.errors == []


def test_an_overlaid_run_that_cannot_be_read_is_reported_in_words(seen: Seen, service: Service) -> None:
    """Said of the run that is going on and of orbits: refused, cut off on the way, of other channels, or no run at all."""
    runs = service.get(f"/machines/{MACHINE}/runs")
    now, earlier = runs[0], [run["id"] for run in runs[1:] if run["kind"] == runs[0]["kind"]]

    def going_on(route: Route) -> None:
        going = {"id": now["id"], "kind": now["kind"], "started_at": now["started_at"], "progress": 0.5}
        route.fulfill(json={**route.fetch().json(), "run": going})

    def of_others(route: Route) -> None:
        answer = route.fetch().json()
        route.fulfill(json={**answer, "channels": [f"other {one}" for one in answer["channels"]]})

    seen.page.route(re.compile(rf"/machines/{MACHINE}/state"), going_on)
    refused = "only an analyst may read this run"
    problem = {"status": 403, "detail": refused}
    seen.page.route(
        re.compile(rf"/runs/{earlier[0]}/"), lambda route: route.fulfill(status=403, content_type=PROBLEM, json=problem)
    )
    seen.page.route(re.compile(rf"/runs/{earlier[1]}/"), lambda route: route.abort("connectionreset"))
    seen.page.route(re.compile(rf"/runs/{earlier[2]}/"), of_others)
    seen.open(f"machines/{MACHINE}")
    panel = seen.page.locator(".live")
    for run, reason in zip(earlier, (refused, "does not answer", "none of this run's channels"), strict=False):
        panel.get_by_label("Overlay").select_option(str(run))
        expect(panel.get_by_role("status")).to_contain_text(f"Run {run} cannot be laid over")
        expect(panel.get_by_role("status")).to_contain_text(reason)
    expect(panel.locator("canvas")).to_have_count(1)
    for page in (f"machines/{MACHINE}", f"machines/{MACHINE}/response", f"machines/{MACHINE}/shapes"):
        seen.open(f"{page}?reference=999999")
        expect(seen.page.locator("main").get_by_text("Run 999999 cannot be laid over").first).to_be_visible()
    seen.open(f"machines/{MACHINE}/shapes?run={now['id']}&reference={earlier[0]}")
    expect(seen.page.locator("main").get_by_text(refused).first).to_be_visible()


def columns(panel: Locator) -> list[str]:
    """Return the names of what a plot shows, as its data name them."""
    with panel.page.expect_download() as told:
        panel.get_by_role("button", name="CSV").click()
    with told.value.path().open(encoding="utf-8-sig", newline="") as data:
        return [name.removesuffix(" [µm pp]") for name in next(csv.reader(data))]


def test_a_maintenance_is_written_down(seen: Seen, service: Service) -> None:
    seen.open("machines/motor-pump")
    seen.page.get_by_role("button", name="Add").click()
    seen.page.get_by_label("Kind").select_option("maintenance")
    seen.page.get_by_label("Text", exact=True).fill("coupling re-shimmed")
    seen.page.get_by_label("Your name").fill("anna")
    seen.page.get_by_role("dialog").get_by_role("button", name="Add").click()
    expect(seen.page.locator(".timeline")).to_contain_text("coupling re-shimmed")
    (entry,) = service.get("/machines/motor-pump/timeline")
    assert (entry["kind"], entry["by"]) == ("maintenance", "anna")
    assert seen.errors == []


LATE_FRAMES = """
const later = window.setTimeout;
window.requestAnimationFrame = (then) => later(then, 600);
window.setTimeout = (then, ms, ...rest) => later(then, Math.max(ms ?? 0, 600), ...rest);
"""
"""A machine that is too busy to draw; what the service says arrives all the same."""
LATE_NEWS_OF_THE_ADDRESS = """
const listen = window.addEventListener;
window.addEventListener = (kind, then, ...rest) =>
  listen.call(window, kind, kind === "hashchange" ? (event) => later(() => then(event), 1500) : then, ...rest);
"""
"""… and where one goes meanwhile is told last of all."""


@pytest.mark.parametrize("shown_at", ["", f"machines/{MACHINE}"])
def test_what_is_answered_before_the_first_frame_is_shown(seen: Seen, shown_at: str) -> None:
    seen.page.add_init_script(LATE_FRAMES)
    seen.open(shown_at)
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    expect(seen.page.locator(".loading")).to_have_count(0)
    seen.page.keyboard.press("?")
    expect(seen.page.get_by_role("dialog", name="Keyboard shortcuts")).to_be_visible()
    assert seen.errors == []


def test_who_has_gone_on_is_not_brought_back(seen: Seen) -> None:
    held: list[Route] = []
    panel = seen.page.get_by_role("heading", name="Identifiability")
    seen.page.add_init_script(LATE_FRAMES + LATE_NEWS_OF_THE_ADDRESS)
    seen.open(f"machines/{MACHINE}/identified")
    expect(panel).to_be_visible()
    seen.open(f"machines/{MACHINE}/settings")
    expect(panel).to_have_count(0)
    # An answer would have it drawn again, and what waits for a frame done before.
    seen.page.route(re.compile("/identifications"), lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}/identified")  # what it shows is known by now, and is put into the address
    expect(panel).to_be_visible()
    seen.open(f"machines/{MACHINE}/trends?element=disc.D1")
    seen.page.wait_for_timeout(2500)
    for one in held:
        one.continue_()
    seen.page.unroute_all()
    expect(seen.page.get_by_role("heading", name="disc D1: single runs")).to_be_visible()
    assert seen.page.url.endswith("/trends?element=disc.D1")
    assert seen.errors == []


def test_the_page_says_that_the_service_is_gone_and_comes_back_with_it(
    seen: Seen, service: Service, serving: subprocess.Popen[bytes]
) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()
    expect(seen.page.locator(".connection-state")).to_have_text(re.compile("live"))
    serving.send_signal(signal.SIGTERM)
    assert serving.wait(20) == 0
    expect(seen.page.locator(".banner")).to_contain_text("does not answer")
    expect(seen.page.get_by_role("alert")).to_have_count(1)  # said once, not by every panel
    expect(seen.page.locator(".alert-row")).to_be_visible()  # what was known stays
    seen.picture("service-gone")
    with service.running():
        expect(seen.page.locator(".banner")).to_have_count(0)
        expect(seen.page.locator(".connection-state")).to_have_text(re.compile("live"))
        (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
        service.client.post(f"/alerts/{alert['id']}/comments", json={"by": "otto", "comment": "back"}).raise_for_status()
        expect(seen.page.locator(".alert-row")).to_contain_text(f"{alert['events'] + 1} events")
