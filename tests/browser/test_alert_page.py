"""Tests what people do to alerts, and where they are afterwards."""

import re
from datetime import UTC, datetime, timedelta

from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service


def test_an_alert_is_acknowledged_by_keys_and_mouse(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    row = seen.page.locator(".alert-row")
    expect(row.locator(".state")).to_have_text("unacknowledged")
    row.get_by_role("button", name="Acknowledge").focus()
    seen.page.keyboard.press("Enter")
    seen.page.get_by_label("Your name").fill("anna")
    seen.page.get_by_label("Comment").fill("on it")
    seen.page.get_by_role("dialog").get_by_role("button", name="Acknowledge").click()
    expect(row.locator(".state")).to_have_text("acknowledged")
    expect(row.get_by_role("button", name="Acknowledge")).to_have_count(0)
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    assert alert["state"] == "acknowledged"
    last = service.get(f"/alerts/{alert['id']}/events")[-1]
    assert (last["by"], last["comment"]) == ("anna", "on it")
    row.get_by_role("button", name="event").click()
    expect(row.locator(".history")).to_contain_text("on it")
    assert seen.errors == []


def test_the_texts_of_an_alert_follow_the_unit(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    seen.open(f"alerts/{alert['id']}")
    expect(seen.page.get_by_text("Offset in µm and angle in mrad")).to_be_visible()
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_pp,rpm")
    expect(seen.page.get_by_text("Offset in mil and angle in mrad")).to_be_visible()
    seen.page.get_by_label("Units of vibration and speed").select_option("um_pp,rpm")
    expect(seen.page.get_by_text("Offset in µm and angle in mrad")).to_be_visible()
    assert seen.errors == []


def test_after_a_dialog_one_goes_on_where_one_was(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}")
    comment = seen.page.locator(".alert-row").get_by_role("button", name="Comment")
    for leave in ("Escape", "Cancel"):
        comment.focus()
        seen.page.keyboard.press("Enter")
        expect(seen.page.get_by_role("dialog")).to_be_visible()
        if leave == "Escape":
            seen.page.keyboard.press("Escape")
        else:
            seen.page.get_by_role("button", name="Cancel").click()
        expect(seen.page.get_by_role("dialog")).to_have_count(0)
        expect(comment).to_be_focused()


def test_after_a_dialog_whose_button_is_gone_one_is_still_on_the_page(seen: Seen) -> None:
    gone = False

    def answer(route: Route) -> None:
        route.fulfill(json=[] if gone else route.fetch().json())

    seen.page.route(re.compile(r"/alerts\?open=true"), answer)
    seen.open(f"machines/{MACHINE}")
    comment = seen.page.locator(".alert-row").get_by_role("button", name="Comment")
    comment.press("Enter")
    expect(seen.page.get_by_role("dialog")).to_be_visible()
    gone = True  # somebody else has closed it; the list is asked for every ten seconds
    expect(comment).to_have_count(0)
    seen.page.keyboard.press("Escape")
    expect(seen.page.get_by_role("dialog")).to_have_count(0)
    expect(seen.page.locator("main")).to_be_focused()


def test_a_long_history_of_an_alert_says_that_it_is_cut(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    first = service.get(f"/alerts/{alert['id']}/events")[0]
    events = [{**first, "id": number, "kind": "commented", "comment": f"comment {number}"} for number in range(1, 1201)]

    def answer(route: Route) -> None:  # as the service does: the oldest first, a hundred if no limit is set
        limit = re.search(r"limit=(\d+)", route.request.url)
        route.fulfill(json=events[: int(limit.group(1)) if limit else 100])

    seen.page.route(re.compile(rf"/alerts/{alert['id']}/events"), answer)
    seen.open(f"machines/{MACHINE}")
    row = seen.page.locator(".alert-row")
    row.get_by_role("button", name="event").click()
    expect(row.locator(".history li")).to_have_count(1000)
    expect(row.locator(".truncated")).to_have_text("The oldest 1000 are shown; there may be more.")
    del events[150:]
    seen.page.reload()
    row.get_by_role("button", name="event").click()
    expect(row.locator(".history")).to_contain_text("comment 150")
    expect(row.locator(".truncated")).to_have_count(0)
    assert seen.errors == []


def test_what_somebody_else_does_shows_by_itself(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    row = seen.page.locator(".alert-row")
    expect(row).to_be_visible()
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    said = {"by": "otto", "comment": "elsewhere", "until": "2099-01-01T00:00:00Z"}
    answer = service.client.post(f"/alerts/{alert['id']}/shelve", json=said)
    assert answer.status_code in (409, 422), "there is no shelving for ever"
    service.client.post(f"/alerts/{alert['id']}/comments", json={"by": "otto", "comment": "seen it"}).raise_for_status()
    count = service.get(f"/alerts/{alert['id']}")["events"]
    expect(row).to_contain_text(f"{count} events", timeout=3000)


def test_who_comes_second_is_told_who_was_first(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    seen.page.locator(".alert-row").get_by_role("button", name="Shelve").click()
    seen.page.get_by_label("Your name").fill("anna")
    until = (datetime.now(UTC) + timedelta(hours=1)).isoformat()
    said = {"by": "otto", "comment": "his shift", "until": until}
    service.client.post(f"/alerts/{alert['id']}/shelve", json=said, headers={"if-match": "*"}).raise_for_status()
    seen.page.get_by_role("dialog").get_by_role("button", name="Shelve").click()
    expect(seen.page.get_by_role("dialog")).to_contain_text("by otto")
    gone = {"by": "otto", "comment": ""}
    service.client.post(f"/alerts/{alert['id']}/unshelve", json=gone, headers={"if-match": "*"}).raise_for_status()
    (event,) = [one for one in service.get(f"/alerts/{alert['id']}/events") if one["kind"] == "shelved"]
    assert event["by"] == "otto"
