"""A machine's report as PDF: what it says, of whom it is kept, and what is answered where it cannot be printed."""

import io
import re
import threading
from datetime import UTC, datetime

import psutil
import pypdf
import pytest
from sqlalchemy import select

from service.reports.report_process import NotPrinted, ReportProcess
from service.reports.state_stamp import report_stamp
from storage.alerts import alerts
from storage.database.engine import Database
from storage.machines import timeline
from storage.tables.alerting import AlertRow
from tests.api_in_process import PREFIX, Api, refused
from tests.plant import KEY, SECOND, START, wait_until
from tests.service.monitoring.test_assessment import BASELINE, STIFFER, WEEK, Weeks

PATH = f"/machines/{KEY.machine}/report.pdf"
YEAR = {"from": datetime.fromtimestamp(START / SECOND, UTC).isoformat()}


@pytest.fixture
def stiffer(plant: Database) -> Api:
    """An API over a machine whose coupling became stiffer over four weeks: one open alert, with a comment and a note."""
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        for week in range(4):
            weeks.file({name: 1.0 + (factor - 1.0) * (0.7 + 0.1 * week) for name, factor in STIFFER.items()})
        timeline.add(session, KEY.machine, at=START + 3 * WEEK, kind="maintenance", text="<b>hot</b> check & foot", by="anna")
    return Api(plant)


def pages(pdf: bytes) -> list[str]:
    """Text of each page, with single spaces."""
    return [re.sub(r"\s+", " ", page.extract_text()) for page in pypdf.PdfReader(io.BytesIO(pdf)).pages]


def test_the_first_page_tells_the_finding_and_what_to_do(stiffer: Api) -> None:
    (alert,) = stiffer.value("/alerts?open=true")
    stiffer("POST", f"/alerts/{alert['id']}/comments", 200, json={"by": "bea", "comment": "crew told: laser on Friday"})
    answer = stiffer.get(PATH, **YEAR)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/pdf"
    first, *others = pages(answer.content)
    assert alert["message"] in first
    assert all(one["text"] in first for one in alert["advice"]["actions"])
    assert alert["advice"]["how_urgent"]["words"] in first
    later = " ".join(others)
    assert "kxx of coupling C1" in later
    assert "crew told: laser on Friday" in later
    assert "<b>hot</b> check & foot" in later


def test_a_report_is_in_the_language_that_is_asked_for(stiffer: Api) -> None:
    for answer in (stiffer.get(PATH, **YEAR, locale="de"), stiffer.get(PATH, **YEAR)):
        german = answer.headers["content-language"] == "de"
        assert ("Zu tun im Betrieb" in pages(answer.content)[0]) == german
        assert ("To do in operation" in pages(answer.content)[0]) != german
    assert [one["field"] for one in stiffer.get(PATH, **YEAR, locale="fr").json()["errors"]] == ["query.locale"]


def test_a_report_is_in_the_units_that_are_asked_for(stiffer: Api) -> None:
    """By `units`, else by the language tag's, else the site's; each is kept by itself."""
    asked = {"um": stiffer.get(PATH, **YEAR), "mil": stiffer.get(PATH, **YEAR, units="mil_p,hz")}
    asked["tag"] = stiffer.ask("GET", PREFIX + PATH, params=YEAR, headers={"Accept-Language": "en-u-ms-ussystem"})
    stiffer.app.state.report_units = "um_p,hz"
    asked["site"] = stiffer.get(PATH, **YEAR)
    told = {name: " ".join(pages(one.content)) for name, one in asked.items()}
    units = {"um": ("µm pp", "r/min"), "mil": ("mil 0-pk", "Hz"), "tag": ("mil pp", "r/min"), "site": ("µm 0-pk", "Hz")}
    for name, (amplitude, speed) in units.items():
        assert f"1× [{amplitude}]" in told[name]
        assert re.search(rf"1× at [\d.]+ {speed} by the fit", told[name])
    assert [one["field"] for one in stiffer.get(PATH, **YEAR, units="inch,rpm").json()["errors"]] == ["query.units"]


