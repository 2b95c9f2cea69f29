"""The page in German: no view has English left, numbers have a comma, and the choice is kept; axe finds nothing."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, ViewportSize, expect

from tests.browser.conftest import Seen, shown
from tests.browser.shown_service import MACHINE, ZONE
from tests.browser.test_accessibility import faults
from tests.browser.views import VIEWS, show
from tests.end_to_end.processes import Service
from tests.paths import ROOT
from tests.service.test_dashboard_messages import PLACE, catalogue, declared

READ = """() => {
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode())
    if (node.parentElement.tagName !== "NOSCRIPT") found.push(node.data);
  for (const one of document.querySelectorAll("[title], [aria-label], [placeholder]"))
    for (const name of ["title", "aria-label", "placeholder"]) if (one.hasAttribute(name)) found.push(one.getAttribute(name));
  return found;
}"""
"""Everything that the page says, what is only read aloud included."""
ENGLISH_WORDS = re.compile(r"\b(?:the|of|is|are|with|from|not|and|this|has|which|since|by)\b")
"""Words that no German text of the page has. Identifiers and names of machines have none either."""
ENGLISH_HEADINGS = re.compile(r"\b(?:speed|time|channel|shaft|imaginary|semi-major|lower|upper|element|gap|overall)\b")
"""Words of headings of files."""
STORED = ROOT / "tests" / "service" / "wording" / "stored-sentences.txt"
WRITTEN = "Two-shaft train of the thesis, Chapter 3"
"""Texts that a person has written: the machine's name."""


@pytest.fixture
def german(browser: Browser, service: Service, request: pytest.FixtureRequest) -> Iterator[Seen]:
    """A page in a window of a laptop whose browser wants German."""
    size = ViewportSize(width=1440, height=900)
    context = browser.new_context(viewport=size, color_scheme="light", timezone_id=ZONE.key, locale="de-DE")
    yield from shown(context, service, request)


def said(page: Page) -> list[str]:
    """All texts of the page."""
    found: list[str] = page.evaluate(READ)
    return [text for one in found if (text := " ".join(one.replace(WRITTEN, "").split()))]


def english_messages() -> re.Pattern[str]:
    """Return what English says and German does not, with anything in its places; as short as one word."""
    names = declared("findings.ts", "FINDING_NAMES"), declared("channels.ts", "CHANNEL_NAMES")
    english, other = ({**catalogue(one), **names[0][one], **names[1][one]} for one in ("en", "de"))
    texts = {text.strip() for key, text in english.items() if other[key] != text}
    texts -= {text.strip() for text in other.values()}
    words = [text for text in texts if re.search(r"[A-Za-z]{3}", PLACE.sub("", text))]
    return re.compile("|".join(".+".join(re.escape(part) for part in PLACE.split(one)[::2]) for one in sorted(words)))


def left_over(page: Page, view: str) -> list[str]:
    """Texts that are English, as far as the catalogue or common words tell."""
    pattern = english_messages()
    return [f"{view}: {one}" for one in dict.fromkeys(said(page)) if pattern.fullmatch(one) or ENGLISH_WORDS.search(one)]


def test_no_view_has_english_left(german: Seen) -> None:
    found = []
    for view in VIEWS:
        show(german.page, german.base, view)
        found += left_over(german.page, view)
        german.picture(f"german-{view}")
    assert german.page.locator("html").get_attribute("lang") == "de"
    assert not found, "\n".join(found)


def test_axe_finds_nothing(german: Seen) -> None:
    found = []
    for view in VIEWS:
        show(german.page, german.base, view)
        found += faults(german.page, f"{view}, German")
    assert found == []


def test_what_the_service_stored_in_english_is_german(german: Seen) -> None:
    """All sentences, rare ones as well, as verdicts of the identification that is shown."""
    sentences = STORED.read_text(encoding="utf-8").splitlines()

    def with_rare_verdict(route: Route) -> None:
        answer = route.fetch()
        found = answer.json()
        if isinstance(found, dict) and "verdict" in found:
            found["verdict"] = "; ".join(sentences)
        route.fulfill(response=answer, json=found)

    german.page.route(re.compile(r"/api/v1/identifications/\d+"), with_rare_verdict)
    show(german.page, german.base, "parameters")
    expect(german.page.locator("main")).to_contain_text("die Welle ihre Lager, ohne zu schwingen")
    assert [one for one in said(german.page) if ENGLISH_WORDS.search(one)] == []
    german.picture("german-rare-verdicts")


def test_findings_and_numbers_are_german(german: Seen) -> None:
    show(german.page, german.base, "alert")
    expect(german.page.get_by_role("heading", level=1)).to_have_text("Ausrichtfehler an Kupplung C1")
    expect(german.page.locator(".alert-row").first).to_contain_text("Kupplung C1 verliert ihre Ausrichtung")
    expect(german.page.locator(".advice")).to_contain_text("Zu tun beim nächsten Stillstand")
    show(german.page, german.base, "overview")
    expect(german.page.locator("main")).to_contain_text(re.compile(r"\d,\d"))


