"""The page says when what it shows is old: the service cannot read its data, or refuses one of its answers."""

import contextlib
import re
from pathlib import Path

from playwright.sync_api import Browser, Route, expect

from tests.browser.conftest import PATIENCE_MS, Seen
from tests.browser.drawing import SEEN, SEEN_AGAIN
from tests.browser.shown_service import MACHINE, ZONE
from tests.end_to_end.processes import Service
from tests.postgresql import FAST, server

WORDS = "the database does not answer"
GONE = {"type": "about:blank", "title": "Service Unavailable", "status": 503, "detail": WORDS}
REFUSED = {"type": "about:blank", "title": "Forbidden", "status": 403, "detail": "this key may not see alerts"}
EVERYTHING = re.compile(r"/api/v1/(?!alert-events/stream)")
ALERTS = re.compile(rf"/machines/{MACHINE}/alerts\?")
DEVIATIONS = re.compile("/deviations")


def comment(service: Service, words: str) -> int:
    """Comment on the open alert, of which every page hears; how many events it has then."""
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    said = {"by": "otto", "comment": words}
    service.client.post(f"/alerts/{alert['id']}/comments", json=said).raise_for_status()
    return int(alert["events"]) + 1


def test_the_page_says_that_the_service_cannot_read_its_data_and_recovers(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()
    expect(seen.page.locator(".loading")).to_have_count(0)
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    seen.page.route(EVERYTHING, lambda route: route.fulfill(status=503, json=GONE))
    events = comment(service, "while nothing can be read")
    expect(seen.page.locator(".banner")).to_contain_text("answers, but cannot read its data")
    expect(seen.page.locator(".banner")).to_contain_text(WORDS)
    expect(seen.page.locator("main")).to_have_class("stale")
    expect(seen.page.locator(".connection-state")).to_have_text("✕ no data")
    expect(seen.page.locator(".alert-row")).to_be_visible()  # what was known stays
    seen.page.wait_for_timeout(6000)
    expect(seen.page.get_by_role("alert")).to_have_count(1)  # said once, not by every panel
    expect(seen.page.locator(".stale-notice")).to_have_count(0)
    seen.picture("no-data")
    seen.page.unroute_all()
    expect(seen.page.locator(".banner")).to_have_count(0)
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    expect(seen.page.locator("main")).not_to_have_class("stale")
    expect(seen.page.locator(".alert-row")).to_contain_text(f"{events} events")


def test_a_page_that_is_opened_meanwhile_says_so_too(seen: Seen) -> None:
    seen.page.route("**/api/v1/**", lambda route: route.fulfill(status=503, json=GONE))  # not even its stream is there
    seen.open()
    expect(seen.page.locator(".banner")).to_contain_text("answers, but cannot read its data")
    expect(seen.page.locator(".error")).to_contain_text(WORDS)
    seen.page.unroute_all()
    expect(seen.page.locator(".banner")).to_have_count(0)
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    expect(seen.page.locator("table.fleet")).to_contain_text(MACHINE)


def test_what_one_panel_is_refused_is_said_beside_its_old_data(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()
    seen.page.route(ALERTS, lambda route: route.fulfill(status=403, json=REFUSED))
    events = comment(service, "seen by others only")
    aging = seen.page.locator(".stale-notice")
    expect(aging).to_have_text(re.compile(r"As of \d\d:\d\d:\d\d, nothing newer: this key may not see alerts"))
    expect(seen.page.locator(".alert-row")).to_be_visible()
    expect(seen.page.locator(".connection-state")).to_have_text("● live")  # it is this panel's trouble alone
    expect(seen.page.locator("main.stale")).to_have_count(0)
    seen.picture("one-panel-is-old")
    seen.page.unroute_all()
    expect(aging).to_have_count(0)
    expect(seen.page.locator(".alert-row")).to_contain_text(f"{events} events")


def test_states_and_what_the_newest_identification_says_do_not_grow_old_unsaid(seen: Seen) -> None:
    seen.page.add_init_script(SEEN)
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".loading")).to_have_count(0)
    seen.page.route(re.compile(r"/(state$|identifications\?limit=)"), lambda route: route.fulfill(status=403, json=REFUSED))
    seen.page.evaluate(SEEN_AGAIN)
    said = re.compile(r"As of \d\d:\d\d:\d\d, nothing newer: this key may not see alerts")
    expect(seen.page.locator(".now .stale-notice")).to_have_text(said)
    baseline = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Deviation from the baseline"))
    expect(baseline.locator(".stale-notice")).to_have_text(said)
    for tab in ("Trends", "Model"):
        seen.page.get_by_role("link", name=tab, exact=True).click()
        expect(seen.page.locator(".stale-notice")).to_have_count(2)
    seen.page.unroute_all()
    expect(seen.page.locator(".stale-notice")).to_have_count(0)


