"""Oil films in a real browser: where journals rest in their clearances, and the films' coefficients."""

import math
import re
from typing import Any, Literal

import pytest
from playwright.sync_api import Locator, Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import COUNT
from tests.browser.story import MACHINE, simulate
from tests.end_to_end.processes import Service, until

FILMS = "motor-compressor"
BEARINGS = ("B1", "B2", "B3", "B4")
MIDDLE = "shape => { const box = shape.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; }"
WIDTH = "shape => shape.getBoundingClientRect().width"
NEWEST = re.compile(r"/identifications/\d+$")
REASON = "two bearings share what the data say"


@pytest.fixture(scope="module")
def films(place: Service, serving: object) -> Service:
    """The running service, which has identified a run-up and a run-down of a machine on oil films besides."""
    assert serving
    place.create(FILMS)
    simulate(place, FILMS, cycles=1, rate=1000, wait_s=90)
    until(place.idle, within_s=120, what="both runs are identified")
    return place


def told(service: Service) -> dict[str, dict[str, Any]]:
    """By name what the newest accepted identification says."""
    newest = next(one for one in service.get(f"/machines/{FILMS}/identifications") if one["accepted"])
    found = service.get(f"/identifications/{newest['id']}")
    return {one.get("parameter") or one["name"]: one for one in (*found["estimates"], *found["derived"])}


def panel(seen: Seen) -> Locator:
    """The panel, in sight."""
    seen.open(f"machines/{FILMS}/model")
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Oil films"))
    expect(found).to_be_visible()
    return found


def circle(found: Locator, bearing: str) -> Locator:
    """The drawing of a bearing's clearance."""
    return found.get_by_role("img", name=re.compile(f"^Oil film of bearing {bearing}: "))


def place_of_dot(drawing: Locator) -> tuple[float, float]:
    """Where the journal is drawn, to the right and up, in parts of the clearance."""
    rim = drawing.locator("circle.clearance").first
    (x0, y0), (x, y) = rim.evaluate(MIDDLE), drawing.locator("circle.journal").evaluate(MIDDLE)
    radius = rim.evaluate(WIDTH) / 2
    return (x - x0) / radius, (y0 - y) / radius


def test_journals_are_drawn_where_they_rest(seen: Seen, films: Service) -> None:
    numbers = told(films)
    found = panel(seen)
    for bearing in BEARINGS:
        of = {name: numbers[f"bearing.{bearing}.{name}"]["value"] for name in ("clearance", "journal_x", "journal_y")}
        expected = (of["journal_x"] / of["clearance"], of["journal_y"] / of["clearance"])
        drawn = place_of_dot(circle(found, bearing))
        assert drawn == pytest.approx(expected, abs=0.02)
        assert drawn[0] > 0.1 > -0.1 > drawn[1]  # it sinks, and is dragged along with the rotation
        assert math.hypot(*drawn) == pytest.approx(numbers[f"bearing.{bearing}.eccentricity_ratio"]["value"], abs=0.02)
    assert seen.errors == []


def test_films_are_said_in_numbers_to_those_who_do_not_see(seen: Seen, films: Service) -> None:
    one = told(films)["bearing.B2.journal_x"]
    low, middle, high = (f"{1e6 * one[key]:.1f}" for key in ("lower", "value", "upper"))
    found = panel(seen)
    expect(circle(found, "B2")).to_have_accessible_name(re.compile(f"journal x {middle} µm \\({low} to {high}\\)"))
    row = found.locator("figure").filter(has=seen.page.get_by_text("B2", exact=True)).get_by_role("row", name="Journal x")
    expect(row).to_contain_text(f"{middle} µm")
    expect(row).to_contain_text(f"{low} … {high}")


def test_coefficients_of_the_chosen_bearing_are_drawn_and_read_out(seen: Seen, films: Service) -> None:
    found = panel(seen)
    found.get_by_role("combobox", name="Bearing").select_option("B3")
    expect(seen.page).to_have_url(re.compile("bearing=B3"))
    plot = found.get_by_role("group", name=re.compile("Stiffness of the oil film of bearing B3"))
    until(lambda: plot.locator("canvas").evaluate(COUNT) > 20, within_s=15, what="kxx is drawn")
    value = f"{told(films)['bearing.B3.kxx@4600rpm']['value'] / 1e6:.1f}"
    plot.focus()
    seen.page.keyboard.press("ArrowRight")
    expect(plot.locator(".readout")).to_contain_text(f"4600 rpm: kxx {value}")
    row = found.get_by_role("table").filter(has_text="MN/m").get_by_role("row", name="kxx")
    expect(row.get_by_role("cell").last).to_contain_text(value)


@pytest.mark.usefixtures("films")
def test_what_the_data_do_not_say_has_its_reason(seen: Seen) -> None:
    """Neither a dot nor a point is drawn of it."""
    missing = {"bearing.B2.journal_y", "bearing.B1.kxy@700rpm"}

    def without(route: Route) -> None:
        found = route.fetch().json()
        gone = {"value": None, "lower": None, "upper": None, "reason": REASON}
        found["derived"] = [one | (gone if one["name"] in missing else {}) for one in found["derived"]]
        route.fulfill(json=found)

    seen.page.route(NEWEST, without)
    found = panel(seen)
    expect(circle(found, "B2").locator("circle.clearance")).to_have_count(1)
    expect(circle(found, "B2").locator("circle.journal")).to_have_count(0)
    expect(circle(found, "B3").locator("circle.journal")).to_have_count(1)
    expect(found.get_by_text(f"Journal y: {REASON}")).to_be_visible()
    expect(found.get_by_text(f"kxy at 700 rpm: {REASON}")).to_be_visible()
    expect(found.get_by_role("row", name="kxy").get_by_text("not estimable")).to_be_visible()


@pytest.mark.usefixtures("films")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_films_fit_on_a_phone(phone: Seen, scheme: Literal["light", "dark"]) -> None:
    phone.page.emulate_media(color_scheme=scheme)
    found = panel(phone)
    expect(found.locator(".film svg")).to_have_count(len(BEARINGS))
    expect(found.locator(".plot canvas")).to_have_count(2)
    assert phone.page.evaluate("document.documentElement.scrollWidth") <= 390
    for drawing in found.locator(".film svg, .film table, .film-plots table").all():
        box = drawing.bounding_box()
        assert box is not None
        assert box["x"] + box["width"] <= 390


def test_a_machine_without_films_has_no_such_panel(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_role("heading", name="Coupling loads")).to_be_visible()
    expect(seen.page.get_by_text("The model of identification")).to_be_visible()
    expect(seen.page.get_by_role("heading", name="Oil films")).to_have_count(0)
    assert seen.errors == []
