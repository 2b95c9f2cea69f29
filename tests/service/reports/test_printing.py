"""Pages of a report: every part of a train on films, few elements, and nothing that people wrote is taken for HTML."""

import io
import re
import socket
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pypdf
import pytest

from estimator.phasors.measurement import Measurement
from service.advice.site_texts import SiteTexts
from service.configuration.settings import Settings
from service.identification.stored_model import UsedRun
from service.reports.contents import ReportContents, ReportedNote, ReportedTrend
from service.reports.period import asked_period
from service.reports.printing import printed_html, report_html
from service.reports.reading import read_contents
from service.reports.trend_figure import trend_figure
from service.wording.language import ENGLISH, GERMAN, Language
from service.wording.shown_units import CHOICES, USUAL_UNITS, ShownUnits, UnitsUnknown, units_of
from storage.clock import now
from storage.database.engine import Database
from tests.databases import Databases, opened
from tests.estimator.alignment.drawn_runs import MODEL
from tests.paths import ROOT
from tests.plant import KEY, START
from tests.service.monitoring.test_alignment_alerts import FilmWeeks, sunk
from tests.service.monitoring.test_assessment import BASELINE
from tests.service.monitoring.test_assessment import Weeks as CoefficientWeeks

MANY = 10_000


@pytest.fixture(scope="module")
def sunken_plant(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    """A plant with a train on films one of whose bearings has sunk by 120 µm; the tests only read it."""
    with opened(databases, plant_template, tmp_path_factory.mktemp("sunken") / "rundown.db") as one:
        weeks = FilmWeeks(one)
        weeks.file({}, times=BASELINE + 2)
        weeks.file(sunk(120e-6), times=3)
        yield one


@pytest.fixture(scope="module")
def sunken(sunken_plant: Database) -> ReportContents:
    """Contents of a report of it."""
    return contents_of(sunken_plant, ENGLISH)


def contents_of(plant: Database, language: Language, units: ShownUnits = USUAL_UNITS) -> ReportContents:
    with plant.reading() as session:
        period = asked_period(START, None, moment=now())
        texts = SiteTexts(language=language)
        return read_contents(session, MODEL.machine.id, period, texts=texts, baseline_runs=BASELINE, units=units)


def test_every_part_is_reported_with_the_same_figures_as_the_alert(sunken: ReportContents) -> None:
    page = report_html(sunken)
    heads = re.findall(r"<h2>(.*?)</h2>", page)
    assert heads == [
        "Trends",
        "Vibration over speed (1×)",
        "Orbits",
        "Shaft centreline",
        "Alignment",
        "Balance",
        "History",
    ]
    (alert,) = sunken.open_alerts
    assert alert.last.advice is not None
    assert all(one.words in page for one in alert.last.advice.how_far)
    carried = re.findall(r"(B\d) carries (\d+) % (more|less)|, (B\d) (\d+) % (more|less)", page)
    assert carried
    for first in carried:
        bearing, part, which = first[:3] if first[0] else first[3:]
        told = f"{'+' if which == 'more' else '-'}{part} %"
        assert re.search(
            rf"<tr><td>{bearing}</td><td>load vertical</td>(<td>[^<]*</td>){{3}}<td>{re.escape(told)}</td></tr>", page
        )
    assert "cannot be computed" not in page
    assert "No correction is proposed: mend C1 first" in page


def test_the_same_is_reported_in_german(sunken_plant: Database, sunken: ReportContents) -> None:
    page = report_html(contents_of(sunken_plant, GERMAN))
    assert '<html lang="de">' in page
    assert re.findall(r"<h2>(.*?)</h2>", page) == [
        "Trends",
        "Schwingung über der Drehzahl (1×)",
        "Wellenbahnen",
        "Wellenlage",
        "Ausrichtung",
        "Auswuchten",
        "Verlauf",
    ]
    assert "Kupplung C1 ist falsch ausgerichtet: die getriebene Welle liegt" in page
    assert "Kein Ausgleich wird vorgeschlagen: zuerst C1 instand setzen" in page
    assert 'content: "Seite " counter(page) " von "' in page
    value = np.array([6.4, 6.6])
    drawn = trend_figure(ReportedTrend("x", "N", np.array([0, 10**16]), value, value, value, None), GERMAN)
    assert ">6,5<" in drawn
    # No sentence of the English report is left.
    english = set(re.findall(r">([^<>]*[A-Za-z]{3,} [a-z]{2,}[^<>]*)<", report_html(sunken)))
    assert {one for one in english if f">{one}<" in page} == set()


@pytest.mark.parametrize("language", [ENGLISH, GERMAN])
def test_a_report_is_in_the_units_that_are_asked_for(
    sunken_plant: Database, sunken: ReportContents, language: Language
) -> None:
    """All of it: plots, tables and sentences. Speeds in sentences of findings are told with their own unit, as on the page."""
    asked = contents_of(sunken_plant, language, units_of("mil_p,hz"))
    quiet = replace(sunken, alerts=(), not_to_balance=None)  # with a proposal of masses, which an alert would hold back
    for contents in (asked, replace(quiet, language=asked.language, units=asked.units, trends=asked.trends)):
        page = report_html(contents)
        assert [text for text in page.split(">") if re.search(r"\b(µm|pp)\b", text)] == []
        assert {">1× [mil 0-pk]<", ">Hz<"} <= set(re.findall(r">[^<>]*<", page))
    assert re.search(rf"({'to below' if language is ENGLISH else 'auf unter'}) [\d.,]+ mil 0-pk", page)
    proposed = re.findall(r"(?:falls from|fällt das größte 1× über den Drehzahlen von) ([\d.,]+)", page)
    in_um = re.findall(r"falls from ([\d.]+)", report_html(quiet))
    assert float(proposed[0].replace(",", ".")) == pytest.approx(float(in_um[0]) / 25.4 / 2.0, rel=0.01)
    (alert,) = asked.open_alerts
    assert alert.last.advice is not None
    offsets = [one.words for one in alert.last.advice.how_far if "mil" in one.words]
    assert offsets, "sentences are in the unit of the plots"
    for before, after in zip(sunken.trends, asked.trends, strict=True):
        if before.unit == "µm":
            assert after.unit == "mil"
            assert np.allclose(after.value, before.value / 25.4)


def test_units_are_those_of_the_page_and_of_the_settings() -> None:
    shown = (ROOT / "dashboard" / "src" / "browser" / "units.ts").read_text(encoding="utf-8")
    amplitudes = re.findall(r"^  (\w+): \{ label: \"(.*?)\", factor: (.*?) \},$", shown, re.MULTILINE)
    assert {f"{name},{speed}" for name, _, _ in amplitudes for speed in ("rpm", "hz")} == set(CHOICES)
    for name, label, factor in amplitudes:
        units = units_of(f"{name},rpm")
        dividend, _, divisor = factor.replace("MIL_UM", "25.4").partition(" / ")
        assert units.amplitude_label() == label
        assert units.amplitude_factor() == pytest.approx(float(dividend) / float(divisor or 1.0))
    assert get_args(Settings.model_fields["report_units"].annotation) == CHOICES
    with pytest.raises(UnitsUnknown, match=r"'inch,rpm' are none of: um_pp,rpm; "):
        units_of("inch,rpm")


def test_a_plot_of_10_000_points_stays_small(sunken: ReportContents) -> None:
    fit = sunken.fit
    assert fit is not None
    machine = fit.one.machine
    phasor = np.full((MANY, len(machine.channels)), 1e-5 + 0j)
    speed = np.linspace(fit.one.speed_minimum, fit.one.speed_maximum, MANY)
    run = UsedRun(1, machine, Measurement.of(speed=speed, phasor=phasor), np.zeros(phasor.shape, bool), np.arange(MANY))
    time, value = np.arange(MANY) * 10**12, np.ones(MANY)
    trend = ReportedTrend("coupling.C1.kxx", "MN/m", time, value, value - 0.1, value + 0.1, None)
    more = replace(sunken, fit=replace(fit, runs=(run,)), trends=(trend,) * 16)
    assert len(report_html(more)) < 3 * len(report_html(sunken))


def test_an_open_alert_is_reported_however_many_came_later(sunken_plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.reports.reading.MOST_ALERTS", 0)
    with sunken_plant.reading() as session:
        period = asked_period(START, None, moment=now())
        found = read_contents(session, MODEL.machine.id, period, texts=SiteTexts(), baseline_runs=BASELINE)
    assert [one.last.element for one in found.open_alerts] == ["coupling.C1"]


def test_what_people_write_is_text(sunken: ReportContents) -> None:
    note = ReportedNote(sunken.last, "note", "<i>eve</i>", '<img src="http://elsewhere/"/>\x00')
    page = report_html(replace(sunken, notes=(note,))).replace("<wbr>", "")  # in long words
    assert "&lt;img src=&quot;http://elsewhere/&quot;/&gt;<" in page
    assert "<i>eve" not in page


@pytest.fixture(scope="module")
def seconds_without_notes(sunken: ReportContents) -> float:
    """Return how long the report without notes takes to print."""
    began = time.process_time()
    printed_html(report_html(replace(sunken, notes=())))
    return time.process_time() - began


@pytest.mark.parametrize(
    "text", ["misaligned coupling " * 45, pytest.param("x" * 870, marks=pytest.mark.long)], ids=["words", "one word"]
)
def test_long_notes_cost_little_and_stay_on_the_page(sunken: ReportContents, seconds_without_notes: float, text: str) -> None:
    """A cell in which every character might end a line took the printer a second of its own."""
    note = ReportedNote(at=sunken.made_at, kind="maintenance", by="anna", text=text)
    began = time.process_time()
    pdf = printed_html(report_html(replace(sunken, notes=(note,) * 40)))
    assert time.process_time() - began < 4.0 * seconds_without_notes + 4.0
    told = "".join(page.extract_text() for page in pypdf.PdfReader(io.BytesIO(pdf)).pages)
    assert re.sub(r"\s|\u200b", "", told).count(text.replace(" ", "")) == 40


def test_nothing_is_loaded(tmp_path: Path) -> None:
    picture = tmp_path / "picture.svg"
    picture.write_text('<svg xmlns="http://www.w3.org/2000/svg"><text>private</text></svg>')
    with socket.create_server(("127.0.0.1", 0)) as listening:
        listening.settimeout(0.1)
        port = listening.getsockname()[1]
        page = f'<img src="http://127.0.0.1:{port}/a.png"/><img src="{picture.as_uri()}"/><p>told</p>'
        (text,) = [one.extract_text() for one in pypdf.PdfReader(io.BytesIO(printed_html(page))).pages]
        with pytest.raises(TimeoutError):
            listening.accept()
    assert text.strip() == "told"


def test_names_and_numbers_are_those_that_people_use(sunken: ReportContents) -> None:
    fit = sunken.fit
    assert fit is not None
    time, value = np.array([0, 10**16]), np.array([1.0, 2.0])
    trends = [
        ReportedTrend(name, "", time, value, value - 0.1, value + 0.1, None)
        for name in ("coupling.C1.k_phix", "splitting.1-3")
    ]
    page = report_html(replace(sunken, trends=tuple(trends), alerts=(), not_to_balance=None))
    assert ">kφx of coupling C1<" in page
    assert ">critical speeds 1 and 3: distance over their mean<" in page
    assert re.search(r"falls from [\d.]+ to below \d+(\.\d+)? µm pp", page)
    assert re.findall(r">[^<>]*\de[+-]\d[^<>]*<", page) == [], "nobody reads 1e+04 aloud"


@pytest.mark.parametrize(("direction", "sense"), [(1, "with"), (-1, "against")])
def test_the_angle_of_a_correction_says_which_way_it_counts(sunken: ReportContents, direction: int, sense: str) -> None:
    """Angles count from +x towards +y: of a train that turns the other way that is against the rotation."""
    fit = sunken.fit
    assert fit is not None
    turned = replace(fit, one=replace(fit.one, direction=direction), baseline=(), reference=())
    page = report_html(replace(sunken, fit=turned, trends=(), alerts=(), not_to_balance=None))
    assert re.findall(r">angle from the mark, \+x towards \+y, (\w+) the rotation<", page) == [sense]


@pytest.mark.parametrize(("hours", "form"), [(0.5, r"\d\d-\d\d \d\d:\d\d"), (24.0 * 300, r"\d{4}-\d\d-\d\d")])
def test_a_trend_shows_values_and_intervals_of_an_hour_or_a_year(hours: float, form: str) -> None:
    time = np.array([0, int(hours * 3600e9)])
    drawn = trend_figure(
        ReportedTrend("x", "N", time, np.array([6.4, 6.42]), np.array([5.0, 5.1]), np.array([8.0, 8.1]), None)
    )
    assert len(re.findall(f">{form}<", drawn)) in range(2, 8)
    assert {">5<", ">8<"} & set(re.findall(r">[58]<", drawn)), "the axis holds the intervals"


def test_what_a_machine_cannot_show_is_said_in_its_place(plant: Database) -> None:
    with plant.transaction() as session:
        CoefficientWeeks(session).file(times=1)
    with plant.reading() as session:
        period = asked_period(START, None, moment=now())
        found = read_contents(session, KEY.machine, period, texts=SiteTexts(), baseline_runs=BASELINE)
    page = report_html(found)
    assert "only of bearings whose oil films the document describes" in page
    assert "a misalignment shows in the coupling&#x27;s force and moment" in page
