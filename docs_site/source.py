"""Writes the source of the site: pages with their links, generated references, the gallery, and mkdocs's configuration."""

import re
import shutil
from pathlib import Path

from docs_site.cli_reference import cli_page
from docs_site.document_reference import document_page
from docs_site.equations import with_equations
from docs_site.error_reference import errors_page
from docs_site.finding_reference import findings_page
from docs_site.gallery import NOTEBOOKS, write_gallery
from docs_site.method_figures import with_figures
from docs_site.python_reference import python_page
from docs_site.rest_reference import DOCUMENT, rest_page
from docs_site.settings_reference import settings_page

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
ELSEWHERE = {
    "README.md": "index.md",
    "deploy/README.md": "deploy.md",
    "dashboard/src/README.md": "page-source.md",
    "CHANGELOG.md": "changes.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "reporting.md",
}
"""Pages outside of docs, and what they are called in the site."""
REFERENCES = {
    "reference-python.md": python_page,
    "reference-commands.md": cli_page,
    "reference-settings.md": settings_page,
    "reference-machine-document.md": document_page,
    "reference-rest.md": rest_page,
    "reference-findings.md": findings_page,
    "reference-errors.md": errors_page,
}
SEARCH_FROM_FILES = "iframe-worker.js"
"""Script that lets pages opened as files search; mkdocs-material would load it from a server, and search nothing without."""
STYLE = "site.css"
NAVIGATION: dict[str, tuple[str, ...]] = {
    "Start": ("index.md", "first-steps.md", "python.md"),
    "Tutorials": tuple(f"gallery-{name}.md" for name in NOTEBOOKS),
    "How to": (
        "operators.md",
        "deployment.md",
        "deploy.md",
        "security.md",
        "runbook.md",
        "integrators.md",
        "edge.md",
        "mqtt.md",
        "opcua.md",
        "grafana.md",
        "dashboard.md",
        "alerts.md",
    ),
    "Reference": tuple(REFERENCES),
    "Explanation": (
        "method-model.md",
        "method-run-downs.md",
        "method-identification.md",
        "method-uncertainty.md",
        "method-alignment.md",
        "method-diagnosis.md",
        "calibration.md",
        "analysts.md",
        "evidence.md",
        "evidence-films.md",
        "evidence-alignment.md",
        "evidence-fleets.md",
        "evidence-calibration.md",
        "evidence-estimator.md",
        "evidence-run-downs.md",
        "evidence-model.md",
        "evidence-service.md",
        "evidence-faults.md",
        "fleets.md",
        "faults.md",
    ),
    "Project": (
        "developers.md",
        "rooms.md",
        "decisions.md",
        "page-source.md",
        "contributing.md",
        "reporting.md",
        "changes.md",
    ),
}
"""Every page of the site; one that is left out fails the build."""


def write_source(folder: Path, *, short: bool) -> Path:
    """Write pages and configuration into a folder, and return the path of the configuration. short: notebooks in short."""
    pages = folder / "pages"
    shutil.copytree(DOCS, pages, ignore=shutil.ignore_patterns(DOCUMENT.name))
    for page in pages.glob("*.md"):
        text = with_equations(site_links(page.read_text(encoding="utf-8"), DOCS))
        page.write_text(with_figures(text, pages, short=short), encoding="utf-8")
    for place, name in ELSEWHERE.items():
        text = (ROOT / place).read_text(encoding="utf-8")
        (pages / name).write_text(site_links(text, (ROOT / place).parent), encoding="utf-8")
    for name, page_of in REFERENCES.items():
        (pages / name).write_text(page_of(), encoding="utf-8")
    write_gallery(pages, short=short)
    for name in (SEARCH_FROM_FILES, STYLE):
        shutil.copy(Path(__file__).with_name(name), pages)
    configuration = folder / "mkdocs.yml"
    configuration.write_text(_configuration(pages), encoding="utf-8")
    return configuration


def site_links(text: str, folder: Path) -> str:
    """Return a page whose links lead to pages of the site; links to other files of the project become their names."""

    def link(found: re.Match[str]) -> str:
        words, target = found[1], found[2]
        if re.match(r"https?:|#|mailto:", target):
            return found[0]
        path, _, anchor = target.partition("#")
        place = (folder / path).resolve()
        if place.is_dir():
            place /= "README.md"
        inside = str(place.relative_to(ROOT))
        end = f"#{anchor}" if anchor else ""
        if inside in ELSEWHERE:
            return f"[{words}]({ELSEWHERE[inside]}{end})"
        if place.is_relative_to(DOCS):
            return f"[{words}]({place.relative_to(DOCS)}{end})"
        return f"{words} (`{inside}`)"

    linked = re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", link, text)
    return re.sub(r"(!\[[^\]]*\]\()docs/", r"\1", linked) if folder == ROOT else linked


def _configuration(pages: Path) -> str:
    sections = "\n".join(
        f"  - {section}:\n" + "\n".join(f"      - {page}" for page in names) for section, names in NAVIGATION.items()
    )
    return f"""site_name: Rundown
docs_dir: {pages}
theme:
  name: material
  font: false
  features: [navigation.sections, navigation.indexes, content.code.copy, toc.follow]
extra_css: [{STYLE}]
extra:
  polyfills: [{SEARCH_FROM_FILES}]
plugins:
  - search
  - offline
  - mkdocstrings:
      handlers:
        python:
          paths: ["{ROOT}"]
          options: {{docstring_style: google, show_source: false, show_root_heading: true, heading_level: 2,
                     members_order: source, show_signature_annotations: true, separate_signature: true,
                     filters: ["!^_"]}}
markdown_extensions:
  - tables
  - attr_list
  - pymdownx.highlight
  - pymdownx.superfences
  - toc:
      permalink: true
      slugify: !!python/object/apply:pymdownx.slugs.slugify {{kwds: {{case: lower}}}}
validation:
  nav: {{omitted_files: warn, not_found: warn, absolute_links: warn}}
  links: {{not_found: warn, anchors: warn, absolute_links: warn, unrecognized_links: warn}}
nav:
{sections}
"""
