"""The page in a real browser, over a service with real data: it draws, is worked with, follows what happens, survives."""

import math
import re
import signal
import subprocess
import threading
from datetime import UTC, datetime, timedelta
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from tests.browser.conftest import PATIENCE_MS, Seen
from tests.browser.story import CYCLES, MACHINE, simulate
from tests.end_to_end.processes import Service, until

expect.set_options(timeout=PATIENCE_MS)

TERMS = 10
"""Of the coupling: each has a trend."""
WORDS_HEIGHT = """(said) => {
  const words = document.createRange();
  words.selectNodeContents(said);
  return words.getBoundingClientRect().height;
}"""
"""Of a text with all its lines [px], also of those that are cut off."""
TOP = "(canvas) => canvas.getBoundingClientRect().top + scrollY"
"""On the page, wherever it is scrolled to [px]."""
LINE = 18
"""Height of a line of a read-out on a phone [px]."""
SHIFT = 0.1
"""Cumulative layout shift that people do not mind, by web.dev's measure."""

COUNT = """(canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let at = 0; at < data.length; at += 4) if (data[at + 2] - data[at] > 60 && data[at + 3] > 200) count += 1;
  return count;
}"""
"""Opaque bluish pixels: the first curve of a plot is blue, while axes, grid, bands and markers are not."""


def drawn(page: Page) -> list[int]:
    """For every plot how many of its pixels belong to its first curve."""
    found = page.locator(".plot canvas")
    return [canvas.evaluate(COUNT) for canvas in found.all()]


def wait_drawn(page: Page, plots: int) -> None:
    """Wait until there are so many plots and each shows its first curve: axes and grid have no such pixel."""
    expect(page.locator(".plot canvas")).to_have_count(plots)
    until(lambda: all(count > 20 for count in drawn(page)), within_s=15, what=f"all curves are drawn: {drawn(page)}")


def test_fleet_shows_the_machine_and_its_alert(seen: Seen) -> None:
    seen.open()
    row = seen.page.locator(f"tr[data-machine={MACHINE}]")
    expect(row).to_contain_text(re.compile("alert|danger"))
    expect(row).to_contain_text("1 new")
    row.get_by_role("link").click()
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Two-shaft train of the thesis, Chapter 3")
    assert seen.errors == []


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


