"""Oil films in a real browser: where journals rest in their clearances, and the films' coefficients."""

import csv
import math
import re
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, Locator, Route, expect

from tests.browser.conftest import PICTURES, Seen
from tests.browser.drawing import COUNT
from tests.browser.levels import FILMS, add_films
from tests.browser.shown_service import MACHINE, ZONE
from tests.browser.test_german import ENGLISH_WORDS, said
from tests.browser.views import show
from tests.end_to_end.processes import Service, until

BEARINGS = ("B1", "B2", "B3", "B4")
MIDDLE = "shape => { const box = shape.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; }"
WIDTH = "shape => shape.getBoundingClientRect().width"
NEWEST = re.compile(r"/identifications/\d+$")
REASON = "two bearings share what the data say"
PAPER = 688
"""Width of A4 less its margins [px]."""


@pytest.fixture(scope="module")
def films(place: Service, serving: object) -> Service:
    """The running service, which has identified a run-up and a run-down of a machine on oil films besides."""
    assert serving
    add_films(place)
    return place


def told(service: Service) -> dict[str, dict[str, Any]]:
    """Return what the newest accepted identification reports, by name."""
    newest = next(one for one in service.get(f"/machines/{FILMS}/identifications") if one["accepted"])
    found = service.get(f"/identifications/{newest['id']}")
    return {one.get("parameter") or one["name"]: one for one in (*found["estimates"], *found["derived"])}


def panel(seen: Seen, shown_at: str = f"machines/{FILMS}/model") -> Locator:
    """The panel, in sight."""
    seen.open(shown_at)
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Oil films"))
    expect(found).to_be_visible()
    return found


def circle(found: Locator, bearing: str) -> Locator:
    """The drawing of a bearing's clearance."""
    return found.get_by_role("img", name=re.compile(f"^Oil film of bearing {bearing}: "))


def place_of_dot(drawing: Locator) -> tuple[float, float]:
    """Return where the journal is drawn, to the right and up, in parts of the clearance."""
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
    expect(plot.locator(".readout")).to_contain_text(f"4600 r/min: kxx {value}")
    row = found.get_by_role("table").filter(has_text="MN/m").get_by_role("row", name="kxx")
    expect(row.get_by_role("cell").last).to_contain_text(value)


def test_the_measured_centreline_is_drawn_beside_the_models(seen: Seen, films: Service, tmp_path: Path) -> None:
    newest = next(one for one in films.get(f"/machines/{FILMS}/identifications") if one["accepted"])
    lines = films.get(f"/identifications/{newest['id']}/model/centreline")
    (measured,) = lines["measured"]
    seen.open(f"machines/{FILMS}/model")
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Shaft centreline"))
    expect(found.get_by_text(f"gaps of run {measured['run']}")).to_be_visible()
    expect(found.get_by_text("Each probe's zero is set by the model")).to_be_visible()
    for one in lines["bearings"]:
        drawing = found.get_by_role("img", name=f"Shaft centreline in bearing {one['bearing']}: model from")
        expect(drawing.locator("path.dots")).to_have_count(1)
        expect(drawing.locator("circle.clearance")).to_have_count(1)
    with seen.page.expect_download() as download:
        found.get_by_role("button", name="Save the data as CSV: Shaft centreline in bearing B1").click()
    download.value.save_as(tmp_path / "line.csv")
    head, *rows = csv.reader((tmp_path / "line.csv").read_text().splitlines())
    assert head == ["line", "speed [r/min]", "x [µm]", "y [µm]"]
    (own,) = [one for one in measured["bearings"] if one["bearing"] == "B1"]
    assert sum(row[0] != "model" for row in rows) == sum(
        None not in pair for pair in zip(own["x_um"], own["y_um"], strict=True)
    )
    assert seen.errors == []


