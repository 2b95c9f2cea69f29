"""A machine's page in a real browser, over a service with real data: what is shown of it, and in which words."""

import math
import re
from typing import Any

import pytest
from playwright.sync_api import Route, expect

from tests.browser.conftest import Seen
from tests.browser.drawing import SEEN, SEEN_AGAIN, drawn, wait_drawn
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service, example, until

BEYOND_DANGER = {
    "channel": "B2X",
    "amplitude_um_pp": 150.0,
    "danger_um_pp": 120.0,
    "speed_rpm": 2980.0,
    "first_at": "2026-11-20T12:00:00Z",
    "last_at": "2026-11-20T12:01:00Z",
}


def test_fleet_shows_the_machine_and_its_alert(seen: Seen) -> None:
    seen.open()
    row = seen.page.locator(f"tr[data-machine={MACHINE}]")
    expect(row).to_contain_text(re.compile("alert|danger"))
    expect(row).to_contain_text("1 unacknowledged")
    row.get_by_role("link", name="Two-shaft train").click()
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Two-shaft train of the thesis, Chapter 3")
    assert seen.errors == []


def test_fleet_names_identifications_that_failed_and_speeds_out_of_range(seen: Seen, service: Service) -> None:
    fleet = service.get("/fleet")
    wrong = {"failed_job": {"id": 7, "error": "NotEnoughData"}, "outside_speed_range": "it turned at 9 r/min"}
    wrong |= {"vibration_beyond_danger": BEYOND_DANGER}
    fleet["machines"] = [one | wrong for one in fleet["machines"]]
    seen.page.route(re.compile("/api/v1/fleet"), lambda route: route.fulfill(json=fleet))
    seen.open()
    needed = seen.page.locator(f"tr[data-machine={MACHINE}] .needs")
    expect(needed).to_contain_text("act on 1× at B2X beyond its danger limit: 150 of 120 µm pp at 2980 r/min")
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_p,hz")
    expect(needed).to_contain_text("2.95 of 2.36 mil 0-pk at 49.67 Hz")
    expect(needed).to_contain_text("see to an identification that failed")
    expect(needed).to_contain_text("check its speeds: it never came into its range")
    assert seen.errors == []


def test_words_on_an_unbalance_say_which_of_its_components_they_are_of(seen: Seen, service: Service) -> None:
    name = "disc.D1.unbalance"
    (series,) = service.get(f"/machines/{MACHINE}/trends", parameter=name)["series"]
    quiet = {"value": 0.0, "limit": 5.0, "passed": False, "began": None}
    passed = {"value": 9.0, "limit": 5.0, "passed": True, "began": series["measured_at"][-2]}
    drift = {"per_week": -8.9, "lower": -12.0, "upper": -5.0, "probability": 1e-4, "alert": None, "danger": None}
    tests: list[dict[str, Any]] = [
        {"name": f"{name}.real", "step_up": passed, "step_down": quiet, "creep": {**passed, "value": -9.0}, "drift": drift},
        {"name": f"{name}.imaginary", "step_up": passed, "step_down": quiet, "creep": quiet, "drift": None},
    ]
    tests = [{"runs": 9, "newest": 1.0, **one} for one in tests]
    answer = {"missing": None, "run_length": 1000, "tests": tests}
    seen.page.route(re.compile("/trend-tests[?]"), lambda route: route.fulfill(json=answer))
    seen.open(f"machines/{MACHINE}/trends?element=disc.D1")
    wait_drawn(seen.page, 2)  # magnitude and angle
    texts = seen.page.locator(".trend-tests")
    mean = "mean of the newest runs below the baseline"
    weekly = "−8.9 % of the baseline's magnitude per week (−12 … −5.0)"
    expect(texts).to_have_text(
        re.compile(
            rf"^real part: drifting, seen since [-\d]+ [:\d]+; real part: {re.escape(mean)}; real part: {re.escape(weekly)}; "
            "imaginary part: step up, most likely since "
        )
    )
    assert texts.evaluate("words => words.scrollWidth <= words.clientWidth && words.scrollHeight <= words.clientHeight")
    seen.page.set_viewport_size({"width": 390, "height": 844})
    assert texts.evaluate("words => words.scrollWidth <= words.clientWidth && words.scrollHeight <= words.clientHeight")
    plot = seen.page.get_by_role("group", name=re.compile(f"Angle of {name} over time"))
    angle = math.degrees(math.atan2(series["imaginary"][-2], series["real"][-2]))
    plot.press("ArrowLeft")
    expect(plot.locator(".readout")).to_contain_text(f" g·mm at {angle % 360:.1f}° ± ")
    size = seen.page.get_by_role("group", name=re.compile(f"{name} over time, ")).first
    expect(size.locator(".readout")).to_have_text(plot.locator(".readout").inner_text())
    assert seen.errors == []


