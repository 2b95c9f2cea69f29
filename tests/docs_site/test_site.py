"""The documentation's site: every page is in its navigation, references have every name, and a broken link fails the build."""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import get_args
from xml.etree import ElementTree

import pytest
from playwright.sync_api import expect, sync_playwright

import rotorundown
from docs_site import source
from docs_site.__main__ import build
from docs_site.cli_reference import cli_page
from docs_site.document_reference import document_page
from docs_site.equations import with_equations
from docs_site.error_reference import errors_page, wordings
from docs_site.finding_reference import findings_page, level_words
from docs_site.gallery import FOLDER, NOTEBOOKS, cells, write_gallery
from docs_site.method_figures import FIGURES, MARK, with_figures
from docs_site.python_reference import python_page
from docs_site.rest_reference import DOCUMENT, rest_page
from docs_site.settings_reference import settings_page
from docs_site.source import DOCS, ELSEWHERE, NAVIGATION, REFERENCES, site_links, write_source
from docs_site.usual_values import USUAL
from estimator.errors import DomainError
from estimator.machine.document import Machine
from formats.wire.rejection import Reason
from service.commands.help_panels import EXAMPLES
from service.configuration.settings import Settings
from service.http.error_status import STATUS
from service.monitoring.rules.drift_rule import RATE_RULE
from service.monitoring.rules.finding_rules import FINDING_RULES
from storage.measurements.runs import SamplesReleased
from tests.browser.shown_service import launch, program_for_tests
from tests.paths import ROOT

LISTED = [page for names in NAVIGATION.values() for page in names]


def test_every_page_is_in_the_navigation_once() -> None:
    pages = {page.name for page in DOCS.glob("*.md")} | set(ELSEWHERE.values()) | set(REFERENCES)
    assert sorted(LISTED) == sorted(pages | {f"gallery-{name}.md" for name in NOTEBOOKS})
    assert {one.stem for one in FOLDER.glob("*.py")} == set(NOTEBOOKS)


def test_references_have_every_name() -> None:
    assert [name for name in rotorundown.__all__ if f".{name}\n" not in python_page()] == []
    assert [name for name in EXAMPLES if f"### rundown {name}\n" not in cli_page()] == []
    assert [one for one in EXAMPLES.values() if f"```sh\n{one}\n```" not in cli_page()] == []
    assert [name for name in Settings.model_fields if f"| `{name}` |" not in settings_page()] == []
    assert [name for name in Machine.model_fields if f"| `{name}` |" not in document_page()] == []
    paths = json.loads(DOCUMENT.read_text())["paths"]
    assert [path for path in paths if f" {path}`" not in rest_page()] == []


def test_the_machine_document_s_fields_have_unit_bounds_and_default() -> None:
    lines = document_page().splitlines()
    meaning = "E [N/m²]; usual is 2.1e+11 N/m², of steel; more than 0"
    assert f"| `young_modulus` | number | needed | {meaning} | 2.06e+11 to 2.1e+11 |" in lines
    assert any(line.startswith("| `shafts` | list of [Shaft](#shaft) | needed | one shaft: sections from") for line in lines)
    assert any(line.startswith("| `rotation` | `positive` or `negative` | `positive` |") for line in lines)
    anchors = {line.removeprefix("## ").lower() for line in lines if line.startswith("## ")}
    links = {part.partition(")")[0] for line in lines for part in line.split("](#")[1:]}
    assert links <= anchors


def test_every_field_of_a_document_has_a_meaning() -> None:
    rows = [line.split(" | ") for line in document_page().splitlines() if line.startswith("| `")]
    assert len(rows) > 200
    assert [row[0] for row in rows if not row[3].strip()] == []


def test_every_number_of_a_document_has_a_usual_value() -> None:
    rows = [line.split(" | ") for line in document_page().splitlines() if line.startswith("| `")]
    numbers = [row for row in rows if "number" in row[1]]
    assert len(numbers) > 150
    assert [row[0] for row in numbers if not row[4].strip(" |")] == []
    assert [f"{part}.{name}" for part, name in USUAL if not any(row[0] == f"| `{name}`" for row in rows)] == []


def test_every_finding_has_its_texts_and_limits() -> None:
    page = findings_page()
    for rule in (*FINDING_RULES, RATE_RULE):
        assert f"> {rule.texts['en'].what}\n" in page
        assert f"| name | `{rule.kind}`, rule `{rule.rule.name}` |" in page
        if rule.rule.limits is not None:
            assert f"| alert | {level_words(rule.rule.limits.alert)} |" in page
    assert "| alert | 4 standard deviations and 8 % against the baseline |" in page


def test_every_error_has_its_texts_its_status_and_what_to_do() -> None:
    page = errors_page()
    for kind, status in STATUS.items():
        assert f"| {status.value} {status.phrase} | `{kind.__name__}` |" in page
        assert kind.remedy in page
    assert all(kind.remedy for kind in DomainError.__subclasses__())
    section = page.partition(f"### {SamplesReleased.__name__}\n")[2].partition("\n### ")[0]
    assert "HTTP 410. What to do: " in section
    assert "\n- `" in section
    assert [reason for reason in get_args(Reason) if f"| `{reason}` |" not in page] == []
    assert len({one.name for one in wordings()}) > 80
    assert "- `name the keys to confirm, or say --all`" in page


METHOD = [page for page in NAVIGATION["Explanation"] if page.startswith("method-")]


