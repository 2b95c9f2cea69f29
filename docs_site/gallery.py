"""The gallery: every notebook run cell by cell, with what it prints and the figures that it makes."""

import ast
import contextlib
import io
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from docs_site.watched_year import watched_year

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "notebooks"
NOTEBOOKS = (
    "first_rotor",
    "fluid_film_train",
    "alignment_over_a_year",
    "measured_rotor_kit",
    "how_wrong_can_it_be",
    "which_measurement_helps",
)
"""In the order in which one reads them."""
WITH_A_SERVICE = {"alignment_over_a_year"}
"""Notebooks that ask a running service: that of RUNDOWN_URL, or else one that runs while the gallery is made."""


def write_gallery(pages: Path, *, short: bool) -> None:
    """Write a page for each notebook, with its figures beside it. short: run them in the form in which the tests do."""
    import matplotlib

    matplotlib.use("Agg")
    if short:
        os.environ["RUNDOWN_SHORT"] = "1"  # of this process, which only builds the site
    with contextlib.chdir(ROOT), _service() as service_url:
        for name in sorted(NOTEBOOKS, key=WITH_A_SERVICE.__contains__):  # what a service needs time for comes last
            if name in WITH_A_SERVICE:
                os.environ["RUNDOWN_URL"] = service_url()
            text = "\n".join(_page(name, pages))
            (pages / f"gallery-{name}.md").write_text(text + "\n", encoding="utf-8")


@contextlib.contextmanager
def _service() -> Iterator[Callable[[], str]]:
    """Yield what waits for the service that notebooks ask, and returns its URL; none is started where none is asked."""
    given = os.environ.get("RUNDOWN_URL")
    if given or WITH_A_SERVICE.isdisjoint(NOTEBOOKS):
        yield lambda: given or ""
        return
    with watched_year() as url:
        yield url
    del os.environ["RUNDOWN_URL"]  # it serves no longer


def cells(text: str) -> Iterator[tuple[bool, str]]:
    """Yield the cells of a percent script: whether it is text, and its content."""
    for part in re.split(r"^# %%", text, flags=re.MULTILINE)[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            yield True, "\n".join(line.removeprefix("#").removeprefix(" ") for line in body.strip().splitlines())
        else:
            yield False, body.strip()


def _page(name: str, pages: Path) -> Iterator[str]:
    names: dict[str, Any] = {"__name__": name}
    number = 0
    for written, content in cells((FOLDER / f"{name}.py").read_text(encoding="utf-8")):
        if written:
            yield f"{content}\n"
            continue
        yield f"```python\n{content}\n```\n"
        shown = _run(content, names)
        if shown:
            yield f"```text\n{shown}\n```\n"
        for figure in _figures():
            number += 1
            file = f"gallery-{name}-{number}.svg"
            figure.savefig(pages / file)
            yield f"![figure {number} of this notebook]({file})\n"
    yield f"The notebook: `examples/notebooks/{name}.py`."


def _run(code: str, names: dict[str, Any]) -> str:
    """Run a cell; returns what it prints, and the value of an expression at its end."""
    tree = ast.parse(code)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "notebook", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "notebook", "eval"), names)
            if value is not None:
                print(value)
    return printed.getvalue().rstrip()


def _figures() -> Iterator[Any]:
    from matplotlib import pyplot

    for number in pyplot.get_fignums():
        yield pyplot.figure(number)
        pyplot.close(number)
