"""Tests what is set in the page: limits, suppressions, subscriptions; and two identifications side by side, in a real
browser."""

import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from playwright.sync_api import Route, expect

from estimator.diagnosis.finding_kind import ELEMENT_LISTS
from service.monitoring.rules.finding_catalogue import ALERT_RULES
from tests.browser.conftest import Seen
from tests.browser.shown_service import MACHINE, day_of
from tests.end_to_end.processes import Service

SETTINGS = f"machines/{MACHINE}/settings"


def test_limits_are_seen_and_changed(seen: Seen, service: Service) -> None:
    seen.open(SETTINGS)
    rule = seen.page.locator("tr[data-rule=bearing]")
    expect(rule).to_contain_text("4 σ, 5 %")
    rule.get_by_role("button").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_role("group", name="alert").get_by_label("change [%]").fill("7.5")
    dialog.get_by_label("Comment").fill("its oil is warm in summer")
    dialog.get_by_label("Your name").fill("anna")
    dialog.get_by_role("button", name="Apply").click()
    expect(dialog).to_have_count(0)
    expect(rule).to_contain_text("4 σ, 7.5 %")
    expect(seen.page.get_by_text("its oil is warm in summer")).to_be_visible()
    found = service.get(f"/machines/{MACHINE}/limits")
    assert (found["limits"]["bearing"]["alert"]["per_cent"], found["by"]) == (7.5, "anna")
    assert found["limits"]["coupling"]["alert"]["per_cent"] == 5
    assert seen.errors == []


def test_limits_that_make_no_sense_are_refused_with_words(seen: Seen, service: Service) -> None:
    before = service.get(f"/machines/{MACHINE}/limits")
    seen.open(SETTINGS)
    seen.page.get_by_role("button", name="Change limits of coupling").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_role("group", name="danger").get_by_label("change [%]").fill("1")
    dialog.get_by_label("Comment").fill("x")
    dialog.get_by_label("Your name").fill("anna")
    dialog.get_by_role("button", name="Apply").click()
    expect(dialog.get_by_role("alert")).to_contain_text("must lie above")
    assert service.get(f"/machines/{MACHINE}/limits") == before


def test_a_suppression_begins_and_ends(seen: Seen, service: Service) -> None:
    seen.open(SETTINGS)
    expect(seen.page.get_by_text("No alert is suppressed or shelved")).to_be_visible()
    seen.page.get_by_role("button", name="Suppress").click()
    dialog = seen.page.get_by_role("dialog")
    elements = dialog.get_by_label("Element")
    document = service.get(f"/machines/{MACHINE}")["document"]
    listed = [f"{kind}.{one['id']}" for kind, part in ELEMENT_LISTS.items() for one in document.get(part) or []]
    assert [one.get_attribute("value") for one in elements.locator("option").all()] == ["", *listed]
    assert "shaft.S1" in listed
    findings = dialog.get_by_label("Finding").locator("option")
    assert findings.evaluate_all("all => all.map((one) => one.value)") == ["", *ALERT_RULES], "those without limits, too"
    elements.select_option("bearing.B1")
    dialog.get_by_label("Comment").fill("its probe is out for calibration")
    dialog.get_by_label("Your name").fill("anna")
    dialog.get_by_role("button", name="Suppress").click()
    table = seen.page.locator("table.suppressions")
    expect(table).to_contain_text("bearing B1")
    (one,) = service.get(f"/machines/{MACHINE}/suppressions")
    assert (one["element"], one["rule"], one["until"], one["by"]) == ("bearing.B1", None, None, "anna")
    table.get_by_role("button", name="End").click()
    seen.page.get_by_role("dialog").get_by_role("button", name="End").click()
    expect(seen.page.get_by_text("No alert is suppressed or shelved")).to_be_visible()
    assert service.get(f"/machines/{MACHINE}/suppressions") == []
    assert service.get(f"/suppressions/{one['id']}")["ended_by"] == "anna"
    assert seen.errors == []


def test_a_subscription_is_added_tried_and_turned_off(seen: Seen, service: Service) -> None:
    seen.open("subscriptions")
    expect(seen.page.get_by_text("nobody is notified")).to_be_visible()
    seen.page.get_by_role("button", name="Add").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_label("Channel").select_option("zenoh")
    dialog.get_by_label("Name").fill("control room")
    dialog.get_by_role("button", name="Add").click()
    one = seen.page.locator(".subscription")
    expect(one).to_contain_text("control room")
    one.get_by_role("button", name="Send a test").click()
    expect(one.get_by_role("status")).to_contain_text("test message delivered")
    one.get_by_role("button", name="deliveries").click()
    expect(one).to_contain_text("No deliveries yet")
    one.get_by_role("button", name="Disable").click()
    expect(one).to_contain_text("disabled")
    (found,) = service.get("/subscriptions")
    assert (found["name"], found["state"]) == ("control room", "disabled")
    one.get_by_role("button", name="Enable").click()
    expect(one.get_by_role("button", name="Disable")).to_be_visible()
    assert seen.errors == []


