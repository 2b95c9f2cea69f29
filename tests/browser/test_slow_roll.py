"""A machine whose shaft has a run-out under one probe, with slow-roll vectors: what is measured is shown as the curve is."""

import re
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from playwright.sync_api import Response, Route, expect

from tests.browser.conftest import Seen
from tests.browser.copied_machine import CopiedRuns, create_copy, first_runs, phasors, send
from tests.browser.shown_service import MACHINE
from tests.end_to_end.processes import Service, until

COPY = "with-run-out"
RUN_OUT_UM_PP, RUN_OUT_LAG_DEG = 60.0, 40.0
SMALL_UM_PP = 5 * RUN_OUT_UM_PP
"""Up to here the run-out stands out from what a source's noise, and another run, have to themselves."""


@pytest.fixture(scope="module")
def place(place: Service) -> Service:
    """The same service, with a copy of its machine: version 1 of the vectors holds what the shaft's pattern adds to it.

    Version 2, of another size, is put in force after its runs were identified.
    """
    with place.running():
        channel = create_copy(place, COPY, "Train with run-out")["probes"][0]["id"]
        _put_in_force(place, channel, RUN_OUT_UM_PP)
        send(place, _with_run_out(first_runs(place), channel))
        until(place.idle, within_s=90, what="they are identified")
        _put_in_force(place, channel, RUN_OUT_UM_PP / 2)
    return place


def _put_in_force(service: Service, channel: str, amplitude_um_pp: float) -> None:
    vector = {"amplitude_um_pp": amplitude_um_pp, "phase_lag_deg": RUN_OUT_LAG_DEG, "standard_error_um_pp": 0.01}
    added = service.client.post(f"/machines/{COPY}/slow-roll", json={"vectors": {channel: vector}})
    assert added.status_code == 201, added.text
    answer = service.client.put(f"/machines/{COPY}/slow-roll/in-force", json={"version": added.json()["version"]})
    assert answer.status_code == 200, answer.text


def _with_run_out(runs: CopiedRuns, channel: str) -> dict[str, Any]:
    """The samples of the machine's first runs as a source would send them, with the run-out in one channel."""
    phasor = runs.phasor.copy()
    phasor[:, runs.channels.index(channel)] += phasors(RUN_OUT_UM_PP, RUN_OUT_LAG_DEG)
    return runs.sent(COPY, phasor)


class PageRequests:
    """A request of the page, and its answer."""

    def __init__(self, seen: Seen) -> None:
        self.answers: list[Response] = []
        seen.page.on("response", lambda answer: self.answers.append(answer))

    def of(self, end: str) -> dict[str, tuple[list[str], Any]]:
        """Return the requested slow roll and the answer by path, of the paths with this end."""
        parts = [(urlsplit(one.url), one) for one in self.answers]
        return {
            url.path: (parse_qs(url.query).get("slow_roll", []), one.json()) for url, one in parts if url.path.endswith(end)
        }


def _runs(service: Service) -> tuple[int, int]:
    """The newest run of the copy, and an older one of its kind; that they were identified without version 1."""
    newest, _, oldest = [run["id"] for run in service.get(f"/machines/{COPY}/runs") if run["state"] == "closed"][:3]
    fits = service.get(f"/machines/{COPY}/identifications")
    used = {fit["runs"][0]: fit["slow_roll_version"] for fit in fits if fit["accepted"] and fit["scope"] == "run"}
    assert used[newest] == used[oldest] == 1
    return newest, oldest


def test_points_are_shown_without_the_slow_roll_of_the_curve(seen: Seen, service: Service) -> None:
    run, reference = _runs(service)
    asked = PageRequests(seen)
    seen.open(f"machines/{COPY}/response?run={run}&reference={reference}")
    for panel in ("Bode, 1×", "Polar, 1×"):
        expect(seen.page.locator(".panel", has=seen.page.get_by_role("heading", name=panel, exact=True))).to_contain_text(
            "slow roll version 1 subtracted"
        )
    expect(seen.page.locator(".polar .faint .dots").first).to_be_attached()
    ((_, bode),) = asked.of("/bode").values()
    shown = asked.of("/phasors")
    assert shown.keys() == {f"/api/v1/runs/{one}/phasors" for one in (run, reference)}
    fitted = bode["fitted"]["channels"][0]
    curve = phasors(fitted["amplitude"], fitted["phase"])
    for without, measured in shown.values():
        assert without == ["1"]
        assert measured["channels"][0] == fitted["channel"]
        near = np.interp(measured["speed_rpm"], bode["fitted"]["speed"], curve)
        away = np.abs(phasors(measured["amplitude_um_pp"][0], measured["phase_lag_deg"][0]) - near)
        small = np.abs(near) < SMALL_UM_PP
        assert np.sum(small) > 5
        assert np.max(away[small]) < RUN_OUT_UM_PP / 3
    seen.page.get_by_label("slow roll subtracted").uncheck()
    expect(seen.page.get_by_text("as measured, no slow roll subtracted").first).to_be_visible()
    assert seen.errors == []


def test_orbits_are_shown_without_it_too(seen: Seen, service: Service) -> None:
    run, reference = _runs(service)
    asked = PageRequests(seen)
    seen.open(f"machines/{COPY}/shapes?run={run}&reference={reference}")
    expect(seen.page.get_by_text("slow roll version 1 subtracted, but not at B1Y, B2X, ")).to_be_visible()
    expect(seen.page.locator(".orbits .faint").first).to_be_attached()
    orbits = asked.of("/orbits")
    assert {path: without for path, (without, _) in orbits.items()} == {
        f"/api/v1/runs/{one}/orbits": ["1"] for one in (run, reference)
    }
    assert seen.errors == []


@pytest.mark.parametrize("tab", ["response", "shapes"])
def test_a_run_without_a_fit_is_shown_without_the_slow_roll_in_force(seen: Seen, service: Service, tab: str) -> None:
    run, _ = _runs(service)

    def none_of_the_run(route: Route) -> None:
        route.fulfill(json=[])

    seen.page.route(re.compile(r"/identifications\?from="), none_of_the_run)
    seen.open(f"machines/{COPY}/{tab}?run={run}")
    expect(seen.page.get_by_text("slow roll version 2 subtracted").first).to_be_visible()
    assert seen.errors == []


@pytest.mark.parametrize("tab", ["response", "shapes"])
def test_what_has_no_slow_roll_is_said_to_be_as_measured(seen: Seen, tab: str) -> None:
    seen.open(f"machines/{MACHINE}/{tab}")
    expect(seen.page.get_by_text("as measured, no slow roll subtracted").first).to_be_visible()
    assert seen.errors == []
