"""The house: which room may import which, that no file or room is in a circle, and that rooms are small and say what they are.

A room is a folder of one of the packages. `ROOMS` is the table in docs/rooms.md: an arrow that is not in it fails
here, and so does one that nobody goes any more.
"""

import ast
import re
import subprocess
import tomllib
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from statistics import median

import pytest

from estimator.bearings.registry import FORMS
from tests.paths import PACKAGES, ROOT
from tests.rooms import ROOMS
from tests.rooms_picture import PICTURE, TABLE, drawing, drawn
from tests.syntax_trees import parsed, statements

LARGEST_ROOM, MEDIAN_ROOM = 25, 12
"""Files in a room, its `__init__.py` left out."""
TWO_PAGES = 150
"""Lines of the page for developers, the picture of the house included."""


@cache
def files() -> dict[str, Path]:
    """All modules of the packages but migrations, by their dotted names."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *PACKAGES]  # also what is not added yet
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    paths = [Path(one) for one in listed.splitlines() if one.endswith(".py") and not one.startswith("storage/migrations/")]
    paths = [one for one in paths if (ROOT / one).exists()]
    return {".".join(path.with_suffix("").parts).removesuffix(".__init__"): path for path in paths}


@cache
def tree(path: Path) -> ast.Module:
    """Return a file's syntax tree, which is parsed once for all tests here."""
    return parsed((ROOT / path).read_text())


def room(module: str) -> str:
    """The folder that a module lies in."""
    return files()[module].parent.as_posix()


def named(tree: ast.Module) -> Iterator[str]:
    """All modules that an import names, also within functions and for types only: circles hide there."""
    for node in statements(tree):
        if isinstance(node, ast.Import):
            yield from (one.name for one in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield from (
                f"{node.module}.{one.name}" if f"{node.module}.{one.name}" in files() else node.module for one in node.names
            )


@cache
def imports() -> dict[str, frozenset[str]]:
    """Return which modules each module imports."""
    return {
        module: frozenset(one for one in named(tree(path)) if one in files() and one != module)
        for module, path in files().items()
    }


@cache
def arrows() -> dict[str, dict[str, str]]:
    """Return the arrows from each room to others, with one import that makes each."""
    found: dict[str, dict[str, str]] = defaultdict(dict)
    for module, others in imports().items():
        for other in others:
            if room(module) != room(other):
                found[room(module)][room(other)] = f"{files()[module]} imports {other}"
    return found


def packages() -> dict[str, set[str]]:
    """Return from each package those that its rooms import."""
    found: dict[str, set[str]] = {one: set() for one in PACKAGES}
    for one, others in arrows().items():
        own = one.split("/")[0]
        found[own] |= {other.split("/")[0] for other in others} - {own}
    return found


def circle(graph: dict[str, set[str]]) -> list[str]:
    """One circle of a graph; empty where there is none."""
    done: set[str] = set()

    def follow(one: str, path: list[str]) -> list[str]:
        if one in path:
            return [*path[path.index(one) :], one]
        if one in done:
            return []
        for other in sorted(graph.get(one, ())):
            if found := follow(other, [*path, one]):
                return found
        done.add(one)
        return []

    return next((found for one in sorted(graph) if (found := follow(one, []))), [])


def test_rooms_import_only_what_the_picture_shows() -> None:
    new = [
        f"{why}: {one} may not import {other}. Move what is needed to a room below, or draw the arrow in tests/rooms.py"
        for one, others in arrows().items()
        for other, why in others.items()
        if other not in ROOMS.get(one, ())
    ]
    assert new == []


def test_no_arrow_of_the_picture_is_left_unused() -> None:
    unused = [f"{one} -> {other}" for one, others in ROOMS.items() for other in others if other not in arrows().get(one, {})]
    assert unused == []


def test_no_room_and_no_file_is_in_a_circle() -> None:
    assert circle({one: set(others) for one, others in ROOMS.items()}) == []
    assert circle({one: set(others) for one, others in imports().items()}) == []


def installed_packages() -> set[str]:
    """Return the packages that the distribution installs."""
    found = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]["find"]["include"]
    return {one.removesuffix("*") for one in found}


def test_the_packages_are_those_that_are_installed_and_copied_into_the_container() -> None:
    assert installed_packages() == set(PACKAGES), "name a new package in tests/paths.py"
    image = (ROOT / "deploy" / "Containerfile").read_text()
    assert {one for one in PACKAGES if f"COPY {one} ./{one}\n" not in image} == set()


def test_no_package_is_in_a_circle() -> None:
    """Rooms may be in none although their packages are: then the packages are one."""
    assert set(packages()) == set(PACKAGES)
    assert circle(packages()) == []


