"""Zero contradictions between the places that tell of one thing, and the comparison sees one when there is one."""

import html
import json
import re
from collections.abc import Callable, Mapping
from typing import Any

import pytest
from sqlalchemy import update

from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.delivery.channel import EventMessage
from service.delivery.cloud_event import cloud_event
from service.delivery.mail import compose_mail
from service.reports.period import asked_period
from service.reports.printing import report_html
from service.reports.reading import read_contents
from service.wording.language import ENGLISH, GERMAN, Language
from service.wording.shown_units import USUAL_UNITS, ShownUnits, UnitsName, units_of
from storage.alerts import alerts
from storage.clock import now
from storage.database.engine import Database
from storage.tables.findings import DiagnosisRow
from tests.api_in_process import Api
from tests.contradictions import contradictions
from tests.estimator.alignment.drawn_runs import MODEL
from tests.plant import KEY
from tests.service.delivery.receivers import settings
from tests.service.monitoring.test_alignment_alerts import FilmWeeks, sunk
from tests.service.monitoring.test_assessment import BASELINE, STIFFER, Weeks

SCENARIOS: Mapping[str, Mapping[str, float]] = {
    "misalignment": STIFFER,
    "unbalance": {"disc.D1.unbalance": 3.0},
    "bearing": {"bearing.B1.kxx": 1.4, "bearing.B1.kyy": 1.4},
}
FILM_SCENARIOS: Mapping[str, Mapping[str, float]] = {
    "misalignment": sunk(120e-6),
    "wear": {"bearing.B2.clearance": 0.15},
}


def asked(api: Api) -> Callable[[str], Any]:
    """Function that asks the API."""
    return lambda path: api.value(path)


@pytest.mark.parametrize("rule", SCENARIOS)
def test_a_train_with_coefficients_is_reported_in_one_way(plant: Database, rule: str) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE, unknown=("coupling.C1.cxx",))
        for week in range(4):
            weeks.file({name: 1.0 + (factor - 1.0) * (0.7 + 0.1 * week) for name, factor in SCENARIOS[rule].items()})
    api = Api(plant)
    assert [one["rule"] for one in api.value("/alerts?open=true")] == [rule]
    wrong, compared = contradictions(asked(api), KEY.machine)
    assert wrong == []
    assert compared > 20


@pytest.mark.parametrize("rule", FILM_SCENARIOS)
def test_a_train_on_oil_films_is_reported_in_one_way(plant: Database, rule: str) -> None:
    weeks = FilmWeeks(plant)
    weeks.file({}, times=BASELINE + 2)
    weeks.file(FILM_SCENARIOS[rule], times=3)
    api = Api(plant)
    assert [one["rule"] for one in api.value("/alerts?open=true")] == [rule]
    wrong, compared = contradictions(asked(api), MODEL.machine.id)
    assert wrong == []
    assert compared > 20


def mail_body(event: AlertEvent, language: Language) -> str:
    """Text of the mail about an event."""
    return str(compose_mail(settings(), "anna@plant.example", EventMessage(event, "plant-1"), language).get_content())


