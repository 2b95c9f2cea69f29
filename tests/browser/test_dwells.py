"""A run of dwells in a real browser: made of a time, shown, identified, balanced with; not by viewers."""

import re
from datetime import datetime, timedelta

from playwright.sync_api import expect

from tests.browser.conftest import Seen
from tests.browser.shown_service import MACHINE, ZONE
from tests.end_to_end.processes import Service

NO_CURVE = "This run has no accepted identification"
LAST_OF_A_MINUTE = 59.999999
"""Seconds after which a time is written as the next whole minute, unless it is one."""


def _minute(moment: str, *, later_s: float = 0.0) -> str:
    """A time of the API as people write it there, and later by some seconds."""
    return f"{datetime.fromisoformat(moment).astimezone(ZONE) + timedelta(seconds=later_s):%Y-%m-%d %H:%M}"


def test_a_run_is_made_of_dwells_and_identified(seen: Seen, service: Service) -> None:
    swept = service.get(f"/machines/{MACHINE}/runs")[0]
    newest = service.get(f"/machines/{MACHINE}/state")["newest_sample_at"]
    seen.open(f"machines/{MACHINE}")
    seen.page.get_by_role("button", name="Run of dwells …").click()
    dialog = seen.page.get_by_role("dialog")
    first, last = dialog.get_by_label("First time"), dialog.get_by_label("Last time")
    expect(last).to_have_value(_minute(newest, later_s=LAST_OF_A_MINUTE))
    expect(first).to_have_value(_minute(newest, later_s=LAST_OF_A_MINUTE - 3600))
    dialog.get_by_label("Your name").fill("anna")
    make = dialog.get_by_role("button", name="Make", exact=True)
    first.fill("2001-01-01 10:00")
    last.fill("2001-01-01 11:00")
    make.click()
    expect(dialog.get_by_role("alert")).to_contain_text("has no samples in that time within its speed range")
    first.fill(_minute(swept["started_at"]))
    last.fill(_minute(swept["ended_at"], later_s=LAST_OF_A_MINUTE))
    make.click()
    expect(dialog).to_have_count(0)
    made = next(one for one in service.get(f"/machines/{MACHINE}/runs") if one["kind"] == "dwells")
    expect(seen.page).to_have_url(re.compile(rf"/response\?run={made['id']}$"))
    expect(seen.page.locator(".choices select").first).to_have_value(str(made["id"]))
    expect(seen.page.get_by_text(NO_CURVE).first).to_be_visible()
    seen.page.get_by_role("button", name=f"Identify run {made['id']}").click()
    dialog.get_by_role("button", name="Identify", exact=True).click()
    expect(dialog).to_have_count(0)
    expect(seen.page.get_by_text(NO_CURVE)).to_have_count(0)
    found = next(one for one in service.get(f"/machines/{MACHINE}/identifications") if one["runs"] == [made["id"]])
    assert (found["scope"], found["accepted"]) == ("variant", True)
    seen.picture("run-of-dwells")
    seen.open(f"machines/{MACHINE}/identified?identification={found['id']}")
    chosen = seen.page.locator(".choices select").first.locator("option:checked")
    expect(chosen).to_have_text(re.compile(rf"{found['id']} dwells, .*, variant$"))
    seen.open(f"machines/{MACHINE}/balancing")
    seen.page.get_by_text("Show balancing all the same").click()
    seen.page.get_by_role("button", name="Begin …").click()
    dialog.get_by_label("Run without trial weights").select_option(str(made["id"]))
    assert [one for one in seen.errors if "422" not in one] == []


def test_who_may_only_look_is_offered_neither(seen: Seen) -> None:
    seen.page.route(
        "**/api/v1/me", lambda route: route.fulfill(json={"name": "vi", "role": "viewer", "plants": None, "kind": "key"})
    )
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.get_by_role("heading", name="Newest runs")).to_be_visible()
    expect(seen.page.get_by_role("cell", name="run-down").first).to_be_visible()
    expect(seen.page.get_by_role("button", name=re.compile("dwells|Identify"))).to_have_count(0)