def test_bode_and_polar_show_measurement_fit_and_another_run(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/response")
    wait_drawn(seen.page, 3)  # amplitude, phase, residuals
    seen.page.get_by_role("button", name="Overlay the oldest of its kind").click()
    expect(seen.page.locator(".polar .faint .dots").first).to_be_attached()
    for path in seen.page.locator(".polar .curve:not(.faint) path:not(.dots)").all():
        assert path.evaluate("path => path.getTotalLength()") > 100
    assert seen.errors == []


def test_orbits_and_mode_shapes_have_a_shape(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/shapes")
    expect(seen.page.locator(".orbits svg").first).to_be_visible()
    expect(seen.page.locator(".modes svg").first).to_be_visible()
    lengths = [path.evaluate("path => path.getTotalLength()") for path in seen.page.locator(".shapes .curve path").all()]
    assert len(lengths) > 4
    assert max(lengths) > 100
    assert seen.errors == []


EDGES = "shape => { const box = shape.getBoundingClientRect(); return [box.left, box.top, box.right, box.bottom]; }"


def test_long_names_of_probes_stand_beside_the_orbit(seen: Seen) -> None:
    """In the corners, each with its end, in which those of a station differ; the whole name is read out."""
    long = {"x": "Turbine drive end bearing, probe X", "y": "Turbine drive end bearing, probe Y"}

    def named(route: Route) -> None:
        found = route.fetch().json()
        orbits = [{**one, "channels": list(long.values())} for one in found["orbits"]]
        route.fulfill(json={**found, "orbits": orbits})

    seen.page.route(re.compile(r"/runs/\d+/orbits[?]"), named)
    seen.open(f"machines/{MACHINE}/shapes")
    figure = seen.page.locator(".orbits figure").first
    names = figure.locator("svg text")
    expect(names).to_have_count(2)
    (left, top, right, _), (left2, top2, right2, _) = (one.evaluate(EDGES) for one in names.all())
    rings = figure.locator("circle.grid").first.evaluate(EDGES)
    outside = figure.locator("svg").evaluate(EDGES)
    assert min(top, top2) >= rings[3], "below the rings, where no orbit is"
    assert outside[0] <= left < right <= left2 < right2 <= outside[2]
    expect(names.first.locator("title")).to_have_text(long["x"])
    assert seen.errors == []


def test_model_shows_campbell_diagram_and_coupling_forces(seen: Seen) -> None:
    seen.open(f"machines/{MACHINE}/model")
    expect(seen.page.locator(".plot canvas")).to_have_count(5)  # Campbell; two forces and two moments
    expect(seen.page.get_by_text("in the range").first).to_be_visible()
    until(lambda: drawn(seen.page)[0] > 100, within_s=15, what="the Campbell diagram is drawn")
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
    unbalance = rows.filter(has_text="disc D1 unbalance, imaginary part").locator("td.number").first
    expect(unbalance).to_have_text(f"{1e6 * change['first']:.0f} g·mm")
    coupling = rows.filter(has_text="coupling C1 kxx").locator("td.number")
    expect(coupling.nth(1)).to_have_text("not determined")
    assert seen.errors == []


def test_a_change_of_an_unbalance_is_what_was_added(seen: Seen) -> None:
    """Nine tenths of one were balanced away: no sign may say that it grew."""

    def balanced(route: Route) -> None:
        found = route.fetch().json()
        like = next(one for one in found["parameters"] if one["parameter"] == "disc.D1.unbalance")
        added = {**like, "per_cent": 89.4, "sigma": 40.0, "added": 1.837e-3, "added_angle_deg": 94.2}
        cross = {
            **like,
            "parameter": "bearing.B1.kxy",
            "element": "bearing.B1",
            "per_cent": -12.3,
            "sigma": -8.0,
            "added": None,
        }
        coupled = {**cross, "parameter": "coupling.C1.kx_phiy", "element": "coupling.C1", "per_cent": 4.5, "sigma": 6.0}
        elements = [{**one, "probability": 1e-12} for one in found["elements"]]
        route.fulfill(json={**found, "missing": None, "elements": elements, "parameters": [added, cross, coupled]})

    seen.page.route(re.compile("/deviations[?]"), balanced)
    seen.open(f"machines/{MACHINE}")
    table = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Deviation from the baseline"))
    for element, words in (
        ("disc.D1", "unbalance: 1837 g·mm added at 94° (89 % of the baseline's, 40 σ)"),
        ("bearing.B1", "kxy −12 % of the direct terms (−8.0 σ)"),
    ):
        expect(table.get_by_role("cell", name=words, exact=True)).to_be_visible()
        expect(seen.page.locator(f".element[data-element='{element}'] title")).to_contain_text(words)
    expect(table.get_by_text("kxφy +4.5 % of the direct terms (6.0 σ)")).to_be_visible()
    assert seen.errors == []


@pytest.mark.parametrize(("rotation", "counted"), [("positive", "with rotation"), ("negative", "against rotation")])
def test_angles_of_unbalances_say_how_they_count(seen: Seen, rotation: str, counted: str) -> None:
    def of_the_machine(route: Route) -> None:
        found = route.fetch().json()
        route.fulfill(json={**found, "document": {**found["document"], "rotation": rotation}})

    def of_the_runs(route: Route) -> None:
        route.fulfill(json={**route.fetch().json(), "direction": rotation})

    seen.page.route(re.compile(rf"/machines/{MACHINE}$"), of_the_machine)
    seen.page.route(re.compile("/balancing$"), of_the_runs)
    words = f"from the mark, +x towards +y, {counted}"
    seen.open(f"machines/{MACHINE}/model")
    seen.page.get_by_text("Show balancing all the same").click()
    expect(seen.page.get_by_role("columnheader", name=f"Angle, {words}")).to_be_visible()
    for tab, heading in (
        ("identified", "Parameters, with 95 % intervals"),
        ("trends?element=disc.D1", "disc D1: single runs"),
    ):
        seen.open(f"machines/{MACHINE}/{tab}")
        panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name=heading))
        expect(panel.get_by_text(f"Angles of unbalances: {words}")).to_be_visible()
    assert seen.errors == []


