"""Tests what is told of an alert: how far, how sure, how urgent, what to do; the same in every place; whatever evidence there
is."""

import re
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import pytest

from service.advice.advice import FindingFacts, advice_of, plain_message
from service.advice.advice_lines import advice_lines
from service.advice.site_texts import SiteTexts
from service.alerts.advice_message import Advice
from service.alerts.lifecycle import Severity
from service.monitoring.rules.finding_catalogue import finding_rule
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.wording.language import ENGLISH, GERMAN, LANGUAGES, Language

MEASURED = datetime(2026, 11, 26, tzinfo=UTC)

NUMBERS = {
    "wear": {"clearance_per_cent": 15.0, "clearance_error_per_cent": 1.0, "before_um": 69.0, "after_um": 79.0},
    "oil": {"viscosity_per_cent": 80.0},
    "settlement": {"vertical_um": -60.0, "vertical_error_um": 5.0},
    "unbalance": {"change_g_mm": 100.0, "change_deg": 12.0, "before_g_mm": 300.0, "after_g_mm": 350.0},
    "bow": {"largest_um": 12.0},
    "run_out": {"largest_um": 12.0},
}
PART = {"name": "coupling.C1.coefficients", "unit": "%", "value": 12.0, "lower": 10.0, "upper": 14.0, "sigma": 12.0}
PART |= {"allowed": None, "before": None, "members": ["coupling.C1.kxx"]}
AHEAD = {"limit": 15.0, "expected": 3.0, "earliest": 2.0, "latest": 6.0}
GROWING = {"runs": 8, "newest": 12.0, "per_week": 1.0, "lower": 0.5, "upper": 1.5, "ahead": AHEAD}
EVIDENCE: dict[str, Any] = {"since": "2026-10-22T09:00:00Z", "quantities": {}, "sigma": 12.0, "runs": 2, "evidence": 40.0}


def told(
    kind: str, element: str, severity: Severity | None = Severity.ALERT, language: Language = ENGLISH, **said: Any
) -> Advice:
    facts = FindingFacts("pump-7", kind, element, EVIDENCE | said, severity, MEASURED)
    found = advice_of(facts, SiteTexts(language=language))
    assert found is not None
    return found


@pytest.mark.parametrize("kind", [one.kind for one in FINDING_RULES])
@pytest.mark.parametrize("severity", [None, Severity.ALERT, Severity.DANGER])
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_finding_says_what_it_is_and_what_to_do(kind: str, severity: Severity | None, language: Language) -> None:
    kinds = {"pedestal": "pedestal.P1", "bow": "shaft.S1"}
    place = kinds.get(kind, "machine" if kind in ("oil", "misfit", "outliers") else "bearing.B2")
    one = told(kind, place, severity, language, quantities=NUMBERS.get(kind, {}))
    assert "2026-10-22" in one.what
    assert one.check
    assert one.confirm
    assert one.not_determined
    assert {action.opportunity for action in one.actions} >= {"in operation", "at the next stop"}
    urgent = severity is Severity.DANGER and finding_rule(kind).can_be_danger
    assert any(action.opportunity == "now" for action in one.actions) == urgent
    assert "{" not in "".join(advice_lines(one, language))


def test_the_time_to_the_limit_has_its_interval() -> None:
    urgent = told("coupling", "coupling.C1", parts=[PART], progress=GROWING).how_urgent
    assert (urgent.weeks, urgent.weeks_earliest, urgent.weeks_latest, urgent.limit) == (3.0, 2.0, 6.0, 15.0)
    assert urgent.by == datetime(2026, 12, 17, tzinfo=UTC)
    assert urgent.words.startswith(
        "Reaches its danger limit of 15 % in 3 weeks (2 weeks at the earliest, 6 weeks at the latest)"
    )
    never = told("coupling", "coupling.C1", parts=[PART], progress=GROWING | {"ahead": AHEAD | {"latest": None}})
    assert "it may also never" in never.how_urgent.words


@pytest.mark.parametrize(
    ("progress", "severity", "words"),
    [
        (
            {"runs": 2, "newest": 9.0},
            Severity.ALERT,
            "No time can be given: the newest run by itself shows 9 %; 2 runs since it began, and 4",
        ),
        ({"runs": 1}, None, "No time can be given: 1 run since it began"),
        (
            GROWING | {"ahead": None},
            Severity.DANGER,
            "The danger limit is reached; the newest run by itself shows 12 %; it grows by",
        ),
        (GROWING | {"lower": -0.1, "ahead": None}, Severity.ALERT, "There is no danger limit ahead: .* no growth is certain"),
        (
            GROWING | {"lower": -0.1, "ahead": AHEAD | {"expected": None}},
            Severity.ALERT,
            "The danger limit of 15 % is not approached measurably",
        ),
        (None, Severity.ALERT, "No time can be given"),
    ],
)
def test_where_no_time_can_be_given_that_is_said(progress: Any, severity: Severity | None, words: str) -> None:
    urgent = told("coupling", "coupling.C1", severity, parts=[PART], progress=progress).how_urgent
    assert urgent.weeks is None
    assert re.match(words, urgent.words), urgent.words


