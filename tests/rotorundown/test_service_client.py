"""The library's client against a real server: rows, frames, a run to identify, and what it says where nothing answers."""

import re
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from http.server import BaseHTTPRequestHandler, HTTPServer
from threading import Thread
from typing import Any

import msgspec
import pytest

import rotorundown as rd
from benchmarks.serving import served
from formats.recordings.recording import read_recording
from formats.wire import to_samples
from rotorundown.run_columns import WrongRun
from rotorundown.service_rows import AlertEntry, EstimateEntry, IdentificationEntry, MachineEntry, RunEntry
from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.api.alerts.schemas import AlertOut
from service.api.findings.schemas import EstimateOut, IdentificationSummary
from service.api.machines.schemas import MachineSummary
from service.api.measurements.schemas import Run
from service.security import api_keys
from service.security.role import Role
from storage.clock import now
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from tests.paths import DATA, EXAMPLES
from tests.plant import KEY, SECOND, START, identification, machine, store_identification
from tests.ports import free_port


@pytest.fixture
def url(plant: Database) -> Iterator[str]:
    """Address of a service over a machine with three identifications and an alert."""
    with plant.transaction() as session:
        for number, factor in enumerate((1.0, 1.0, 1.2)):
            outcome = identification({"coupling.C1.kxx": factor})
            row = store_identification(session, outcome, run_id=number, measured_at=START + number * SECOND)
        finding = AlertFinding({}, row.id, START)
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
    with served(plant) as where:
        yield where.removesuffix("/api/v1")


@pytest.fixture
def service(url: str) -> rd.Service:
    return rd.Service(url)


