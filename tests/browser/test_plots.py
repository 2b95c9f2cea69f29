"""Plots in a real browser: they are read out, zoomed and picked from, by mouse, keys and fingers."""

import re
from functools import partial

import pytest
from playwright.sync_api import Locator, Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import COUNT, SEEN, SEEN_AGAIN, drawn, looks, pinch, swipe, wait_drawn
from tests.browser.shown_service import MACHINE
from tests.browser.views import show
from tests.end_to_end.processes import Service, until

WORDS_HEIGHT = """(said) => {
  const words = document.createRange();
  words.selectNodeContents(said);
  return words.getBoundingClientRect().height;
}"""
"""Of a text with all its lines [px], also of those that are cut off."""


SPEEDS = """(canvas) => {
  const [left, height] = [64 * devicePixelRatio, 28 * devicePixelRatio];
  const axis = document.createElement("canvas");
  Object.assign(axis, { width: canvas.width - left, height });
  axis.getContext("2d").drawImage(canvas, left, canvas.height - height, axis.width, height, 0, 0, axis.width, height);
  return axis.toDataURL();
}"""
"""Look of the axis below a plot."""
TERMS = 10
"""Of the coupling: each has a trend."""
TOP = "(canvas) => canvas.getBoundingClientRect().top + scrollY"
"""On the page, wherever it is scrolled to [px]."""


LINE = 18
"""Height of a line of a read-out on a phone [px]."""


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
    seen.page.keyboard.press("?")
    expect(seen.page.get_by_role("dialog", name="Keyboard shortcuts")).to_be_visible()
    assert seen.errors == []


@pytest.mark.parametrize("view", ["alert", "overview", "vibration", "trends", "response", "shapes", "model", "parameters"])
def test_every_drawing_can_be_saved_with_its_data(seen: Seen, view: str) -> None:
    show(seen.page, seen.base, view)
    drawings = seen.page.locator(".plot:visible, figure:visible:has(> svg), figure:visible:has(.film svg)")
    assert drawings.count() > 0
    for one in drawings.all():
        expect(one.get_by_role("button", name=re.compile("^Save as (PNG|SVG): "))).to_have_count(1)
        expect(one.get_by_role("button", name=re.compile("^Save the data as CSV: "))).to_have_count(1)


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
    """Return where one of its points is [px]: the read-out by keys marks it."""
    plot.focus()
    plot.page.keyboard.press("ArrowLeft")
    plane = plot.locator(".u-over").bounding_box()
    assert plane is not None
    for box in [mark.bounding_box() for mark in plot.locator(".u-cursor-pt").all()]:
        if box is not None and box["x"] > plane["x"]:
            return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    raise AssertionError("no point is marked")


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
    expect(plot.get_by_role("button", include_hidden=True)).to_have_count(5)
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
            r"\d+ r/min: " + ", ".join(rf"{one} −?[\d.]+" for one in EIGHT) + " [µ°rσ].*",
        ),
        ("model", 1, r"\d[\d\u202f ]* r/min: .*\d [kM]?(Hz|N|N·m)"),
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
    expect(phone.page.locator(".loading")).to_have_count(0)
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
    whole = re.compile(rf"({number}) r/min: " + ", ".join(f"{one} ({number})" for one in shown) + f" {unit}")
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
    seen.open(f"machines/{MACHINE}/response?channels=B1X,B1Y")
    wait_drawn(seen.page, 3)
    plot = seen.page.get_by_role("group", name=re.compile("Polar plot of B1X"))
    said = seen.page.locator(".polar", has=plot).locator("figcaption .muted")
    expect(said).to_contain_text("rings of")
    plot.focus()
    seen.page.keyboard.press("ArrowRight")
    expect(said).to_contain_text(re.compile(r"r/min, .* µm pp, -?\d+° lag"))
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


def words(parameter: str) -> str:
    """A parameter as the page writes it: `disc D1 unbalance, real part` of `disc.D1.unbalance.real`."""
    name, _, component = parameter.partition(".unbalance.")
    said = f"{name} unbalance, {component} part" if component else name
    return said.replace(".", " ").replace("k_phi", "kφ").replace("c_phi", "cφ")


def test_correlations_are_read_out_by_keys(seen: Seen, service: Service) -> None:
    found = service.get("/identifications/1/correlation")
    names = [words(one) for one in found["coordinates"]]
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


def says_unit_of_speed(canvas: Locator) -> bool:
    return "r/min" in canvas.evaluate("(canvas) => written.get(canvas) ?? []")


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
    for canvas in seen.page.locator(".plot canvas").all():
        until(partial(says_unit_of_speed, canvas), within_s=5, what="the axis says r/min")
    assert seen.errors == []