def test_the_secret_of_a_webhook_is_shown_once(seen: Seen) -> None:
    seen.open("subscriptions")
    seen.page.get_by_role("button", name="Add").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("historian")
    dialog.get_by_label("Address").fill("no address")
    dialog.get_by_role("button", name="Add").click()
    expect(dialog.get_by_role("alert")).to_contain_text("http")
    dialog.get_by_label("Address").fill("https://historian.example/alerts")
    dialog.get_by_role("button", name="Add").click()
    expect(seen.page.locator(".secret code")).to_have_text(re.compile("^whsec_"))
    seen.page.reload()
    expect(seen.page.locator(".subscription", has_text="historian")).to_be_visible()
    expect(seen.page.locator(".secret")).to_have_count(0)


def test_reports_by_mail_are_chosen_and_changed(seen: Seen, service: Service) -> None:
    seen.open("subscriptions")
    seen.page.get_by_role("button", name="Add").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("manager")
    expect(dialog.get_by_label("Reports of its machines")).to_have_count(0)  # a webhook carries none
    dialog.get_by_label("Channel").select_option("email")
    dialog.get_by_label("Address").fill("manager@plant.example")
    dialog.get_by_label("Reports of its machines").select_option("monthly")
    with seen.page.expect_response(re.compile("/subscriptions")):
        pass  # the page behind is refreshed
    seen.page.wait_for_timeout(200)
    expect(dialog.get_by_label("Reports of its machines")).to_have_value("monthly")
    dialog.get_by_role("button", name="Add").click()
    one = seen.page.locator(".subscription", has_text="manager")
    expect(one.get_by_label("Reports as PDF")).to_have_value("monthly")
    one.get_by_label("Reports as PDF").select_option("weekly")
    expect(one.get_by_role("status")).to_contain_text("a report each week")
    (found,) = [each for each in service.get("/subscriptions") if each["name"] == "manager"]
    assert found["reports"] == "weekly"
    assert seen.errors == []


def test_two_identifications_are_compared(seen: Seen, service: Service) -> None:
    found = [one for one in service.get(f"/machines/{MACHINE}/identifications") if one["scope"] == "run"]
    newest, oldest = found[0]["id"], found[-1]["id"]
    seen.open(f"machines/{MACHINE}/identified?identification={newest}")
    seen.page.get_by_label("Compare with").select_option(str(oldest))
    expected = service.get("/identifications/compare", first=oldest, second=newest)
    rows = seen.page.locator("table.comparison tbody tr")
    expect(rows).to_have_count(len(expected["changes"]))
    strongest = max(expected["changes"], key=lambda one: abs(one["sigma"] or 0))
    expect(rows.first).to_contain_text(strongest["parameter"].replace(".", " "))
    assert seen.errors == []


def test_the_correlation_of_estimates_is_drawn_and_read_out(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}/identified?identification=1")
    found = service.get("/identifications/1/correlation")
    picture = seen.page.locator(".correlation svg")
    expect(picture).to_be_visible()
    shown = picture.locator("rect, path").count()
    count = len(found["coordinates"])
    assert count <= shown <= count * count
    picture.hover(position={"x": 2, "y": 2})
    first = found["coordinates"][0].replace(".", " ")
    expect(seen.page.locator(".correlation figcaption")).to_contain_text(f"{first} and {first}: 1.0")
    assert seen.errors == []


def test_a_list_that_is_cut_says_so(seen: Seen, service: Service) -> None:
    (alert,) = service.get("/alerts", limit=1)

    def many(route: Route) -> None:  # as on a plant with a long history
        route.fulfill(json=[alert | {"id": number} for number in range(200)])

    seen.page.route(re.compile(r"/alerts\?"), many)
    seen.open("alerts")
    expect(seen.page.get_by_text("The newest 200 are shown; there may be more.")).to_be_visible()


def test_a_report_of_a_past_period_shows_what_was_identified_then(seen: Seen, service: Service) -> None:
    found = service.get(f"/machines/{MACHINE}/identifications")
    past = [one for one in found if day_of(one["measured_at"]) < day_of(found[0]["measured_at"])]
    assert past, "the scenario is longer than a day"
    day = day_of(past[0]["measured_at"])
    shown = next(one for one in past if one["accepted"] and one["scope"] == "run")
    asked: list[str] = []
    seen.page.on("request", lambda request: asked.append(request.url))
    seen.open(f"reports/{MACHINE}?from=2020-01-01&to={day}")
    expect(seen.page.locator(".elements table").first).to_be_visible()
    assert any(url.endswith(f"/identifications/{shown['id']}") for url in asked)
    assert not any(url.endswith(f"/identifications/{found[0]['id']}") for url in asked)


