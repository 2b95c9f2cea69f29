"""The documentation names what exists: settings, quarantine reasons, commands, files."""

import re
import shlex
import subprocess
from pathlib import Path
from typing import Any, get_args

import pytest
import typer.main
from pydantic import SecretStr

from formats.wire import Reason
from service.commands.app import app
from service.configuration.settings import Settings

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def test_every_setting_is_documented_with_its_default() -> None:
    page = (ROOT / "docs" / "operators.md").read_text()
    for name, field in Settings.model_fields.items():
        row = next((line for line in page.splitlines() if line.startswith(f"| `{name}`")), None)
        assert row is not None, f"setting {name} is not in docs/operators.md"
        default = field.default.get_secret_value() if isinstance(field.default, SecretStr) else field.default
        shown = (
            str(default).replace("'", '"')
            if isinstance(default, list)
            else f"{default:g}"
            if isinstance(default, float)
            else str(default)
        )
        assert f"`{shown}`" in row, f"docs/operators.md gives another default for {name} than {shown}"


def test_every_quarantine_reason_is_documented() -> None:
    page = (ROOT / "docs" / "integrators.md").read_text()
    assert [reason for reason in get_args(Reason) if f"`{reason}`" not in page] == []


def test_the_pages_show_commands() -> None:
    assert len([one for page in PAGES for one in commands_of(page.read_text())]) > 25


def commands_of(text: str) -> list[list[str]]:
    """The commands `rundown …` in a page's blocks for a shell, each as its words, with 1 for variables."""
    lines = "\n".join(re.findall(r"```sh\n(.*?)```", text, re.DOTALL)).replace("\\\n", " ").splitlines()
    found = [re.fullmatch(r"(?:\w+=\S+ )*rundown (.*?)(?: [&|>].*)?", line.partition("  #")[0].strip()) for line in lines]
    return [shlex.split(re.sub(r"\$\w+", "1", one[1]), comments=True) for one in found if one is not None]


@pytest.mark.parametrize("page", [*PAGES, ROOT / "deploy" / "README.md"], ids=lambda page: page.parent.name + page.name)
def test_every_command_that_a_page_shows_has_the_options_that_it_shows(page: Path) -> None:
    text = page.read_text()
    for words in commands_of(text):
        command: Any = typer.main.get_command(app)
        name = "rundown"
        while hasattr(command, "commands"):
            assert words[0] in command.commands, f"no command {words[0]}"
            name, command, words = words[0], command.commands[words[0]], words[1:]
        command.make_context(name, list(words))  # raises for an option or an argument that is not there
    named = set(re.findall(r"`rundown ([a-z][a-z-]+)", text))
    assert sorted(named - typer.main.get_command(app).commands.keys()) == []  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_settings_that_a_page_sets_reach_the_command_after_them(page: Path) -> None:
    """A line of assignments alone sets variables of the shell, which no program sees."""
    blocks = re.findall(r"```sh\n(.*?)```", page.read_text(), re.DOTALL)
    alone = [line for block in blocks for line in block.splitlines() if re.fullmatch(r"(RUNDOWN_\w+=\S+\s*)+(#.*)?", line)]
    assert alone == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_a_page_names_exist(page: Path) -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    names = {Path(one).name for one in listed if one.startswith(("estimator/", "storage/", "formats/", "service/"))}
    named = re.findall(r"`((?:[\w-]+/)*[\w-]+\.(?:py|yaml|md))`|\]\(([\w/-]+\.md)\)", page.read_text())
    invented = {"FILE.yaml", "columns.yaml"}
    found = [pair[0] or pair[1] for pair in named]
    missing = [
        name
        for name in found
        if name not in invented and name not in names and not any((place / name).exists() for place in (ROOT, ROOT / "docs"))
    ]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_sections_that_a_page_links_to_exist(page: Path) -> None:
    links = re.findall(r"\]\(([\w./-]*)#([\w-]+)\)", page.read_text())
    pages = [(page.parent / name if name else page, anchor) for name, anchor in links]
    assert [anchor for there, anchor in pages if there.suffix == ".md" and anchor not in sections(there.read_text())] == []


def sections(text: str) -> set[str]:
    """The anchors of a page's headings, as they are made of their words, and those that it sets itself."""
    headings = [re.sub(r"[^\w\- ]", "", one.lower()).strip().replace(" ", "-") for one in re.findall(r"(?m)^#+ (.*)$", text)]
    return {*headings, *re.findall(r'<a (?:id|name)="([\w-]+)"', text)}