def test_a_report_is_kept_until_something_changes_that_it_tells(stiffer: Api, plant: Database) -> None:
    once = stiffer.get(PATH, **YEAR).content
    stiffer.app.state.report_process = _Never()
    assert stiffer.get(PATH, **YEAR).content == once
    with plant.transaction() as session:
        timeline.add(session, KEY.machine, at=START + WEEK, kind="note", text="heard a knock", by="anna")
    assert "ended" in refused(stiffer.get(PATH, **YEAR), 503)


class _Never:
    """A worker that dies with each report."""

    def printed(self, _: object) -> bytes:
        """No report."""
        raise NotPrinted("the process that prints reports ended")

    def close(self) -> None:
        """Close nothing."""


@pytest.mark.usefixtures("stiffer")
def test_figures_of_a_newer_run_renew_the_report(plant: Database) -> None:
    """An open alert follows its newest run without an event."""
    with plant.reading() as session:
        before = report_stamp(session, KEY.machine)
    with plant.transaction() as session:
        (row,) = session.scalars(select(AlertRow)).all()
        row.updated_at += 1
    with plant.reading() as session:
        assert report_stamp(session, KEY.machine) != before


@pytest.mark.usefixtures("stiffer")
def test_they_do_so_where_the_clock_was_ahead_once(plant: Database) -> None:
    """The newest time is for long that of the change that was made then."""
    with plant.transaction() as session:
        (row,) = session.scalars(select(AlertRow)).all()
        later = alerts.add(
            session,
            KEY.machine,
            rule=row.rule,
            element="bearing.B1",
            evidence=row.evidence,
            identification_id=row.identification_id,
            measured_at=row.measured_at,
            latching=False,
        )
        later.updated_at += 365 * 86_400 * SECOND
    with plant.reading() as session:
        before = report_stamp(session, KEY.machine)
    with plant.transaction() as session:
        session.get_one(AlertRow, row.id).updated_at += SECOND
    with plant.reading() as session:
        assert report_stamp(session, KEY.machine) != before


def test_an_empty_machine_is_not_called_well(api: Api) -> None:
    text = " ".join(pages(api.get(PATH).content))
    assert "Nothing has been measured of this machine yet: it cannot be judged." in text
    assert "No alert is open" not in text


def test_a_report_that_takes_too_long_says_so(stiffer: Api) -> None:
    stiffer.app.state.report_process = ReportProcess(time_s=0.001)
    answer = stiffer.get(PATH, **YEAR)
    assert "ask for a shorter period" in refused(answer, 503)
    assert answer.headers["retry-after"] == "5"


def test_a_worker_that_dies_is_said_and_replaced(stiffer: Api) -> None:
    killed: list[int] = []
    stiffer.app.state.report_process = ReportProcess()
    others = workers()  # of tests before this one

    def kill() -> None:
        wait_until(lambda: bool(set(workers()) - set(others)))  # one of these may end meanwhile
        for one in set(workers()) - set(others):
            killed.append(one.pid)
            one.kill()

    killing = threading.Thread(target=kill)
    killing.start()
    said = refused(stiffer.get(PATH, **YEAR), 503)
    killing.join()
    assert killed
    assert "ask again" in said
    assert stiffer.get(PATH, **YEAR).status_code == 200
    stiffer.app.state.report_process.close()


def workers() -> list[psutil.Process]:
    """Worker processes of this one that are not dead."""
    alive = [one for one in psutil.Process().children() if one.status() != psutil.STATUS_ZOMBIE]
    return [one for one in alive if "spawn_main" in " ".join(one.cmdline())]


def test_no_machine_and_no_period(api: Api) -> None:
    refused(api.get("/machines/none/report.pdf"), 404)
    assert "ends before it begins" in refused(api.get(PATH, **{"from": "2200-01-01T00:00:00Z"}), 422)
