"""Declarations of findings: complete, without contradictions, and in the documentation as in the code."""

import re
from collections.abc import Mapping

import pytest

from estimator.diagnosis.finding_kinds import FINDING_KINDS
from service.monitoring.rules.finding_catalogue import LIMITED_RULES, finding_at, finding_name, require_complete
from service.monitoring.rules.finding_rule import AlertRule, FindingRule
from service.monitoring.rules.finding_rules import FINDING_RULES
from service.monitoring.rules.limit_rule import Level, Rule
from service.wording.finding_texts import FindingTexts
from service.wording.language import ENGLISH, GERMAN, Locale
from tests.paths import ROOT

DOCS = ROOT / "docs"
KINDS = [one.kind for one in FINDING_KINDS]


RUBS_LISTS = (("a",), ("b",), ("c",), ("d",), ("e",), ("f",))
RUBS = FindingTexts("Shaft {id} rubs", *RUBS_LISTS)
NAMES: Mapping[Locale, str] = {"de": "Anstreifen"}


def in_all(english: FindingTexts) -> Mapping[Locale, FindingTexts]:
    """Texts in every language: German ones that can be told, and the English ones."""
    return {"de": FindingTexts("Welle {id} streift an", *RUBS_LISTS), "en": english}


def test_a_kind_without_texts_is_refused() -> None:
    with pytest.raises(ValueError, match="without texts and alert rule in FINDING_RULES: rub"):
        require_complete(FINDING_RULES, [*KINDS, "rub"])


def test_texts_of_what_is_no_finding_is_refused() -> None:
    rub = FindingRule("rub", AlertRule("rub"), NAMES, in_all(RUBS))
    with pytest.raises(ValueError, match="no kind of finding of the estimator: rub"):
        require_complete([*FINDING_RULES, rub], KINDS)
    with pytest.raises(ValueError, match="declared twice"):
        require_complete([*FINDING_RULES, FINDING_RULES[0]], KINDS)
    assert require_complete([*FINDING_RULES, rub], [*KINDS, "rub"])["rub"] is rub


def test_limits_that_contradict_their_rule_are_refused() -> None:
    limits = Rule(alert=Level(sigma=4, per_cent=5))
    with pytest.raises(ValueError, match="'rub' needs both limits and quantities"):
        AlertRule("rub", limits=limits)
    with pytest.raises(ValueError, match="'rub' needs both limits and quantities"):
        AlertRule("rub", quantities=("sigma",))
    with pytest.raises(ValueError, match=r"alert\.per_cent is no limit of rub: it has sigma"):
        AlertRule("rub", limits=limits, quantities=("sigma",))


def test_a_limit_for_a_force_needs_one() -> None:
    rule = AlertRule("rub", limits=Rule(alert=Level(sigma=4, force=5)), quantities=("sigma", "force"))
    with pytest.raises(ValueError, match="'rub' can have a limit for a force"):
        FindingRule("rub", rule, NAMES, in_all(RUBS))


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (FindingTexts("Shaft {id} rubs at {speed}", *RUBS_LISTS), r"what \{speed\} is no place: it has \{id\}, \{element\}"),
        (FindingTexts("Shaft {id} rubs", ("look at {id:d}",), *RUBS_LISTS[1:]), r"check\[0\] \{id:d\} is no place"),
        (FindingTexts("Shaft {id} rubs", ("look at {id",), *RUBS_LISTS[1:]), r"check\[0\] is no text with places"),
        (FindingTexts("Shaft {id} rubs", (" ",), *RUBS_LISTS[1:]), r"check\[0\] must have 1 to 600 characters"),
        (FindingTexts("Shaft {id} rubs"), "no texts of check, in_operation, at_next_stop, confirm, not_determined"),
    ],
)
def test_texts_that_could_not_be_reported_are_refused(texts: FindingTexts, words: str) -> None:
    with pytest.raises(ValueError, match=f"finding 'rub'.*{words}"):
        FindingRule("rub", AlertRule("rub"), NAMES, in_all(texts))


@pytest.mark.parametrize(
    ("names", "texts", "words"),
    [
        ({}, in_all(RUBS), "name of finding 'rub' is missing in: de"),
        ({"de": ""}, in_all(RUBS), "name of finding 'rub' is missing in: de"),
        (NAMES, {"en": RUBS}, "texts of finding 'rub' is missing in: de"),
        (NAMES, {"de": RUBS}, "texts of finding 'rub' is missing in: en"),
        (NAMES, {"en": RUBS, "de": RUBS, "fr": RUBS}, "texts of finding 'rub' is said in fr, and the languages are en, de"),
        (NAMES, {"en": RUBS, "de": FindingTexts("Welle {id} streift an")}, r"'rub' \(de\) has no texts of check"),
        (
            NAMES,
            {"en": RUBS, "de": FindingTexts("Welle {if} streift an", *RUBS_LISTS)},
            r"'rub' \(de\): what \{if\} is no place",
        ),
    ],
)
def test_a_language_that_lacks_a_finding_is_refused(
    names: Mapping[Locale, str], texts: Mapping[Locale, FindingTexts], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        FindingRule("rub", AlertRule("rub"), names, texts)


def test_a_finding_is_named_in_each_language() -> None:
    assert finding_name("light_load", ENGLISH) == "light load"
    assert finding_name("light_load", GERMAN) == "zu geringe Lagerlast"
    assert finding_name("rate_of_change", GERMAN) == "Änderungsrate"
    assert finding_name("rubs_of_old", GERMAN) == "rubs of old"


@pytest.mark.parametrize(
    ("kind", "element", "english", "german"),
    [
        ("misalignment", "coupling.C1", "misalignment of coupling C1", "Ausrichtfehler an Kupplung C1"),
        ("heavy_load", "bearing.B2", "heavy load of bearing B2", "zu hohe Lagerlast an Lager B2"),
        ("bearing", "seal.S2", "seal S2 itself", "Dichtung S2 selbst"),
        ("process_force", "static_load.F1", "static force F1 itself", "Prozesskraft F1 selbst"),
        ("misfit", "machine", "model does not fit", "Modell passt nicht"),
        ("rubs_of_old", "shaft.S1", "rubs of old of shaft S1", "rubs of old an Welle S1"),
    ],
)
def test_a_finding_is_reported_with_its_element(kind: str, element: str, english: str, german: str) -> None:
    assert (finding_at(kind, element, ENGLISH), finding_at(kind, element, GERMAN)) == (english, german)


def test_the_documentation_has_every_kind_and_every_rule() -> None:
    method, alerts = (DOCS / "method-diagnosis.md").read_text(), (DOCS / "alerts.md").read_text()
    assert [kind for kind in KINDS if f"`{kind}`" not in method] == []
    rules = {
        name for line in alerts.splitlines() if line.startswith("| `") for name in re.findall(r"`(\w+)`", line.split("|")[1])
    }
    assert {one.rule.name for one in FINDING_RULES} | set(LIMITED_RULES) <= rules


@pytest.mark.parametrize("rule", LIMITED_RULES.values(), ids=lambda rule: rule.name)
def test_the_documentation_has_the_limits(rule: AlertRule) -> None:
    rows = [line.split("|") for line in (DOCS / "alerts.md").read_text().splitlines() if line.startswith("| `")]
    (row,) = [cells for cells in rows if f"`{rule.name}`" in cells[1] and len(cells) == 6]
    assert rule.limits is not None
    for level, shown in ((rule.limits.alert, row[2]), (rule.limits.danger, row[3])):
        sizes = [] if level is None else [f"{getattr(level, name):g}" for name in level.named]
        assert re.findall(r"[\d.]+", shown) == sizes