def test_a_thinned_trend_and_its_angle_say_so(seen: Seen) -> None:
    said = seen.page.get_by_text("lowest and highest in each interval, of 4321 points")

    def thinned(route: Route) -> None:  # as of a machine with more runs than a plot has room for
        answer = route.fetch().json()
        series = [one | {"down_sampling": {"method": "min-max-per-bucket", "points": 4321}} for one in answer["series"]]
        route.fulfill(json=answer | {"series": series})

    seen.open(f"machines/{MACHINE}/trends?element=disc.D1")
    wait_drawn(seen.page, 2)
    expect(said).to_have_count(0)
    seen.page.route(re.compile(r"/trends\?"), thinned)
    seen.page.reload()
    wait_drawn(seen.page, 2)
    expect(said).to_have_count(2)
    expect(seen.page.get_by_text("where the magnitude is lowest and highest in each interval, of 4321 points")).to_be_visible()
    assert seen.errors == []


NEXT = 9001
"""An identification that comes while one looks."""


@pytest.mark.parametrize(("tab", "plots"), [("trends", TERMS), ("model", 1)])
def test_what_comes_meanwhile_changes_nothing_that_one_looks_at(seen: Seen, service: Service, tab: str, plots: int) -> None:
    listed = service.get(f"/machines/{MACHINE}/identifications")
    real = next(one for one in listed if one["accepted"] and one["scope"] == "run")
    alerts = service.get(f"/machines/{MACHINE}/alerts")
    alert = {**alerts[0], "id": 9001, "element": "disc.D1", "severity": "alert", "closed_at": None}
    held: list[Route] = []

    def later(route: Route) -> None:
        asked = route.request.url
        if asked.endswith(f"/{NEXT}") or asked.endswith("/campbell"):
            held.append(route)
        else:
            release(route)

    def release(route: Route) -> None:
        found = route.fetch(url=route.request.url.replace(str(NEXT), str(real["id"]))).json()
        route.fulfill(json=found | ({"id": NEXT} if "model" not in route.request.url else {}))

    def is_asked() -> bool:
        seen.page.wait_for_timeout(50)
        return len(held) > 0

    def release_one() -> None:
        until(is_asked, within_s=5, what="the next one is asked for")
        expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(plots)
        release(held.pop())

    seen.page.add_init_script(SEEN)
    seen.open(f"machines/{MACHINE}/{tab}")
    canvas = seen.page.locator(".plot canvas").first
    until(lambda: canvas.count() == 1 and canvas.evaluate(COUNT) > 20, within_s=15, what="drawn")
    expect(seen.page.locator(".loading")).to_have_count(0)
    seen.page.get_by_role("button", name="Zoom in").first.click()
    expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(plots)
    seen.page.route(re.compile(r"/alerts\?limit="), lambda route: route.fulfill(json=[alert, *alerts]))
    seen.page.route(re.compile(r"/identifications\?limit="), lambda route: route.fulfill(json=[real | {"id": NEXT}, *listed]))
    seen.page.route(re.compile(f"/identifications/{NEXT}"), later)
    seen.page.evaluate(SEEN_AGAIN)
    release_one()
    if tab == "model":
        until(is_asked, within_s=5, what="its speeds are asked for")
        busy = {"title": "Service Unavailable", "detail": "computations wait already"}
        held.pop().fulfill(status=503, json=busy, headers={"Retry-After": "1"})
        expect(seen.page.get_by_role("alert")).to_have_text("computations wait already")
        release_one()
        expect(seen.page.get_by_role("alert")).to_have_count(0)
        expect(seen.page.get_by_text(f"The model of identification {NEXT}, ")).to_be_visible()
    else:
        expect(seen.page.get_by_role("button", name="disc D1")).to_contain_text("▲")
        expect(seen.page.get_by_role("heading", name="coupling C1: single runs")).to_be_visible()
    expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(plots)
    if tab == "trends":  # what one chooses is shown whole
        period = seen.page.get_by_role("button", pressed=False).filter(has_text="year").first
        period.click()
        expect(seen.page.locator(".uplot")).to_have_count(plots)
        expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(0)
    assert [one for one in seen.errors if "503" not in one] == []


def test_a_plot_that_comes_later_is_zoomed_as_those_beside_it(seen: Seen) -> None:
    """The run is identified while one looks at it."""
    listed = re.compile(r"/identifications\?from=")
    seen.page.route(listed, lambda route: route.fulfill(json=[]))
    seen.open(f"machines/{MACHINE}/response?channels=B1X,B1Y")
    expect(seen.page.get_by_text("This run has no accepted identification")).to_be_visible()
    wait_drawn(seen.page, 2)
    seen.page.get_by_role("button", name="Zoom in").first.click()
    expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(2)
    seen.page.unroute(listed)
    expect(seen.page.get_by_role("group", name=re.compile("Residuals over speed"))).to_be_visible()
    expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(3)
    wait_drawn(seen.page, 3)
    assert len({canvas.evaluate(SPEEDS) for canvas in seen.page.locator(".uplot[data-zoomed='1'] canvas").all()}) == 1
    seen.page.get_by_role("button", name="Show all").last.click()
    expect(seen.page.locator(".uplot[data-zoomed='1']")).to_have_count(0)
    assert seen.errors == []
