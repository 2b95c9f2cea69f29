"""A machine whose source sends the 2× and whose document names limits: what is measured is seen, saved and compared."""

import csv
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import wait_drawn
from tests.browser.levels import COPY, GAP_UM, OVERALL_PART, SECOND_PART, add_copy
from tests.browser.shown_service import MACHINE
from tests.browser.views import show
from tests.end_to_end.processes import Service


@pytest.fixture(scope="module")
def place(place: Service) -> Service:
    """The same service, with a copy of its machine whose source sends a 2× and, in a batch of its own, times in ms."""
    with place.running():
        sent = add_copy(place)
        wrong = sent | {"epoch": 2, "time_ns": [time // 1_000_000 for time in sent["time_ns"]]}
        assert place.client.post(f"/machines/{COPY}/samples", json=wrong).status_code == 422
    return place


def test_bars_stand_beside_the_train_with_the_limits(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{COPY}")
    newest = {one["channel"]: one for one in service.get(f"/machines/{COPY}/vibration")["probes"]}
    bars = seen.page.locator(".vibration-bars li")
    expect(bars).to_have_count(len(newest))
    first = seen.page.locator(".vibration-bars li[data-channel=B1X]")
    expect(first).to_contain_text("1× ")
    expect(first).to_contain_text("2× ")
    assert float(newest["B1X"]["second"]["amplitude_um_pp"]) == pytest.approx(
        SECOND_PART * newest["B1X"]["first"]["amplitude_um_pp"]
    )
    assert newest["B1X"]["overall_um_pp"] == pytest.approx(OVERALL_PART * newest["B1X"]["first"]["amplitude_um_pp"])
    expect(first).to_contain_text("overall ")
    expect(first.locator(".limit")).to_have_count(2)
    expect(first.locator(".boundary")).to_have_count(3)
    distance = GAP_UM - 0.5 * newest["B1X"]["first"]["amplitude_um_pp"]
    expect(first.locator(".gap-of")).to_contain_text(f"gap −{int(distance)}")
    expect(seen.page.get_by_text("from a contract made up for this test: A/B 200, B/C 400, C/D 2000 µm pp")).to_be_visible()
    expect(seen.page.get_by_text("Limits of the 1×: alert 400 µm pp, danger 4000 µm pp")).to_be_visible()
    assert seen.errors == []


def test_bars_are_saved_as_a_picture_and_as_data(seen: Seen, tmp_path: Path) -> None:
    seen.open(f"machines/{COPY}/vibration")
    for kind, name in (
        ("svg", "Save as SVG: Vibration at the probes"),
        ("csv", "Save the data as CSV: Vibration at the probes"),
    ):
        with seen.page.expect_download() as download:
            seen.page.get_by_role("button", name=name).click()
        download.value.save_as(tmp_path / f"bars.{kind}")
    picture = ElementTree.parse(tmp_path / "bars.svg").getroot()
    said = [one.text for one in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert "B1X" in said
    assert any(one and one.startswith("1× ") and "overall" in one for one in said)
    channels = len((tmp_path / "bars.csv").read_text().splitlines()) - 1
    assert len(list(picture.iter("{http://www.w3.org/2000/svg}rect"))) == 1 + 3 * channels
    assert len(list(picture.iter("{http://www.w3.org/2000/svg}path"))) == 2 + 3, "limits, and boundaries of zones"
    assert seen.errors == []


def test_units_are_changed_everywhere_and_kept(seen: Seen) -> None:
    seen.open(f"machines/{COPY}")
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_p,hz")
    expect(seen.page.get_by_text("Limits of the 1×: alert 7.87 mil 0-pk")).to_be_visible()
    seen.open(f"machines/{COPY}/vibration")
    seen.page.reload()
    expect(seen.page.locator(".told").first).to_contain_text("mil 0-pk")
    expect(seen.page.locator("main")).not_to_contain_text("µm pp")
    expect(seen.page.locator(".polar figcaption").first).to_contain_text("mil 0-pk")
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_role("heading", name="Critical speeds")).to_be_visible()
    expect(seen.page.locator(".loading")).to_have_count(0)
    expect(seen.page.locator("main")).not_to_contain_text("µm pp")
    expect(seen.page.locator("main")).not_to_contain_text(re.compile(r"\d r/min"))
    expect(seen.page.locator("table").first).to_contain_text(" Hz")
    seen.open(f"machines/{MACHINE}/trends?element=derived_quantities")
    critical = seen.page.locator(".history-plot", has_text="critical speed 1").first
    expect(critical.locator("figcaption")).to_contain_text("[Hz]")
    seen.page.get_by_label("Units of vibration and speed").select_option("um_pp,rpm")
    assert seen.errors == []


def test_trends_at_running_speed_are_drawn_and_read_within_a_turn(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{COPY}/vibration?channels=B1X,B1Y")
    wait_drawn(seen.page, 6)
    phase = seen.page.get_by_role("group", name=re.compile("^1× phase at running speed"))
    lags = [int(one) for one in re.findall(r"B1[XY] (\d+)", phase.locator(".readout").inner_text())]
    assert len(lags) == 2
    assert all(0 <= lag < 360 for lag in lags)
    ratio = seen.page.get_by_role("group", name=re.compile("^2× over 1×"))
    (found,) = [one for one in service.get(f"/machines/{COPY}/vibration/trend")["probes"] if one["channel"] == "B1X"]
    told = found["second_over_first"][-1]
    assert told == pytest.approx(SECOND_PART, rel=0.02)  # a mean over samples whose phases differ
    expect(ratio.locator(".readout")).to_contain_text(f"B1X {told:.3f}")
    expect(seen.page.get_by_text("No region yet").first).to_be_visible()
    for name, values in (("Overall level", "B1X"), ("Gap", "B1X ")):
        expect(
            seen.page.get_by_role("group", name=re.compile(f"^{name} at running speed")).locator(".readout")
        ).to_contain_text(values)
    assert seen.errors == []


def test_bode_and_polar_of_the_2x_and_as_measured(seen: Seen) -> None:
    seen.open(f"machines/{COPY}/response?channels=B1X")
    wait_drawn(seen.page, 3)
    seen.page.get_by_role("group", name="Order").get_by_role("button", name="2×").click()
    expect(seen.page.get_by_role("heading", name="Bode, 2×")).to_be_visible()
    wait_drawn(seen.page, 2)
    seen.page.get_by_role("group", name="Order").get_by_role("button", name="1×").click()
    switch = seen.page.get_by_label("slow roll subtracted")
    expect(switch).to_be_disabled()  # there are no vectors that could be
    expect(switch).not_to_be_checked()
    expect(seen.page.get_by_text("as measured, no slow roll subtracted").first).to_be_visible()
    seen.page.get_by_label("Newest run of").select_option(MACHINE)
    expect(seen.page.get_by_text(f"overlaid run of {MACHINE}").first).to_be_visible()
    assert seen.errors == []


def test_a_run_without_2x_says_so(seen: Seen) -> None:
    def without(route: Route) -> None:  # as of a source that sends none
        answer = route.fetch()
        route.fulfill(response=answer, json={name: one for name, one in answer.json().items() if "2x" not in name})

    seen.page.route(re.compile(r"/phasors\?"), without)
    seen.open(f"machines/{MACHINE}/response?order=2")
    expect(seen.page.get_by_text("sent no 2×")).to_be_visible()
    assert seen.errors == []


def test_the_2x_of_the_simulated_plant_is_shown(seen: Seen) -> None:
    show(seen.page, seen.base, "vibration")
    expect(seen.page.locator(".vibration-bars")).to_contain_text("2× ")
    ratio = seen.page.get_by_role("group", name=re.compile("^2× over 1×"))
    expect(ratio.locator("canvas")).to_be_visible()
    seen.open(f"machines/{MACHINE}/shapes?order=2")
    expect(seen.page.get_by_role("heading", name="Orbits at the probes, 1× and 2×")).to_be_visible()
    expect(seen.page.locator(".orbits figure svg").first).to_be_visible()
    assert seen.errors == []


def test_orbits_open_at_running_speed_with_probes_and_timebase(seen: Seen, service: Service) -> None:
    seen.open(f"machines/{COPY}/shapes?order=2")
    expect(seen.page.get_by_role("heading", name="Orbits at the probes, 1× and 2×")).to_be_visible()
    orbit = seen.page.locator(".orbits figure").first
    expect(orbit.locator("svg text")).to_have_text(["B1X", "B1Y"])
    highest = max(run["speed_maximum_rpm"] for run in service.get(f"/machines/{COPY}/runs"))
    shown = re.search(r"Speed: ([\d\u202f]+) r/min", seen.page.locator(".wide").inner_text())
    assert shown is not None
    assert int(shown.group(1).replace("\u202f", "")) == pytest.approx(highest, abs=6)
    expect(orbit).to_contain_text("µm pp")
    assert seen.errors == []


def test_every_plot_is_saved_as_a_picture_and_its_data_as_csv(seen: Seen, tmp_path: Path) -> None:
    seen.open(f"machines/{COPY}/response?channels=B1X")
    wait_drawn(seen.page, 3)
    for name, beginning in (("Save as PNG: Amplitude of B1X", b"\x89PNG"), ("Save as SVG: Polar plot of B1X", b"<svg")):
        with seen.page.expect_download() as download:
            seen.page.get_by_role("button", name=name).click()
        path = tmp_path / download.value.suggested_filename
        download.value.save_as(path)
        assert path.read_bytes().startswith(beginning)
    assert b'stroke="rgb' in path.read_bytes(), "the drawing brings its colours along"
    with seen.page.expect_download() as download:
        seen.page.get_by_role("button", name="Save the data as CSV: Amplitude of B1X").click()
    path = tmp_path / "data.csv"
    download.value.save_as(path)
    head, *rows = csv.reader(path.read_text().splitlines())
    assert head[0] == "x [r/min]"
    assert "B1X [µm pp]" in head
    assert len(rows) > 50
    count = seen.page.locator(".plot, .polar").count()
    expect(seen.page.get_by_role("button", name=re.compile("^Save the data as CSV"))).to_have_count(count)
    assert seen.errors == []


def test_two_machines_are_in_one_plot_of_trends_and_in_its_file(seen: Seen, service: Service, tmp_path: Path) -> None:
    page, name = seen.page, "coupling.C1.kxx"
    show(page, seen.base, "trends")
    page.get_by_label("Beside it").select_option(COPY)
    expect(page.locator(".names").first).to_contain_text(f"run-down of {MACHINE}")
    expect(page.locator(".names").first).to_contain_text(f"run-down of {COPY}")
    expect(page.locator("main")).to_contain_text(f"Beside it {COPY}: grey, tests and marks are those of this machine alone.")
    own, other = (service.get(f"/machines/{one}/trends", parameter=name)["series"][0] for one in (MACHINE, COPY))
    points = len(own["value"]) + len(other["value"])
    assert other["value"]
    plot = page.get_by_role("group", name=f"{name} over time, {points} points")
    plot.focus()
    read = set()
    for _ in range(points):
        plot.press("ArrowLeft")
        read |= {one.split(",")[0] for one in plot.locator(".readout").inner_text().split("; ")}
    assert read == {MACHINE, COPY}, "its runs are those of the machine at the same instants: both are read out"
    lines = [one.get_attribute("class") for one in page.locator(".names").first.locator("svg").all()]
    assert len(set(lines)) == len(lines) == 4
    for button, has in (
        (
            page.locator(".panel").filter(has_text="single runs").get_by_role("button", name="CSV", exact=True),
            (f"{MACHINE},", f"{COPY},"),
        ),
        (plot.get_by_title("Save the data as CSV"), (f"of {MACHINE}", f"of {COPY}")),
    ):
        with page.expect_download() as started:
            button.first.click()
        started.value.save_as(tmp_path / "both.csv")
        text = (tmp_path / "both.csv").read_text(encoding="utf-8")
        assert [one for one in has if one not in text] == []
    seen.picture("two-machines")
    page.get_by_label("Beside it").select_option("")
    expect(page.get_by_role("group", name=f"{name} over time, {len(own['value'])} points")).to_be_visible()


def test_another_machine_without_these_parameters_says_so(seen: Seen) -> None:
    seen.page.route(re.compile(f"/machines/{COPY}/identifications"), lambda route: route.fulfill(json=[]))
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1&beside={COPY}")
    expect(seen.page.locator("main")).to_contain_text(f"{COPY} has no history of these parameters.")
    expect(seen.page.locator(".plot canvas").first).to_be_visible()


def test_refused_data_are_a_badge_in_a_persons_words(seen: Seen) -> None:
    seen.open(f"machines/{COPY}")
    badge = seen.page.locator(".refused")
    expect(badge).to_contain_text("refused: times look like milliseconds")
    badge.get_by_role("button").click()
    expect(badge.locator("q").first).to_contain_text("before 2000")
    seen.open()
    row = seen.page.locator(f"tr[data-machine={COPY}]")
    expect(row.locator(".needs")).to_contain_text("some were refused")
    assert seen.errors == []


def test_what_else_is_wrong_comes_before_balancing(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/balancing")
    expect(seen.page.get_by_role("heading", name="Not now: something else is wrong")).to_be_visible()
    expect(seen.page.get_by_role("button", name="Begin")).to_be_hidden()
    seen.page.get_by_text("Show balancing all the same").click()
    expect(seen.page.get_by_role("button", name="Begin")).to_be_visible()


def test_a_model_proposes_no_weights_while_something_else_is_wrong(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.get_by_role("heading", name="Not now: something else is wrong")).to_be_visible()
    proposal = seen.page.get_by_role("heading", name="Balancing proposal")
    expect(proposal).to_have_count(0)
    seen.page.get_by_text("Show balancing all the same").click()
    expect(proposal).to_be_visible()


def test_a_wall_shows_the_fleet_and_follows_it(seen: Seen) -> None:
    seen.open("wall")
    tiles = seen.page.locator(".tile")
    expect(tiles).to_have_count(2)
    expect(tiles.first).to_contain_text("Misalignment of coupling C1")
    with seen.page.expect_response(re.compile("/api/v1/fleet")):
        seen.page.wait_for_timeout(100)
    assert seen.errors == []


@pytest.mark.parametrize("part", ["identifications", "trends"])
def test_that_the_histories_of_another_machine_cannot_be_had_is_not_said_to_be_none(seen: Seen, part: str) -> None:
    refused = {"title": "Forbidden", "status": 403, "detail": "this key may not see them"}
    seen.page.route(re.compile(rf"/machines/{COPY}/{part}\?"), lambda route: route.fulfill(status=403, json=refused))
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1&beside={COPY}")
    expect(seen.page.locator("main")).to_contain_text(f"{COPY}: its history could not be loaded: this key may not see them")
    expect(seen.page.locator("main")).not_to_contain_text(f"{COPY} has no history")


@pytest.mark.parametrize(
    ("rotation", "said"),
    [
        ("positive", "Angles of unbalances: from the mark, +x towards +y, with rotation."),
        (
            "negative",
            f"Angles of unbalances of {MACHINE}: from the mark, +x towards +y, with rotation. "
            f"· Angles of unbalances of {COPY}: from the mark, +x towards +y, against rotation.",
        ),
    ],
)
def test_angles_of_two_machines_are_reported_for_each_where_they_do_not_turn_the_same_way(
    seen: Seen, service: Service, rotation: str, said: str
) -> None:
    found = service.get(f"/machines/{COPY}")
    turned = found | {"document": found["document"] | {"rotation": rotation}}
    seen.page.route(re.compile(rf"/machines/{COPY}$"), lambda route: route.fulfill(json=turned))
    seen.open(f"machines/{MACHINE}/trends?element=disc.D1&beside={COPY}")
    expect(seen.page.locator("main")).to_contain_text(said)


def test_ticks_of_an_axis_and_labels_of_limits_tell_themselves_apart(seen: Seen) -> None:
    """Values that hardly differ are drawn flat, not on an axis of which all ticks read the same."""
    seen.page.add_init_script(
        "window.written = []; const fill = CanvasRenderingContext2D.prototype.fillText;"
        "CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {"
        "  const at = this.getTransform();"
        "  written.push([this.canvas.closest('[aria-label]')?.ariaLabel ?? '', text, x + at.e, y + at.f,"
        "    this.measureText(text).width]); return fill.call(this, text, x, y, ...rest); };"
    )
    seen.open(f"machines/{COPY}/vibration")
    wait_drawn(seen.page, 6)
    written = seen.page.evaluate("written")
    ratio = {text for label, text, *_ in written if label.startswith("2× over 1×") and re.fullmatch(r"[\d.]+", text)}
    assert len(ratio) > 1, "the axis of a constant ratio"
    zones = {text: (x, y, width) for label, text, x, y, width in written if text in ("A/B", "B/C", "C/D")}
    assert zones.keys() == {"A/B", "B/C", "C/D"}
    (left, low, width), (other, high, _) = zones["A/B"], zones["B/C"]
    assert abs(low - high) > 10 or other >= left + width, "boundaries that lie close together are named beside each other"
