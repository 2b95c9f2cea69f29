"""Writes a page of the evidence from what benchmarks print: each section is a command and its output; no figure is typed.

python -m benchmarks.printed_page run-downs
"""

import argparse
import subprocess
import sys
import textwrap
from collections.abc import Sequence
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
        """Return the section in markdown. An error of the benchmark is the page's."""
        printed = subprocess.run([sys.executable, "-m", *self.arguments], capture_output=True, text=True, check=True).stdout
        said = f"`python -m {' '.join(self.arguments)}` on commit {commit(self.arguments[0])} prints:"
        return paragraphs(f"## {self.heading}", _filled(self.conditions), said, f"```text\n{printed.strip(chr(10))}\n```")


@dataclass(frozen=True)
class PrintedPage:
    """A page of such sections."""

    name: str
    introduction: str
    sections: tuple[PrintedSection, ...]

    def write(self) -> Path:
        """Run its commands and write the page."""
        path = DOCS / self.name
        path.write_text(paragraphs(self.introduction, *(one.text() for one in self.sections)) + "\n", encoding="utf-8")
        return path


def _filled(text: str) -> str:
    return textwrap.fill(text, 120, break_on_hyphens=False)


RUN_DOWNS = PrintedPage(
    "evidence-run-downs.md",
    """\
# The evidence: from readings to runs and phasors

What is done to readings before a fit sees them, on simulated machines and waveforms. Seeds are stated in the code, so that the
same numbers come again; times are those of the machine that ran it.""",
    (
        PrintedSection(
            "States and runs",
            "Simulated cycles of run-up, hold and run-down, with noise of the speed as a keyphasor's, or of a constant size "
            "as soon as the shaft turns.",
            ("benchmarks.estimator.states",),
        ),
        PrintedSection(
            "Picked samples",
            "A run-down of the Chapter 3 train of which samples are picked for the fit, or averaged.",
            ("benchmarks.estimator.capture",),
        ),
        PrintedSection(
            "Phasors from waveforms",
            "Least squares over a block beside band-pass and peak picking as in the thesis (§5.4); 26 dB is noise of 5 %.",
            ("benchmarks.estimator.phasors",),
        ),
        PrintedSection(
            "The sense of orbits",
            "Run-downs of the examples that have pairs of probes: nothing wrong, each pair swapped in turn, sense reversed.",
            ("benchmarks.estimator.orbit_sense",),
        ),
        PrintedSection(
            "Coast-downs",
            "The Chapter 3 train with half of its damping, integrated in time; waveforms through keyphasor and order "
            "tracking; documents wrong by 10 %.",
            ("benchmarks.estimator.coast_down", "--runs", "6"),
        ),
    ),
)
PAGES = {"run-downs": RUN_DOWNS}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the pages that are asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.printed_page", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("pages", nargs="+", choices=PAGES)
    for name in parser.parse_args(arguments).pages:
        print(PAGES[name].write())


if __name__ == "__main__":
    main()