@pytest.mark.parametrize(
    ("tab", "link", "chosen"),
    [
        ("response", "Bode and polar", "run"),
        ("shapes", "Orbits and modes", "run"),
        ("identified", "Parameters", "identification"),
    ],
)
def test_what_is_chosen_by_itself_is_in_the_address_also_the_second_time(seen: Seen, tab: str, link: str, chosen: str) -> None:
    seen.open(f"machines/{MACHINE}/{tab}")
    whole = re.compile(rf"/{tab}\?{chosen}=\d+$")
    expect(seen.page).to_have_url(whole)
    seen.page.evaluate("window.addEventListener('hashchange', () => { document.body.dataset.gone = 'yes'; })")
    seen.page.get_by_role("link", name=link, exact=True).click()
    expect(seen.page.locator("body[data-gone]")).to_have_count(1)  # the page's policy forbids functions from text
    expect(seen.page).to_have_url(whole)


def test_the_speed_of_the_orbit_laid_over_is_shown(seen: Seen, service: Service) -> None:
    """Each run has its own nearest sample, which may be far away."""
    closed = [run for run in service.get(f"/machines/{MACHINE}/runs") if run["state"] == "closed"]
    newest, other = closed[0], [run for run in closed if run["kind"] == closed[0]["kind"]][-1]

    def elsewhere(route: Route) -> None:
        found = route.fetch().json()
        route.fulfill(json={**found, "orbits": [{**one, "speed_rpm": 987.0} for one in found["orbits"]]})

    seen.page.route(re.compile(f"/runs/{other['id']}/orbits[?]"), elsewhere)
    seen.open(f"machines/{MACHINE}/shapes?run={newest['id']}&reference={other['id']}&rpm=1500")
    said = seen.page.locator(".orbits figure").first.locator("p")
    own = service.get(f"/runs/{newest['id']}/orbits", rpm=1500)["orbits"][0]["speed_rpm"]
    expect(said).to_have_text(re.compile(rf"µm pp at {own // 1000:.0f}\s{own % 1000:03.0f} r/min; overlaid run at 987 r/min$"))
    assert seen.errors == []


