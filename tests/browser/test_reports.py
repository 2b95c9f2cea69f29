"""Reports of a period: as it was then, on paper as well."""

import re
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Literal
from urllib.parse import parse_qs, urlsplit

import pypdf
import pytest
from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.shown_service import CYCLES, MACHINE, day_ahead, day_of, end_of
from tests.end_to_end.processes import Service, until


def test_report_prints_on_paper_without_the_frame(seen: Seen) -> None:
    seen.open(f"reports/{MACHINE}")
    expect(seen.page.get_by_text(f"{2 * CYCLES} runs")).to_be_visible()
    expect(seen.page.locator(".history-plot canvas").first).to_be_visible()
    seen.page.emulate_media(media="print", color_scheme="dark")
    expect(seen.page.locator(".bar")).to_be_hidden()
    assert seen.page.evaluate("document.documentElement.dataset.theme") == "light", "ink is dark, paper is not"
    assert seen.page.pdf(format="A4").count(b"/Type /Page\n") >= 1
    assert seen.errors == []


def test_a_report_is_printed_on_demand_and_says_that_it_is_being_printed(seen: Seen, tmp_path: Path) -> None:
    seen.open(f"reports/{MACHINE}")
    with seen.page.expect_download(timeout=90_000) as download:
        seen.page.get_by_role("button", name="Report as PDF").click()
        expect(seen.page.get_by_role("progressbar", name="The report is being printed")).to_be_visible()
    download.value.save_as(tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")
    assert download.value.suggested_filename.startswith(f"{MACHINE}-")
    expect(seen.page.get_by_role("button", name="Report as PDF")).to_be_enabled()
    assert seen.errors == []


def test_a_report_as_pdf_is_in_the_units_of_the_page(seen: Seen) -> None:
    seen.open(f"reports/{MACHINE}")
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_p,hz")
    with seen.page.expect_download(timeout=90_000) as download:
        seen.page.get_by_role("button", name="Report as PDF").click()
    pages = [page.extract_text() for page in pypdf.PdfReader(download.value.path()).pages]
    assert "1× [mil 0-pk]" in " ".join(pages)
    assert "µm pp" not in " ".join(pages)
    assert seen.errors == []


def test_a_report_that_cannot_be_printed_says_why(seen: Seen) -> None:
    problem = {"detail": "too many reports wait; ask again in 30 s"}
    seen.page.route(re.compile(r"/report\.pdf"), lambda route: route.fulfill(status=503, json=problem))
    seen.open(f"reports/{MACHINE}")
    seen.page.get_by_role("button", name="Report as PDF").click()
    expect(seen.page.get_by_role("alert")).to_contain_text("too many reports wait")
    expect(seen.page.get_by_role("button", name="Report as PDF")).to_be_enabled()


@pytest.mark.parametrize(
    ("shown_at", "width", "media"),
    [
        (f"reports/{MACHINE}", 688, "print"),  # A4 less its margins
        (f"reports/{MACHINE}", 794, "print"),
        (f"machines/{MACHINE}/identified", 1440, "screen"),
        (f"machines/{MACHINE}/identified", 1920, "screen"),
    ],
)
def test_no_number_of_a_parameter_is_cut_off(seen: Seen, shown_at: str, width: int, media: Literal["print", "screen"]) -> None:
    seen.page.set_viewport_size({"width": width, "height": 1000})
    seen.open(shown_at)
    tables = seen.page.locator(".elements .scroll")
    expect(tables.filter(has_text="°").first).to_be_attached()
    seen.page.emulate_media(media=media)
    for one in tables.all():
        assert one.evaluate("one => one.scrollWidth <= one.clientWidth + 1"), one.inner_text()
    seen.picture(f"parameters-{media}-{width}")
    assert seen.errors == []


def test_trends_of_an_old_period_are_marked_by_what_was_done_then(seen: Seen) -> None:
    last = day_ahead(-3)
    first = last - timedelta(days=40)
    done = {"id": 1, "at": f"{last}T00:00:00Z", "kind": "maintenance", "text": "coupling re-shimmed", "by": "anna"}

    def timeline(route: Route) -> None:  # so much was done since that the newest entries do not reach so far back
        period = parse_qs(urlsplit(route.request.url).query)
        route.fulfill(json=[done] if "to" in period and period["to"][0] < f"{last + timedelta(days=2)}" else [])

    seen.page.route(re.compile(r"/timeline\?"), timeline)
    seen.open(f"reports/{MACHINE}?from={first}&to={last}")
    expect(seen.page.locator(".timeline").first).to_contain_text("coupling re-shimmed")
    assert seen.errors == []


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("from=x&to=y", ["first day is not a date: “x”.", "last day is not a date: “y”."]),
        ("from=2026-01-01T00:00:00Z&to=2026-02-01", ["first day is not a date: “2026-01-01T00:00:00Z”."]),
        ("from=2026-01-01&to=2026-02-31", ["last day is not a date: “2026-02-31”."]),
        ("from=2026-02-02&to=2026-02-01", ["first day is after its last."]),
    ],
)
def test_report_says_what_is_wrong_with_a_period(seen: Seen, asked: str, said: list[str]) -> None:
    seen.open(f"reports/{MACHINE}?{asked}")
    wrong = seen.page.locator(".empty")
    expect(wrong).to_have_count(len(said))
    for number, words in enumerate(said):
        expect(wrong.nth(number)).to_contain_text(f"The period's {words}")
    assert seen.errors == []


