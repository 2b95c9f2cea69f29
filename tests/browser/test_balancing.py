"""Field balancing in a real browser: begun with a run, tried, computed, checked, drawn; refused while an alert is open."""

import re
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Route, expect

from estimator.machine.document import parse_machine
from tests.browser.conftest import Seen
from tests.browser.copied_machine import CopiedRuns, create_copy, first_runs, send
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service, example
from tests.estimator.trains import dense_response

COPY = "to-be-balanced"
NEW = "never-run"
TRIAL_G_MM = 5000.0


@pytest.fixture(scope="module")
def place(place: Service) -> Service:
    """The same service, with a copy of its machine, of whose three runs the second had a trial weight on D1."""
    with place.running():
        create_copy(place, COPY, "Train to be balanced")
        create_copy(place, NEW, "Train that never ran")
        send(place, _with_trial_weight(first_runs(place)))
    return place


def _with_trial_weight(runs: CopiedRuns) -> dict[str, Any]:
    """The samples of the machine's first runs as a source would send them, the second with a weight on D1 at 0°."""
    loaded = np.array([runs.begins[1] <= one < runs.begins[2] for one in runs.times])
    added = 2e6 * 1e-6 * TRIAL_G_MM * _influence(runs.speed_rpm * np.pi / 30)
    return runs.sent(COPY, runs.phasor + np.where(loaded[:, None], added, 0.0))


def _influence(speed: Any) -> Any:
    """Vibration per unbalance on D1 [m/(kg m)]."""
    document = example(MACHINE)
    for disc in document["discs"]:
        disc["unbalance"] = {"magnitude": 1.0 if disc["id"] == "D1" else 0.0, "angle_deg": 0.0}
    return dense_response(parse_machine(document), np.maximum(speed, 1.0), direction=1)


def _step(seen: Seen, button: str) -> Locator:
    seen.page.get_by_role("button", name=button).click()
    dialog = seen.page.get_by_role("dialog")
    dialog.get_by_label("Your name").fill("anna")
    return dialog


def _send(dialog: Locator, button: str) -> None:
    dialog.get_by_role("button", name=button, exact=True).click()


def _add_trial(seen: Seen, run: int, disc: str) -> None:
    """Add a run with the trial weight on a disc to the balancing that is shown."""
    dialog = _step(seen, "Add a trial run …")
    dialog.get_by_label("Run with the weight").select_option(str(run))
    dialog.locator("select[name=disc]").select_option(disc)
    dialog.get_by_label("Amount").fill(str(TRIAL_G_MM))
    dialog.get_by_label("Angle").fill("0")
    _send(dialog, "Add")
    expect(dialog).to_have_count(0)
    expect(seen.page.get_by_text(f"Trial run {run}: 5000 g·mm on {disc} at 0°")).to_be_visible()


def _until_tried(seen: Seen, machine: str, runs: list[int], *, despite_alert: bool = False) -> None:
    """Begin a balancing with the first of some runs, and add the second as a trial."""
    seen.open(f"machines/{machine}/balancing")
    if despite_alert:
        expect(seen.page.get_by_role("heading", name="Not now: something else is wrong")).to_be_visible()
        seen.page.get_by_text("Show balancing all the same").click()
    dialog = _step(seen, "Begin …")
    dialog.get_by_label("Run without trial weights").select_option(str(runs[0]))
    _send(dialog, "Begin")
    expect(dialog).to_have_count(0)
    _add_trial(seen, runs[1], "D1")


def _closed_runs(service: Service, machine: str) -> list[int]:
    """Closed runs, the oldest first."""
    return sorted(run["id"] for run in service.get(f"/machines/{machine}/runs") if run["state"] == "closed")


