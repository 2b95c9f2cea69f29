"""Waiting for what the service computes first: the page says so and for how long, and does not call it a failure."""

import re

from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.copied_machine import create_copy
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service, example

HURRIED = """const wait = AbortSignal.timeout.bind(AbortSignal);
AbortSignal.timeout = (ms) => wait(ms === 20000 ? 1000 : ms);"""
"""The twenty seconds that the page waits for what is only read, shortened; what is computed may take as long as before."""
LATER = """const began = Date.now(), now = Date.now.bind(Date);
Date.now = () => now() + (now() - began > 1500 ? 30000 : 0);"""
"""A clock that half a minute has passed on, from some moment."""
MODEL = re.compile(r"/identifications/\d+/(model/|bode)|/alignment")
STABILITY = re.compile("/stability$")
CAMPBELL = re.compile("/model/campbell")
BUSY = {"type": "about:blank", "title": "Service Unavailable", "status": 503, "detail": "32 wait already; ask again"}


def test_a_model_that_takes_long_is_being_computed_and_comes(seen: Seen) -> None:
    held: list[Route] = []
    seen.page.add_init_script(HURRIED)
    seen.page.route(CAMPBELL, lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}/model")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Campbell diagram"))
    expect(panel.get_by_text(re.compile(r"^Being computed, [4-9] s"))).to_be_visible()  # longer than what is read may take
    expect(panel.get_by_role("progressbar")).to_be_visible()
    expect(seen.page.get_by_role("alert")).to_have_count(0)
    expect(seen.page.locator(".connection-state")).to_have_text("● live")
    assert len(held) == 1, "it is asked for once, not again and again"
    held[0].continue_()
    expect(panel.locator("canvas")).to_be_visible()
    assert seen.errors == []


def test_after_some_time_it_says_what_takes_so_long(seen: Seen) -> None:
    held: list[Route] = []
    seen.page.add_init_script(LATER)
    seen.page.route(CAMPBELL, lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_text(re.compile(r"^Being computed, 3\d s\. Models of long trains"))).to_be_visible()
    held[0].continue_()
    expect(seen.page.locator(".loading")).to_have_count(0)


def test_computations_leave_connections_for_everything_else(seen: Seen) -> None:
    held: list[Route] = []
    seen.page.route(MODEL, lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}/model")
    seen.page.wait_for_timeout(3000)
    assert len(held) == 3, "a browser has six connections; one holds the events"
    held[0].continue_()
    seen.page.wait_for_timeout(1000)
    assert len(held) == 4, "the next one has its turn"
    for one in held[1:]:
        one.continue_()
    seen.page.unroute_all()
    expect(seen.page.locator(".loading")).to_have_count(0)
    assert seen.errors == []


def test_who_goes_on_does_not_wait_behind_what_was_left(seen: Seen) -> None:
    held: list[Route] = []
    seen.page.route(MODEL, lambda route: held.append(route))
    seen.open(f"machines/{MACHINE}/model")
    seen.page.wait_for_timeout(3000)
    assert len(held) == 3
    seen.page.unroute_all()
    seen.open(f"machines/{MACHINE}/response")
    expect(seen.page.locator(".plot canvas").first).to_be_visible()
    expect(seen.page.locator(".loading")).to_have_count(0)
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_role("heading", name="Campbell diagram")).to_be_visible()
    expect(seen.page.locator(".loading")).to_have_count(0)
    expect(seen.page.get_by_role("alert")).to_have_count(0)


def test_a_service_with_too_much_to_compute_is_asked_again(seen: Seen) -> None:
    seen.page.route(CAMPBELL, lambda route: route.fulfill(status=503, json=BUSY, headers={"retry-after": "2"}))
    seen.open(f"machines/{MACHINE}/model")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Campbell diagram"))
    expect(panel.get_by_role("alert")).to_contain_text("32 wait already")
    seen.page.unroute_all()
    expect(panel.locator("canvas")).to_be_visible()


def test_whether_a_train_would_whirl_is_computed_beside_its_page(seen: Seen, service: Service) -> None:
    bearings = [one | {"kxy": 3.0 * one["kxx"], "kyx": -3.0 * one["kxx"]} for one in example(MACHINE)["bearings"]]
    create_copy(service, "unstable", "Train that would whirl", bearings=bearings)
    held: list[Route] = []
    seen.page.route(STABILITY, lambda route: held.append(route))
    seen.open("machines/unstable")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Warnings of the document"))
    expect(panel).to_contain_text("Whether the train would whirl, or a journal touch its bearing")
    expect(panel.get_by_role("progressbar")).to_be_visible()
    held[0].continue_()
    expect(panel.get_by_role("listitem")).to_contain_text(re.compile(r"^bearings: at \d+ r/min a mode would grow"))
    expect(panel.get_by_role("progressbar")).to_have_count(0)
    seen.page.unroute_all()
    seen.page.get_by_label("Language of the page").select_option("de")
    said = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Warnungen des Dokuments"))
    expect(said.get_by_role("listitem")).to_contain_text("würde eine Mode aufklingen (Dämpfungsgrad -")
    expect(said.get_by_role("listitem")).to_contain_text("stimmen Dämpfung und Kreuzsteifigkeit?")
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.get_by_role("heading", name="Offene Alarme")).to_be_visible()
    expect(seen.page.locator(".loading")).to_have_count(0)
    expect(said).to_have_count(0)
    assert seen.errors == []