def test_report_marks_the_train_as_it_was_at_the_end_of_the_period(seen: Seen, service: Service) -> None:
    coupling = seen.page.locator("[data-element='coupling.C1']")
    newest = next(
        one for one in service.get(f"/machines/{MACHINE}/identifications") if one["scope"] == "run" and one["accepted"]
    )
    seen.open(f"reports/{MACHINE}")
    expect(coupling).to_have_class(re.compile("alert|danger"))
    expect(seen.page.get_by_text(f"those of identification {newest['id']} ")).to_be_visible()
    deviations = service.get(f"/machines/{MACHINE}/deviations", identification=newest["id"])
    changed = {one["element"] for one in deviations["elements"] if one["probability"] < 1e-3}
    assert "coupling.C1" in changed
    for one in deviations["elements"]:
        level = "changed" if one["element"] in changed else "normal"
        expect(seen.page.locator(f".element[data-element='{one['element']}']")).to_have_class(
            re.compile(f"{level}|alert|danger")
        )
    last = day_ahead(-3)
    before = next(
        one
        for one in service.get(f"/machines/{MACHINE}/identifications", to=end_of(last))
        if one["scope"] == "run" and one["accepted"]
    )
    seen.open(f"reports/{MACHINE}?to={last}")
    expect(seen.page.get_by_text(f"those of identification {before['id']} ")).to_be_visible()
    expect(seen.page.get_by_text("No alert in this period")).to_be_visible()
    expect(coupling).to_have_class(re.compile("changed|normal"))
    assert seen.errors == []


@pytest.mark.parametrize(
    ("days", "word", "opened", "marked"),
    [(0, "closed", 0, "changed"), (9, "unacknowledged", 1, "alert|danger")],
    ids=["closed", "open"],
)
def test_report_says_an_alert_s_state_at_the_end_of_the_period(
    seen: Seen, service: Service, days: int, word: str, opened: int, marked: str
) -> None:
    at = (datetime.now(UTC) + timedelta(days=days)).isoformat()
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    then = service.get(f"/alerts/{alert['id']}/events")[-1]
    assert then["state"] == "unacknowledged"  # the label is the same
    gone = "it is as at the baseline again"
    today = {**alert, "state": "normal", "message": gone, "closed_at": at, "updated_at": at}  # as if it had been closed
    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=1000"), lambda route: route.fulfill(json=[today]))
    seen.open(f"reports/{MACHINE}")
    row = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alerts of the period")).locator("tbody tr")
    expect(row.locator("td").nth(3)).to_have_text(word)
    expect(row.locator("td").nth(1)).to_have_text(then["message"] if opened else gone)
    expect(seen.page.get_by_text(f"of which {opened} open at the end")).to_be_visible()
    expect(seen.page.locator("[data-element='coupling.C1']")).to_have_class(re.compile(marked))
    assert seen.errors == []


@pytest.mark.parametrize(("days", "severity"), [(0, "alert"), (10, "danger")])
def test_report_says_how_severe_an_alert_was_at_the_end_of_the_period(
    seen: Seen, service: Service, days: int, severity: str
) -> None:
    later = (datetime.now(UTC) + timedelta(days=9)).isoformat()
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    events = [{**one, "severity": "alert"} for one in service.get(f"/alerts/{alert['id']}/events")]
    worse = {**events[-1], "id": 10**9, "at": later, "kind": "severity_changed", "severity": "danger"}
    today = [{**alert, "severity": "danger", "updated_at": later}]
    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=1000"), lambda route: route.fulfill(json=today))
    seen.page.route(re.compile(rf"/alerts/{alert['id']}/events"), lambda route: route.fulfill(json=[*events, worse]))
    last = day_ahead(days)
    seen.open(f"reports/{MACHINE}?to={last}")
    row = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alerts of the period")).locator("tbody tr")
    expect(row.locator("td").first).to_contain_text(severity)
    expect(seen.page.locator(".element[data-element='coupling.C1']")).to_have_class(re.compile(rf"\b{severity}\b"))
    expect(seen.page.get_by_text("1 alert, of which 1 open at the end")).to_be_visible()
    assert seen.errors == []


def test_a_report_of_many_alerts_asks_for_the_events_of_each_once(seen: Seen, service: Service) -> None:
    """More than the page keeps of what nobody follows."""
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    events = service.get(f"/alerts/{alert['id']}/events")
    later = (datetime.now(UTC) + timedelta(days=9)).isoformat()
    many = [{**alert, "id": 1000 + number, "updated_at": later} for number in range(80)]
    asked: list[str] = []

    def told(route: Route) -> None:
        asked.append(route.request.url)
        route.fulfill(json=events)

    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=1000"), lambda route: route.fulfill(json=many))
    seen.page.route(re.compile(r"/alerts/1\d{3}/events"), told)
    seen.open(f"reports/{MACHINE}?to={day_ahead(0)}")
    expect(seen.page.get_by_text("80 alerts, of which 80 open at the end")).to_be_visible()
    seen.page.wait_for_timeout(1500)
    assert len(asked) == len(set(asked)) == 80
    assert seen.errors == []