def test_a_machine_is_balanced_from_the_page(seen: Seen, service: Service) -> None:
    runs = _closed_runs(service, COPY)
    _until_tried(seen, COPY, runs)
    dialog = _step(seen, "Compute the correction …")
    _send(dialog, "Compute")
    expect(dialog).to_have_count(0)
    chosen = service.get(f"/machines/{COPY}/balancings")[0]["correction"]["speeds_rpm"]
    assert len(chosen) > 2
    stated = [round(one) for one in chosen[1:3]]
    dialog = _step(seen, "Compute anew")
    dialog.get_by_label("Speeds, with blanks between").fill(f"{stated[0]}  {stated[1]},0")
    _send(dialog, "Compute")
    expect(dialog).to_have_count(0)
    at_stated = service.get(f"/machines/{COPY}/balancings")[0]["correction"]
    assert at_stated["speeds_rpm"] == pytest.approx(stated)
    dialog = _step(seen, "Compute anew")
    _send(dialog, "Compute")
    expect(dialog).to_have_count(0)
    found = service.get(f"/machines/{COPY}/balancings")[0]
    assert found["correction"]["speeds_rpm"] == chosen
    (plane,) = found["correction"]["planes"]
    assert plane["disc"] == "D1"
    expect(seen.page.get_by_role("cell", name=f"{round(plane['angle_deg'])}", exact=False).first).to_be_visible()
    expect(seen.page.locator(".polars figure")).to_have_count(8)
    expect(seen.page.get_by_role("heading", name="Residual unbalance as of rigid rotors, ISO 21940-11 G 2.50")).to_be_visible()
    dialog = _step(seen, "Compare a check run …")
    dialog.locator("select[name=run]").select_option(str(runs[2]))
    _send(dialog, "Compare")
    expect(dialog).to_have_count(0)
    expect(seen.page.get_by_text("points within the prediction. To trim, add")).to_be_visible()
    expect(seen.page.get_by_text("with the weights proposed:")).to_be_visible()
    expect(seen.page.get_by_text("more than promised").first).to_be_visible()
    first = service.get(f"/machines/{COPY}/balancings")[0]
    assert first["state"] == "checked"
    dialog = _step(seen, "Compare another check run …")
    dialog.locator("select[name=run]").select_option(str(runs[2]))
    dialog.locator("select[name=installed]").select_option("trimmed")
    _send(dialog, "Compare")
    expect(dialog).to_have_count(0)
    expect(seen.page.get_by_text("with the weights proposed:")).to_have_count(0)
    second = service.get(f"/machines/{COPY}/balancings")[0]["check"]
    assert len(second["weights"]) == 2, "those of the correction, and the trim"
    dialog = _step(seen, "Compare another check run …")
    dialog.locator("select[name=run]").select_option(str(runs[2]))
    dialog.locator("select[name=installed]").select_option("others")
    _send(dialog, "Compare")
    expect(dialog).to_have_count(0)
    expect(seen.page.get_by_text("with none on:")).to_be_visible()
    expect(seen.page.get_by_text("Other weights than the correction's were on")).to_be_visible()
    expect(seen.page.get_by_role("columnheader", name="Predicted for the weights that were on, 95 %")).to_be_visible()
    expect(seen.page.get_by_text("more than promised")).to_have_count(0)
    third = service.get(f"/machines/{COPY}/balancings")[0]["check"]
    assert third["weights"] == []
    assert seen.errors == []


def test_a_trial_is_withdrawn_with_a_reason_and_the_correction_goes_with_it(seen: Seen, service: Service) -> None:
    runs = _closed_runs(service, COPY)
    _until_tried(seen, COPY, runs)
    dialog = _step(seen, "Compute the correction …")
    _send(dialog, "Compute")
    expect(dialog).to_have_count(0)
    dialog = _step(seen, f"Withdraw trial run {runs[1]}")
    expect(dialog.get_by_text("The correction that was computed from it, and its check run, are given up too")).to_be_visible()
    dialog.get_by_label("Why").fill("the weight was on D2")
    _send(dialog, "Withdraw")
    expect(dialog).to_have_count(0)
    gone = re.compile(rf"Withdrawn: trial run {runs[1]}, 5000 g·mm on D1 at 0°; .* by anna: the weight was on D2")
    expect(seen.page.get_by_text(gone)).to_be_visible()
    expect(seen.page.get_by_role("button", name="Compute the correction …")).to_have_count(0)
    found = service.get(f"/machines/{COPY}/balancings")[0]
    assert (found["state"], found["trials"], found["correction"]) == ("begun", [], None)
    _add_trial(seen, runs[1], "D2")
    assert seen.errors == []


def test_on_paper_the_buttons_are_left_out(seen: Seen, service: Service) -> None:
    _until_tried(seen, COPY, _closed_runs(service, COPY))
    seen.page.emulate_media(media="print")
    expect(seen.page.get_by_role("button", name="Compute the correction …")).to_be_hidden()
    expect(seen.page.get_by_role("button", name="Print")).to_be_hidden()
    expect(seen.page.get_by_text("Initial run")).to_be_visible()


def test_an_alert_that_comes_meanwhile_ends_no_form_that_is_being_filled_in(seen: Seen, service: Service) -> None:
    runs = _closed_runs(service, COPY)
    _until_tried(seen, COPY, runs)
    shown = service.get(f"/machines/{COPY}/balancings")[0]["id"]
    dialog = _step(seen, "Add a trial run …")
    dialog.get_by_label("Amount").fill("777")
    alert = service.get(f"/machines/{MACHINE}/alerts", open=True)[0] | {"machine": COPY, "severity": "alert"}
    later = service.client.post(f"/machines/{COPY}/balancings", json={"runs": [runs[2]], "by": "otto"})
    assert later.status_code == 201, later.text  # somebody else begins another one
    seen.page.route(re.compile(rf"/machines/{COPY}/alerts\?open=true"), lambda route: route.fulfill(json=[alert]))
    heading = seen.page.get_by_role("heading", name="Not now: something else is wrong", include_hidden=True)
    expect(heading).to_be_attached()
    expect(dialog.get_by_role("status")).to_have_text("Not now: something else is wrong")
    expect(dialog.get_by_label("Amount")).to_have_value("777")
    dialog.get_by_label("Run with the weight").select_option(str(runs[2]))
    dialog.locator("select[name=disc]").select_option("D1")
    dialog.get_by_label("Angle").fill("0")
    _send(dialog, "Add")
    expect(dialog).to_have_count(0)
    tried = _balancing(service, shown)
    assert [one["run"] for one in tried["trials"]] == runs[1:3], "the trial is of the balancing that was shown"
    expect(heading).to_be_visible()
    expect(seen.page.get_by_role("button", name="Begin …")).to_be_hidden()