def test_an_identification_that_is_accepted_later_is_noticed(seen: Seen) -> None:
    answers: list[dict[str, Any]] = [{"status": 503, "json": {"title": "Service Unavailable", "detail": "too much to do"}}]
    seen.page.route(
        re.compile(r"/identifications\?from="), lambda route: route.fulfill(**answers[0]) if answers else route.continue_()
    )
    seen.open(f"machines/{MACHINE}/response")
    none = seen.page.get_by_text("This run has no accepted identification")
    zoomed = seen.page.locator(".uplot[data-zoomed='1']")
    held: list[Route] = []
    expect(seen.page.get_by_role("alert")).to_have_text("too much to do")
    expect(seen.page.get_by_text("Whether this run was identified is unknown")).to_be_visible()
    expect(none).to_have_count(0)
    answers[0] = {"json": []}
    expect(none).to_be_visible()
    expect(seen.page.get_by_role("alert")).to_have_count(0)
    seen.page.get_by_role("button", name="Zoom in").first.click()
    expect(zoomed).to_have_count(2)
    seen.page.route(re.compile(r"/bode\?"), lambda route: held.append(route))
    with seen.page.expect_request(re.compile(r"/bode\?")):
        answers.clear()
    seen.page.wait_for_timeout(200)
    expect(none).to_be_visible()  # the points alone, until the curve is there
    expect(zoomed).to_have_count(2)
    held[0].continue_()
    expect(none).to_have_count(0)
    wait_drawn(seen.page, 3)
    expect(zoomed).to_have_count(3)


def test_a_probe_that_an_identification_does_not_know_is_said(seen: Seen) -> None:
    """It was added to the machine's document afterwards."""

    def without(route: Route) -> None:
        found = route.fetch().json()
        for part in (found["fitted"], *found["measured"]):
            part["channels"] = [one for one in part["channels"] if one["channel"] != "B1Y"]
        route.fulfill(json=found)

    seen.page.route(re.compile(r"/bode\?"), without)
    seen.open(f"machines/{MACHINE}/response?channels=B1X,B1Y")
    expect(seen.page.get_by_text("does not include B1Y: there is no curve")).to_be_visible()
    wait_drawn(seen.page, 3)
    assert seen.errors == []


def test_a_view_that_fails_says_so_in_its_place_and_can_be_tried_again(seen: Seen) -> None:
    seen.page.route(re.compile(r"/model/campbell"), lambda route: route.fulfill(json={"curves": None}))
    seen.open(f"machines/{MACHINE}/model")
    failed = seen.page.get_by_role("alert")
    expect(failed).to_contain_text("This view cannot be shown")
    expect(seen.page.get_by_role("heading", level=1)).to_be_visible()
    seen.page.get_by_role("link", name="Parameters").click()
    expect(seen.page.get_by_role("heading", name="Identifiability")).to_be_visible()
    seen.page.go_back()
    expect(failed).to_be_visible()
    seen.page.unroute_all()
    failed.get_by_role("button", name="Try again").click()
    expect(seen.page.locator(".plot canvas")).to_have_count(5)
    expect(failed).to_have_count(0)