@pytest.mark.parametrize(("language", "words"), [(ENGLISH, "Its cause is gone"), (GERMAN, "Die Ursache ist entfallen")])
def test_nothing_is_urgent_once_the_cause_is_gone(language: Language, words: str) -> None:
    """Otherwise a mail that an alert is over says that its danger limit is reached, and to agree on a stop now."""
    evidence = EVIDENCE | {"parts": [PART], "progress": GROWING}
    facts = FindingFacts("pump-7", "coupling", "coupling.C1", evidence, Severity.DANGER, MEASURED)
    for is_gone in (False, True):
        one = advice_of(replace(facts, is_gone=is_gone), SiteTexts(language=language))
        assert one is not None
        assert one.how_urgent.words.startswith(words) == is_gone
        assert one.how_urgent.reached != is_gone
        assert any(action.opportunity == "now" for action in one.actions) != is_gone
        assert one.how_far  # what was found stays


def test_the_size_of_several_elements_is_reported_as_their_mean() -> None:
    """Otherwise +53 % stands above and 36 % below, and a reader takes one of them for wrong."""
    bearing = PART | {"name": "bearing.B2.coefficients", "value": 4.0}
    urgent = told("misalignment", "coupling.C1", parts=[PART, bearing], per_cent=8.0, progress=GROWING).how_urgent
    words = "the mean of the 2 elements that the limits are for is 8 %, in the newest run by itself 12 %; it grows"
    assert words in urgent.words


@pytest.mark.parametrize(("language", "oil"), [(ENGLISH, "oil"), (GERMAN, "öl")])
def test_of_a_seal_nothing_is_said_of_oil(language: Language, oil: str) -> None:
    one = told("bearing", "seal.S1", Severity.DANGER, language, parts=[PART | {"name": "seal.S1.coefficients"}])
    said = " ".join([one.what, *one.check, *(each.text for each in one.actions), *one.confirm, *one.not_determined])
    assert "S1" in one.what
    assert oil not in said.lower()
    of_bearing = told("bearing", "bearing.B1", Severity.DANGER, language, parts=[PART | {"name": "bearing.B1.coefficients"}])
    assert oil in " ".join(of_bearing.check).lower()


def test_an_alignment_is_reported_in_micrometres_and_milliradians() -> None:
    numbers = {"allowed_at_rpm": 3600.0, "angle_vertical_urad": 600.0, "angle_vertical_half_width_urad": 50.0}
    numbers |= {"angle_vertical_allowed_urad": 370.0}
    part = PART | {"name": "coupling.C1.angle_vertical", "unit": "urad", "value": 600.0, "lower": 550.0, "upper": 650.0}
    part |= {"allowed": 370.0, "members": []}
    one = told("misalignment", "coupling.C1", quantities=numbers, parts=[part], tolerance_per_cent=162.0)
    (figure,) = one.how_far
    assert (figure.unit, figure.value, figure.lower, figure.allowed) == ("mrad", 0.6, 0.55, 0.37)
    assert figure.runs == 1
    assert one.what.startswith("Coupling C1 is out of alignment: ")
    assert "The offset is not determined" in one.not_determined


def test_evidence_of_another_release_is_reported_by_kind_and_element(caplog: pytest.LogCaptureFixture) -> None:
    facts = FindingFacts("pump-7", "wear", "bearing.B2", EVIDENCE, Severity.ALERT, MEASURED)
    assert advice_of(facts, SiteTexts()) is None  # without the numbers of a clearance
    assert "cannot be put into words" in caplog.text
    older = FindingFacts("pump-7", "misalignment", "coupling.C1", {"coupling": "C1", "shift": 0.1}, None, MEASURED)
    assert advice_of(older, SiteTexts()) is None
    assert advice_of(FindingFacts("pump-7", "rub", "shaft.S1", EVIDENCE, None, MEASURED), SiteTexts()) is None
    assert plain_message("run_out", "probe.B1X") == "Run-out of probe B1X"
    assert plain_message("bearing", "bearing.B1") == "Bearing B1 itself"


def test_a_finding_is_reported_in_german() -> None:
    others = {"runners_up": [{"kind": "coupling", "element": "coupling.C1", "evidence": 38.0}]}
    ahead = AHEAD | {"expected": 1.0, "earliest": 0.5, "latest": None}
    one = told("misalignment", "coupling.C1", None, GERMAN, parts=[PART], progress=GROWING | {"ahead": ahead}, **others)
    assert one.what == (
        "Kupplung C1 verliert ihre Ausrichtung: alle Koeffizienten von Kupplung C1 zusammen +12 % (+10 bis +14), "
        "gegen den Referenzzustand, seit 2026-10-22"
    )
    assert one.how_sure.words == (
        "12 σ für alles zusammen über die neuesten 2 Läufe gemeinsam; 7,4 Mal so wahrscheinlich wie die nächste Erklärung: "
        "Kupplung C1 selbst"
    )
    assert one.how_urgent.words == (
        "Erreicht den Grenzwert für Gefahr von 15 % in 7 Tagen (frühestens in 4 Tagen, möglicherweise auch nie): "
        "der neueste Lauf für sich zeigt 12 %; es wächst um +1 % je Woche (+0,5 bis +1,5) über 8 Läufe"
    )
    # What programs read is the same in all languages.
    assert one.actions[0].opportunity == "in operation"
    assert "Zu tun beim nächsten Stillstand:" in advice_lines(one, GERMAN)
    assert plain_message("run_out", "probe.B1X", GERMAN) == "Runout an Aufnehmer B1X"
