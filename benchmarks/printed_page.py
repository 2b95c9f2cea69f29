"""A page of the evidence that is what benchmarks print: each section is a command and its output; no figure is typed."""

import re
import shlex
import subprocess
import sys
import textwrap
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from benchmarks.kept_outcomes import commit
from benchmarks.thesis.tables import paragraphs

DOCS = Path(__file__).parents[1] / "docs"


@dataclass(frozen=True)
class PrintedSection:
    """One command with its output. arguments: module and options behind `python -m`."""

    heading: str
    conditions: str
    arguments: tuple[str, ...]

    def text(self) -> str:
        """Return the section in markdown; a figure that falls short is told, a crash goes on."""
        done = subprocess.run([sys.executable, "-m", *self.arguments], capture_output=True, text=True)
        short = done.returncode == 1 and "Traceback" not in done.stderr
        if not short:
            done.check_returncode()
        said = f"`python -m {shlex.join(self.arguments)}` on commit {commit(self.arguments[0])}"
        said += " falls short of something that is asked; it prints:" if short else " prints:"
        printed = f"```text\n{done.stdout.strip(chr(10))}\n```"
        return paragraphs(f"## {self.heading}", _filled(self.conditions), said, printed)


@dataclass(frozen=True)
class PrintedPage:
    """A page of such sections."""

    name: str
    introduction: str
    sections: tuple[PrintedSection, ...]

    def write(self, only: Collection[str]) -> Path:
        """Run the commands of the sections with these headings, of all where none is given, and write the page."""
        path = DOCS / self.name
        written = _sections(path) if only else {}
        for one in self.sections:
            if not only or one.heading in only:
                written[one.heading] = one.text()
        whole = (written[one.heading] for one in self.sections if one.heading in written)
        path.write_text(paragraphs(self.introduction, *whole) + "\n", encoding="utf-8")
        return path


def _sections(path: Path) -> dict[str, str]:
    """Return the sections of a page as it was written, by their headings."""
    if not path.exists():
        return {}
    _, *parts = re.split(r"^## ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {part.partition("\n")[0]: f"## {part.strip(chr(10))}" for part in parts}


def _filled(text: str) -> str:
    return textwrap.fill(text, 120, break_on_hyphens=False)