def test_the_centreline_of_an_earlier_identification_is_laid_over(seen: Seen, films: Service) -> None:
    accepted = [one["id"] for one in films.get(f"/machines/{FILMS}/identifications") if one["accepted"]]
    newest, earlier = accepted[0], accepted[-1]
    assert newest != earlier
    seen.open(f"machines/{FILMS}/model")
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Shaft centreline"))
    drawing = found.get_by_role("img", name="Shaft centreline in bearing B1: model from")
    expect(drawing.locator("path.dots")).to_have_count(1)
    found.get_by_label("Overlay").select_option(str(earlier))
    expect(drawing.locator("path.dots")).to_have_count(2)
    expect(found.get_by_text(f"model, identification {earlier}")).to_be_visible()
    expect(seen.page).to_have_url(re.compile(f"overlay={earlier}"))
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_pp,hz")
    expect(found.get_by_text("radial clearance").first).to_contain_text(" mil")
    oil = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Oil films"))
    expect(oil.locator("tr", has_text="Journal x").first).to_contain_text(" mil")
    expect(oil).not_to_contain_text("µm")
    expect(found).not_to_contain_text("µm")
    seen.page.get_by_label("Units of vibration and speed").select_option("um_pp,rpm")
    assert seen.errors == []


def test_alignment_of_the_coupling_is_reported_with_what_is_known_of_its_change(seen: Seen, films: Service) -> None:
    """Of a machine whose baseline is not complete nothing has changed yet, which is said."""
    told = films.get(f"/machines/{FILMS}/alignment")
    seen.open(f"machines/{FILMS}/model")
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alignment of couplings"))
    expect(found.get_by_text(f"No change against a baseline: {told['missing']}.")).to_be_visible()
    assert len(told["numbers"]) == 4
    for one in told["numbers"]:
        quantity = one["quantity"].replace("_", ", ").capitalize()
        row = found.get_by_role("row", name=f"{one['coupling']} {quantity}")
        value = one["absolute"]["value"]
        expect(row).to_contain_text("not determined: " + one["absolute"]["reason"] if value is None else "µ")
        assert one["change"] is None
    assert seen.errors == []


def test_alignment_and_loads_against_a_baseline_follow_the_unit(seen: Seen, films: Service) -> None:
    """The machine's own numbers, with changes as a complete baseline gives them."""
    change = {"value": 254e-6, "lower": 203.2e-6, "upper": 304.8e-6, "reason": None}
    load = {"bearing": "B2", "unit": "N", "before": 5000.0}
    loads = [
        load
        | {"name": "bearing.B2.load_vertical", "quantity": "load_vertical", "change_per_cent": 7.2}
        | {"change": {"value": 360.0, "lower": 300.0, "upper": 420.0, "reason": None}},
        load
        | {"name": "bearing.B2.load_horizontal", "quantity": "load_horizontal", "change_per_cent": None}
        | {"change": {"value": None, "lower": None, "upper": None, "reason": REASON}},
    ]
    told = films.get(f"/machines/{FILMS}/alignment")

    def compared(route: Route) -> None:
        both = zip(told["numbers"], (1.0, 0.957), strict=False)
        numbers = [one | {"change": change, "allowed": 50.8e-6, "beyond": beyond} for one, beyond in both]
        route.fulfill(json=told | {"missing": None, "numbers": numbers, "loads": loads})

    seen.page.route(re.compile("/alignment"), compared)
    seen.open(f"machines/{FILMS}/model")
    found = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Alignment of couplings"))
    rows = found.get_by_role("table").nth(1).get_by_role("row")
    expect(rows).to_have_count(3)
    expect(rows.nth(1)).to_contain_text(re.compile(r"^B2Load, vertical5000 N360 N \(7\.20 %\)\s*300 … 420$"))
    expect(rows.nth(2)).to_contain_text(f"not determined: {REASON}")
    expect(found).to_contain_text("254 µm")
    for chance in ("over 99 %", "96 %"):
        expect(found).to_contain_text(f"exceeded with {chance}")
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_pp,rpm")
    expect(found).to_contain_text(re.compile(r"10\.0 mil\s*8\.00 … 12\.0"))
    expect(found).to_contain_text("2.00 mil")
    expect(found).not_to_contain_text("µm")
    assert seen.errors == []


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
    expect(found.get_by_text(f"kxy at 700 r/min: {REASON}")).to_be_visible()
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