def test_the_language_is_chosen_and_kept(seen: Seen) -> None:
    show(seen.page, seen.base, "fleet")
    expect(seen.page.locator("html")).to_have_attribute("lang", "en")
    seen.page.get_by_label("Language of the page").select_option("de")
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Maschinenpark")
    seen.page.reload()
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Maschinenpark")
    seen.page.get_by_label("Sprache der Seite").select_option("en")
    expect(seen.page.get_by_role("heading", level=1)).to_have_text("Fleet")


def test_a_catalogue_that_cannot_be_loaded_leaves_the_page_in_english(german: Seen) -> None:
    german.page.route(re.compile(r"/assets/de-.*\.js"), lambda route: route.abort())
    german.open()
    expect(german.page.get_by_role("heading", level=1)).to_have_text("Fleet")
    expect(german.page.locator("html")).to_have_attribute("lang", "en")


def test_data_are_saved_as_german_spreadsheets_open_them(german: Seen, tmp_path: Path) -> None:
    """Cells parted by semicolons, decimals behind a comma, headings in German, a mark that says UTF-8."""
    show(german.page, german.base, "overview")
    for place, button in (
        ("overview", re.compile("^Die Daten als CSV sichern: Schwingung")),
        ("overview", re.compile("^Die Daten als CSV sichern: Wellenstrang")),
        ("shapes", re.compile("^Die Daten als CSV sichern: Eigenform")),
        ("trends", re.compile("^CSV$")),
        ("response", re.compile("^Die Daten als CSV sichern: Amplitude")),
    ):
        show(german.page, german.base, place)
        with german.page.expect_download() as download:
            german.page.get_by_role("button", name=button).first.click()
        path = tmp_path / "data.csv"
        download.value.save_as(path)
        text = path.read_text(encoding="utf-8")
        assert text.startswith("\ufeff"), place
        head, *rows = csv.reader(text.removeprefix("\ufeff").splitlines(), delimiter=";")
        assert len(head) > 2
        assert {len(row) for row in rows} == {len(head)}
        assert re.search(r"(^|;)-?\d+,\d+(;|$)", text, re.MULTILINE), f"{place}: no decimal comma"
        assert not re.search(r"(^|;)-?\d+\.\d+(;|$)", text, re.MULTILINE), f"{place}: a decimal point"
        if place != "trends":  # whose columns are the API's, by its names
            assert not ENGLISH_HEADINGS.search(";".join(head)), head


def test_days_and_times_of_fields_have_the_page_s_form(german: Seen) -> None:
    """Whatever the browser's language would make of a date field; what is no day is chosen nowhere."""
    page = german.page
    german.open(f"machines/{MACHINE}/trends?element=coupling.C1")
    first = page.get_by_role("textbox", name="Von")
    expect(first).to_have_attribute("placeholder", "JJJJ-MM-TT")
    first.fill("26.11.2026")
    first.press("Enter")
    assert first.evaluate("one => one.validationMessage") == "Ein Tag wird 2026-11-26 geschrieben."
    assert "from=" not in page.url
    first.fill("2026-02-31")
    first.press("Enter")
    assert "from=" not in page.url
    first.fill("2026-11-10")
    first.press("Enter")
    page.wait_for_url(re.compile("from=2026-11-10"))
    german.open(f"machines/{MACHINE}/settings")
    page.get_by_role("button", name="Unterdrücken").first.click()
    until = page.get_by_role("dialog").locator("input[name=until]")
    until.fill("morgen")
    assert until.evaluate("one => one.validationMessage") == "Eine Zeit wird 2026-11-26 11:26 geschrieben."
    until.fill("2030-01-01 06:00")
    assert until.evaluate("one => one.validationMessage") == ""
    assert german.errors == []


def test_keys_lead_where_they_do_in_english(german: Seen) -> None:
    german.open()
    expect(german.page.locator("table.fleet")).to_be_visible()
    for key, place in (("a", "alerts"), ("w", "subscriptions"), ("f", "")):
        german.page.keyboard.press(key)
        expect(german.page).to_have_url(f"{german.base}/#/{place}")


def test_what_an_address_names_and_there_is_not_is_said_with_the_way_back(german: Seen) -> None:
    for place, words, back in (
        ("alerts/999999", "Einen Alarm „999999“ gibt es nicht.", "Alle Alarme"),
        ("alerts/abc", "Einen Alarm „abc“ gibt es nicht.", "Alle Alarme"),
        ("reports/none", "Eine Maschine „none“ gibt es nicht.", "Zum Maschinenpark"),
    ):
        german.open(place)
        expect(german.page.get_by_role("alert")).to_have_text(words)
        expect(german.page.locator("main").get_by_role("link", name=back)).to_be_visible()