def test_words_on_trends_are_those_of_the_period(seen: Seen, service: Service) -> None:
    last = day_ahead(-10)
    before = next(
        one
        for one in service.get(f"/machines/{MACHINE}/identifications", to=end_of(last))
        if one["scope"] == "run" and one["accepted"]
    )
    now = service.get(f"/machines/{MACHINE}/trend-tests", parameter="coupling.C1.kxx")["tests"]
    assert any(one["step_up"]["passed"] and day_of(one["step_up"]["began"]) > last for one in now), "it came after the period"
    asked: list[str] = []
    seen.page.on("request", lambda request: asked.append(request.url) if "/trend-tests" in request.url else None)
    seen.open(f"reports/{MACHINE}?to={last}")
    expect(seen.page.locator(".history-plot .trend-tests").first).to_be_attached()
    expect(seen.page.locator(".loading")).to_have_count(0)
    assert {*asked_identifications(asked)} == {str(before["id"])}
    expect(seen.page.locator(".trend-tests", has_text=re.compile("step up|higher"))).to_have_count(0)
    assert seen.errors == []


def asked_identifications(addresses: list[str]) -> list[str]:
    """Return which identification each request is of; "newest" where it names none."""
    return [parse_qs(urlsplit(one).query).get("identification", ["newest"])[0] for one in addresses]


def test_a_period_without_an_accepted_identification_has_no_words_on_trends(seen: Seen) -> None:
    asked: list[str] = []

    def not_accepted(route: Route) -> None:
        route.fulfill(json={**route.fetch().json(), "accepted": False})

    seen.page.route(re.compile(r"/identifications/\d+$"), not_accepted)
    seen.page.on("request", lambda request: asked.append(request.url) if "/trend-tests" in request.url else None)
    seen.open(f"reports/{MACHINE}")
    expect(seen.page.locator(".history-plot canvas").first).to_be_visible()
    expect(seen.page.locator(".trend-tests")).to_have_count(0)
    assert (asked, seen.errors) == ([], [])


@pytest.mark.parametrize(
    ("first", "last", "begins", "ends", "shown"),
    [
        ("2026-03-20", "2026-03-29", "2026-03-19T23:00:00.000Z", "2026-03-29T21:59:59.999Z", "2026-03-20 to 2026-03-29"),
        ("2026-10-20", "2026-10-25", "2026-10-19T22:00:00.000Z", "2026-10-25T22:59:59.999Z", "2026-10-20 to 2026-10-25"),
    ],
    ids=["a day of 23 hours", "a day of 25 hours"],
)
def test_a_period_ends_with_its_last_day_however_long_that_is(
    seen: Seen, first: str, last: str, begins: str, ends: str, shown: str
) -> None:
    asked: list[dict[str, list[str]]] = []
    seen.page.on("request", lambda request: asked.append(parse_qs(urlsplit(request.url).query)))
    seen.open(f"reports/{MACHINE}?from={first}&to={last}")
    expect(seen.page.locator("article.report > header")).to_contain_text(shown)
    expect(seen.page.locator("article.report > header")).to_contain_text("Times are local time of Europe/Berlin.")
    expect(seen.page.get_by_text("No notes or maintenance in this period")).to_be_visible()
    periods = {(one["from"][0], one["to"][0]) for one in asked if "from" in one}
    assert periods == {(begins, ends)}
    assert seen.errors == []


@pytest.mark.parametrize("late", [r"/trends\?", "/drawing", "/deviations"])
def test_a_report_that_is_printed_too_early_says_so(seen: Seen, late: str) -> None:
    held: list[Route] = []
    said = "getComputedStyle(document.querySelector('main'), '::before').content"
    seen.page.route(re.compile(late), lambda route: held.append(route))
    seen.open(f"reports/{MACHINE}")
    expect(seen.page.get_by_role("heading", name="Identifiability")).to_be_visible()
    assert seen.page.evaluate(said) == "none"
    seen.page.emulate_media(media="print")
    assert "parts are missing" in seen.page.evaluate(said)
    for route in held:
        route.continue_()
    until(lambda: seen.page.evaluate(said) == "none", within_s=20, what="all parts are there")
    expect(seen.page.locator(".orbits svg").first).to_be_visible()
    until(lambda: seen.page.evaluate(said) == "none", within_s=20, what="the orbits' parts are there, too")
    assert seen.errors == []


def test_a_report_says_why_its_identification_is_not_there(seen: Seen) -> None:
    refused = {"title": "Forbidden", "status": 403, "detail": "this key may not see identifications"}
    seen.page.route(re.compile(r"/identifications/\d+$"), lambda route: route.fulfill(status=403, json=refused))
    seen.open(f"reports/{MACHINE}")
    expect(seen.page.get_by_role("alert")).to_have_text("this key may not see identifications")
    expect(seen.page.locator(".loading")).to_have_count(0)