def test_a_report_prints_the_films_of_all_bearings_uncut(seen: Seen, films: Service) -> None:
    numbers = told(films)
    found = panel(seen, f"reports/{FILMS}")
    expect(found.locator(".plot canvas")).to_have_count(2 * len(BEARINGS))
    until(lambda: all(one.evaluate(COUNT) > 20 for one in found.locator("canvas").all()), within_s=15, what="all is drawn")
    seen.page.emulate_media(media="print")
    seen.page.set_viewport_size({"width": PAPER, "height": 1000})
    expect(found.get_by_role("combobox")).to_have_count(0)
    for bearing in BEARINGS:
        expect(circle(found, bearing).locator("circle.journal")).to_be_visible()
        viscosity = f"{1e3 * numbers[f'bearing.{bearing}.viscosity']['value']:#.3g} mPa·s"
        figure = circle(found, bearing).locator("..")
        for name in ("Radial clearance", "Eccentricity ratio", "Load, vertical", f"Viscosity {viscosity}"):
            expect(figure.get_by_role("row", name=name)).to_contain_text("…")
        plotted = found.locator(".film-plots", has_text=f"{bearing} Stiffness").get_by_role(
            "row", name=re.compile("^[kc][xy]{2} ")
        )
        expect(plotted).to_have_count(8)
    for one in found.locator("svg, table, canvas").all():
        box = one.bounding_box()
        assert box is not None
        assert -0.5 <= box["x"] < box["x"] + box["width"] <= PAPER + 0.5
    PICTURES.mkdir(parents=True, exist_ok=True)
    seen.page.pdf(format="A4", path=PICTURES / "report-of-films.pdf")
    assert seen.errors == []


def test_films_of_one_oil_supply_have_its_factor(seen: Seen, films: Service) -> None:
    """In place of a viscosity each."""
    del films

    def supplied(route: Route) -> None:
        found = route.fetch().json()
        for one in found["document"]["bearings"]:
            one["film"]["oil"]["supply"] = "main"
        route.fulfill(json=found)

    def factor(route: Route) -> None:
        found = route.fetch().json()
        viscosity = next(one for one in found["estimates"] if one["parameter"] == "bearing.B1.viscosity")
        shared = {"parameter": "oil.main.viscosity_factor", "element": "oil.main", "quantity": "scale factor", "unit": "1"}
        found["estimates"] = [one for one in found["estimates"] if not one["parameter"].endswith(".viscosity")]
        found["estimates"].append(viscosity | shared | {"value": 1.04, "lower": 0.97, "upper": 1.11})
        route.fulfill(json=found)

    seen.page.route(re.compile(rf"/machines/{FILMS}$"), supplied)
    seen.page.route(NEWEST, factor)
    rows = panel(seen).get_by_role("row", name="Viscosity factor of oil main")
    expect(rows).to_have_count(len(BEARINGS))
    expect(rows.first).to_contain_text("1.04 0.970 … 1.11")
    assert seen.errors == []


def test_a_machine_without_films_has_no_such_panel(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_role("heading", name="Coupling loads")).to_be_visible()
    expect(seen.page.get_by_text("The model of identification")).to_be_visible()
    expect(seen.page.get_by_role("heading", name="Oil films")).to_have_count(0)
    assert seen.errors == []


def test_the_model_of_a_train_on_films_has_no_english_left_in_german(browser: Browser, films: Service) -> None:
    context = browser.new_context(locale="de-DE", timezone_id=ZONE.key)
    page = context.new_page()
    show(page, f"http://127.0.0.1:{films.port}", "films", views={"films": (f"machines/{FILMS}/model", ".films svg")})
    expect(page.locator("main")).to_contain_text("Ausrichtung der Kupplungen")
    found = [one for one in said(page) if ENGLISH_WORDS.search(one) and "Motor and compressor" not in one]
    context.close()
    assert found == []