def test_a_contradiction_is_seen(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
        row = session.query(DiagnosisRow).order_by(DiagnosisRow.identification_id.desc()).first()
        assert row is not None
        (cause,) = row.causes
        part = cause["parts"][0]
        lied = cause | {"parts": [part | {"value": 2.0 * part["value"]}, *cause["parts"][1:]]}
        session.execute(
            update(DiagnosisRow).where(DiagnosisRow.identification_id == row.identification_id).values(causes=[lied])
        )
    api = Api(plant)
    wrong, _ = contradictions(asked(api), KEY.machine)
    assert any(part["name"] in one and "diagnosis" in one for one in wrong)


@pytest.mark.parametrize("language", [ENGLISH, pytest.param(GERMAN, marks=pytest.mark.long)])
def test_report_mail_and_webhook_tell_the_alert_s_figures(plant: Database, language: Language) -> None:
    """Of the same event the same words, in either language."""
    weeks = FilmWeeks(plant)
    weeks.file({}, times=BASELINE + 2)
    weeks.file(sunk(120e-6), times=2)
    texts = SiteTexts(language=language)
    alert = open_alert(plant, language)
    with plant.reading() as session:
        event = alert_event(alerts.history(session, alert["id"])[-1], texts)
    hook = json.dumps(json.loads(cloud_event(EventMessage(event, "plant-1"))), ensure_ascii=False)
    for place, told in {"report": report_of(plant, texts), "mail": mail_body(event, language), "webhook": hook}.items():
        assert [one for one in words_of(alert) if one not in told] == [], place
    # An alert follows the newest run without an event; so does the report.
    weeks.file(sunk(150e-6), times=2)
    later, page = open_alert(plant, language), report_of(plant, texts)
    assert words_of(later) != words_of(alert)
    assert [one for one in words_of(later) if one not in page] == []
    (figure, *_) = later["advice"]["how_far"]
    size, half = figure["value"], (figure["upper"] - figure["lower"]) / 2.0
    row = f"<td>{size:.0f} µm</td><td>{half:.0f} µm</td>"
    assert (row if language == ENGLISH else row.replace(".", ",")) in page, "the table of alignments says the same"


@pytest.mark.parametrize("units", [pytest.param("um_pp,rpm", marks=pytest.mark.long), "mil_pp,rpm"])
def test_report_and_api_tell_the_same_alignment_and_loads(plant: Database, units: UnitsName) -> None:
    """Every row of the report's tables, in µm or mil, is a number of `alignment`; the alert's words are the same in both."""
    weeks = FilmWeeks(plant)
    weeks.file({}, times=BASELINE)
    weeks.file(sunk(120e-6), times=4)
    shown = units_of(units)
    page = report_of(plant, SiteTexts(), shown)
    tag = "en-u-ms-ussystem" if shown.length == "mil" else "en"
    (alert,) = Api(plant).ask("GET", "/api/v1/alerts?open=true", headers={"accept-language": tag}).json()
    assert [one for one in words_of(alert) if one not in page] == []
    told = Api(plant).value(f"/machines/{MODEL.machine.id}/alignment")
    scale = {"m": shown.in_length(1e6), "rad": 1e3, "N": 1.0}
    rows = [re.findall(r"<td[^>]*>([^<]*)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", page)]
    compared = 0
    for one in (*told["numbers"], *told["loads"]):
        element, change = one.get("coupling") or one["bearing"], one["change"]
        quantity = one["quantity"].replace("_", " ")
        (row,) = (each for each in rows if each[:2] == [element, quantity] and len(each) == 6)
        if change["value"] is None:
            assert "not determined" in row[2]
            continue
        said, half = (row[3], row[4]) if one["unit"] == "N" else (row[2], row[3])
        factor = scale[one["unit"]]
        for text, value in ((said, change["value"]), (half, (change["upper"] - change["lower"]) / 2.0)):
            digits = text.split()[0]
            last = 10.0 ** -len(digits.partition(".")[2])
            assert float(digits) == pytest.approx(factor * value, abs=0.51 * last + 0.005 * abs(factor * value)), (row, one)
            compared += 1
    assert compared >= 8


def open_alert(plant: Database, language: Language) -> dict[str, Any]:
    """Return the one open alert as the API tells it."""
    answer = Api(plant).ask("GET", "/api/v1/alerts?open=true", headers={"accept-language": language.code})
    (alert,) = answer.json()
    return dict(alert)


def words_of(alert: dict[str, Any]) -> list[str]:
    """Return what an alert says of its size, certainty and urgency."""
    said = alert["advice"]
    return [said["what"], *(one["words"] for one in said["how_far"]), said["how_sure"]["words"], said["how_urgent"]["words"]]


def report_of(plant: Database, texts: SiteTexts, units: ShownUnits = USUAL_UNITS) -> str:
    """Return the report's pages as text."""
    with plant.reading() as session:
        period = asked_period(0, None, moment=now())
        contents = read_contents(session, MODEL.machine.id, period, texts=texts, baseline_runs=BASELINE, units=units)
    return html.unescape(report_html(contents))