def test_trends_are_drawn_and_read_out_by_keys(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    names = [one["parameter"] for one in service.get("/identifications/1")["estimates"] if one["element"] == "coupling.C1"]
    wait_drawn(seen.page, len(names))
    plot = seen.page.get_by_role("group", name=re.compile("coupling.C1.kxx over time"))
    plot.focus()
    before = plot.locator(".readout").inner_text()
    assert before.startswith("newest")
    for _ in range(3):
        seen.page.keyboard.press("ArrowLeft")
    expect(plot.locator(".readout")).not_to_have_text(before)
    expect(plot.locator(".readout")).to_contain_text("kN/m")
    assert seen.errors == []


def test_an_alert_is_marked_where_it_was_raised(seen: Seen, service: Service) -> None:
    """Runs that still say so come afterwards."""
    alerts = [one for one in service.get(f"/machines/{MACHINE}/alerts") if one["element"] == "coupling.C1"]
    assert alerts
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    marks = seen.page.locator(".marks li", has_text="measured").locator("time")
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


def trend(seen: Seen) -> Locator:
    """A trend of the coupling, drawn and in sight."""
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    plot = seen.page.get_by_role("group", name=re.compile("coupling.C1.kxx over time"))
    until(
        lambda: plot.locator("canvas").count() == 1 and plot.locator("canvas").evaluate(COUNT) > 20, within_s=15, what="drawn"
    )
    plot.evaluate("plot => plot.scrollIntoView({ block: 'center' })")
    return plot


def point_of(plot: Locator) -> tuple[float, float]:
    """Where one of its points is [px]: the read-out by keys marks it."""
    plot.focus()
    plot.page.keyboard.press("ArrowLeft")
    plane = plot.locator(".u-over").bounding_box()
    assert plane is not None
    for box in [mark.bounding_box() for mark in plot.locator(".u-cursor-pt").all()]:
        if box is not None and box["x"] > plane["x"]:
            return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    raise AssertionError("no point is marked")


def test_words_on_an_unbalance_say_which_of_its_components_they_are_of(seen: Seen, service: Service) -> None:
    name = "disc.D1.unbalance"
    (series,) = service.get(f"/machines/{MACHINE}/trends", parameter=name)["series"]
    quiet = {"value": 0.0, "limit": 5.0, "passed": False, "began": None}
    passed = {"value": 9.0, "limit": 5.0, "passed": True, "began": series["measured_at"][-2]}
    drift = {"per_week": -8.9, "lower": -12.0, "upper": -5.0, "probability": 1e-4, "alert": None, "danger": None}
    tests = [
        {"name": f"{name}.real", "step_up": quiet, "step_down": quiet, "creep": {**passed, "value": -9.0}, "drift": drift},
        {"name": f"{name}.imaginary", "step_up": passed, "step_down": quiet, "creep": quiet, "drift": None},
    ]
    tests = [{"runs": 9, "newest": 1.0, **one} for one in tests]
    answer = {"missing": None, "run_length": 1000, "tests": tests}
    seen.page.route(re.compile("/trend-tests[?]"), lambda route: route.fulfill(json=answer))
    seen.open(f"machines/{MACHINE}/trends?element=disc.D1")
    wait_drawn(seen.page, 2)  # magnitude and angle
    told = seen.page.locator(".told")
    mean = "the mean of its newest runs lies below the baseline"
    weekly = "−8.9 % of the baseline's magnitude a week (−12 … −5.0)"
    expect(told).to_have_text(
        re.compile(re.escape(f"real part: {mean}; real part: {weekly}; imaginary part: a step up, likeliest since "))
    )
    assert told.evaluate("words => words.scrollWidth <= words.clientWidth && words.scrollHeight <= words.clientHeight")
    seen.page.set_viewport_size({"width": 390, "height": 844})
    assert told.evaluate("words => words.scrollWidth <= words.clientWidth && words.scrollHeight <= words.clientHeight")
    plot = seen.page.get_by_role("group", name=re.compile(f"Angle of {name} over time"))
    angle = math.degrees(math.atan2(series["imaginary"][-2], series["real"][-2]))
    plot.press("ArrowLeft")
    expect(plot.locator(".readout")).to_contain_text(f" g·mm at {angle:.1f}°")
    assert seen.errors == []


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
        expect(disc).to_have_attribute("aria-label", "disc D1: not known: there is nothing to compare")
    expect(seen.page.locator(".legend")).to_contain_text("▢ not known")
    assert seen.errors == []


def test_a_click_picks_only_what_it_is_near_to(seen: Seen) -> None:
    plot = trend(seen)
    x, y = point_of(plot)
    plane = plot.locator(".u-over").bounding_box()
    assert plane is not None
    away = 40 if y < plane["y"] + plane["height"] / 2 else -40
    seen.page.mouse.click(x, y + away)
    seen.page.wait_for_timeout(200)
    expect(seen.page).to_have_url(re.compile("/trends"))
    seen.page.mouse.click(x + 5, y)
    expect(seen.page).to_have_url(re.compile("/identified"))
    assert seen.errors == []


def test_a_tap_reads_out_and_a_second_one_picks(phone: Seen) -> None:
    plot = trend(phone)
    x, y = point_of(plot)
    phone.page.keyboard.press("Escape")
    plane = plot.locator(".u-over").bounding_box()
    assert plane is not None
    phone.page.touchscreen.tap(plane["x"] + 8, plane["y"] + plane["height"] / 2)
    elsewhere = plot.locator(".readout").inner_text()
    phone.page.touchscreen.tap(x + 5, y)
    expect(plot.locator(".readout")).not_to_have_text(elsewhere)
    expect(plot.locator(".readout")).to_contain_text("kN/m")
    phone.page.wait_for_timeout(200)
    expect(phone.page).to_have_url(re.compile("/trends"))
    phone.page.touchscreen.tap(x + 5, y)
    expect(phone.page).to_have_url(re.compile("/identified"))
    assert phone.errors == []


def test_fingers_zoom_a_plot_and_scroll_the_page_over_it(phone: Seen) -> None:
    plot = trend(phone)
    canvas = plot.locator("canvas")
    whole = looks(canvas)
    plot.get_by_role("button", name="Zoom in").tap()
    until(lambda: looks(canvas) != whole, within_s=5, what="it zooms in")
    plot.get_by_role("button", name="Zoom out").tap()
    plot.get_by_role("button", name="Zoom out").focus()
    zoomed_out = looks(canvas)
    phone.page.keyboard.press("Enter")
    until(lambda: looks(canvas) != zoomed_out, within_s=5, what="it zooms out by keys too")
    plot.get_by_role("button", name="Show all").tap()
    until(lambda: looks(canvas) == whole, within_s=5, what="it shows all again")
    pinch(plot.locator(".u-over"))
    until(lambda: looks(canvas) != whole, within_s=5, what="two fingers zoom")
    zoomed_in = looks(canvas)
    before = phone.page.evaluate("scrollY")
    swipe(plot.locator(".u-over"))
    until(lambda: phone.page.evaluate("scrollY") > before + 50, within_s=5, what="the page scrolls")
    assert looks(canvas) == zoomed_in
    assert phone.page.evaluate("visualViewport.scale") == 1
    phone.page.emulate_media(media="print")
    expect(plot.get_by_role("button", include_hidden=True)).to_have_count(3)
    for button in plot.get_by_role("button", include_hidden=True).all():
        expect(button).to_be_hidden()
    assert phone.errors == []


@pytest.mark.parametrize("by", ["button", "key", "wheel", "fingers", "drag"])
def test_trends_zoom_together(seen: Seen, phone: Seen, by: str) -> None:
    page = phone if by == "fingers" else seen
    plot = trend(page)
    plots = page.page.locator(".history-plot canvas")
    expect(plots).to_have_count(TERMS)
    until(lambda: all(count > 20 for count in drawn(page.page)), within_s=15, what="all are drawn")
    whole = [looks(canvas) for canvas in plots.all()]
    zoom(plot, by)
    until(
        lambda: all(now != before for now, before in zip(map(looks, plots.all()), whole, strict=True)),
        within_s=5,
        what="all of them are zoomed",
    )
    expect(page.page.locator(".history-plot .uplot[data-zoomed='1']")).to_have_count(TERMS)
    if by == "drag":
        plot.locator(".u-over").dblclick()
    else:
        plot.get_by_role("button", name="Show all").click()
    until(lambda: [looks(canvas) for canvas in plots.all()] == whole, within_s=5, what="all of them show all again")
    expect(page.page.locator(".history-plot .uplot[data-zoomed='1']")).to_have_count(0)
    assert page.errors == []


def zoom(plot: Locator, by: str) -> None:
    """Zoom in on a plot."""
    over, mouse = plot.locator(".u-over"), plot.page.mouse
    box = over.bounding_box()
    assert box is not None
    if by == "button":
        plot.get_by_role("button", name="Zoom in").click()
    elif by == "key":
        plot.press("+")
    elif by == "fingers":
        pinch(over)
    elif by == "wheel":
        over.hover()
        plot.page.keyboard.down("Control")
        mouse.wheel(0, -100)
        plot.page.keyboard.up("Control")
    else:
        mouse.move(box["x"] + 0.3 * box["width"], box["y"] + box["height"] / 2)
        mouse.down()
        mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2, steps=5)
        mouse.up()