def test_the_points_of_a_run_do_not_grow_old_unsaid(seen: Seen) -> None:
    seen.page.add_init_script(SEEN)
    seen.open(f"machines/{MACHINE}/response")
    expect(seen.page.locator(".loading")).to_have_count(0)
    seen.page.route(re.compile(r"/phasors\?"), lambda route: route.fulfill(status=403, json=REFUSED))
    seen.page.evaluate(SEEN_AGAIN)
    said = re.compile(r"^As of \d\d:\d\d:\d\d, nothing newer: this key may not see alerts$")
    expect(seen.page.locator(".stale-notice")).to_have_text(said)
    expect(seen.page.get_by_role("alert")).to_have_count(0)
    expect(seen.page.get_by_role("group", name=re.compile("^Amplitude of "))).to_be_visible()
    seen.page.unroute_all()
    expect(seen.page.locator(".stale-notice")).to_have_count(0)


def test_a_single_try_that_failed_is_repaired_and_not_reported(seen: Seen, service: Service) -> None:
    refused: list[str] = []

    def once(route: Route) -> None:
        refused.append(route.request.url)
        if len(refused) > 1:
            route.continue_()
        else:
            route.fulfill(status=503, json=GONE)

    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()
    seen.page.evaluate(
        "window.errors = 0; new MutationObserver(() => { errors += document.querySelectorAll('.error').length; })"
        ".observe(document.body, { subtree: true, childList: true })"
    )
    seen.page.route(ALERTS, once)
    events = comment(service, "once more")
    expect(seen.page.locator(".alert-row")).to_contain_text(f"{events} events", timeout=8000)  # polled less often than that
    assert len(refused) > 1
    assert seen.page.evaluate("errors") == 0


def test_a_database_that_is_gone_is_said_and_its_return_too(browser: Browser, tmp_path: Path) -> None:
    with server(*FAST) as database:
        one = Service(tmp_path, database=database.url)
        with contextlib.closing(one.client), one.running():
            one.create(MACHINE)
            context = browser.new_context(timezone_id=ZONE.key, locale="en-GB")
            context.set_default_timeout(PATIENCE_MS)
            page = context.new_page()
            page.goto(f"http://127.0.0.1:{one.port}/#/")
            expect(page.locator(".connection-state")).to_have_text("● live")
            expect(page.locator("table.fleet")).to_contain_text(MACHINE)
            with database.away():
                expect(page.locator(".banner")).to_contain_text("answers, but cannot read its data")
                expect(page.locator("main.stale")).to_contain_text(MACHINE)
            expect(page.locator(".connection-state")).to_have_text("● live")
            expect(page.locator(".banner")).to_have_count(0)
            expect(page.locator("main.stale")).to_have_count(0)
            context.close()


IMPATIENT = """const wait = AbortSignal.timeout.bind(AbortSignal);
AbortSignal.timeout = (ms) => wait(ms > 5000 ? 1500 : ms);"""
"""The twenty seconds that the page waits for an answer, shortened."""
NEWEST_RUNS = re.compile(rf"/machines/{MACHINE}/runs\?limit=12")


def test_an_answer_that_does_not_come_is_reported_while_the_service_is_there(seen: Seen, service: Service) -> None:
    held: list[Route] = []
    seen.page.add_init_script(IMPATIENT)
    seen.page.route(NEWEST_RUNS, lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()
    seen.page.route(ALERTS, lambda route: held.append(route))
    events = comment(service, "not seen yet")
    runs = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Newest runs"))
    expect(runs.get_by_role("alert")).to_have_text(re.compile("did not answer this request within 20 s. Retrying"))
    aging = seen.page.locator(".stale-notice")
    expect(aging).to_have_text(re.compile(r"As of \d\d:\d\d:\d\d, nothing newer: .*within 20 s. Retrying"))
    expect(seen.page.locator(".alert-row")).to_be_visible()
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    seen.page.unroute_all()
    expect(aging).to_have_count(0)
    expect(seen.page.locator(".alert-row")).to_contain_text(f"{events} events")
    expect(runs.get_by_role("table")).to_be_visible()


def test_an_answer_that_is_cut_off_is_reported(seen: Seen) -> None:
    seen.page.route(NEWEST_RUNS, lambda route: route.fulfill(body='[{"id": 1', content_type="application/json"))
    seen.open(f"machines/{MACHINE}")
    runs = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Newest runs"))
    expect(runs.get_by_role("alert")).to_have_text("The service's response is not JSON.")
    seen.page.unroute_all()
    expect(runs.get_by_role("table")).to_be_visible()


def test_news_that_comes_during_a_question_is_asked_for_behind_it(seen: Seen, service: Service) -> None:
    held: list[Route] = []
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alert-row")).to_be_visible()

    def hold_the_first(route: Route) -> None:
        if held:
            route.continue_()
        else:
            held.append(route)

    seen.page.route(ALERTS, hold_the_first)
    with seen.page.expect_response(DEVIATIONS):  # asked for on the same news
        comment(service, "one")
    stale = service.get(f"/machines/{MACHINE}/alerts", open=True)
    with seen.page.expect_request(DEVIATIONS):
        events = comment(service, "two")
    held[0].fulfill(json=stale)
    expect(seen.page.locator(".alert-row")).to_contain_text(f"{events} events", timeout=3000)  # polled less often than that