def test_what_is_there_is_read_as_rows(service: rd.Service) -> None:
    (one,) = service.machines()
    assert (one.id, one.name) == (KEY.machine, "Pump 7")
    assert service.machine(KEY.machine) == machine()
    assert len(service.runs(KEY.machine)) == 0
    found = service.identifications(KEY.machine, last=datetime.fromtimestamp(START // SECOND + 1, UTC))
    assert [one.id for one in found] == [2, 1]
    estimates = {one.parameter: one for one in service.estimates(3)}
    assert estimates["coupling.C1.kxx"].value == pytest.approx(2.4e6)
    (alert,) = service.alerts(only_open=True)
    assert (alert.element, alert.severity) == ("coupling.C1", "alert")
    assert "Misalignment of coupling C1" in repr(service.alerts(KEY.machine))
    assert service.alerts(KEY.machine)._repr_html_().startswith("<pre>AlertEntry(id=1, machine=&#x27;")


MISNAMED: dict[str, tuple[Callable[[Any], Any], str]] = {
    "an entry for a machine": (lambda service: service.machine(service.machines()[0]), "its id, not a MachineEntry"),
    "an entry for an identification": (
        lambda service: service.estimates(service.identifications(KEY.machine)[0]),
        "which identification, not a IdentificationEntry: of an entry give its .id",
    ),
    "text for a run": (lambda service: service.run("7"), "a whole number tells which run, not a str"),
    "a list of parameters": (
        lambda service: service.trend(KEY.machine, ["coupling.C1.kxx"]),
        "such as 'coupling.C1.kxx', not a list: name one or more, none in a list",
    ),
    "no parameter": (lambda service: service.trend(KEY.machine), "nothing was given: name one or more"),
    "text for a moment": (
        lambda service: service.runs(KEY.machine, first="2026-01-01"),
        "moments such as datetime(2026, 11, 27), not a str",
    ),
}


@pytest.mark.parametrize("name", MISNAMED)
def test_what_names_nothing_is_one_line(service: rd.Service, name: str) -> None:
    ask, words = MISNAMED[name]
    with pytest.raises(rd.ServiceError, match=re.escape(words)) as said:
        ask(service)
    assert "\n" not in str(said.value)


def test_trends_are_points_and_frames(service: rd.Service) -> None:
    points = service.trend(KEY.machine, "coupling.C1.kxx", "bearing.B1.kxx")
    assert [one.value for one in points if one.parameter == "coupling.C1.kxx"] == pytest.approx([2e6, 2e6, 2.4e6])
    frame = points.to_frame()
    assert len(frame) == 6
    assert frame["measured_at"].is_monotonic_increasing is False  # one parameter after the other
    assert list(points[:2].to_frame()["parameter"]) == ["coupling.C1.kxx"] * 2


def test_long_lists_are_followed_to_their_end(service: rd.Service, plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(110):
            store_identification(session, identification(), run_id=1000 + number, measured_at=START + 1000 + number)
    assert len(service.identifications(KEY.machine)) == 113


def test_refusals_say_why(service: rd.Service) -> None:
    with pytest.raises(rd.ServiceError, match="404 Not Found: no machine pump-8") as refused:
        service.machine("pump-8")
    assert refused.value.status == 404


def test_a_key_opens_the_service(plant: Database) -> None:
    with plant.transaction() as session:
        _, key = api_keys.create(session, name="historian", role=Role.VIEWER, plants=[KEY.plant], days=1)
    with served(plant) as where:
        url = where.removesuffix("/api/v1")
        with pytest.raises(rd.ServiceError, match="401"):
            rd.Service(url).machines()
        assert len(rd.Service(url, key=key).machines()) == 1


def test_what_does_not_answer_or_is_no_address_is_said_in_one_line() -> None:
    with pytest.raises(rd.ServiceError, match=r"http://127\.0\.0\.1:\d+ does not answer: .*refused") as silent:
        rd.Service(f"http://127.0.0.1:{free_port()}").machines()
    assert silent.value.status is None
    for wrong in ("localhost:8080", "file:///etc/passwd", "http://"):
        with pytest.raises(ValueError, match="is no address of a service"):
            rd.Service(wrong)


@pytest.mark.parametrize(
    ("row", "model"),
    [
        (MachineEntry, MachineSummary),
        (RunEntry, Run),
        (IdentificationEntry, IdentificationSummary),
        (EstimateEntry, EstimateOut),
        (AlertEntry, AlertOut),
    ],
)
def test_rows_have_the_fields_that_the_service_answers_with(row: type[msgspec.Struct], model: type) -> None:
    assert set(row.__struct_fields__) <= set(model.model_fields)  # type: ignore[attr-defined]


def test_a_recorded_run_is_taken_home_to_identify(service: rd.Service, plant: Database) -> None:
    kit, file = rd.read_machine(EXAMPLES / "rk4-rotor-kit.yaml"), DATA / "rk4_runup_1x.csv"
    samples, taken, _ = to_samples(read_recording(file), kit, received_at=now())
    with plant.transaction() as session:
        machines.create(session, kit)
        row = runs.open_run(session, kit.id, revision=1, kind="run-up", direction=1, time_first=int(samples.time[0]))
        runs.close(row, samples=samples.pick(taken), state=runs.CLOSED, reason="the speed stood still")
        number = row.id
    (entry,) = service.runs(kit.id)
    found, there = service.run(entry.id), rd.read_run(file, machine=kit)
    assert (found.name, entry.kind, entry.samples) == (f"run {number}", "run-up", len(there))
    assert found.speed_rpm == pytest.approx(there.speed_rpm)
    assert found.recorded.phasor == pytest.approx(there.recorded.phasor)
    assert found.interval_s == pytest.approx(there.interval_s)
    backwards = rd.Machine.model_validate(kit.model_dump() | {"rotation": "negative"})
    with pytest.raises(WrongRun, match="does not turn as"):
        service.run(number, machine=backwards)


def test_a_web_page_in_the_services_place_is_told_in_one_line() -> None:
    class Page(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(404)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(b"<!DOCTYPE html>\n<html>\n<body>not here</body></html>")

        def log_message(self, *_args: object) -> None: ...

    with HTTPServer(("127.0.0.1", 0), Page) as server:
        Thread(target=server.handle_request).start()
        with pytest.raises(rd.ServiceError) as refused:
            rd.Service(f"http://127.0.0.1:{server.server_port}").machines()
    assert str(refused.value) == "404 Not Found: a web page: is it the address of the service?"