def test_enter_picks_the_point_read_out_as_a_click_does(seen: Seen, service: Service) -> None:
    (series,) = service.get(f"/machines/{MACHINE}/trends", parameter="coupling.C1.kxx")["series"]
    plot = trend(seen)
    plot.focus()
    for _ in range(2):
        seen.page.keyboard.press("ArrowLeft")
    plot.get_by_role("button", name="Zoom in").press("Enter")
    expect(plot.locator(".uplot")).to_have_attribute("data-zoomed", "1")
    expect(seen.page).to_have_url(re.compile("/trends"))
    plot.press("Enter")
    expect(seen.page).to_have_url(re.compile(f"/identified.*identification={series['identification'][-3]}$"))
    assert seen.errors == []


EIGHT = ["B1X", "B1Y", "B2X", "B2Y", "B3X", "B3Y", "B4X", "B4Y"]
"""Channels of the machine, all of them."""


@pytest.mark.parametrize(
    ("tab", "lines", "whole"),
    [
        ("trends?element=coupling.C1", 2, r".*: .*\d \(.*\d … .*\d\) [kMG]?N.*, not accepted"),
        (
            f"response?channels={','.join(EIGHT)}",
            2,
            r"\d+ rpm: " + ", ".join(rf"{one} −?[\d.]+" for one in EIGHT) + " [µ°rσ].*",
        ),
        ("model", 1, r"\d[\d ]* rpm: .*\d [kM]?(Hz|N|N·m)"),
    ],
)
def test_on_a_phone_read_outs_are_whole(phone: Seen, tab: str, lines: int, whole: str) -> None:
    """Among them the longest there are: of what was not accepted, and of all channels at once."""

    def not_accepted(route: Route) -> None:
        answer = route.fetch().json()
        for series in answer["series"]:
            series["quality"] = ["not_accepted"] * len(series["quality"])
        route.fulfill(json=answer)

    phone.page.route(re.compile("/trends[?]"), not_accepted)
    phone.open(f"machines/{MACHINE}/{tab}")
    plots = phone.page.locator(".plot:has(canvas)")
    until(lambda: plots.count() > 2, within_s=15, what="they are drawn")
    expect(phone.page.locator(".waiting")).to_have_count(0)
    most = 0
    for plot in plots.all():
        said, canvas = plot.locator(".readout"), plot.locator("canvas")
        plot.focus()
        before = canvas.evaluate(TOP)
        for _ in range(8):
            phone.page.keyboard.press("ArrowLeft")
            expect(said).to_have_text(re.compile(f"^{whole}$"))
            assert canvas.evaluate(TOP) == before, "no plot moves from under the finger"
            box, height = said.bounding_box(), said.evaluate(WORDS_HEIGHT)
            assert box is not None
            assert height <= box["height"], said.inner_text()
            assert box["x"] + box["width"] <= 390
            most = max(most, round(height / LINE))
    assert most >= lines
    phone.picture(f"phone-read-outs-{tab.partition('?')[0]}")
    assert phone.errors == []


