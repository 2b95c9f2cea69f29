"""Write docs/evidence.md again, or run one numerical experiment of the thesis and print its table.

python -m benchmarks.thesis
python -m benchmarks.thesis chapter-2 --method I --case A --noise 1 --scaling norm --seed 0
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from threadpoolctl import threadpool_limits

from benchmarks.thesis.chapter_2 import report as chapter_2
from benchmarks.thesis.chapter_3 import report as chapter_3
from benchmarks.thesis.chapter_4 import report as chapter_4
from benchmarks.thesis.chapter_5 import report as chapter_5
from benchmarks.thesis.future_work import report as future_work

CHAPTERS: dict[str, ModuleType] = {
    "chapter-2": chapter_2,
    "chapter-3": chapter_3,
    "chapter-4": chapter_4,
    "chapter-5": chapter_5,
    "future-work": future_work,
}
PAGE = Path(__file__).parents[2] / "docs" / "evidence.md"
INTRODUCTION = """\
# The evidence: the thesis run again

M. Lal's thesis (*Identification of multiple fault parameters in rotor-bearing-coupling systems based on forced response
measurements*, IIT Guwahati) is where this project comes from. This page runs its numerical experiments again with its own
methods and sets beside them what the maximum-likelihood fit of this project finds in the same data. Where the page does not
say otherwise, numbers are computed by `python -m benchmarks.thesis`, which writes the page; noise comes from stated seeds, so
that the same numbers come again.
`python -m benchmarks.thesis chapter-2 --help` shows how to run one experiment alone, with other noise, seeds or scaling.

## How to read it

- **printed** is the thesis's figure, copied as it stands.
- **regression** is the thesis's method run here: the equations of motion, with noisy responses put in, solved for the unknowns
  by least squares. Of N seeds the median over the seeds is given, and where it says so the smallest and the largest.
- **maximum likelihood** is this project's fit of the response itself to the same noisy data.
- **Cramér-Rao bound** is the smallest standard error that any unbiased estimate can have with the noise stated. A single
  error is not a standard error: it is smaller two times out of three.
- **noise of N %** is that of Eq. 2.19-2.20: each phasor times a real number drawn evenly from 1 ± N/200, so that 5 % is
  1.44 % rms and the phase stays exact. **circular noise** is complex Gaussian noise of the same rms in amplitude and phase.
- **largest error** is, as in the thesis, the largest of all parameters, each relative to its true value. Small cross-coupled
  damping terms usually take this place: 20 N s/m beside a direct term of 300 N s/m.
"""


def page() -> str:
    """Return the whole page."""
    return "\n".join([INTRODUCTION, *(chapter.section() for chapter in CHAPTERS.values())])


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the page, or run one experiment."""
    description, _, _ = (__doc__ or "").partition("\n")
    parser = argparse.ArgumentParser(prog="python -m benchmarks.thesis", description=description)
    chapters = parser.add_subparsers(dest="chapter", help="run one experiment; without it the page is written")
    for name, chapter in CHAPTERS.items():
        summary, _, _ = (chapter.__doc__ or "").partition("\n")
        chapter.add_arguments(chapters.add_parser(name, help=summary, description=summary))
    chosen = parser.parse_args(arguments)
    with threadpool_limits(limits=1):
        if chosen.chapter is not None:
            try:
                print(CHAPTERS[chosen.chapter].run(chosen))
            except ValueError as refusal:
                parser.error(str(refusal))
            return
        PAGE.write_text(page(), encoding="utf-8")
    print(f"written: {PAGE.relative_to(Path.cwd()) if PAGE.is_relative_to(Path.cwd()) else PAGE}")


if __name__ == "__main__":
    main()
