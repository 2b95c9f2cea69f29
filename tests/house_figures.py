"""Figures of the house: how large its rooms, classes and functions are, and what their docstrings state.

    python -m tests.house_figures

prints what is asked beside what is measured. Tests hold each figure: `test_rooms`, `test_sizes`, `test_docstrings`,
`test_places_to_touch`, `estimator/test_docstrings`, `estimator/test_sources`, `service/test_dashboard_rooms`.
"""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from tests import test_docstrings, test_rooms, test_sizes
from tests.additions.additions import ADDITIONS
from tests.additions.package_copy import PackageCopy
from tests.estimator import test_docstrings as estimator_docstrings
from tests.estimator import test_sources
from tests.paths import PACKAGES
from tests.rooms import ROOMS
from tests.service import test_dashboard_rooms
from tests.syntax_trees import statements


@dataclass(frozen=True)
class HouseFigure:
    """A figure with its bound. least: whether it may not be smaller, instead of not larger."""

    name: str
    bound: float
    measured: float
    unit: str = ""
    least: bool = False

    @property
    def holds(self) -> bool:
        """Return whether it keeps its bound."""
        return self.measured >= self.bound if self.least else self.measured <= self.bound

    def __str__(self) -> str:
        asked = f"{'at least' if self.least else 'at most'} {self.bound:g}{self.unit}"
        return f"{self.name:58} {asked:>16} {self.measured:8.4g}{self.unit:3} {'' if self.holds else 'FAILS'}".rstrip()


def figures() -> Iterator[HouseFigure]:
    """Yield all figures."""
    yield from _rooms()
    yield from _sizes()
    yield from _docstrings()
    yield from _additions()


def _additions() -> Iterator[HouseFigure]:
    with TemporaryDirectory() as folder:
        copy = PackageCopy(Path(folder), runs=False)
        for one in ADDITIONS:
            copy.forget()
            one.add(copy)
            yield HouseFigure(f"files to touch for one more {one.name}", one.most_files, len(copy.touched))


def _rooms() -> Iterator[HouseFigure]:
    python = Counter(path.parent for path in test_rooms.files().values() if path.name != "__init__.py").values()
    sources = test_dashboard_rooms.SOURCES
    page = [sum(path.suffix != ".md" for path in (sources / room).iterdir()) for room in test_dashboard_rooms.MAY_IMPORT]
    for place, counts in (("the packages", python), ("the page", page)):
        yield HouseFigure(f"files in the largest folder of {place}", test_rooms.LARGEST_ROOM, max(counts))
        yield HouseFigure(f"files in the median folder of {place}", test_rooms.MEDIAN_ROOM, median(counts))
    graphs = {
        "files": {one: set(others) for one, others in test_rooms.imports().items()},
        "rooms": {one: set(others) for one, others in test_rooms.arrows().items()},
        "packages": test_rooms.packages(),
    }
    for what, graph in graphs.items():
        found = test_rooms.circle(graph)
        yield HouseFigure(f"{what} in a circle of imports", 0, max(0, len(found) - 1))
    floor = {one: place for place, one in enumerate(ROOMS)}
    arrows = [(one, other) for one, others in test_rooms.arrows().items() for other in others]
    yield HouseFigure("arrows upward", 0, sum(floor[other] >= floor[one] for one, other in arrows))


def _sizes() -> Iterator[HouseFigure]:
    classes, methods, functions = [0], [0], [0]
    for file, tree in test_sizes.modules(*PACKAGES):
        for one in statements(tree):
            if isinstance(one, ast.ClassDef):
                classes.append(test_sizes.lines(one))
                if (file, one.name) not in test_sizes.FLAT_CLIENTS:
                    methods.append(sum(isinstance(part, test_sizes.Function) for part in one.body))
            elif isinstance(one, test_sizes.Function):
                functions.append(test_sizes.lines(one))
    yield HouseFigure("lines of the longest class", test_sizes.LARGEST_CLASS, max(classes))
    yield HouseFigure("methods of the largest class, flat clients aside", test_sizes.MAXIMUM_METHODS, max(methods))
    yield HouseFigure("lines of the longest function", test_sizes.LARGEST_FUNCTION, max(functions))
    yield HouseFigure("functions of more than 60 lines", 0, sum(one > test_sizes.LARGEST_FUNCTION for one in functions))


def _docstrings() -> Iterator[HouseFigure]:
    public = [
        bool(ast.get_docstring(one))
        for _, tree in test_sizes.modules(*PACKAGES)
        for _, one in estimator_docstrings.public_functions(tree)
    ]
    yield HouseFigure("public functions with a docstring", 100, _per_cent(public), " %", least=True)
    stated = [
        not list(estimator_docstrings.faults_of_function(one))
        for _, tree in test_sizes.modules("estimator")
        for _, one in estimator_docstrings.public_functions(tree)
    ]
    yield HouseFigure("those of estimator with arguments, units and errors", 95, _per_cent(stated), " %", least=True)
    due = [one for one in test_sources.MODULES if test_sources.is_due(test_sources.text(one))]
    given = [one in test_sources.OWN or test_sources.is_given(test_sources.text(one)) for one in due]
    yield HouseFigure("modules of estimator that solve something, with source", 95, _per_cent(given), " %", least=True)
    own = [
        given for one in test_sources.MODULES for given in test_sources.functions_with_source(test_sources.text(one)).values()
    ]
    yield HouseFigure("functions of estimator that solve something, with source", 95, _per_cent(own), " %", least=True)
    faults = sum(len(test_docstrings.faults_of_room(room)) for room in test_docstrings.ROOMS)
    yield HouseFigure("docstrings of service and storage that begin otherwise", 0, faults)


def _per_cent(which: list[bool]) -> float:
    return 100.0 * sum(which) / max(1, len(which))


if __name__ == "__main__":
    for one in figures():
        print(one)