def looks(canvas: Locator) -> str:
    """What is drawn, to be compared."""
    return str(canvas.evaluate("canvas => canvas.toDataURL()"))


def pinch(place: Locator) -> None:
    """Two fingers, apart."""
    touches(place, [[(0.45, 0.5), (0.55, 0.5)], [(0.4, 0.5), (0.6, 0.5)], [(0.3, 0.5), (0.7, 0.5)]])


def swipe(place: Locator) -> None:
    """One finger, upwards."""
    touches(place, [[(0.5, 0.9 - 0.1 * step)] for step in range(9)])


def touches(place: Locator, steps: list[list[tuple[float, float]]]) -> None:
    """Fingers at parts of a place, put down, moved and lifted."""
    box = place.bounding_box()
    assert box is not None
    session = place.page.context.new_cdp_session(place.page)
    for number, fingers in enumerate(steps):
        at = [
            {"x": box["x"] + x * box["width"], "y": box["y"] + y * box["height"], "id": id}
            for id, (x, y) in enumerate(fingers)
        ]
        session.send("Input.dispatchTouchEvent", {"type": "touchMove" if number else "touchStart", "touchPoints": at})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    session.detach()


def test_bode_and_polar_show_measurement_fit_and_another_run(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/response")
    wait_drawn(seen.page, 3)  # amplitude, phase, residuals
    seen.page.get_by_role("button", name="Over the oldest of its kind").click()
    expect(seen.page.locator(".polar .faint .dots").first).to_be_attached()
    for path in seen.page.locator(".polar .curve:not(.faint) path:not(.dots)").all():
        assert path.evaluate("path => path.getTotalLength()") > 100
    assert seen.errors == []


@pytest.mark.parametrize(("what", "unit"), [("Amplitude", "µm pp"), ("Phase lag", "° lag")])
def test_bode_plots_read_out_every_channel_at_every_speed(seen: Seen, service: Service, what: str, unit: str) -> None:
    shown = ["B1X", "B2Y", "B3X"]
    run = next(one for one in service.get(f"/machines/{MACHINE}/runs") if one["kind"] == "run-up")
    other = next(one for one in service.get(f"/machines/{MACHINE}/runs") if one["kind"] == "run-down")
    phasors = service.get(f"/runs/{run['id']}/phasors")
    seen.open(f"machines/{MACHINE}/response?run={run['id']}&reference={other['id']}&channels={','.join(shown)}")
    wait_drawn(seen.page, 3)
    plot = seen.page.get_by_role("group", name=re.compile(f"^{what} of"))
    said = plot.locator(".readout")
    number = r"−?\d[\d.]*"
    whole = re.compile(rf"({number}) rpm: " + ", ".join(f"{one} ({number})" for one in shown) + f" {unit}")
    plot.focus()
    read = {}
    for _ in phasors["speed_rpm"][1:]:
        seen.page.keyboard.press("ArrowLeft")
        found = whole.fullmatch(said.inner_text())
        assert found is not None, said.inner_text()
        read[found.group(1)] = [float(one.replace("−", "-")) for one in found.groups()[1:]]
    assert len(read) == len(phasors["speed_rpm"]) - 1, "each key leads to another speed"
    for speed, told in read.items():
        at = min(range(len(phasors["speed_rpm"])), key=lambda one: abs(phasors["speed_rpm"][one] - float(speed)))
        for channel, value in zip(shown, told, strict=True):
            row = phasors["channels"].index(channel)
            true = phasors["amplitude_um_pp" if what == "Amplitude" else "phase_lag_deg"][row][at]
            turns = 0 if what == "Amplitude" else 360 * round((value - true) / 360)
            assert value == pytest.approx(true + turns, rel=6e-3, abs=1)
    plane = plot.locator(".u-over").bounding_box()
    assert plane is not None
    for step in range(100):
        seen.page.mouse.move(plane["x"] + (step + 0.5) / 100 * plane["width"], plane["y"] + plane["height"] / 2)
        assert whole.fullmatch(said.inner_text()), said.inner_text()
    assert seen.errors == []


def test_polar_plots_are_read_out_by_keys(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/response")
    wait_drawn(seen.page, 3)
    plot = seen.page.get_by_role("group", name=re.compile("Polar plot of B1X"))
    said = seen.page.locator(".polar", has=plot).locator("figcaption .muted")
    expect(said).to_contain_text("rings of")
    plot.focus()
    seen.page.keyboard.press("ArrowRight")
    expect(said).to_contain_text(re.compile(r"rpm, .* µm pp, -?\d+° lag"))
    first, at = said.inner_text(), plot.locator(".chosen").bounding_box()
    seen.page.keyboard.press("Shift+ArrowRight")
    expect(said).not_to_have_text(first)
    assert plot.locator(".chosen").bounding_box() != at
    seen.page.keyboard.press("Shift+ArrowLeft")
    expect(said).to_have_text(first)
    seen.page.keyboard.press("ArrowDown")
    expect(said).not_to_have_text(first)
    expect(said).to_contain_text("° lag")
    seen.page.keyboard.press("Escape")
    expect(said).to_contain_text("rings of")
    assert seen.errors == []


def test_correlations_are_read_out_by_keys(seen: Seen, service: Service) -> None:
    found = service.get("/identifications/1/correlation")
    names = found["coordinates"]
    seen.open(f"machines/{MACHINE}/identified?identification=1")
    matrix = seen.page.get_by_role("group", name=re.compile("Correlation of"))
    said = seen.page.locator(".correlation figcaption")
    matrix.focus()
    seen.page.keyboard.press("ArrowRight")
    expect(said).to_have_text(f"{names[0]} and {names[0]}: 1.0")
    seen.page.keyboard.press("ArrowRight")
    seen.page.keyboard.press("ArrowRight")
    seen.page.keyboard.press("ArrowDown")
    expect(said).to_contain_text(f"{names[1]} and {names[2]}: ")
    expect(matrix.locator(".chosen")).to_be_visible()
    for _ in range(len(names) // 10 + 1):
        seen.page.keyboard.press("Shift+ArrowDown")
    expect(said).to_contain_text(f"{names[-1]} and {names[2]}: ")
    seen.page.keyboard.press("Escape")
    expect(matrix.locator(".chosen")).to_have_count(0)
    assert seen.errors == []


def test_orbits_and_mode_shapes_have_a_shape(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/shapes")
    expect(seen.page.locator(".orbits svg").first).to_be_visible()
    expect(seen.page.locator(".modes svg").first).to_be_visible()
    lengths = [path.evaluate("path => path.getTotalLength()") for path in seen.page.locator(".shapes .curve path").all()]
    assert len(lengths) > 4
    assert max(lengths) > 100
    assert seen.errors == []


def test_model_shows_campbell_diagram_and_coupling_forces(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.locator(".plot canvas")).to_have_count(5)  # Campbell; two forces and two moments
    expect(seen.page.get_by_text("in the range").first).to_be_visible()
    until(lambda: drawn(seen.page)[0] > 100, within_s=15, what="the Campbell diagram is drawn")
    assert seen.errors == []


@pytest.mark.parametrize(("tab", "plots"), [("response", 3), ("model", 5)])
def test_axes_of_speed_carry_their_unit(seen: Seen, tab: str, plots: int) -> None:
    seen.page.add_init_script("""window.written = new Map();
    const write = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, ...where) {
      written.set(this.canvas, [...(written.get(this.canvas) ?? []), text]);
      return write.call(this, text, ...where);
    };""")
    seen.open(f"machines/{MACHINE}/{tab}")
    wait_drawn(seen.page, plots) if tab == "response" else expect(seen.page.locator(".plot canvas")).to_have_count(plots)
    written = "(canvas) => written.get(canvas) ?? []"
    for canvas in seen.page.locator(".plot canvas").all():
        until(lambda canvas=canvas: "rpm" in canvas.evaluate(written), within_s=5, what="the axis says rpm")
    assert seen.errors == []


def test_parameters_say_in_words_what_the_data_tell(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}/identified?identification=1")
    found = service.get("/identifications/1")["estimates"]
    known = sum(one["value"] is not None for one in found)
    expect(seen.page.get_by_text(f"{known} of {len(found)} parameters are determined")).to_be_visible()
    assert seen.errors == []


def test_a_comparison_has_units_and_says_what_is_not_determined(seen: Seen, service: Service) -> None:
    found = service.get("/identifications/compare", first=1, second=2)

    def undetermined(route: Route) -> None:
        answer = route.fetch().json()
        for one in answer["changes"]:
            if one["parameter"] == "coupling.C1.kxx":
                one["second"] = one["per_cent"] = one["sigma"] = None
        route.fulfill(json=answer)

    seen.page.route(re.compile("/compare[?]"), undetermined)
    seen.open(f"machines/{MACHINE}/identified?identification=2&against=1")
    rows = seen.page.locator("table.comparison tbody tr")
    expect(rows).to_have_count(len(found["changes"]))
    for row in rows.all():
        cells = [cell.inner_text() for cell in row.locator("td.number").all()][:2]
        assert all(re.fullmatch(r"−?[\d.]+ \S+|not determined", cell) for cell in cells), cells
    (change,) = [one for one in found["changes"] if one["parameter"] == "disc.D1.unbalance.imaginary"]
    unbalance = rows.filter(has_text="disc.D1.unbalance.imaginary").locator("td.number").first
    expect(unbalance).to_have_text(f"{1e6 * change['first']:.0f} g·mm")
    coupling = rows.filter(has_text="coupling.C1.kxx").locator("td.number")
    expect(coupling.nth(1)).to_have_text("not determined")
    assert seen.errors == []


def test_report_prints_on_paper_without_the_frame(seen: Seen) -> None:
    seen.open(f"reports/{MACHINE}")
    expect(seen.page.get_by_text(f"{2 * CYCLES} runs")).to_be_visible()
    expect(seen.page.locator(".history-plot canvas").first).to_be_visible()
    seen.page.emulate_media(media="print", color_scheme="dark")
    expect(seen.page.locator(".bar")).to_be_hidden()
    assert seen.page.evaluate("document.documentElement.dataset.theme") == "light", "ink is dark, paper is not"
    assert seen.page.pdf(format="A4").count(b"/Type /Page\n") >= 1
    assert seen.errors == []


def test_trends_of_an_old_period_are_marked_by_what_was_done_then(seen: Seen) -> None:
    last = datetime.now(UTC).date() - timedelta(days=3)
    first = last - timedelta(days=40)
    done = {"id": 1, "at": f"{last}T00:00:00Z", "kind": "maintenance", "text": "coupling re-shimmed", "by": "anna"}

    def timeline(route: Route) -> None:  # so much was done since that the newest entries do not reach so far back
        period = parse_qs(urlsplit(route.request.url).query)
        route.fulfill(json=[done] if "to" in period and period["to"][0] < f"{last + timedelta(days=2)}" else [])

    seen.page.route(re.compile(r"/timeline\?"), timeline)
    seen.open(f"reports/{MACHINE}?from={first}&to={last}")
    expect(seen.page.locator(".marks").first).to_contain_text("coupling re-shimmed")
    assert seen.errors == []


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("from=x&to=y", ["first day is no date: “x”.", "last day is no date: “y”."]),
        ("from=2026-01-01T00:00:00Z&to=2026-02-01", ["first day is no date: “2026-01-01T00:00:00Z”."]),
        ("from=2026-01-01&to=2026-02-31", ["last day is no date: “2026-02-31”."]),
        ("from=2026-02-02&to=2026-02-01", ["first day lies behind its last."]),
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
    last = (datetime.now(UTC) - timedelta(days=3)).date()
    before = next(
        one
        for one in service.get(f"/machines/{MACHINE}/identifications", to=f"{last}T00:00:00Z")
        if one["scope"] == "run" and one["accepted"]
    )
    seen.open(f"reports/{MACHINE}?to={last}")
    expect(seen.page.get_by_text(f"those of identification {before['id']} ")).to_be_visible()
    expect(seen.page.get_by_text("No alert in this period")).to_be_visible()
    expect(coupling).to_have_class(re.compile("changed|normal"))
    assert seen.errors == []


@pytest.mark.parametrize(
    ("days", "word", "opened", "marked"), [(0, "closed", 0, "changed"), (9, "new", 1, "alert|danger")], ids=["closed", "open"]
)
def test_report_says_an_alert_s_state_at_the_end_of_the_period(
    seen: Seen, service: Service, days: int, word: str, opened: int, marked: str
) -> None:
    at = (datetime.now(UTC) + timedelta(days=days)).isoformat()
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    then = service.get(f"/alerts/{alert['id']}/events")[-1]
    assert then["state"] == "unacknowledged"  # in words: new
    gone = "it is as at the baseline again"
    today = {**alert, "state": "normal", "message": gone, "closed_at": at, "updated_at": at}  # as if it had been closed
    seen.page.route(re.compile(rf"/machines/{MACHINE}/alerts\?limit=1000"), lambda route: route.fulfill(json=[today]))
    seen.open(f"reports/{MACHINE}")
    row = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alerts of the period")).locator("tbody tr")
    expect(row.locator("td").nth(2)).to_have_text(word)
    expect(row.locator("td").nth(5)).to_have_text(then["message"] if opened else gone)
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
    last = (datetime.now(UTC) + timedelta(days=days)).date()
    seen.open(f"reports/{MACHINE}?to={last}")
    row = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alerts of the period")).locator("tbody tr")
    expect(row.locator("td").first).to_contain_text(severity)
    expect(seen.page.locator(".element[data-element='coupling.C1']")).to_have_class(re.compile(rf"\b{severity}\b"))
    expect(seen.page.get_by_text("1 alert, of which 1 open at the end")).to_be_visible()
    assert seen.errors == []


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
        expect(seen.page.locator(".waiting")).to_have_count(0)
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
    """Of an element, across the window [px]."""
    box = element.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2


def test_an_address_that_was_cut_off_still_leads_somewhere(seen: Seen) -> None:
    seen.open("machines/%E0%A4%A")
    expect(seen.page.get_by_role("alert")).to_be_visible()
    seen.page.get_by_role("link", name="Fleet").click()
    expect(seen.page.locator("table.fleet")).to_be_visible()


def test_keys_alone_lead_through_the_page(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".element").first).to_be_visible()
    seen.page.keyboard.press("2")
    expect(seen.page.get_by_role("link", name="Trends")).to_have_attribute("aria-current", "page")
    seen.page.keyboard.press("d")
    expect(seen.page.locator("html")).to_have_attribute("data-theme", "dark")
    seen.page.keyboard.press("?")
    expect(seen.page.get_by_role("dialog", name="Keys")).to_be_visible()
    seen.page.keyboard.press("Escape")
    expect(seen.page.get_by_role("dialog")).to_have_count(0)
    seen.page.keyboard.press("f")
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Fleet")
    assert seen.errors == []


def test_what_comes_late_moves_nothing(seen: Seen) -> None:
    watch = "new PerformanceObserver((list) => { for (const one of list.getEntries()) window.moved += one.value; })"
    seen.page.add_init_script(f"window.moved = 0; {watch}.observe({{ type: 'layout-shift', buffered: true }});")
    for place in ("", f"machines/{MACHINE}", f"machines/{MACHINE}/trends", f"machines/{MACHINE}/response"):
        seen.open(place)
        seen.page.reload()
        expect(seen.page.locator(".waiting")).to_have_count(0)
        assert seen.page.evaluate("window.moved") < SHIFT, place


def test_a_name_that_no_machine_may_have_is_said_to_be_unknown(seen: Seen) -> None:
    for place in ("machines/%00", "reports/%00"):
        seen.open(place)
        expect(seen.page.get_by_role("alert")).to_have_text("There is no machine “%00”.")
    assert seen.errors == []


def test_an_unknown_machine_is_said_to_be_unknown(seen: Seen) -> None:
    seen.open("machines/no-such-machine")
    expect(seen.page.get_by_role("alert")).to_contain_text("no machine no-such-machine")


def test_an_alert_is_acknowledged_by_keys_and_mouse(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    alarm = seen.page.locator(".alarm")
    expect(alarm).to_contain_text("new")
    alarm.get_by_role("button", name="Acknowledge").focus()
    seen.page.keyboard.press("Enter")
    seen.page.get_by_label("Your name").fill("anna")
    seen.page.get_by_label("Comment").fill("on it")
    seen.page.get_by_role("dialog").get_by_role("button", name="Acknowledge").click()
    expect(alarm).to_contain_text("acknowledged")
    expect(alarm.get_by_role("button", name="Acknowledge")).to_have_count(0)
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    assert alert["state"] == "acknowledged"
    last = service.get(f"/alerts/{alert['id']}/events")[-1]
    assert (last["by"], last["comment"]) == ("anna", "on it")
    alarm.get_by_role("button", name="event").click()
    expect(alarm.locator(".history")).to_contain_text("on it")
    assert seen.errors == []


def test_an_older_run_is_shown_and_one_that_is_not_there_is_not_replaced(seen: Seen, service: Service) -> None:
    runs = service.get(f"/machines/{MACHINE}/runs")

    def newest_only(route: Route) -> None:  # as on a machine with more runs than the page lists
        route.fulfill(json=runs[:2])

    seen.page.route(re.compile(r"/runs\?limit="), newest_only)
    oldest = runs[-1]["id"]
    seen.open(f"machines/{MACHINE}/response?run={oldest}")
    expect(seen.page.locator("select").first).to_have_value(str(oldest))
    wait_drawn(seen.page, 3)
    seen.open(f"machines/{MACHINE}/response?run=999999")
    expect(seen.page.get_by_role("alert")).to_contain_text("no run 999999")
    expect(seen.page.locator(".plot canvas")).to_have_count(0)


def test_after_a_dialog_one_goes_on_where_one_was(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}")
    comment = seen.page.locator(".alarm").get_by_role("button", name="Comment")
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
    comment = seen.page.locator(".alarm").get_by_role("button", name="Comment")
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
    alarm = seen.page.locator(".alarm")
    alarm.get_by_role("button", name="event").click()
    expect(alarm.locator(".history li")).to_have_count(1000)
    expect(alarm.locator(".cut")).to_have_text("The oldest 1000 are shown; there may be more.")
    del events[150:]
    seen.page.reload()
    alarm.get_by_role("button", name="event").click()
    expect(alarm.locator(".history")).to_contain_text("comment 150")
    expect(alarm.locator(".cut")).to_have_count(0)
    assert seen.errors == []


def test_what_somebody_else_does_shows_by_itself(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{MACHINE}")
    alarm = seen.page.locator(".alarm")
    expect(alarm).to_be_visible()
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    said = {"by": "otto", "comment": "elsewhere", "until": "2099-01-01T00:00:00Z"}
    answer = service.client.post(f"/alerts/{alert['id']}/shelve", json=said)
    assert answer.status_code in (409, 422), "there is no shelving for ever"
    service.client.post(f"/alerts/{alert['id']}/comments", json={"by": "otto", "comment": "seen it"}).raise_for_status()
    count = service.get(f"/alerts/{alert['id']}")["events"]
    expect(alarm).to_contain_text(f"{count} events", timeout=3000)


SEEN = """Object.defineProperty(document, "hidden", { get: () => window.away === true });
Object.defineProperty(document, "visibilityState", { get: () => (document.hidden ? "hidden" : "visible") });"""
"""A headless browser shows all of its tabs at once; here it can be told that one lies behind another."""
TABS = 8
"""More than the six connections that a browser has to one host over HTTP/1.1."""


SIGNALS = """() => {
  window.signals = [];
  const signal = document.querySelector(".signal");
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
        expect(tabs[-1].locator(".alarm")).to_be_visible()
        expect(tabs[-1].locator(".signal")).to_have_text("● live")
    said = {"by": "otto", "comment": "while you were away"}
    service.client.post(f"/alerts/{alert['id']}/comments", json=said).raise_for_status()
    expect(tabs[-1].locator(".alarm")).to_contain_text(f"{alert['events'] + 1} event", timeout=3000)
    tabs[0].wait_for_timeout(500)
    expect(tabs[0].locator(".alarm")).to_contain_text(f"{alert['events']} event")  # a tab that nobody sees asks nothing
    put(tabs[-1], away=True)
    put(tabs[0], away=False)
    expect(tabs[0].locator(".alarm")).to_contain_text(f"{alert['events'] + 1} event", timeout=3000)
    expect(tabs[0].locator(".signal")).to_have_text("● live")


def test_what_only_waits_is_not_told_as_a_service_that_is_gone(seen: Seen) -> None:
    waiting: list[Route] = []
    seen.page.route(
        re.compile(r"/api/v1/(?!alert-events/stream)"), lambda route: waiting.append(route)
    )  # as without a free connection
    other = seen.page.context.new_page()
    other.goto(f"{seen.base}/#/machines/{MACHINE}")
    expect(other.locator(".alarm")).to_be_visible()
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".signal")).to_have_text("● live")
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


def test_a_maintenance_is_written_down(seen: Seen, service: Service) -> None:
    seen.open("machines/motor-pump")
    seen.page.get_by_role("button", name="Write").click()
    seen.page.get_by_label("Kind").select_option("maintenance")
    seen.page.get_by_label("What", exact=True).fill("coupling re-shimmed")
    seen.page.get_by_label("Your name").fill("anna")
    seen.page.get_by_role("button", name="Write down").click()
    expect(seen.page.locator(".marks")).to_contain_text("coupling re-shimmed")
    (entry,) = service.get("/machines/motor-pump/timeline")
    assert (entry["kind"], entry["by"]) == ("maintenance", "anna")
    assert seen.errors == []


def test_the_page_says_that_the_service_is_gone_and_comes_back_with_it(
    seen: Seen, service: Service, serving: subprocess.Popen[bytes]
) -> None:
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".alarm")).to_be_visible()
    expect(seen.page.locator(".signal")).to_have_text(re.compile("live"))
    serving.send_signal(signal.SIGTERM)
    assert serving.wait(20) == 0
    expect(seen.page.locator(".banner")).to_contain_text("does not answer")
    expect(seen.page.get_by_role("alert")).to_have_count(1)  # said once, not by every panel
    expect(seen.page.locator(".alarm")).to_be_visible()  # what was known stays
    seen.picture("service-gone")
    with service.running():
        expect(seen.page.locator(".banner")).to_have_count(0)
        expect(seen.page.locator(".signal")).to_have_text(re.compile("live"))
        (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
        service.client.post(f"/alerts/{alert['id']}/comments", json={"by": "otto", "comment": "back"}).raise_for_status()
        expect(seen.page.locator(".alarm")).to_contain_text(f"{alert['events'] + 1} events")