def test_no_arrow_goes_up() -> None:
    """The table lists the rooms from the bottom up, the ground floor of each package before its rooms."""
    floor = {one: place for place, one in enumerate(ROOMS)}
    assert [f"{one} -> {other}" for one, others in ROOMS.items() for other in others if floor[other] >= floor[one]] == []


def test_a_circle_is_found() -> None:
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]


def test_rooms_are_small() -> None:
    sizes: dict[str, int] = defaultdict(int)
    for path in files().values():
        sizes[path.parent.as_posix()] += path.name != "__init__.py"
    assert {one: size for one, size in sizes.items() if size > LARGEST_ROOM} == {}
    assert median(sizes.values()) <= MEDIAN_ROOM


WITHOUT_TESTS = {
    "formats": "it holds rooms only",
    "storage/tables": "declarations: tests/storage/database compares them with the migrations",
    "rotorundown/environment": "tests/rotorundown asks it through the library",
    "rotorundown/plots": "tests/rotorundown/test_plots.py",
}
"""Rooms without tests of their own, and why."""


def test_tests_mirror_the_rooms() -> None:
    rooms = {path.parent.as_posix() for path in files().values()}
    assert {one for one in rooms if not list((ROOT / "tests" / one).glob("test_*.py"))} == set(WITHOUT_TESTS)


@pytest.mark.parametrize("package", sorted({path.parent.as_posix() for path in files().values()}))
def test_each_room_says_what_lives_there(package: str) -> None:
    """In two or three sentences: what lives there, what it may import, where data come from and go to."""
    said = ast.get_docstring(ast.parse((ROOT / package / "__init__.py").read_text())) or ""
    assert 2 <= len(re.findall(r"[.:;](?=\s|$)", said)) <= 6, f"{package}/__init__.py: {said!r}"


def test_the_developers_page_shows_the_picture() -> None:
    for page in (PICTURE, TABLE):
        assert drawn(page) == page.read_text(), f"{page.name} is stale: run `python -m tests.rooms_picture`, commit the page"


def test_the_packages_stand_apart_from_their_rooms() -> None:
    labels = [line for line in drawing().splitlines() if line and line[0] not in " `"]
    assert [label.split()[0] for label in labels] == ["service", "rotorundown", "formats", "storage", "estimator"]


def test_the_page_for_developers_is_two_pages() -> None:
    """A newcomer reads it at once; tables and decisions have pages of their own."""
    assert len(PICTURE.read_text().splitlines()) <= TWO_PAGES


BY_NAME = {
    "estimator/fit/problem/train_models.py": "models of whole trains, each declared in a room that the fit may import",
    "rotorundown/__init__.py": "public names, whose modules are also imported for types",
    "rotorundown/environment/optional_packages.py": "packages of others",
}
"""Modules that import what a variable names, and why no arrow is hidden by it."""


def test_only_few_modules_import_what_a_variable_names() -> None:
    found = {
        str(path)
        for path, source in trees()
        for node in ast.walk(source)
        if isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__", "run_module", "exec")
    }
    assert found == set(BY_NAME)


ALLOWED_IN_ESTIMATOR = frozenset(
    [
        "__future__",
        "abc",
        "annotated_types",
        "bisect",
        "collections",
        "contextlib",
        "contextvars",
        "copy",
        "dataclasses",
        "difflib",
        "enum",
        "estimator",
        "fnmatch",
        "fractions",
        "functools",
        "heapq",
        "importlib",
        "itertools",
        "math",
        "msgspec",
        "numbers",
        "numpy",
        "operator",
        "pydantic",
        "pydantic_core",
        "re",
        "scipy",
        "statistics",
        "string",
        "types",
        "typing",
        "weakref",
    ]
)
"""Modules that neither read nor write, ask no clock and start no threads: the estimator is given what it needs."""


def trees() -> Iterator[tuple[Path, ast.Module]]:
    """Yield each file with its syntax tree."""
    for path in files().values():
        yield path, tree(path)


def _called(call: ast.Call) -> str:
    return str(getattr(call.func, "attr", getattr(call.func, "id", "")))