def _balancing(service: Service, number: int) -> Any:
    return next(one for one in service.get(f"/machines/{COPY}/balancings") if one["id"] == number)


def test_amplitudes_of_a_correction_are_in_the_chosen_unit(seen: Seen, service: Service) -> None:
    _until_tried(seen, COPY, _closed_runs(service, COPY))
    dialog = _step(seen, "Compute the correction …")
    _send(dialog, "Compute")
    expect(dialog).to_have_count(0)
    expect(seen.page.locator(".polar figcaption").first).to_contain_text("µm pp")
    seen.page.get_by_label("Units of vibration and speed").select_option("mil_p,hz")
    expect(seen.page.locator(".polar figcaption").first).to_contain_text("mil 0-pk")
    expect(seen.page.get_by_role("heading", name=re.compile(r"ISO 21940-11 G 2.50 at .* Hz"))).to_be_visible()
    expect(seen.page.locator("main")).not_to_contain_text("µm pp")
    seen.page.get_by_label("Units of vibration and speed").select_option("um_pp,rpm")


def test_no_masses_while_an_alert_says_that_the_coupling_is_misaligned(seen: Seen, service: Service) -> None:
    _until_tried(seen, MACHINE, _closed_runs(service, MACHINE), despite_alert=True)
    dialog = _step(seen, "Compute the correction …")
    _send(dialog, "Compute")
    expect(dialog.get_by_role("alert")).to_contain_text("mend C1 first, no masses are proposed")


def test_a_form_stays_until_the_balancing_that_it_began_is_shown(seen: Seen, service: Service) -> None:
    """Otherwise the next step would be filed to the balancing that was shown before."""
    runs = _closed_runs(service, COPY)
    _until_tried(seen, COPY, runs)
    older = service.get(f"/machines/{COPY}/balancings")[-1]["id"]
    seen.page.get_by_role("combobox", name="Balancing").select_option(str(older))
    held: list[Route] = []
    seen.page.route(re.compile(rf"/machines/{COPY}/balancings$"), lambda route: _hold_reads(route, held))
    dialog = _step(seen, "Begin …")
    dialog.get_by_label("Run without trial weights").select_option(str(runs[0]))
    with seen.page.expect_request(lambda one: one.method == "GET" and one.url.endswith("/balancings")):
        _send(dialog, "Begin")
    expect(dialog.get_by_role("button", name="…", exact=True)).to_be_disabled()
    for one in held:
        one.continue_()
    expect(dialog).to_have_count(0)
    begun = service.get(f"/machines/{COPY}/balancings")[0]["id"]
    expect(seen.page.get_by_role("combobox", name="Balancing")).to_have_value(str(begun))


def test_without_a_closed_run_a_form_says_what_it_waits_for(seen: Seen) -> None:
    seen.open(f"machines/{NEW}/balancing")
    dialog = _step(seen, "Begin …")
    expect(dialog.get_by_text("No run of this machine is closed yet.")).to_be_visible()
    _send(dialog, "Begin")
    expect(dialog).to_be_visible()


def test_a_weight_of_zero_and_a_run_that_is_used_already_are_answered_in_the_form(seen: Seen, service: Service) -> None:
    runs = _closed_runs(service, COPY)
    _until_tried(seen, COPY, runs)
    dialog = _step(seen, "Add a trial run …")
    dialog.locator("select[name=run]").select_option(str(runs[2]))
    dialog.get_by_label("Amount").fill("0")
    dialog.get_by_label("Angle").fill("0")
    _send(dialog, "Add")
    expect(dialog.get_by_text("a weight of zero is none")).to_be_visible()
    dialog.get_by_label("Amount").fill("100")
    dialog.locator("select[name=run]").select_option(str(runs[1]))
    _send(dialog, "Add")
    expect(dialog.get_by_text(f"run {runs[1]} is part of this balancing already")).to_be_visible()


def _hold_reads(route: Route, held: list[Route]) -> None:
    if route.request.method == "GET":
        held.append(route)
    else:
        route.continue_()