def test_trends_say_that_alerts_and_marks_are_cut(seen: Seen, service: Service) -> None:
    (alert,) = service.get("/alerts", limit=1)
    note = {"kind": "note", "text": "looked at it", "by": "anna", "at": alert["opened_at"]}
    less = [1]

    def many(one: dict[str, Any], most: int) -> Callable[[Route], None]:  # as of a machine with a long history
        return lambda route: route.fulfill(json=[one | {"id": number} for number in range(most - less[0])])

    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=200"), many(alert, 200))
    seen.page.route(re.compile(rf"/machines/{MACHINE}/timeline\?limit=1000"), many(note, 1000))
    seen.open(f"machines/{MACHINE}/trends")
    alerts = seen.page.get_by_text("The newest 200 alerts of the machine are shown; there may be more.")
    marks = seen.page.get_by_text("The newest 1000 entries of the timeline are shown; there may be more.")
    expect(seen.page.locator(".history-plot canvas").first).to_be_visible()
    expect(alerts.or_(marks)).to_have_count(0)
    less[0] = 0
    seen.page.reload()
    expect(alerts).to_be_visible()
    expect(marks).to_be_visible()


def test_since_when_a_subscription_is_disabled_is_not_made_up(seen: Seen) -> None:
    """The API tells when it was added only."""
    added = {"kind": "email", "name": "shift", "target": "shift@example.org", "created_at": "2026-01-02T03:04:05Z"}
    states = [{"id": 901, "state": "disabled", "reason": "it bounced"}, {"id": 902, "state": "active", "reason": None}]
    seen.page.route(re.compile(r"/subscriptions\?"), lambda route: route.fulfill(json=[added | one for one in states]))
    seen.open("subscriptions")
    said = seen.page.locator(".subscription > p:not(.buttons)")
    expect(said).to_have_text([re.compile(r"^✕ disabled: it bounced; added \S"), re.compile(r"^active; added \S")])
    assert seen.errors == []


def test_what_was_undone_meanwhile_is_done_again(seen: Seen, service: Service) -> None:
    said = {"kind": "zenoh", "name": "night shift", "target": ""}
    added = service.client.post("/subscriptions", json=said).raise_for_status().json()["id"]
    lost: list[Route] = []

    def unanswered(route: Route) -> None:
        if lost:
            route.continue_()
        else:
            lost.append(route)
            route.fetch()  # it is carried out
            route.abort()

    seen.page.route(re.compile("/disable$"), unanswered)
    seen.open("subscriptions")
    one = seen.page.locator(f"[data-subscription='{added}']")
    for button, becomes in (("Disable", "Enable"), ("Enable", "Disable"), ("Disable", "Enable")):
        one.get_by_role("button", name=button).click()
        expect(one.get_by_role("button", name=becomes)).to_be_visible()
    assert len(lost) == 1
    assert service.get(f"/subscriptions/{added}")["state"] == "disabled"


@pytest.mark.parametrize("status", [None, 502])
def test_what_is_asked_again_after_no_answer_came_is_done_once(seen: Seen, service: Service, status: int | None) -> None:
    before = service.get(f"/machines/{MACHINE}/timeline")
    asked: list[str | None] = []

    def unanswered(route: Route) -> None:
        if route.request.method != "POST":
            route.continue_()
            return
        asked.append(route.request.header_value("idempotency-key"))
        if len(asked) > 1:
            route.continue_()
        else:
            route.fetch()  # it is carried out
            if status is None:
                route.abort()
            else:  # of a proxy
                route.fulfill(status=status)

    seen.page.route(re.compile("/timeline"), unanswered)
    seen.open(f"machines/{MACHINE}")
    seen.page.get_by_role("button", name="Add").click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_label("Text", exact=True).fill("oil changed")
    dialog.get_by_label("Your name").fill("anna")
    seen.page.clock.set_fixed_time(datetime.now(UTC) + timedelta(minutes=5))  # what nobody chose stays as it was
    dialog.get_by_role("button", name="Add").click()
    expect(dialog.get_by_role("alert")).to_be_visible()
    dialog.get_by_role("button", name="Add").click()
    expect(dialog).to_have_count(0)
    assert asked[0] is not None
    assert asked == [asked[0]] * 2
    assert len(service.get(f"/machines/{MACHINE}/timeline")) == len(before) + 1