def test_imports_are_absolute_and_in_the_open() -> None:
    """Relative imports, imports by a string, and imports of what stands beside the house would not be seen in the picture."""
    found = []
    for path, source in trees():
        for node in ast.walk(source):
            if isinstance(node, ast.ImportFrom) and (node.level > 0 or node.module is None):
                found.append(f"{path}:{node.lineno}: a relative import")
            elif isinstance(node, ast.Import | ast.ImportFrom):
                hidden = any(one.name == "import_module" and one.asname for one in node.names)
                found += [f"{path}:{node.lineno}: import_module under another name"] if hidden else []
                names = [one.name for one in node.names] if isinstance(node, ast.Import) else [str(node.module)]
                beside = [one for one in names if one.split(".")[0] in ("tests", "benchmarks", "examples")]
                found += [f"{path}:{node.lineno}: imports {one}, which is not installed" for one in beside]
            elif isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__"):
                named = [one.value for one in node.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
                own = [one for one in named if one.split(".")[0] in PACKAGES]
                found += [f"{path}:{node.lineno}: imports {one} by a string" for one in own]
    assert found == []


def beyond_computing(source: ast.Module) -> list[str]:
    """Return what a file of the estimator imports or calls that is no computation."""
    found = []
    for node in statements(source):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else [str(node.module)]
            found += [one for one in names if one.split(".")[0] not in ALLOWED_IN_ESTIMATOR]
    return found + ["open()" for node in ast.walk(source) if isinstance(node, ast.Call) and _called(node) == "open"]


def test_the_estimator_does_no_input_or_output_and_reads_no_clock() -> None:
    found = {str(path): beyond_computing(source) for path, source in trees() if path.parts[0] == "estimator"}
    assert {path: names for path, names in found.items() if names} == {}
    assert beyond_computing(ast.parse("import sqlite3\nfrom urllib import request\nopen('file')")) == [
        "sqlite3",
        "urllib",
        "open()",
    ]


def test_models_of_whole_trains_stand_where_the_fit_may_import() -> None:
    """Only the fit imports by a name that a form declares: the picture would not show another."""
    by_name = [
        str(path) for path, source in trees() if path.parts[0] == "estimator" and "import_module" in ast.unparse(source)
    ]
    assert by_name == ["estimator/fit/problem/train_models.py"]
    declared = [form.whole_train.model.split(":") for form in FORMS if form.whole_train is not None]
    assert ["estimator.statics.film_model", "film_model"] in declared
    assert {room(module) for module, _ in declared} <= set(ROOMS["estimator/fit/problem"])
    assert all(callable(getattr(import_module(module), function)) for module, function in declared)


def test_modules_that_are_imported_exist() -> None:
    """A half-moved import within a function would be found only when it is called."""
    known = {*files(), *(".".join(Path(one).parts) for path in files().values() for one in path.parents)}
    found = [
        f"{path}:{node.lineno} imports {node.module}"
        for path, source in trees()
        for node in statements(source)
        if isinstance(node, ast.ImportFrom) and node.module is not None and node.module.split(".")[0] in PACKAGES
        if node.module not in known and not node.module.startswith("storage.migrations")
    ]
    assert found == []


def said_imports(package: str) -> tuple[str, frozenset[str]]:
    """The clause in which a room says what it imports, empty without one, and the names of the rooms in it."""
    said = " ".join((ast.get_docstring(ast.parse((ROOT / package / "__init__.py").read_text())) or "").split())
    clause = re.search(r"\b(?:It|it|They|Its ground floor \([^)]*\)) (?:may import every room|imports? [^;.]*)", said)
    return (clause[0], frozenset(end(one) for one in re.findall(r"`([\w/]+)`", clause[0]))) if clause else ("", frozenset())


def end(room: str) -> str:
    """The last part of a room's name, by which others speak of it."""
    return room.rsplit("/", 1)[-1]


def below(rooms: Iterable[str]) -> set[str]:
    """Rooms that these import, and those that they import in turn."""
    found: set[str] = set()
    left = list(rooms)
    while left:
        one = left.pop()
        new = set(ROOMS[one]) - found
        found |= new
        left += new
    return found


@pytest.mark.parametrize("package", sorted(ROOMS))
def test_what_a_room_says_that_it_imports_is_an_arrow(package: str) -> None:
    _, named = said_imports(package)
    assert named - {end(one) for one in ROOMS[package]} == set()


def unsaid(package: str) -> list[str]:
    """Arrows of a room that its docstring says nothing of.

    The ground floor of the package, which every room may import, needs no word, nor do the packages below, of which the
    package's own docstring speaks. "What lies below" stands for what the rooms named with it import.
    """
    clause, named = said_imports(package)
    if "every room" in clause:
        return []
    own = package.split("/")[0]
    arrows = {one for one in ROOMS[package] if one.startswith(f"{own}/")}
    said = {one for one in arrows if end(one) in named}
    if "what lies below" in clause:
        said |= below(said)
    return sorted(arrows - said)


@pytest.mark.parametrize("package", sorted(set(ROOMS) - set(PACKAGES)))
def test_each_arrow_of_a_room_is_said(package: str) -> None:
    assert said_imports(package)[0] != "", f"{package}/__init__.py does not say what it imports"
    assert unsaid(package) == []