@pytest.mark.parametrize("accepted_before", [True, False])
def test_an_accepted_identification_is_looked_for_behind_many_that_were_not(
    seen: Seen, service: Service, accepted_before: bool
) -> None:
    listed = service.get(f"/machines/{MACHINE}/identifications")
    refused = [{**listed[0], "id": 9000 - number, "accepted": False} for number in range(1000)]

    def answer(route: Route) -> None:
        short = "limit=20" in route.request.url
        route.fulfill(json=refused[:20] if short else refused[:900] + listed if accepted_before else refused)

    seen.page.route(re.compile(r"/identifications\?limit="), answer)
    seen.open(f"machines/{MACHINE}")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Deviation from the baseline"))
    if accepted_before:
        expect(panel.get_by_role("row")).not_to_have_count(0)
    else:
        expect(panel).to_contain_text("Of the newest 1000 identifications none of a single run was accepted.")
    expect(panel).not_to_contain_text("accepted yet")
    assert seen.errors == []


def test_the_baseline_stays_until_the_next_identification_is_compared(seen: Seen, service: Service) -> None:
    listed = service.get(f"/machines/{MACHINE}/identifications")
    real = next(one for one in listed if one["accepted"] and one["scope"] == "run")
    held: list[Route] = []
    seen.page.add_init_script(SEEN)
    seen.open(f"machines/{MACHINE}")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Deviation from the baseline"))
    expect(panel.get_by_role("table")).to_be_visible()
    seen.page.route(re.compile(r"/identifications\?limit="), lambda route: route.fulfill(json=[real | {"id": 9001}, *listed]))
    seen.page.route(re.compile("identification=9001"), lambda route: held.append(route))
    with seen.page.expect_request(re.compile("identification=9001")):
        seen.page.evaluate(SEEN_AGAIN)
    seen.page.wait_for_timeout(200)
    expect(panel.get_by_role("table")).to_be_visible()
    held[0].fulfill(status=404, json={"title": "Not Found", "detail": "it is gone"})
    expect(panel.get_by_role("alert")).to_have_text("it is gone")
    expect(panel.get_by_role("table")).to_have_count(0)


def test_lists_say_where_they_are_cut(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    alerts = [{**alert, "id": 1000 + number} for number in range(200)]
    run = service.get(f"/machines/{MACHINE}/runs")[0]
    runs = [{**run, "id": 9000 - number, "state": "closed" if number < 100 else "discarded"} for number in range(200)]
    job = {"scope": "run", "attempts": 0, "error": None, "created_at": run["started_at"]}
    jobs = [job | {"id": 90 - at, "runs": [90 - at], "state": "queued" if at < 29 else "running"} for at in range(30)]

    def some_jobs(route: Route) -> None:
        route.fulfill(json=jobs[:20] if "limit=20" in route.request.url else jobs)

    def many_modes(route: Route) -> None:
        found = route.fetch().json()
        shape = {**found["modes"][0], "damping_ratio": 0.01}
        modes = [{**shape, "frequency_hz": 10.0 + number} for number in range(11)]
        route.fulfill(json={**found, "modes": [*modes, {**shape, "damping_ratio": 0.95}]})

    seen.page.route(re.compile(r"/alerts\?open=true"), lambda route: route.fulfill(json=alerts))
    seen.page.route(re.compile(r"/jobs\?limit="), some_jobs)
    seen.page.route(re.compile(r"/runs\?limit="), lambda route: route.fulfill(json=runs))
    seen.page.route(re.compile("/model/modes"), many_modes)
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.locator(".panel", has=seen.page.locator(".alert-row")).locator(".truncated")).to_contain_text(
        "The newest 200 "
    )
    expect(seen.page.locator(".computing")).to_contain_text("Identifying run 61, 29 queued")
    jobs[:] = [job | {"id": 2000 - at, "runs": [2000 - at], "state": "queued"} for at in range(1000)]
    expect(seen.page.locator(".computing")).to_contain_text("Identification: 1000 or more queued")
    seen.open(f"machines/{MACHINE}/shapes?run={run['id']}")
    expect(seen.page.get_by_text("The newest 200 runs are shown; there may be more.")).to_be_visible()
    expect(seen.page.get_by_text("The lowest 8 of 11 modes are shown")).to_be_visible()
    expect(seen.page.get_by_text("1 mode damped by 90 % or more is omitted")).to_be_visible()
    assert seen.errors == []