def test_the_method_is_six_pages_with_equations_a_figure_assumptions_limits_and_evidence() -> None:
    assert len(METHOD) == 6
    figures = []
    for page in METHOD:
        text = (DOCS / page).read_text()
        headings = [line for line in text.splitlines() if line.startswith("## ")]
        assert headings[0] == "## Equations"
        assert headings[-3:] == ["## Assumptions", "## Limits", "## Evidence"]
        assert with_equations(text).count("<math ") >= 2
        figures += [name for name, _ in MARK.findall(text)]
    assert sorted(figures) == sorted(FIGURES)


def test_equations_become_mathml_that_is_well_formed() -> None:
    for page in METHOD:
        for one in re.findall("<math .*?</math>", with_equations((DOCS / page).read_text())):
            assert ElementTree.fromstring(one).tag.endswith("math")
            assert "\\" not in one
    with pytest.raises(ValueError, match="not closed"):
        with_equations("text\n\n$$\nx = 1\n")


def test_figures_are_drawn_where_a_page_names_them(tmp_path: Path) -> None:
    page = with_figures("# A\n\n<!-- figure: polar: two vectors -->\n\nText.\n", tmp_path, short=True)
    assert "![two vectors](method-polar.svg)\n\n*Two vectors.*\n\nText." in page
    assert (tmp_path / "method-polar.svg").read_text().startswith("<?xml")
    with pytest.raises(KeyError, match="nothing"):
        with_figures("<!-- figure: nothing: none -->", tmp_path, short=True)


def test_links_lead_to_pages_of_the_site_or_become_names() -> None:
    said = site_links(
        "[a](docs/operators.md#storage) [b](deploy/) [c](https://x.org/) [d](examples/by-hand.sh) [e](#here)", ROOT
    )
    assert said == "[a](operators.md#storage) [b](deploy.md) [c](https://x.org/) d (`examples/by-hand.sh`) [e](#here)"
    assert site_links("[x](../README.md)", DOCS) == "[x](index.md)"


def test_notebooks_are_run_cell_by_cell_with_what_they_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "one.py").write_text(
        "# %% [markdown]\n# # Title\n#\n# Text.\n\n# %%\nimport matplotlib.pyplot as plt\n\nprint(1)\n2\n\n"
        "# %%\nplt.plot([1, 2]);\n"
    )
    monkeypatch.setattr("docs_site.gallery.FOLDER", tmp_path)
    monkeypatch.setattr("docs_site.gallery.NOTEBOOKS", ("one",))
    assert [kind for kind, _ in cells((tmp_path / "one.py").read_text())] == [True, False, False]
    write_gallery(tmp_path, short=False)
    page = (tmp_path / "gallery-one.md").read_text()
    assert page.startswith("# Title\n\nText.\n")
    assert "```text\n1\n2\n```" in page
    assert "](gallery-one-1.svg)" in page
    assert (tmp_path / "gallery-one-1.svg").read_text().startswith("<?xml")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built with its notebooks in short."""
    folder = tmp_path_factory.mktemp("built") / "site"
    done = subprocess.run([sys.executable, "-m", "docs_site", str(folder), "--short"], cwd=ROOT, check=False)
    assert done.returncode == 0
    return folder


@pytest.mark.long
def test_the_site_builds(site: Path) -> None:
    for page in LISTED:
        name = "index.html" if page == "index.md" else f"{page.removesuffix('.md')}.html"
        assert (site / name).is_file()


@pytest.mark.long
def test_every_notebook_of_the_gallery_shows_what_it_draws_and_prints(site: Path) -> None:
    for name in NOTEBOOKS:
        assert list(site.glob(f"gallery-{name}-*.svg")), name
    year = (site / "gallery-alignment_over_a_year.html").read_text(encoding="utf-8")
    assert "Coupling C1 is going out of alignment" in year
    assert re.search(r"coupling\.C1\.kxx: .* \+\d\d\.\d % in 16 runs", year)


@pytest.mark.long
def test_a_wide_equation_is_moved_by_itself(site: Path) -> None:
    page = (site / "method-model.html").read_text(encoding="utf-8")
    assert 'href="site.css"' in page
    assert '<div class="equation">' in page
    assert re.search(r"\.equation \{\s*overflow-x: auto", (site / "site.css").read_text(encoding="utf-8"))


@pytest.mark.long
def test_it_is_searched_as_files_and_asks_nobody(site: Path) -> None:
    program = program_for_tests()
    if program is None:
        pytest.skip("chromium is not installed")
    with sync_playwright() as playwright:
        browser = launch(playwright, program)
        page = browser.new_page()
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto((site / "index.html").as_uri())
        page.keyboard.press("/")
        page.keyboard.type("baseline")
        expect(page.locator(".md-search-result__meta")).to_have_text(re.compile(r"\d+ matching documents"))
        found = page.locator("a.md-search-result__link")
        names = [found.nth(place).get_attribute("href") or "" for place in range(found.count())]
        browser.close()
    assert any("alerts.html" in name for name in names)
    assert [one for one in asked if not one.startswith(("file:", "data:"))] == []


@pytest.mark.long
def test_a_broken_link_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def titles_only(pages: Path, **_how: bool) -> None:
        for name in NOTEBOOKS:
            (pages / f"gallery-{name}.md").write_text(f"# {name}\n")

    monkeypatch.setattr(source, "write_gallery", titles_only)
    configuration = write_source(tmp_path / "source", short=True)
    python = tmp_path / "source" / "pages" / "python.md"
    python.write_text(python.read_text() + "\n[nowhere](nowhere.md)\n")
    broken = build(configuration, tmp_path / "broken")
    assert broken.returncode != 0
    assert "nowhere.md" in broken.stderr