def test_that_identifications_cannot_be_had_is_said_beside_the_baseline(seen: Seen) -> None:
    refused = {"title": "Forbidden", "status": 403, "detail": "this key may not see identifications"}
    seen.page.route(re.compile(r"/identifications\?limit="), lambda route: route.fulfill(status=403, json=refused))
    seen.open(f"machines/{MACHINE}")
    panel = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Deviation from the baseline"))
    expect(panel.get_by_role("alert")).to_have_text("this key may not see identifications")


def test_what_is_hardly_meant_in_a_document_is_said_in_words(seen: Seen, service: Service) -> None:
    document = example(MACHINE) | {"id": "narrow-table"}
    document["bearings"][1] |= {
        "speed_dependence": {
            "form": "table",
            "speed_rpm": [500, 1500, 2500, 3500, 4600],
            "kxx": [2.1e5, 2.5e5, 2.9e5, 3.2e5, 3.5e5],
        }
    }
    del document["bearings"][1]["kxx"]
    answer = service.client.post("/machines", json=document)
    assert answer.status_code == 201, answer.text
    seen.open("machines/narrow-table")
    said = seen.page.locator(".panel", has=seen.page.get_by_role("heading", name="Warnings of the document"))
    expect(said).to_contain_text("Revision 1 is used as it stands.")
    expect(said.get_by_role("listitem")).to_have_count(1)
    expect(said.get_by_role("listitem")).to_have_text(
        "bearing B2, speed_dependence.speed_rpm: the table covers 500 to 4600 r/min and is held level beyond its ends, "
        "from 90 to 500 and from 4600 to 6000 r/min"
    )
    assert seen.errors == []
    seen.open(f"machines/{MACHINE}")
    expect(seen.page.get_by_role("heading", name="Open alerts")).to_be_visible()
    expect(said).to_have_count(0)


def test_a_young_ramp_is_not_called_a_step(seen: Seen, service: Service) -> None:
    (found,) = service.get(f"/machines/{MACHINE}/trend-tests", parameter="coupling.C1.kxx")["tests"]
    assert found["step_up"]["passed"]
    assert found["step_up"]["runs"] < 6
    seen.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    texts = seen.page.locator(".trend-tests")
    expect(texts.first).to_contain_text(re.compile(r"higher, most likely since .*; whether a step or a drift"))
    expect(texts.filter(has_text="step up")).to_have_count(0)


def test_an_element_is_reported_once_as_its_alert_tells_it(seen: Seen, service: Service) -> None:
    (alert,) = service.get(f"/machines/{MACHINE}/alerts", open=True)
    figure = next(one for one in alert["advice"]["how_far"] if one["of"] == "coupling.C1.coefficients")
    seen.open(f"machines/{MACHINE}")
    row = seen.page.get_by_role("row").filter(has=seen.page.get_by_role("link", name="coupling C1", exact=True))
    expect(row.first).to_contain_text("all coefficients together")
    expect(row.first).to_contain_text(f"+{figure['value']:.0f} %")
    seen.open(f"alerts/{alert['id']}")
    moved = seen.page.locator(".facts dd", has_text=re.compile(r"kxx \+\d"))
    expect(moved).to_be_visible()
    names = re.findall(r"coupling C1 \w+", moved.inner_text())
    assert len(names) == 1, "of an element whose change as a whole is told, only its largest"
